# SPDX-License-Identifier: BSD-3-Clause
# The Python package hyperpatch: one module per VTK module, with type hints.
set(hyperpatch_python_modules Hyperpatch::Readers Hyperpatch::Filters)

# Beside the modules of ParaView (if it has the same prefix they are found without PYTHONPATH).
if (PARAVIEW_PYTHONPATH)
  string(REGEX REPLACE "^lib/" "${CMAKE_INSTALL_LIBDIR}/" default_destination
    "${PARAVIEW_PYTHONPATH}")
else ()
  vtk_module_python_default_destination(default_destination)
endif ()
set(HYPERPATCH_PYTHON_DESTINATION "${default_destination}" CACHE STRING
  "Where Python modules are installed, relative to the prefix")

# Hints come from the built modules, so they need an interpreter that can import them.
set(hyperpatch_type_hints OFF)
if (Python3_EXECUTABLE)
  execute_process(COMMAND "${Python3_EXECUTABLE}" -c "import vtkmodules.generate_pyi"
    RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if (status EQUAL 0)
    set(hyperpatch_type_hints ON)
  endif ()
endif ()

vtk_module_wrap_python(
  MODULES ${hyperpatch_python_modules}
  TARGET Hyperpatch::Python
  PYTHON_PACKAGE hyperpatch
  MODULE_DESTINATION "${HYPERPATCH_PYTHON_DESTINATION}"
  LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  INSTALL_HEADERS OFF
  BUILD_STATIC OFF
  BUILD_PYI_FILES ${hyperpatch_type_hints})
configure_file("${CMAKE_CURRENT_LIST_DIR}/__init__.py.in"
  "${CMAKE_BINARY_DIR}/${HYPERPATCH_PYTHON_DESTINATION}/hyperpatch/__init__.py" @ONLY)
install(FILES "${CMAKE_BINARY_DIR}/${HYPERPATCH_PYTHON_DESTINATION}/hyperpatch/__init__.py"
  DESTINATION "${HYPERPATCH_PYTHON_DESTINATION}/hyperpatch")
message(STATUS
  "Python modules: in ${HYPERPATCH_PYTHON_DESTINATION}, type hints ${hyperpatch_type_hints}")
