# SPDX-License-Identifier: BSD-3-Clause
"""NURBS Extract Patches: what it passes on is a model again, and shows as one."""
import os
import unittest

import common
from paraview import simple


class ExtractPatches(unittest.TestCase):
    def setUp(self):
        self.model = common.open_file(os.path.join(common.DATA, 'tube_on_block.xml'))

    def volume(self, model):
        solid = simple.NURBSTessellate(Input=model, MeshType='Solid', Tolerance=1e-4)
        sizes = common.fetch(simple.IntegrateVariables(Input=simple.CellSize(Input=solid)))
        return sizes.GetCellData().GetArray('Volume').GetValue(0)

    def test_parts_add_up_to_the_whole(self):
        parts = [simple.NURBSExtractPatches(Input=self.model, PatchIds=[i]) for i in (0, 1)]
        both = simple.NURBSExtractPatches(Input=self.model, PatchIds=[1, 0])
        volumes = [self.volume(part) for part in parts]
        self.assertGreater(min(volumes), 0.0)
        # The tolerance is relative to each model's size.
        self.assertLess(abs(sum(volumes) - self.volume(self.model)), 1e-2 * sum(volumes))
        self.assertEqual(self.volume(both), self.volume(self.model))

    def test_a_patch_shows_as_a_solid(self):
        view = common.view()
        self.addCleanup(simple.Delete, view)
        part = simple.NURBSExtractPatches(Input=self.model, PatchIds=[1])
        display = simple.Show(part, view)
        self.assertEqual(display.SMProxy.GetXMLName(), 'NURBSRepresentation')
        self.assertEqual(display.Representation, 'NURBS Solid')
        whole = simple.Show(self.model, view)
        simple.ResetCamera(view)
        everything = common.silhouette(view).sum()
        whole.Visibility = 0
        alone = common.silhouette(view).sum()
        self.assertGreater(alone, 1000)
        self.assertLess(alone, 0.9 * everything)

    def test_a_box_begins_as_the_bounds_and_takes_all(self):
        extract = simple.NURBSExtractPatches(Input=self.model, ExtractBy='Box')
        bounds = self.model.GetDataInformation().GetBounds()
        self.assertEqual(list(extract.Box.Position), list(bounds[::2]))
        self.assertEqual(list(extract.Box.Length), [b - a for a, b in zip(bounds[::2], bounds[1::2])])
        self.assertEqual(self.volume(extract), self.volume(self.model))
        # Away from the model there is nothing.
        extract.Box.Position = [bounds[1] + 1, 0, 0]
        extract.UpdatePipeline()
        self.assertEqual(extract.GetDataInformation().GetNumberOfPoints(), 0)

    def test_the_boundaries_of_the_input_are_offered(self):
        blocks = common.open_file(os.path.join(common.DATA, 'two_blocks.txt'))
        extract = simple.NURBSExtractPatches(Input=blocks, ExtractBy='Boundary')
        self.assertEqual(list(extract.GetProperty('BoundaryName').Available), ['BOUNDARY left', 'BOUNDARY right'])
        self.assertEqual(extract.BoundaryName, 'BOUNDARY left')
        bounds = []
        for name in ('BOUNDARY left', 'BOUNDARY right'):
            extract.BoundaryName = name
            extract.UpdatePipeline()
            bounds.append(extract.GetDataInformation().GetBounds()[:2])
        self.assertEqual(bounds, [(0.0, 1.0), (1.0, 2.0)])

    def test_what_is_not_there_gives_one_error(self):
        for arguments, text in (({'PatchIds': [7]}, 'no patch 7; there are 0, 1'),
                                ({'ExtractBy': 'Boundary', 'BoundaryName': 'inlet'},
                                 'no boundary "inlet"')):
            extract = simple.NURBSExtractPatches(Input=self.model, **arguments)
            with common.messages() as texts:
                extract.UpdatePipeline()
            self.assertEqual(len(texts), 1, texts)
            self.assertIn(text, texts[0])
            self.assertEqual(extract.GetDataInformation().GetNumberOfPoints(), 0)


if __name__ == '__main__':
    unittest.main()
