# Installs the library and uses it as a stranger would: from elsewhere, with other flags than ours, by CMake and by pkg-config.
#   cmake -DBUILD=<build tree> -DSOURCE=<source tree> -DWORK=<scratch> -P use_installed.cmake
# Tried on what is installed, and killed: a header with the includes of the tree, or one that does not look at the alignment; another
# directory beside mbd/; the definitions, or KLU, left out of mbd.pc; the assertion left out of abi.hpp; its symbol not asked for; the
# manual, or a page that others link to, not installed.
cmake_minimum_required(VERSION 3.25)
include("${CMAKE_CURRENT_LIST_DIR}/package.cmake")

file(REMOVE_RECURSE "${WORK}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${WORK}/prefix")
set(only "")  # all of them
build_examples(-DCMAKE_BUILD_TYPE=None "-DCMAKE_CXX_FLAGS=-O0 -march=x86-64 -Wall -Wextra")
use_pkg_config()
refuse_other_alignment()
look_at_headers()
look_at_documents()

# Heavy libraries come when they are used.
run("${WORK}/prefix/bin/mbd" --version)
message("${out}")
loaded_by(out "${SOURCE}/models/pendulum.xml")
if(out MATCHES "libsundials|libdmumps|libmetis|libhdf5")
  message(FATAL_ERROR "a run that needs none of them loads ${CMAKE_MATCH_0}:\n${out}")
endif()
loaded_by(out "${SOURCE}/models/pendulum.xml" --method ida --tolerance 1e-6)
if(NOT out MATCHES "libsundials_ida")
  message(FATAL_ERROR "a run by IDA does not load it:\n${out}")
endif()
