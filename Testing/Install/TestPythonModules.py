# SPDX-License-Identifier: BSD-3-Clause
"""The Python package: import, a pipeline, help and type hints."""
import ast
import os
import pydoc
import unittest

import hyperpatch
from hyperpatch.vtkNURBSFilters import vtkNURBSContour, vtkNURBSSlice, vtkNURBSTessellate
from hyperpatch.vtkNURBSReaders import vtkBSplineReader
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPlane

FOLDER = os.environ['HYPERPATCH_PYTHON']
PIPE = os.path.join(os.environ['HYPERPATCH_DATA'], 'heated_pipe_bend.vtpc')


class PythonModules(unittest.TestCase):
    def setUp(self):
        self.reader = vtkBSplineReader()
        self.reader.SetFileName(PIPE)

    def test_the_package_is_the_one_under_test(self):
        self.assertEqual(os.path.realpath(os.path.dirname(hyperpatch.__file__)),
                         os.path.realpath(os.path.join(FOLDER, 'hyperpatch')))

    def test_a_slice_lies_on_its_plane(self):
        plane = vtkPlane()
        plane.SetOrigin(1.5, 1.5, 0.0)
        plane.SetNormal(0.0, 1.0, 0.0)
        cut = vtkNURBSSlice()
        cut.SetSliceFunction(plane)
        cut.SetInputConnection(self.reader.GetOutputPort())
        cut.Update()
        points = vtk_to_numpy(cut.GetOutputDataObject(0).GetPoints().GetData())
        self.assertGreater(len(points), 100)
        # 1e-12 of the model's size, as the README promises.
        self.assertLess(abs(points[:, 1] - 1.5).max(), 1e-12 * abs(points).max())

    def test_a_contour_has_its_value(self):
        contour = vtkNURBSContour()
        contour.SetInputConnection(self.reader.GetOutputPort())
        contour.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS,
                                       'Temperature')
        contour.SetNumberOfContours(1)
        contour.SetValue(0, 100.0)
        contour.Update()
        values = vtk_to_numpy(
            contour.GetOutputDataObject(0).GetPointData().GetArray('Temperature'))
        self.assertGreater(len(values), 100)
        self.assertLess(abs(values - 100.0).max(), 1e-12 * 100.0)

    def test_help_reads_well(self):
        text = pydoc.render_doc(vtkNURBSTessellate, renderer=pydoc.plaintext)
        self.assertIn('SetMeshTypeToSolid', text)
        self.assertIn('Filip, Magedson, Markot', text)
        self.assertIn('range 1e-12 and up', pydoc.render_doc(
            vtkNURBSTessellate.SetTolerance, renderer=pydoc.plaintext))
        self.assertIn('vtkBSplineReader', pydoc.render_doc(hyperpatch, renderer=pydoc.plaintext))

    @unittest.skipUnless(os.environ['HYPERPATCH_TYPE_HINTS'] == 'ON', 'built without type hints')
    def test_type_hints_are_python_and_name_the_classes(self):
        for module, name in (('vtkNURBSFilters', 'vtkNURBSSlice'),
                             ('vtkNURBSReaders', 'vtkBSplineReader')):
            with open(os.path.join(FOLDER, 'hyperpatch', module + '.pyi'), encoding='utf-8') as file:
                tree = ast.parse(file.read())
            classes = [node.name for node in tree.body if isinstance(node, ast.ClassDef)]
            self.assertIn(name, classes)


if __name__ == '__main__':
    unittest.main()
