# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's own filters on a control lattice: which are exact, and which are wrong and say so."""
import unittest

import common
import numpy
from paraview import simple

EPSILON = numpy.finfo(float).eps


def cut(model, origin=common.ORIGIN, normal=(0.0, 1.0, 0.0)):
    """A slice, fetched."""
    proxy = simple.NURBSSlice(Input=model)
    proxy.SliceType.Origin = origin
    proxy.SliceType.Normal = normal
    return common.fetch(proxy)


class StockFilters(unittest.TestCase):
    def setUp(self):
        self.model = common.open_file(common.PIPE)

    def test_transform_then_slice_is_slice_then_transform(self):
        def turned(proxy):
            # By a right angle, after which the tolerance is still the same length.
            result = simple.Transform(Input=proxy)
            result.Transform.Rotate = [0, 0, 90]
            result.Transform.Translate = [1, 2, 3]
            return result

        first = cut(turned(self.model), (-0.7, 3.7, 3.0), (0, 1, 0))
        plane = simple.NURBSSlice(Input=self.model)
        plane.SliceType.Origin = common.ORIGIN
        plane.SliceType.Normal = [1, 0, 0]
        last = common.fetch(turned(plane))
        a, b = (common.cell_corners(data) for data in (first, last))
        self.assertGreater(len(a), 100)
        # Round-off may turn a diagonal, so not all triangles are the same.
        self.assertLess(common.differ_as_surfaces(a, b), 1e-6)
        # The points that both have are polished onto the plane to 1e-12 of the model's size.
        points = [common.points(data) for data in (first, last)]
        values = [common.point_array(data, 'Temperature') for data in (first, last)]
        distance = numpy.linalg.norm(points[0][:, None] - points[1][None], axis=2)
        nearest = distance.argmin(axis=1)
        same = distance.min(axis=1) < 2e-12 * abs(points[0]).max()
        self.assertGreater(same.mean(), 0.5)
        self.assertLess(abs(values[0] - values[1][nearest])[same].max(),
                        1e-10 * abs(values[0]).max())

    def test_affine_calculator_is_exact(self):
        # A few roundings of coefficients and of the rational evaluation.
        scale = 64 * EPSILON
        data = cut(simple.Calculator(Input=self.model, Function='coordsX-2*coordsY+3'))
        x = common.points(data)
        expected = x[:, 0] - 2 * x[:, 1] + 3
        self.assertLess(abs(common.point_array(data, 'Result') - expected).max(), 10 * scale)
        for function, array in (('2*Temperature+1', 'Temperature'),
                                ('2*Displacement_X+1', 'Displacement')):
            data = cut(simple.Calculator(Input=self.model, Function=function))
            values = common.point_array(data, array)
            expected = 2 * (values if values.ndim == 1 else values[:, 0]) + 1
            self.assertLess(abs(common.point_array(data, 'Result') - expected).max(),
                            scale * abs(expected).max(), function)

    def test_extract_block_is_exact(self):
        data = cut(simple.ExtractBlock(Input=self.model, Selectors=['/Root/Geometry']))
        whole = cut(self.model)
        self.assertIsNone(data.GetPointData().GetArray('Temperature'))
        # Without the temperature less refinement is needed; the area stays to the tolerance.
        areas = []
        for corners in (common.cell_corners(data), common.cell_corners(whole)):
            normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            areas.append(0.5 * numpy.linalg.norm(normals, axis=1).sum())
        self.assertLess(abs(areas[0] - areas[1]), 0.01 * areas[1])

    def test_lattices_show_as_solids_by_default(self):
        s, model = simple, self.model
        view = common.view()
        self.addCleanup(s.Delete, view)
        s.Show(model, view)
        lattices = [s.Transform(Input=model), s.Calculator(Input=model, Function='coordsX'),
                    s.ExtractBlock(Input=model, Selectors=['/Root/Geometry']),
                    s.ForceTime(Input=model), s.GenerateIds(Input=model)]
        for proxy in lattices:
            display = s.Show(proxy, view)
            self.assertEqual(display.Representation, 'NURBS Solid', proxy.GetXMLName())
        for proxy in (s.Tetrahedralize(Input=model), s.NURBSSlice(Input=model), s.Sphere()):
            display = s.Show(proxy, view)
            self.assertEqual(display.Representation, 'Surface', proxy.GetXMLName())

    def test_colours_of_their_outputs_span_the_coefficients_and_so_the_values(self):
        view = common.view()
        self.addCleanup(simple.Delete, view)
        outputs = {'Temperature': simple.Transform(Input=self.model),
                   'Result': simple.Calculator(Input=self.model, Function='3*Temperature')}
        for name, proxy in outputs.items():
            display = simple.Show(proxy, view)
            simple.ColorBy(display, ('POINTS', name))
            display.RescaleTransferFunctionToDataRange(False, True)
            simple.Render(view)
            colors = simple.GetColorTransferFunction(name).RGBPoints
            self.assertEqual((colors[0], colors[-4]), proxy.PointData[name].GetRange())
            drawn = display.SMProxy.GetRepresentedDataInformation().GetArrayInformation(
                name, 0).GetComponentRange(0)
            self.assertTrue(colors[0] <= drawn[0] and drawn[1] <= colors[-4], name)
            simple.Hide(proxy, view)

    def test_slice_cuts_the_lattice_and_says_nothing(self):
        stock = simple.Slice(Input=self.model)
        stock.SliceType.Origin = common.ORIGIN
        stock.SliceType.Normal = [0, 1, 0]
        with common.messages() as texts:
            stock.UpdatePipeline()
        self.assertEqual(texts, [])
        information = stock.GetDataInformation()
        self.assertGreater(information.GetNumberOfCells(), 0)
        # Control points are off the solid, so the bounds of the two cuts differ.
        exact = cut(self.model).GetBounds()
        differences = [abs(a - b) for a, b in zip(information.GetBounds(), exact)]
        self.assertGreater(max(differences), 0.1)

    def test_a_changed_lattice_gives_one_error_and_no_output(self):
        s, model = simple, self.model
        subset = s.ExtractSubset(Input=model)
        subset.VOI = [0, 2, 0, 4, 0, 4]
        changed = {
            'Extract Subset': (subset, 'use NURBS Refine'),
            'Threshold': (s.Threshold(Input=model, Scalars=['POINTS', 'Weight'],
                                      LowerThreshold=0, UpperThreshold=10), 'use NURBS Refine'),
            'Clip': (s.Clip(Input=model), 'use NURBS Refine'),
            'Tetrahedralize': (s.Tetrahedralize(Input=model), 'use NURBS Refine'),
            'Extract Surface': (s.ExtractSurface(Input=model), 'use NURBS Refine'),
            'Merge Blocks': (s.MergeBlocks(Input=model), 'use NURBS Refine'),
            'Pass Arrays': (s.PassArrays(Input=model, PointDataArrays=['Displacement']), 'Weight'),
            'Point Data to Cell Data': (s.PointDatatoCellData(Input=model), 'Weight'),
            'Extract Block': (s.ExtractBlock(Input=model, Selectors=['/Root/Temperature']),
                              'no geometry'),
            'Slice': (s.Slice(Input=model), 'no control lattice'),
        }
        for name, (proxy, expected) in changed.items():
            proxy.UpdatePipeline()
            with common.messages() as texts:
                data = cut(proxy)
            self.assertEqual(len(texts), 1, (name, texts))
            self.assertIn(expected, texts[0], name)
            self.assertEqual(data.GetNumberOfPoints(), 0, name)


if __name__ == '__main__':
    unittest.main()
