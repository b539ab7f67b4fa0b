# Finds IDA and the serial vectors of SUNDIALS (BSD-3-Clause), and nothing else of it: the CMake config of
# Debian's libsundials-dev also asks for MPI, PETSc and others that its optional parts are built with.
# Defines the target IDA::IDA.

find_path(IDA_INCLUDE_DIR ida/ida.h)
find_library(IDA_LIBRARY sundials_ida)
find_library(IDA_NVECTOR_LIBRARY sundials_nvecserial)
if(IDA_INCLUDE_DIR)
  file(STRINGS "${IDA_INCLUDE_DIR}/sundials/sundials_config.h" line
       REGEX "^#define SUNDIALS_VERSION +\"")
  string(REGEX REPLACE "^.*\"([0-9.]+)\".*$" "\\1" IDA_VERSION "${line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(IDA
  REQUIRED_VARS IDA_LIBRARY IDA_NVECTOR_LIBRARY IDA_INCLUDE_DIR
  VERSION_VAR IDA_VERSION
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsundials-dev")

if(IDA_FOUND AND NOT TARGET IDA::IDA)
  add_library(IDA::IDA UNKNOWN IMPORTED)
  set_target_properties(IDA::IDA PROPERTIES
    IMPORTED_LOCATION "${IDA_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${IDA_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${IDA_NVECTOR_LIBRARY}")
endif()

mark_as_advanced(IDA_INCLUDE_DIR IDA_LIBRARY IDA_NVECTOR_LIBRARY)
