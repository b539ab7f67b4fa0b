# Untested: vcpkg is not there where this was written.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../../.." ABSOLUTE)
# vcpkg_from_git(OUT_SOURCE_PATH SOURCE_PATH URL … REF …)
vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}" OPTIONS
  -DMBD_BUILD_TESTS=OFF -DMBD_WERROR=OFF -DMBD_UNITY=ON -DMBD_PYTHON=OFF -DMBD_HDF5=OFF -DMBD_METIS=OFF
  "-DMUMPS_LIBRARY=${CURRENT_INSTALLED_DIR}/lib/libdmumps.a")
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME mbd CONFIG_PATH lib/cmake/mbd)
vcpkg_copy_tools(TOOL_NAMES mbd AUTO_CLEAN)
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
