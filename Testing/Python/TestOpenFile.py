# SPDX-License-Identifier: BSD-3-Clause
"""Files open by File > Open, and the filters draw them."""
import glob
import os
import tempfile
import unittest

import common
import numpy
from paraview import simple

SHARED = [name for folder, pattern in (('gismo', '*.xml'), ('splinepy', '*.xml'),
                                       ('mfem', '*.mesh'), ('gotools', '*.g2'), ('splipy', '*.g2'),
                                       ('irit', '*.itd'), ('geopdes', '*.txt'))
          for name in sorted(glob.glob(os.path.join(common.SHARED, folder, pattern)))]


class OpenFile(unittest.TestCase):
    def assert_opens(self, name):
        with common.messages():  # what is skipped in a file is told in warnings
            reader = common.open_file(name)
        self.assertEqual(reader.GetXMLName(), 'BSplineReader', name)
        self.assertGreater(reader.GetDataInformation().GetNumberOfPoints(), 0, name)
        surface = simple.NURBSTessellate(Input=reader, Tolerance=0.01)
        with common.messages() as texts:
            surface.UpdatePipeline()
        self.assertEqual(texts, [], name)
        self.assertGreater(surface.GetDataInformation().GetNumberOfCells(), 0, name)
        simple.Delete(surface)
        simple.Delete(reader)

    def test_samples_open(self):
        names = [name for name in sorted(glob.glob(os.path.join(common.DATA, '*.*')))
                 if not name.endswith('.py')]
        self.assertGreater(len(names), 3)
        for name in names:
            self.assert_opens(name)

    @unittest.skipUnless(SHARED, 'files of other projects are not here')
    def test_files_of_other_projects_open(self):
        for name in SHARED:
            self.assert_opens(name)

    def test_what_is_refused_gives_one_error_and_no_data(self):
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, 'torn.itd')
            with open(os.path.join(common.DATA, 'quarter_tube.itd'), encoding='ascii') as whole:
                text = whole.read()
            with open(name, 'w', encoding='ascii') as torn:
                torn.write(text[:len(text) // 2])
            with common.messages() as texts:
                reader = common.open_file(name)
            self.assertEqual(len(texts), 1, texts)
            self.assertEqual(reader.GetDataInformation().GetNumberOfPoints(), 0)

    def test_filters_carry_all_arrays(self):
        model = common.open_file(common.PIPE)
        for name, proxy in common.four_filters(
                model, common.ATTRIBUTE, common.ISOVALUE, common.ORIGIN).items():
            data = common.fetch(proxy)
            self.assertGreater(data.GetNumberOfCells(), 0, name)
            for array in ('Displacement', 'Temperature', 'Normals', 'ParametricCoordinates'):
                self.assertTrue(numpy.isfinite(common.point_array(data, array)).all(), array)
            for array in ('PatchId', 'ElementId'):
                self.assertIsNotNone(data.GetCellData().GetArray(array), array)

    def test_an_offset_of_the_plane_counts(self):
        slices = simple.NURBSSlice(Input=common.open_file(common.PIPE))
        slices.SliceType.Origin = [1.5, 0, 0]
        slices.SliceType.Normal = [2, 0, 0]
        slices.SliceType.Offset = 0.25
        slices.UpdatePipeline()
        plane = slices.SliceType.GetClientSideObject()
        points = common.points(common.fetch(slices))
        self.assertGreater(len(points), 0)
        self.assertLess(max(abs(plane.FunctionValue(p)) for p in points), 1e-11)


if __name__ == '__main__':
    unittest.main()
