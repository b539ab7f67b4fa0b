# Finds KINSOL and the serial vectors of SUNDIALS (BSD-3-Clause), and nothing else of it: the CMake config of
# Debian's libsundials-dev also asks for MPI, PETSc and others that its optional parts are built with.
# Defines the target KINSOL::KINSOL.

find_path(KINSOL_INCLUDE_DIR kinsol/kinsol.h)
find_library(KINSOL_LIBRARY sundials_kinsol)
find_library(KINSOL_NVECTOR_LIBRARY sundials_nvecserial)
if(KINSOL_INCLUDE_DIR)
  file(STRINGS "${KINSOL_INCLUDE_DIR}/sundials/sundials_config.h" line
       REGEX "^#define SUNDIALS_VERSION +\"")
  string(REGEX REPLACE "^.*\"([0-9.]+)\".*$" "\\1" KINSOL_VERSION "${line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(KINSOL
  REQUIRED_VARS KINSOL_LIBRARY KINSOL_NVECTOR_LIBRARY KINSOL_INCLUDE_DIR
  VERSION_VAR KINSOL_VERSION
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsundials-dev")

if(KINSOL_FOUND AND NOT TARGET KINSOL::KINSOL)
  add_library(KINSOL::KINSOL UNKNOWN IMPORTED)
  set_target_properties(KINSOL::KINSOL PROPERTIES
    IMPORTED_LOCATION "${KINSOL_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${KINSOL_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${KINSOL_NVECTOR_LIBRARY}")
endif()

mark_as_advanced(KINSOL_INCLUDE_DIR KINSOL_LIBRARY KINSOL_NVECTOR_LIBRARY)
