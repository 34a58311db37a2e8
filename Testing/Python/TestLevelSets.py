# SPDX-License-Identifier: BSD-3-Clause
"""Boxes in NURBS Slice, what NURBS Contour draws besides attributes, and NURBS Clip."""
import os
import unittest

import numpy

import common
from paraview import simple, smstate
from vtkmodules.util.numpy_support import vtk_to_numpy

TUBE = os.path.join(common.DATA, 'tube_on_block.xml')


def integral(proxy, name):
    sizes = common.fetch(simple.IntegrateVariables(Input=simple.CellSize(Input=proxy)))
    array = sizes.GetCellData().GetArray(name)
    return array.GetValue(0) if array else 0.0


class LevelSets(unittest.TestCase):
    def setUp(self):
        self.pipe = common.open_file(common.PIPE)
        self.view = common.view()
        self.addCleanup(simple.Delete, self.view)

    def test_a_box_slice_is_closed_inside_the_model(self):
        block = simple.NURBSPrimitive(Shape='Box')
        block.UpdatePipeline()
        bounds = numpy.array(block.GetDataInformation().GetBounds()).reshape(3, 2)
        cut = simple.NURBSSlice(Input=block, SliceType='Box')
        cut.SliceType.Position = list(bounds.mean(axis=1) - 0.1 * (bounds[:, 1] - bounds[:, 0]))
        cut.SliceType.Length = list(0.25 * (bounds[:, 1] - bounds[:, 0]))
        cut.UpdatePipeline()
        mesh = common.fetch(cut)
        corners = common.cell_corners(mesh)
        a, b, c = 0.25 * (bounds[:, 1] - bounds[:, 0])
        self.assertAlmostEqual(common.area(corners), 2 * (a * b + b * c + c * a), places=12)
        self.assertEqual(common.outline(corners), 0.0)

    def test_contours_of_coordinates_and_parameters(self):
        contour = simple.NURBSContour(Input=self.pipe, ContourOf='Coordinates', Component=0,
                                      Isosurfaces=[1.0, 1.5])
        contour.UpdatePipeline()
        mesh = common.fetch(contour)
        x = numpy.unique(numpy.round(common.points(mesh)[:, 0], 12))
        self.assertEqual(list(x), [1.0, 1.5])
        contour.ContourOf = 'Parametric Coordinates'
        contour.Component = 2
        contour.Isosurfaces = [0.5]
        contour.UpdatePipeline()
        mesh = common.fetch(contour)
        self.assertGreater(mesh.GetNumberOfCells(), 0)
        self.assertEqual(set(common.point_array(mesh, 'ParametricCoordinates')[:, 2]), {0.5})
        # It is coloured like any other surface.
        display = simple.Show(contour, self.view)
        self.view.CameraPosition = [-2.0, -1.2, 1.6]
        simple.ColorBy(display, ('POINTS', common.ATTRIBUTE))
        simple.ResetCamera(self.view)
        self.assertGreater(common.silhouette(self.view).sum(), 100)

    def test_clips_of_a_plane_add_up_to_the_solid(self):
        whole = integral(simple.NURBSTessellate(Input=self.pipe, MeshType='Solid', Tolerance=1e-3),
                         'Volume')
        clip = simple.NURBSClip(Input=self.pipe, Tolerance=3e-3, AttributeTolerance=0)
        self.assertEqual(clip.Invert, 1)
        parts = []
        for invert in (1, 0):
            clip.Invert = invert
            parts.append(integral(clip, 'Volume'))
        self.assertGreater(min(parts), 0.1 * whole)
        self.assertLess(abs(sum(parts) - whole), 2e-2 * whole)
        data = clip.GetDataInformation()
        self.assertEqual(data.GetDataSetTypeAsString(), 'vtkUnstructuredGrid')
        for name in (common.ATTRIBUTE, 'ParametricCoordinates'):
            self.assertTrue(clip.PointData[name], name)
        for name in ('PatchId', 'ElementId'):
            self.assertTrue(clip.CellData[name], name)

    def test_a_clip_by_an_attribute_keeps_small_values(self):
        clip = simple.NURBSClip(Input=self.pipe, ClipType='Scalar',
                                Scalars=['POINTS', common.ATTRIBUTE], Value=common.ISOVALUE,
                                Tolerance=5e-3, AttributeTolerance=0.1)
        clip.UpdatePipeline()
        values = common.point_array(common.fetch(clip), common.ATTRIBUTE)
        self.assertAlmostEqual(values.max(), common.ISOVALUE, places=10)
        clip.Invert = 0
        clip.UpdatePipeline()
        values = common.point_array(common.fetch(clip), common.ATTRIBUTE)
        self.assertAlmostEqual(values.min(), common.ISOVALUE, places=10)
        display = simple.Show(clip, self.view)
        simple.ResetCamera(self.view)
        self.assertGreater(common.silhouette(self.view).sum(), 100)
        self.assertTrue(display.Visibility)

    def test_clip_types_are_those_of_paraview(self):
        clip = simple.NURBSClip(Input=common.open_file(TUBE), Tolerance=1e-2,
                                AttributeTolerance=0)
        for kind in ('Plane', 'Box', 'Sphere', 'Cylinder', 'Scalar'):
            self.assertIn(kind, clip.GetProperty('ClipType').Available)
        for kind in ('Box', 'Sphere', 'Cylinder'):
            clip.ClipType = kind
            clip.UpdatePipeline()
            mesh = common.fetch(clip)
            self.assertEqual(vtk_to_numpy(mesh.GetCellTypesArray()).tolist(),
                             [10] * mesh.GetNumberOfCells(), kind)

    def test_a_state_says_what_was_chosen(self):
        contour = simple.NURBSContour(Input=self.pipe, ContourOf='Parametric Coordinates',
                                      Isosurfaces=[0.25], AttributeTolerance=0)
        clip = simple.NURBSClip(Input=self.pipe, ClipType='Sphere', Tolerance=1e-2,
                                AttributeTolerance=0)
        clip.ClipType.Radius = 0.5
        for proxy in (contour, clip):
            proxy.UpdatePipeline()
        state = smstate.get_state()
        self.assertIn("ContourOf = 'Parametric Coordinates'", state)
        self.assertIn("ClipType = 'Sphere'", state)
        self.assertIn('ClipType.Radius = 0.5', state)

    def test_mistakes_give_one_error(self):
        clip = simple.NURBSClip(Input=self.pipe, ClipType='Scalar', ClipBy='Coordinates',
                                Component=5)
        with common.messages() as texts:
            clip.UpdatePipeline()
        self.assertEqual(len(texts), 1, texts)
        self.assertIn('no component 5', texts[0])
        self.assertEqual(clip.GetDataInformation().GetNumberOfPoints(), 0)


if __name__ == '__main__':
    unittest.main()
