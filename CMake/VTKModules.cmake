# SPDX-License-Identifier: BSD-3-Clause
# The VTK modules and, on top of them, the ParaView plugin.

# 9.2.20230111 is the VTK of ParaView 5.11, the first with CheckAbort; 9.3 has everything too.
set(hyperpatch_vtk_version 9.2.20230111)
set(hyperpatch_vtk_components
  CommonColor
  CommonCore
  CommonDataModel
  CommonExecutionModel
  CommonMisc
  CommonTransforms
  FiltersCore
  FiltersGeneral
  IOXML
  IOParallelXML
  ParallelCore)
set(hyperpatch_vtk_optional_components Python WrappingPythonCore)

if (HYPERPATCH_BUILD_PLUGIN)
  find_package(ParaView 5.11 REQUIRED COMPONENTS
    ProcessXML RemotingCore RemotingServerManager RemotingViews VTKExtensionsFiltersRendering
    VTKExtensionsIOCore WrapClientServer)
else ()
  # Once the VTK inside ParaView is in the cache it would be found alone, and ParaView be forgotten.
  if (NOT ParaView_DIR)
    find_package(VTK ${hyperpatch_vtk_version} QUIET COMPONENTS ${hyperpatch_vtk_components}
      OPTIONAL_COMPONENTS ${hyperpatch_vtk_optional_components})
  endif ()
  if (NOT VTK_FOUND)
    find_package(ParaView 5.11 REQUIRED COMPONENTS VTKExtensionsCore)
  endif ()
endif ()
if (ParaView_FOUND)
  # ParaView finds only what its own components need of the VTK inside it.
  find_package(VTK ${hyperpatch_vtk_version} REQUIRED COMPONENTS ${hyperpatch_vtk_components}
    OPTIONAL_COMPONENTS ${hyperpatch_vtk_optional_components}
    PATHS "${ParaView_DIR}/vtk" NO_DEFAULT_PATH)
endif ()

if (HYPERPATCH_BUILD_PLUGIN)
  paraview_plugin_scan(
    PLUGIN_FILES "${PROJECT_SOURCE_DIR}/Plugin/paraview.plugin"
    PROVIDES_PLUGINS hyperpatch_plugins
    REQUIRES_MODULES hyperpatch_required_modules
    ENABLE_BY_DEFAULT ON)
endif ()

set(hyperpatch_module_files
  "${PROJECT_SOURCE_DIR}/DataModel/vtk.module"
  "${PROJECT_SOURCE_DIR}/Readers/vtk.module"
  "${PROJECT_SOURCE_DIR}/Filters/vtk.module")
if (HYPERPATCH_BUILD_PLUGIN)
  list(APPEND hyperpatch_module_files "${PROJECT_SOURCE_DIR}/Plugin/Representation/vtk.module")
endif ()
vtk_module_scan(
  MODULE_FILES ${hyperpatch_module_files}
  PROVIDES_MODULES hyperpatch_modules
  WANT_BY_DEFAULT ON
  ENABLE_TESTS OFF)
list(REMOVE_ITEM hyperpatch_modules Hyperpatch::Representation)
vtk_module_build(
  MODULES ${hyperpatch_modules}
  PACKAGE Hyperpatch
  VERSION "${PROJECT_VERSION}"
  SOVERSION "${hyperpatch_soversion}"
  INSTALL_EXPORT Hyperpatch
  HEADERS_DESTINATION "${hyperpatch_headers_destination}"
  CMAKE_DESTINATION "${hyperpatch_cmake_destination}"
  TEST_DIRECTORY_NAME NONE)

if (HYPERPATCH_BUILD_PLUGIN)
  # What only the plugin uses has no place in the CMake package.
  vtk_module_build(
    MODULES Hyperpatch::Representation
    PACKAGE HyperpatchPlugin
    VERSION "${PROJECT_VERSION}"
    SOVERSION "${hyperpatch_soversion}"
    INSTALL_HEADERS OFF
    TEST_DIRECTORY_NAME NONE)
  paraview_plugin_build(
    PLUGINS ${hyperpatch_plugins}
    PLUGINS_FILE_NAME hyperpatch.plugins.xml
    RUNTIME_DESTINATION "${CMAKE_INSTALL_BINDIR}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY_SUBDIRECTORY "${PARAVIEW_PLUGIN_SUBDIR}")
endif ()

if (NOT HYPERPATCH_BUILD_PYTHON)
  message(STATUS "Python modules: off (HYPERPATCH_BUILD_PYTHON)")
elseif (VTK_WRAP_PYTHON AND TARGET VTK::WrappingPythonCore AND BUILD_SHARED_LIBS)
  include(CMake/PythonModules.cmake)
else ()
  message(STATUS "Python modules: skipped, VTK was built without Python or we build static")
endif ()
