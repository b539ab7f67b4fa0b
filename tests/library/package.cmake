# What use_installed.cmake and shared.cmake have in common: checks of what is installed in ${WORK}/prefix.
cmake_minimum_required(VERSION 3.25)

foreach(name BUILD SOURCE WORK)
  if(NOT ${name})
    message(FATAL_ERROR "this test needs -D${name}=…")
  endif()
endforeach()
set(prefix "${WORK}/prefix")

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed with ${status}: ${ARGN}\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

# The command has to fail and to say so.
function(fails says)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(status EQUAL 0)
    message(FATAL_ERROR "goes well, and should not: ${ARGN}\n${out}")
  endif()
  if(NOT out MATCHES "${says}")
    message(FATAL_ERROR "does not say \"${says}\": ${ARGN}\n${out}")
  endif()
endfunction()

# The programs of the guide by find_package(), those in `only` or all, and what they say of themselves.
function(build_examples)
  file(COPY "${SOURCE}/tools/example/" DESTINATION "${WORK}/example")
  # They include <mbd/mbd.hpp> all of them, which is most of what there is to compile: once.
  set(precompile "")
  file(GLOB names RELATIVE "${SOURCE}/tools/example" "${SOURCE}/tools/example/*.cpp")
  list(TRANSFORM names REPLACE "[.]cpp$" "")
  list(POP_FRONT names first)
  string(APPEND precompile "cmake_language(DEFER CALL target_precompile_headers ${first} PRIVATE <mbd/mbd.hpp>)\n")
  foreach(name IN LISTS names)
    string(APPEND precompile "cmake_language(DEFER CALL target_precompile_headers ${name} REUSE_FROM ${first})\n")
  endforeach()
  file(WRITE "${WORK}/precompile.cmake" "${precompile}")
  run("${CMAKE_COMMAND}" -S "${WORK}/example" -B "${WORK}/build" "-DCMAKE_PREFIX_PATH=${prefix}"
      "-DCMAKE_PROJECT_INCLUDE=${WORK}/precompile.cmake" ${ARGN})
  file(READ "${WORK}/build/CMakeCache.txt" cache)
  if(NOT cache MATCHES "mbd_DIR:PATH=${prefix}")
    message(FATAL_ERROR "another libmbd was found than the one just installed")
  endif()
  set(programs "${only}")
  if(NOT programs)
    file(GLOB programs RELATIVE "${SOURCE}/tools/example" "${SOURCE}/tools/example/*.cpp")
    list(TRANSFORM programs REPLACE "[.]cpp$" "")
  endif()
  run("${CMAKE_COMMAND}" --build "${WORK}/build" --target ${programs})
  foreach(program IN LISTS programs)
    run("${WORK}/build/${program}")
    message("${program}: ${out}")
  endforeach()
endfunction()

find_program(cxx NAMES c++ g++ REQUIRED)
find_program(cc NAMES cc gcc)
find_program(pkg_config NAMES pkg-config pkgconf)

function(ask_pkg_config variable)
  set(ENV{PKG_CONFIG_PATH} "${prefix}/lib/pkgconfig:${prefix}/lib64/pkgconfig")
  file(GLOB multiarch "${prefix}/lib/*/pkgconfig")
  if(multiarch)
    set(ENV{PKG_CONFIG_PATH} "$ENV{PKG_CONFIG_PATH}:${multiarch}")
  endif()
  execute_process(COMMAND "${pkg_config}" ${ARGN} mbd OUTPUT_VARIABLE text ERROR_VARIABLE why RESULT_VARIABLE status
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "pkg-config ${ARGN} mbd: ${why}")
  endif()
  separate_arguments(words UNIX_COMMAND "${text}")
  set(${variable} "${words}" PARENT_SCOPE)
endfunction()

