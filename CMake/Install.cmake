# SPDX-License-Identifier: BSD-3-Clause
# The CMake package Hyperpatch, in the build tree and in the installed one, and what is beside code.
include(CMakePackageConfigHelpers)

set(hyperpatch_find_static_dependencies)
if (NOT BUILD_SHARED_LIBS)
  set(hyperpatch_find_static_dependencies "find_dependency(pugixml)\n")
  # Static libraries name what they link privately.
  install(TARGETS HyperpatchOptions EXPORT Hyperpatch)
endif ()

set(hyperpatch_find_vtk)
if (NOT HYPERPATCH_BUILD_VTK)
  # Where there are VTK modules, vtk_module_build() exports the targets.
  export(EXPORT Hyperpatch NAMESPACE Hyperpatch::
    FILE "${CMAKE_BINARY_DIR}/${hyperpatch_cmake_destination}/Hyperpatch-targets.cmake")
  install(EXPORT Hyperpatch NAMESPACE Hyperpatch:: DESTINATION "${hyperpatch_cmake_destination}"
    FILE Hyperpatch-targets.cmake)
elseif (ParaView_FOUND)
  string(CONFIGURE [[
# The VTK inside ParaView. It stays VTK_DIR: further find_package(VTK) find the same one.
find_dependency(ParaView @ParaView_VERSION_MAJOR@.@ParaView_VERSION_MINOR@
  COMPONENTS VTKExtensionsCore)
find_dependency(VTK @VTK_VERSION@ COMPONENTS CommonCore CommonDataModel CommonExecutionModel
  PATHS "${ParaView_DIR}/vtk" NO_DEFAULT_PATH)
]] hyperpatch_find_vtk @ONLY)
else ()
  string(CONFIGURE [[
find_dependency(VTK @VTK_VERSION@ COMPONENTS CommonCore CommonDataModel CommonExecutionModel)
]] hyperpatch_find_vtk @ONLY)
endif ()

set(config "${CMAKE_BINARY_DIR}/${hyperpatch_cmake_destination}/HyperpatchConfig.cmake")
set(config_version
  "${CMAKE_BINARY_DIR}/${hyperpatch_cmake_destination}/HyperpatchConfigVersion.cmake")
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/HyperpatchConfig.cmake.in" "${config}"
  INSTALL_DESTINATION "${hyperpatch_cmake_destination}"
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${config_version}" COMPATIBILITY SameMinorVersion)
install(FILES "${config}" "${config_version}" DESTINATION "${hyperpatch_cmake_destination}")

install(FILES LICENSE README.md CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
# Side by side, as the example state names its file by a relative path.
install(DIRECTORY Data Examples DESTINATION "${CMAKE_INSTALL_DATADIR}/hyperpatch"
  PATTERN __pycache__ EXCLUDE)
