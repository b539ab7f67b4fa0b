# Finds solvers of SUNDIALS (BSD-3-Clause) by component, and its serial vectors, and nothing else of it: the CMake
# config of Debian's libsundials-dev also asks for MPI, PETSc and others that its optional parts are built with.
# Defines a target SUNDIALS::<component>, such as SUNDIALS::ida, for each component.

find_path(SUNDIALS_INCLUDE_DIR sundials/sundials_config.h)
find_library(SUNDIALS_NVECTOR_LIBRARY sundials_nvecserial)
foreach(component IN LISTS SUNDIALS_FIND_COMPONENTS)
  find_library(SUNDIALS_${component}_LIBRARY sundials_${component})
  mark_as_advanced(SUNDIALS_${component}_LIBRARY)
  if(SUNDIALS_${component}_LIBRARY)
    set(SUNDIALS_${component}_FOUND TRUE)
  endif()
endforeach()
if(SUNDIALS_INCLUDE_DIR)
  file(STRINGS "${SUNDIALS_INCLUDE_DIR}/sundials/sundials_config.h" line
       REGEX "^#define SUNDIALS_VERSION +\"")
  string(REGEX REPLACE "^.*\"([0-9.]+)\".*$" "\\1" SUNDIALS_VERSION "${line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SUNDIALS
  REQUIRED_VARS SUNDIALS_INCLUDE_DIR SUNDIALS_NVECTOR_LIBRARY
  VERSION_VAR SUNDIALS_VERSION
  HANDLE_COMPONENTS
  REASON_FAILURE_MESSAGE "On Debian: apt-get install libsundials-dev")

foreach(component IN LISTS SUNDIALS_FIND_COMPONENTS)
  if(SUNDIALS_FOUND AND NOT TARGET SUNDIALS::${component})
    add_library(SUNDIALS::${component} UNKNOWN IMPORTED)
    set_target_properties(SUNDIALS::${component} PROPERTIES
      IMPORTED_LOCATION "${SUNDIALS_${component}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${SUNDIALS_INCLUDE_DIR}"
      INTERFACE_LINK_LIBRARIES "${SUNDIALS_NVECTOR_LIBRARY}")
  endif()
endforeach()

mark_as_advanced(SUNDIALS_INCLUDE_DIR SUNDIALS_NVECTOR_LIBRARY)
