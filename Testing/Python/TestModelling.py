# SPDX-License-Identifier: BSD-3-Clause
"""The modelling sources and filters: pipelines, panels, pictures."""
import math
import os
import tempfile
import unittest

import common
import numpy
from paraview import simple

SHAPES = ('Box', 'Cylinder', 'Tube', 'Cone', 'Sphere', 'Spherical Shell', 'Torus', 'Wedge',
          'Helix')


def area(surface):
    corners = common.cell_corners(common.fetch(surface))
    return 0.5 * numpy.linalg.norm(numpy.cross(
        corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()


def lens():
    """Martin and Cohen's Figure 1: a line with an attribute, a disk, a volume."""
    line = simple.NURBSCurve(Points=[0, 0, 0, 1, 0, 0], AttributeName='Index',
                             AttributeValues=[1.6, 1.6, 1.5, 1.4])
    disk = simple.NURBSRevolve(Input=line, AxisDirection=[0, 0, 1])
    return line, disk, simple.NURBSExtrude(Input=disk, Vector=[0, 0, 0.5])


class Modelling(unittest.TestCase):
    def setUp(self):
        self.view = common.view()
        self.addCleanup(simple.Delete, self.view)
        self.view.CameraPosition = [3, -5, 4]

    def assert_shows(self, proxy, least=500):
        """It shows as NURBS Solid by itself, and is to be seen."""
        simple.HideAll(self.view)
        display = simple.Show(proxy, self.view)
        self.assertEqual(display.SMProxy.GetXMLName(), 'NURBSRepresentation')
        self.assertEqual(display.Representation, 'NURBS Solid')
        # Lines have the full colour, which is white as the background.
        display.AmbientColor = display.DiffuseColor = [0.5, 0.5, 0.5]
        self.view.ResetCamera(True)
        self.assertGreater(common.silhouette(self.view).sum(), least)
        return display

    def test_every_primitive_shows_and_has_its_patches(self):
        for shape in SHAPES:
            for parametrisation in ('Patches', 'Poles'):
                solid = simple.NURBSPrimitive(Shape=shape, Parametrisation=parametrisation)
                self.assert_shows(solid, 2000)
                mesh = common.fetch(simple.NURBSTessellate(Input=solid))
                patches = len(set(common.vtk_to_numpy(mesh.GetCellData().GetArray('PatchId'))))
                if parametrisation == 'Poles' or shape in ('Box', 'Tube'):
                    self.assertEqual(patches, 1)
                else:
                    self.assertGreater(patches, 2)

    def test_curves_and_surfaces_show(self):
        line, disk, solid = lens()
        self.assert_shows(line, 100)
        self.assert_shows(disk)
        self.assert_shows(solid)

    def test_an_edit_upstream_is_seen_downstream(self):
        line, _, solid = lens()
        display = self.assert_shows(solid)
        simple.ColorBy(display, ('POINTS', 'Index'))
        display.RescaleTransferFunctionToDataRange(False, True)
        before = common.pixels(self.view)
        contour = simple.NURBSContour(Input=solid, ContourBy=['POINTS', 'Index'],
                                      Isosurfaces=[1.5])
        radii = []
        for values in ([1.6, 1.6, 1.5, 1.4], [1.6, 1.5, 1.4, 1.3]):
            line.AttributeValues = values
            radii.append(common.fetch(contour).GetBounds()[1])
            # All points are at one radius: the index varies with it alone.
            places = common.points(common.fetch(contour))
            self.assertLess(numpy.ptp(numpy.hypot(places[:, 0], places[:, 1])), 1e-12)
        # The second attribute is linear, 1.6 - 0.3 r.
        self.assertAlmostEqual(radii[1], 1 / 3, 12)
        self.assertGreater(radii[0], radii[1])
        self.assertGreater((common.pixels(self.view) != before).sum(), 1000)

    def test_a_polyline_becomes_a_vase(self):
        profile = simple.PolyLineSource(Points=[1, 0, 0, 1.5, 0, 1, 0.5, 0, 2, 1, 0, 3])
        wall = simple.NURBSCurveThroughPoints(Input=profile)
        vase = simple.NURBSRevolve(Input=wall, Angle=270, AxisDirection=[0, 0, 1])
        self.assert_shows(vase, 2000)
        places = common.points(common.fetch(simple.NURBSTessellate(Input=vase)))
        for x, _, z in numpy.reshape(profile.Points, (-1, 3)):
            radii = numpy.hypot(places[:, 0], places[:, 1])
            # Vertices are about a tenth apart, and on the wall.
            self.assertLess(min(abs(radii - x) + abs(places[:, 2] - z)), 0.1)

    def test_rule_and_loft_take_sections_in_their_order(self):
        circles = [simple.NURBSRevolve(
            Input=simple.NURBSCurve(Points=[0.1, 0, z, r, 0, z], Degree=1 + z % 2),
            AxisDirection=[0, 0, 1])
            for z, r in ((0, 1.0), (1, 1.5), (2, 0.8), (3, 1.0))]
        ring = simple.NURBSRule(Input=circles[:2])
        self.assert_shows(ring)
        solid = simple.NURBSTessellate(Input=ring, MeshType='Solid', Tolerance=1e-4)
        volume = common.fetch(simple.IntegrateVariables(Input=simple.CellSize(
            Input=solid))).GetCellData().GetArray('Volume').GetValue(0)
        # A frustum with a hole.
        self.assertAlmostEqual(
            volume / (math.pi * ((1 + 1.5 + 2.25) / 3 - 0.01)), 1, 3)
        loft = simple.NURBSLoft(Input=circles)
        self.assert_shows(loft)
        ends = common.fetch(simple.NURBSTessellate(Input=loft)).GetBounds()[4:]
        self.assertAlmostEqual(ends[0], 0, 12)
        self.assertAlmostEqual(ends[1], 3, 12)

    def test_a_sweep_follows_and_twists(self):
        section = simple.NURBSExtrude(
            Input=simple.NURBSCurve(Points=[-0.5, -0.25, 0, 0.5, -0.25, 0]), Vector=[0, 0.5, 0])
        path = simple.NURBSCurve(Points=[0, 0, 0, 0, 0, 2, 0, 2, 4, 2, 2, 4])
        for arguments in ({}, {'Twist': 90}, {'Orientation': 'Fixed'}):
            sweep = simple.NURBSSweep(Input=section, Path=path, **arguments)
            self.assert_shows(sweep, 2000)
        straight = simple.NURBSCurve(Points=[0, 0, 0, 0, 0, 2])
        # Joy and Duchaineau's Figure 11: 35 degrees, four sections.
        twisted = simple.NURBSSweep(Input=section, Path=straight, Twist=35, Sections=4)
        places = common.points(common.fetch(simple.NURBSTessellate(Input=twisted)))
        top = places[abs(places[:, 2] - 2) < 1e-12]
        angle = math.radians(35)
        self.assertAlmostEqual(
            top[:, 0].max(), 0.5 * math.cos(angle) + 0.25 * math.sin(angle), 12)

    def test_refine_adds_control_points_and_leaves_the_picture(self):
        pipe = common.open_file(common.PIPE)
        refined = simple.NURBSRefine(Input=pipe)
        refined.UpdatePipeline()
        self.assertGreater(refined.GetDataInformation().GetNumberOfPoints(),
                           2 * pipe.GetDataInformation().GetNumberOfPoints())
        areas = [area(simple.NURBSTessellate(Input=model, Tolerance=1e-4))
                 for model in (pipe, refined)]
        self.assertLess(abs(areas[0] - areas[1]), 1e-3 * areas[0])

    def test_append_joins_models_and_finds_interfaces(self):
        boxes = [simple.NURBSPrimitive(Center=[x, 0, 0]) for x in (0, 1)]
        both = simple.NURBSAppend(Input=boxes)
        self.assert_shows(both)
        interfaces = both.GetClientSideObject().GetOutputDataObject(0).GetFieldData().GetArray(
            'Interfaces')
        self.assertEqual([interfaces.GetComponent(0, i) for i in range(4)], [0, 2, 1, 1])

    def test_a_model_is_saved_and_opened(self):
        _, _, solid = lens()
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, 'lens.vtpc')
            simple.SaveData(name, solid, DataMode='Binary')
            again = common.open_file(name)
            self.assertEqual(area(simple.NURBSTessellate(Input=again)),
                             area(simple.NURBSTessellate(Input=solid)))

    def test_bad_input_gives_one_error(self):
        line = simple.NURBSCurve(Points=[-1, 0, 0, 1, 0, 0])
        crossing = simple.NURBSRevolve(Input=line)
        with common.messages() as texts:
            crossing.UpdatePipeline()
        self.assertEqual(len(texts), 1, texts)
        self.assertIn('crosses the axis of revolution', texts[0])
        self.assertEqual(crossing.GetDataInformation().GetNumberOfPoints(), 0)


if __name__ == '__main__':
    unittest.main()