set(small "#include <mbd/mbd.hpp>
#include <cstdio>
int main() {
  const mbd::Model model = mbd::compile(mbd::read_model_text(R\"(<mbd name='s'><body name='b' mass='2' inertia='1 1 1'/>
    <transient duration='1' step='0.5'/></mbd>)\"));
  std::printf(\"%g kg\", model.mass);
}
")

function(use_pkg_config)
  if(NOT pkg_config)
    message("skipped: there is no pkg-config")
    return()
  endif()
  file(WRITE "${WORK}/small.cpp" "${small}")
  ask_pkg_config(cflags --cflags)
  ask_pkg_config(libs --libs)
  run("${cxx}" -std=c++20 -O0 -march=x86-64 ${cflags} "${WORK}/small.cpp" -o "${WORK}/small" ${libs} "-Wl,-rpath,${prefix}/lib")
  run("${WORK}/small")
  if(NOT out STREQUAL "2 kg")
    message(FATAL_ERROR "the program by pkg-config says \"${out}\"")
  endif()
  if(cc)  # the interface of plug-ins is plain C
    file(WRITE "${WORK}/plugin.c" "#include <mbd/plugin.h>
static int zero(void* self, const struct mbd_motion* at, double* wrenches) { (void)self; (void)at; (void)wrenches; return 1; }
static const struct mbd_force forces[] = {{\"zero\", 0, zero, 0, 0, 0}};
static const struct mbd_plugin plugin = {MBD_PLUGIN_VERSION, 1, forces};
const struct mbd_plugin* mbd_get_plugin(void) { return &plugin; }
")
    run("${cc}" -std=c99 -Wall -Wextra -pedantic -Werror -fPIC -shared "-I${prefix}/include" "${WORK}/plugin.c" -o "${WORK}/plugin.so")
  endif()
endfunction()

# A program of another alignment is refused when it is compiled; and where its headers say otherwise than the library, when it is linked.
function(refuse_other_alignment)
  file(READ "${prefix}/include/mbd/abi.hpp" abi)
  if(NOT abi MATCHES "EIGEN_MAX_ALIGN_BYTES == ([0-9]+)")
    message(FATAL_ERROR "abi.hpp says no alignment")
  endif()
  set(own "${CMAKE_MATCH_1}")
  set(other 32)
  if(own EQUAL 32)
    set(other 16)
  endif()
  file(WRITE "${WORK}/small.cpp" "${small}")
  find_path(eigen Eigen/Core PATHS /usr/include/eigen3 REQUIRED)
  set(compile "${cxx}" -std=c++20 -O0 "-I${eigen}" -c "${WORK}/small.cpp" -o "${WORK}/small.o")
  fails("this libmbd aligns arrays of Eigen to ${own} bytes" ${compile} "-I${prefix}/include" "-DEIGEN_MAX_ALIGN_BYTES=${other}")
  fails("this libmbd aligns arrays of Eigen to ${own} bytes" ${compile} "-I${prefix}/include" "-DEIGEN_MAX_ALIGN_BYTES=${own}"
        "-DEIGEN_MAX_STATIC_ALIGN_BYTES=${own}" -DEIGEN_MALLOC_ALREADY_ALIGNED=1)

  if(NOT pkg_config)
    return()
  endif()
  file(COPY "${prefix}/include/mbd" DESTINATION "${WORK}/other")  # as installed with a library of that alignment
  string(REPLACE "BYTES == ${own}" "BYTES == ${other}" abi "${abi}")
  string(REPLACE "eigen_${own}" "eigen_${other}" abi "${abi}")
  file(WRITE "${WORK}/other/mbd/abi.hpp" "${abi}")
  ask_pkg_config(cflags --cflags)
  ask_pkg_config(libs --libs)
  list(TRANSFORM cflags REPLACE "BYTES=${own}" "BYTES=${other}")
  run(${compile} "-I${WORK}/other" ${cflags})
  fails("undefined reference to [^\n]*mbd_abi_[0-9_]+_eigen_${other}" "${cxx}" "${WORK}/small.o" -o "${WORK}/small" ${libs})
endfunction()

# One directory, with one name in it, and every header for itself.
function(look_at_headers)
  file(GLOB roots RELATIVE "${prefix}/include" "${prefix}/include/*")
  if(NOT roots STREQUAL "mbd")
    message(FATAL_ERROR "include has ${roots}")
  endif()
  file(GLOB_RECURSE headers "${prefix}/include/*.hpp")
  list(LENGTH headers count)
  if(count LESS 150)
    message(FATAL_ERROR "only ${count} headers are installed")
  endif()
  foreach(header IN LISTS headers)
    file(STRINGS "${header}" includes REGEX "^#include")
    foreach(line IN LISTS includes)
      if(line MATCHES "<mbd/([^>]+)>")
        if(NOT EXISTS "${prefix}/include/mbd/${CMAKE_MATCH_1}")
          message(FATAL_ERROR "${header}: ${line}: there is none")
        endif()
      elseif(line MATCHES "\"")
        message(FATAL_ERROR "${header}: ${line}")
      endif()
    endforeach()
    if(NOT header MATCHES "/abi.hpp$" AND NOT "#include <mbd/abi.hpp>" IN_LIST includes)
      message(FATAL_ERROR "${header} does not look at the alignment")
    endif()
  endforeach()
endfunction()

# Pages, models and examples, and what the pages link to.
function(look_at_documents)
  set(documents "${prefix}/share/doc/mbd")
  foreach(page IN ITEMS README.md LICENSE libmbd/ENGINE.md libmbd/NOTATION.md models/GUIDE.md models/MANUAL.md models/four_bar.xml
                        tools/example/four_bar.cpp tools/example/CMakeLists.txt)
    if(NOT EXISTS "${documents}/${page}")
      message(FATAL_ERROR "${page} is not installed")
    endif()
  endforeach()
  foreach(page IN ITEMS README.md libmbd/ENGINE.md libmbd/NOTATION.md models/GUIDE.md models/MANUAL.md models/STUDIES.md)
    file(READ "${documents}/${page}" text)
    string(REPLACE ";" "," text "${text}")
    string(REPLACE "](" "<to>" text "${text}")  # brackets would make one item of several
    string(REGEX REPLACE "[][]" " " text "${text}")
    string(REGEX MATCHALL "<to>[^)#: ]+" links "${text}")
    list(FILTER links EXCLUDE REGEX "^<to>https?$")
    get_filename_component(here "${documents}/${page}" DIRECTORY)
    foreach(link IN LISTS links)
      string(SUBSTRING "${link}" 4 -1 link)
      if(NOT EXISTS "${here}/${link}")
        message(FATAL_ERROR "${page} links to ${link}, which is not installed")
      endif()
    endforeach()
  endforeach()
endfunction()

# What the dynamic linker says of a run.
function(loaded_by variable model)
  set(ENV{LD_DEBUG} files)
  execute_process(COMMAND "${prefix}/bin/mbd" run "${model}" --out "${WORK}/results" --quiet ${ARGN}
                  RESULT_VARIABLE status ERROR_VARIABLE text OUTPUT_VARIABLE ignored)
  unset(ENV{LD_DEBUG})
  if(status EQUAL 1 OR status GREATER 2)  # 2: other numbers than those of the model's own method
    message(FATAL_ERROR "mbd run ${model} ${ARGN} ends with ${status}\n${text}")
  endif()
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()
