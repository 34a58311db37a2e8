# SPDX-License-Identifier: BSD-3-Clause
"""The representation NURBS Solid, as the user sees it."""
import unittest

import common
import numpy
from paraview import simple


class NURBSSolid(unittest.TestCase):
    def setUp(self):
        self.model = common.open_file(common.PIPE)
        self.view = common.view()
        self.display = simple.Show(self.model, self.view)
        self.view.CameraPosition = [-2.0, -1.2, 1.6]
        self.view.ResetCamera(True)

    def tearDown(self):
        simple.Delete(self.view)

    def drawn(self, array):
        """Range of an array of what is drawn."""
        information = self.display.SMProxy.GetRepresentedDataInformation()
        return information.GetArrayInformation(array, 0).GetComponentRange(0)

    def test_a_file_is_shown_as_the_solid_and_not_as_its_lattice(self):
        self.assertEqual(self.display.Representation, 'NURBS Solid')
        solid = common.silhouette(self.view)
        self.display.Representation = 'Surface'
        lattice = common.silhouette(self.view)
        simple.Hide(self.model, self.view)
        surface = simple.NURBSTessellate(Input=self.model)
        display = simple.Show(surface, self.view)
        display.Representation = 'Surface'
        exact = common.silhouette(self.view)
        self.assertGreater(exact.sum(), 5000)
        self.assertEqual((solid != exact).sum(), 0)
        self.assertGreater((lattice != exact).sum(), 500)

    def test_shading_is_that_of_the_exact_normals(self):
        simple.ColorBy(self.display, ('POINTS', None))
        solid = common.pixels(self.view)
        simple.Hide(self.model, self.view)
        display = simple.Show(simple.NURBSTessellate(Input=self.model), self.view)
        simple.ColorBy(display, ('POINTS', None))
        self.assertEqual((solid != common.pixels(self.view)).sum(), 0)

    def test_every_attribute_colours_at_once(self):
        for name in ('Displacement', 'Temperature'):
            simple.ColorBy(self.display, ('POINTS', name))
            picture = common.pixels(self.view)
            self.assertGreater(len(numpy.unique(picture.reshape(-1, 3), axis=0)), 1000, name)

    def test_weights_are_no_colours(self):
        def offered():
            domain = self.display.SMProxy.GetProperty('ColorArrayName').FindDomain(
                'vtkSMArrayListDomain')
            return [domain.GetString(i) for i in range(domain.GetNumberOfStrings())]

        self.assertIn('Temperature', offered())
        self.assertNotIn('Weight', offered())
        self.assertIsNotNone(self.model.PointData['Weight'])
        # On other data an array of this name is as good as any.
        other = simple.Calculator(Input=simple.Sphere(), Function='coordsX',
                                  ResultArrayName='Weight')
        self.display = simple.Show(other, self.view)
        self.assertIn('Weight', offered())

    def test_bounds_are_those_of_the_solid(self):
        simple.Render(self.view)
        drawn = self.display.SMProxy.GetRepresentedDataInformation().GetBounds()
        exact = simple.NURBSTessellate(Input=self.model)
        exact.UpdatePipeline()
        self.assertEqual(drawn, exact.GetDataInformation().GetBounds())
        lattice = self.model.GetDataInformation().GetBounds()
        self.assertGreater(lattice[3] - drawn[3], 0.1)

    def test_colours_span_the_values_drawn_and_not_the_coefficients(self):
        # Nothing has been rendered yet.
        simple.ColorBy(self.display, ('POINTS', 'Temperature'))
        self.display.RescaleTransferFunctionToDataRange(False, True)
        colors = simple.GetColorTransferFunction('Temperature').RGBPoints
        self.assertEqual((colors[0], colors[-4]), self.drawn('Temperature'))
        low, high = self.model.PointData['Temperature'].GetRange()
        self.assertLess(colors[-4], high - 0.1 * (high - low))

    def test_a_tolerance_refines_what_is_drawn(self):
        cells = []
        for tolerance in (1e-2, 1e-5):
            self.display.SolidTolerance = tolerance
            self.view.Update()
            information = self.display.SMProxy.GetRepresentedDataInformation()
            cells.append(information.GetNumberOfCells())
        self.assertLess(4 * cells[0], cells[1])

    def tessellated(self):
        """When the points that are drawn were made."""
        simple.Render(self.view)
        drawn = self.display.GetClientSideObject().GetActiveRepresentation().GetRenderedDataObject(0)
        blocks = drawn.NewIterator()
        blocks.InitTraversal()
        return blocks.GetCurrentDataObject().GetPoints().GetData().GetMTime()

    def test_another_colour_tessellates_nothing(self):
        time = self.tessellated()
        for name in ('Temperature', 'Displacement', None):
            simple.ColorBy(self.display, ('POINTS', name))
            self.assertEqual(self.tessellated(), time)
        self.display.SolidTolerance = 0.002
        self.assertGreater(self.tessellated(), time)

    def edges(self):
        """Which pixels have the colour of edges, magenta."""
        picture = common.pixels(self.view).astype(int)
        return (abs(picture - [255, 0, 255]) < 8).all(axis=2)

    def test_edges_are_knot_lines(self):
        solid = common.silhouette(self.view)
        self.display.Representation = 'NURBS Solid With Edges'
        self.display.EdgeColor = [1, 0, 1]
        self.display.LineWidth = 2
        # Edges of triangles would be more with a finer tolerance, those of the lattice outside.
        coarse = self.edges()
        self.display.SolidTolerance = 1e-5
        fine = self.edges()
        self.assertGreater(coarse.sum(), 1000)
        self.assertLess(abs(int(fine.sum()) - int(coarse.sum())), 0.1 * coarse.sum())
        grown = solid.copy()
        for axis in (0, 1):
            for step in (-2, -1, 1, 2):
                grown |= numpy.roll(solid, step, axis)
        self.assertEqual((fine & ~grown).sum(), 0)
        # They go where the solid goes.
        self.display.Position = [0.3, 0, 0]
        self.assertGreater((self.edges() & ~fine).sum(), 0.5 * fine.sum())
        self.display.Representation = 'NURBS Solid'
        self.assertEqual(self.edges().sum(), 0)
        self.display.Representation = 'NURBS Solid With Edges'
        simple.Hide(self.model, self.view)
        self.assertEqual(self.edges().sum(), 0)

    def test_thin_edges_are_whole(self):
        self.display.Representation = 'NURBS Solid With Edges'
        self.display.EdgeColor = [1, 0, 1]
        # Across the pipe: the side is a quarter of a ring with one line along it.
        self.view.CameraPosition = [0, 0, 10]
        self.view.CameraFocalPoint = [0, 0, 0]
        self.view.CameraViewUp = [0, 1, 0]
        self.view.ResetCamera(False)
        simple.ColorBy(self.display, ('POINTS', None))
        red, green, blue = common.pixels(self.view).astype(int).transpose(2, 0, 1)
        hit = numpy.minimum(red, blue) - green > 25  # thin lines are blended with what is behind
        grown = hit.copy()
        for rows in (-1, 0, 1):
            for columns in (-1, 0, 1):
                grown |= numpy.roll(hit, (rows, columns), (0, 1))
        # Everything drawn hangs together where no pixel of a line is missing.
        found = numpy.zeros_like(hit)
        found[tuple(numpy.argwhere(hit)[0])] = True
        count = 0
        while found.sum() != count:
            count = found.sum()
            for axis in (0, 1):
                for step in (-1, 1):
                    found |= numpy.roll(found, step, axis) & grown
        self.assertGreater(hit.sum(), 500)
        self.assertEqual((hit & ~found).sum(), 0)

    def test_blocks_are_datasets(self):
        self.display.Representation = 'NURBS Solid With Edges'
        everything = common.silhouette(self.view)
        self.display.BlockSelectors = ['/Root/Temperature']
        self.assertEqual(common.silhouette(self.view).sum(), 0)
        self.display.BlockSelectors = ['/Root/Geometry']
        self.assertEqual((common.silhouette(self.view) != everything).sum(), 0)
        opaque = common.pixels(self.view)
        self.display.BlockOpacities = ['/Root/Geometry', '0.3']
        changed = (common.pixels(self.view) != opaque).any(axis=2)
        self.assertGreater(changed.sum(), 0.5 * everything.sum())

    def test_a_selection_passes_through_the_solid(self):
        for style, count in (('NURBS Solid', 0), ('Surface', 1)):
            self.display.Representation = style
            simple.Render(self.view)
            simple.SelectSurfaceCells(Rectangle=[150, 100, 250, 200], View=self.view)
            selections = self.model.SMProxy.GetSelectionInput(0)
            self.assertEqual(selections is not None, count == 1, style)
            simple.ClearSelection(self.model)

    def test_other_data_is_shown_as_it_is(self):
        simple.Hide(self.model, self.view)
        wavelet = simple.Wavelet()
        grid = simple.AppendDatasets(Input=wavelet)
        display = simple.Show(grid, self.view)
        simple.ResetCamera(self.view)
        pictures = []
        for style in ('Surface', 'NURBS Solid', 'Surface With Edges', 'NURBS Solid With Edges'):
            display.Representation = style
            pictures.append(common.pixels(self.view))
        self.assertEqual((pictures[0] != pictures[1]).sum(), 0)
        self.assertEqual((pictures[2] != pictures[3]).sum(), 0)
        self.assertGreater((pictures[0] != pictures[2]).sum(), 1000)
        self.assertGreater((pictures[0] != 255).sum(), 5000)

    def test_a_changed_lattice_gives_an_error_and_an_empty_picture(self):
        changed = simple.PassArrays(Input=self.model, PointDataArrays=['Displacement'])
        simple.Hide(self.model, self.view)
        display = simple.Show(changed, self.view)
        display.Representation = 'NURBS Solid'
        with common.messages() as texts:
            empty = common.silhouette(self.view)
        self.assertEqual(len(texts), 1, texts)
        self.assertIn('Weight', texts[0])
        self.assertEqual(empty.sum(), 0)


if __name__ == '__main__':
    unittest.main()
