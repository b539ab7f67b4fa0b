# Installs the library and builds tools/example against it as a stranger would: from elsewhere, with other
# flags than ours. Then runs it.
#   cmake -DBUILD=<build tree> -DSOURCE=<source tree> -DWORK=<scratch> -P use_installed.cmake
foreach(name BUILD SOURCE WORK)
  if(NOT ${name})
    message(FATAL_ERROR "use_installed.cmake needs -D${name}=…")
  endif()
endforeach()

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed with ${status}: ${ARGN}\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/prefix")
file(COPY "${SOURCE}/tools/example/" DESTINATION "${WORK}/example")
run("${CMAKE_COMMAND}" -S "${WORK}/example" -B "${WORK}/build" "-DCMAKE_PREFIX_PATH=${WORK}/prefix"
    -DCMAKE_BUILD_TYPE=None "-DCMAKE_CXX_FLAGS=-O1 -march=x86-64 -Wall -Wextra")
file(READ "${WORK}/build/CMakeCache.txt" cache)
if(NOT cache MATCHES "mbd_DIR:PATH=${WORK}/prefix")
  message(FATAL_ERROR "another libmbd was found than the one just installed")
endif()
run("${CMAKE_COMMAND}" --build "${WORK}/build")
foreach(program struck_arm driven_arm)
  run("${WORK}/build/${program}")
  message("${out}")
endforeach()
run("${WORK}/prefix/bin/mbd" --version)
message("${out}")
