# SPDX-License-Identifier: BSD-3-Clause
"""ParaView's own filters on a control lattice: which are exact, and which are wrong and say so."""
import os
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


class ControlNet(unittest.TestCase):
    """A quarter of a tube, radii 1 and 2, height 1; its control net has right angles.

    Of the field with the coefficients x^2 + y^2, coefficients reach 8 and values 5.66.
    """

    def setUp(self):
        self.model = simple.Calculator(
            Input=common.open_file(os.path.join(common.DATA, 'quarter_tube.g2')),
            Function='coordsX*coordsX+coordsY*coordsY')
        self.solid = simple.NURBSTessellate(Input=self.model, MeshType='Solid', Tolerance=1e-5)

    def silently(self, proxy):
        with common.messages() as texts:
            proxy.UpdatePipeline()
        self.assertEqual(texts, [])
        return proxy

    def test_integrals_are_those_of_the_net(self):
        volumes = [common.fetch(self.silently(simple.IntegrateVariables(Input=data)))
                   .GetCellData().GetArray('Volume').GetValue(0)
                   for data in (self.model, self.solid)]
        self.assertAlmostEqual(volumes[0], 3.0, 12)
        self.assertAlmostEqual(volumes[1], 0.75 * numpy.pi, 3)

    def test_probes_find_points_of_the_net_that_are_not_in_the_solid(self):
        masks = []
        for data in (self.model, self.solid):
            probe = simple.ProbeLocation(Input=data, ProbeType='Fixed Radius Point Source')
            probe.ProbeType.Center = [1.8, 1.8, 0.5]
            data = common.fetch(self.silently(probe))
            masks.append(common.point_array(data, 'vtkValidPointMask')[0])
        self.assertEqual(masks, [1, 0])

    def test_resampling_and_plots_sample_the_net(self):
        def farthest(proxy):
            data = common.fetch(self.silently(proxy))
            places = numpy.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
            valid = common.point_array(data, 'vtkValidPointMask') == 1
            return numpy.linalg.norm(places[valid, :2], axis=1).max()

        grid = simple.Wavelet(WholeExtent=[0, 2, 0, 2, 0, 1])
        line = {'Point1': [0, 0, 0.5], 'Point2': [2, 2, 0.5]}
        for sample in (lambda data: simple.ResampleToImage(Input=data,
                                                           SamplingDimensions=[21, 21, 3]),
                       lambda data: simple.ResampleWithDataset(SourceDataArrays=data,
                                                               DestinationMesh=grid),
                       lambda data: simple.PlotOverLine(Input=data, **line)):
            self.assertGreater(farthest(sample(self.model)), 2.7)
            # The corners of an image are outside by a rounding.
            self.assertLess(farthest(sample(self.solid)), 2.0 + 1e-3)

    def test_contours_are_those_of_coefficients(self):
        cells = [self.silently(proxy).GetDataInformation().GetNumberOfCells() for proxy in (
            simple.Contour(Input=self.model, ContourBy=['POINTS', 'Result'], Isosurfaces=[6]),
            simple.NURBSContour(Input=self.model, ContourBy=['POINTS', 'Result'],
                                Isosurfaces=[6]))]
        self.assertGreater(cells[0], 0)
        self.assertEqual(cells[1], 0)

    def test_gradients_are_those_of_the_net(self):
        steepest = [self.silently(simple.Gradient(Input=data, ScalarArray=['POINTS', 'Result']))
                    .PointData['Gradient'].GetRange(0)[1] for data in (self.model, self.solid)]
        self.assertAlmostEqual(steepest[0], 3.0)
        self.assertAlmostEqual(steepest[1], 2.0 + numpy.sqrt(2.0), 3)

    def test_attributes_of_another_basis_are_on_another_lattice(self):
        pipe = common.open_file(common.PIPE)
        image = self.silently(simple.ResampleToImage(Input=pipe, SamplingDimensions=[9, 9, 9]))
        self.assertEqual(set(image.PointData.keys()), {'vtkGhostType', 'vtkValidPointMask'})
        both = common.fetch(simple.IntegrateVariables(Input=pipe))
        one = common.fetch(simple.IntegrateVariables(
            Input=simple.ExtractBlock(Input=pipe, Selectors=['/Root/Geometry'])))
        volumes = [data.GetCellData().GetArray('Volume').GetValue(0) for data in (both, one)]
        self.assertGreater(volumes[0], 1.5 * volumes[1])

    def test_append_and_group_refuse_collections(self):
        other = common.open_file(common.PIPE)
        for proxy in (simple.AppendDatasets(Input=[self.model, other]),
                      simple.AppendGeometry(Input=[self.model, other]),
                      simple.GroupDatasets(Input=[self.model, other])):
            with common.messages() as texts:
                proxy.UpdatePipeline()
            self.assertIn('vtkPartitionedDataSetCollection', texts[0], proxy.GetXMLName())
            self.assertEqual(proxy.GetDataInformation().GetNumberOfPoints(), 0)
        # What it passes on of other collections is for NURBS Append.
        group = simple.GroupDatasets(Input=[self.model, other], OutputType='vtkPartitionedDataSet')
        self.silently(group)
        with common.messages() as texts:
            self.assertEqual(cut(group).GetNumberOfPoints(), 0)
        self.assertEqual(len(texts), 1, texts)
        self.assertIn('use NURBS Append', texts[0])


if __name__ == '__main__':
    unittest.main()
