# Builds the shared library, unoptimised, and uses it: what it exports and needs, its name, and programs of another alignment.
#   cmake -DBUILD=<scratch build tree> -DSOURCE=<source tree> -DWORK=<scratch> -P shared.cmake
# Tried, and killed: no version script; one that exports std and Eigen, or not the symbol of the alignment; no version in the name;
# SUNDIALS linked.
cmake_minimum_required(VERSION 3.25)
include("${CMAKE_CURRENT_LIST_DIR}/package.cmake")

run("${CMAKE_COMMAND}" -G Ninja -S "${SOURCE}" -B "${BUILD}" -DBUILD_SHARED_LIBS=ON -DMBD_BUILD_TESTS=OFF -DMBD_PYTHON=OFF
    -DMBD_UNITY=ON -DMBD_PRECOMPILE=ON -DMBD_FIXED_ORDERS=OFF -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O0)
run("${CMAKE_COMMAND}" --build "${BUILD}" --target mbd)
file(REMOVE_RECURSE "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${prefix}" --component library)
file(GLOB library "${prefix}/lib/libmbd.so" "${prefix}/lib/*/libmbd.so")
file(REAL_PATH "${library}" file)

# ---- what it exports: tools/cmake/mbd.map ----
find_program(nm nm REQUIRED)
run("${nm}" --dynamic --defined-only --format=posix "${file}")
string(REGEX REPLACE " [^\n]*\n" ";" symbols "${out}")
list(FILTER symbols EXCLUDE REGEX "^$")
list(LENGTH symbols count)
set(foreign "${symbols}")
# Functions; tables, type information and thunks of classes; statics of functions.
list(FILTER foreign EXCLUDE REGEX "^_ZN?K?(N|NK)3mbd|^_ZN3mbd|^_ZNK3mbd|^_ZT[VTIS]N3mbd|^_ZT[hv][^N]*_NK?3mbd|^_ZG?V?ZNK?3mbd|^_ZGVN3mbd|^_ZT[HW]N3mbd")
if(NOT foreign MATCHES "^mbd_abi_[0-9]+_[0-9]+_eigen_[0-9]+$")
  string(REPLACE ";" "\n  " foreign "${foreign}")
  message(FATAL_ERROR "it exports more than namespace mbd and one symbol:\n  ${foreign}")
endif()
foreach(needed IN ITEMS _ZN3mbd10read_model _ZN3mbd7compile _ZN3mbd3run _ZN3mbd12make_stepper _ZN3mbd9linearize _ZTIN3mbd5Error)
  if(NOT symbols MATCHES "(^|;)${needed}")
    message(FATAL_ERROR "it does not export ${needed}")
  endif()
endforeach()
message("${count} symbols exported")

# ---- its name, and what it needs ----
find_program(readelf readelf REQUIRED)
run("${readelf}" --dynamic --wide "${file}")
if(NOT out MATCHES "SONAME[^\n]*\\[libmbd[.]so[.][0-9]+[.][0-9]+\\]")
  message(FATAL_ERROR "it has no name with a version:\n${out}")
endif()
if(out MATCHES "NEEDED[^\n]*(sundials|mumps|metis|hdf5|gtest|yaml|png|webp)[^\n]*")
  message(FATAL_ERROR "it needs ${CMAKE_MATCH_0}")
endif()
if(out MATCHES "TEXTREL")
  message(FATAL_ERROR "it is not position independent")
endif()

set(only four_bar struck_arm own_forces)  # the library is not optimised
build_examples(-DCMAKE_BUILD_TYPE=None "-DCMAKE_CXX_FLAGS=-O1 -Wall -Wextra")
use_pkg_config()
refuse_other_alignment()
look_at_headers()

# ---- another library of that name in its place: of another alignment, it has another symbol ----
file(WRITE "${WORK}/small.cpp" "#include <mbd/core/types.hpp>\nint main() { return mbd::abi::needed == nullptr; }\n")
ask_pkg_config(cflags --cflags)
ask_pkg_config(libs --libs)
run("${cxx}" -std=c++20 ${cflags} "${WORK}/small.cpp" -o "${WORK}/small" ${libs} "-Wl,-rpath,${WORK}/stub")
file(WRITE "${WORK}/stub.cpp" "extern \"C\" { extern const char mbd_abi_0_1_eigen_8; const char mbd_abi_0_1_eigen_8 = 0; }\n")
get_filename_component(name "${file}" NAME)
string(REGEX REPLACE "[.][0-9]+$" "" name "${name}")  # libmbd.so.0.1
file(MAKE_DIRECTORY "${WORK}/stub")
run("${cxx}" -shared -fPIC "${WORK}/stub.cpp" "-Wl,-soname,${name}" -o "${WORK}/stub/${name}")
fails("mbd_abi_[0-9_]+_eigen_[0-9]+" "${WORK}/small")
