# Packages for Debian by CPack, a component each: mbd (the program), libmbd-multibody-dev (Debian's libmbd is another library),
# python3-mbd and, where the library is shared for its levels (MBD_PORTABLE), libmbd-multibody0.1. tools/packages builds them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME mbd)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_CONTACT "the developers of libmbd <libmbd@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program library)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)

# What is loaded when it is needed is not linked, so dpkg-shlibdeps does not see it.
set(mbd_loaded "")
find_program(MBD_DPKG_QUERY dpkg-query)
mark_as_advanced(MBD_DPKG_QUERY)
foreach(library IN ITEMS "${MUMPS_LIBRARY}" "${MBD_HDF5_LIBRARY}" "${MBD_METIS_LIBRARY}" "${MBD_ASSIMP_LIBRARY}")
  if(MBD_DPKG_QUERY AND EXISTS "${library}")
    file(REAL_PATH "${library}" library)
    execute_process(COMMAND "${MBD_DPKG_QUERY}" --search "${library}" OUTPUT_VARIABLE owner ERROR_QUIET)
    if(owner MATCHES "^([a-z0-9.+-]+)[:,]")
      list(APPEND mbd_loaded "${CMAKE_MATCH_1}")
    endif()
  endif()
endforeach()
list(JOIN mbd_loaded ", " mbd_loaded)

set(mbd_for "")
if(MBD_NATIVE)
  set(mbd_for " This one runs on processors like that of the machine it was built on.")
endif()
set(mbd_library_kind "static")
set(mbd_needs "${mbd_loaded}")
set(mbd_library_needs "libfmt-dev, libsuitesparse-dev, libsundials-dev, libtinyxml2-dev, libudunits2-dev, zlib1g-dev, ${mbd_loaded}")
if(MBD_PORTABLE)
  set(mbd_library_kind "shared")
  set(mbd_runtime "libmbd-multibody${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
  # Its own: program, module and library use one another's inside, so they are of one version.
  set(mbd_needs "${mbd_runtime} (= ${PROJECT_VERSION})")
  set(mbd_library_needs "${mbd_needs}")
  list(APPEND CPACK_COMPONENTS_ALL runtime)
  list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}")
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME "${mbd_runtime}")
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "${mbd_loaded}")
  set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
      "flexible multibody dynamics: the shared library
 For any x86-64-v2, with kernels for x86-64-v3 (AVX2) and x86-64-v4 (AVX-512) that the loader takes where the processor has them.")
  install(FILES LICENSE DESTINATION "share/doc/${mbd_runtime}" RENAME copyright COMPONENT runtime EXCLUDE_FROM_ALL)
endif()
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME mbd)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${mbd_needs}")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "flexible multibody dynamics: the program
 Computes how machines made of rigid and bending parts move, and what forces that takes, from models in XML.${mbd_for}")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libmbd-multibody-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libeigen3-dev, ${mbd_library_needs}")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
    "flexible multibody dynamics: the library (C++20)
 The ${mbd_library_kind} library, its headers, and what find_package(mbd CONFIG) reads.${mbd_for}")
install(FILES LICENSE DESTINATION share/doc/mbd RENAME copyright COMPONENT program EXCLUDE_FROM_ALL)
install(FILES LICENSE DESTINATION share/doc/libmbd-multibody-dev RENAME copyright COMPONENT library EXCLUDE_FROM_ALL)

if(MBD_PYTHON_FOUND)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-mbd)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  string(REGEX MATCH "^([0-9]+)[.]([0-9]+)" python "${MBD_PYTHON_VERSION}")
  math(EXPR next "${CMAKE_MATCH_2} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${python}), python3 (<< ${CMAKE_MATCH_1}.${next}), python3-numpy, ${mbd_needs}")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-pandas, python3-matplotlib")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "mbd, python3-distributed")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
      "flexible multibody dynamics: the Python module
 Loads, runs, steps, controls and sweeps models; arrays are NumPy's.${mbd_for}")
  set(packages lib/python3/dist-packages/mbd)
  install(TARGETS mbd_python DESTINATION "${packages}" COMPONENT python EXCLUDE_FROM_ALL)
  install(DIRECTORY tools/python/mbd/ DESTINATION "${packages}" COMPONENT python EXCLUDE_FROM_ALL
          FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed")
  install(FILES LICENSE DESTINATION share/doc/python3-mbd RENAME copyright COMPONENT python EXCLUDE_FROM_ALL)
endif()

include(CPack)
