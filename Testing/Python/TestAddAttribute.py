# SPDX-License-Identifier: BSD-3-Clause
"""NURBS Add Attribute in ParaView."""
import unittest

import numpy as np

import common  # loads the plugin
from common import report
from paraview import simple


class AddAttribute(unittest.TestCase):
    def setUp(self):
        self.model = common.open_file(common.PIPE)

    def test_an_expression(self):
        added = simple.NURBSAddAttribute(Input=self.model, AttributeName='Radius',
                                         Expression='sqrt(x^2+y^2)')
        added.UpdatePipeline()
        row, = report(added)
        self.assertLess(float(row['RelativeError']), 0.05)
        mesh = common.fetch(simple.NURBSTessellate(Input=added))
        x = common.points(mesh)
        np.testing.assert_allclose(common.point_array(mesh, 'Radius'), np.hypot(x[:, 0], x[:, 1]),
                                   atol=1.5 * float(row['MaximumError']))
        # Those that were there are there.
        self.assertTrue(mesh.GetPointData().HasArray(common.ATTRIBUTE))

    def test_samples_of_a_data_set(self):
        wavelet = simple.Wavelet()
        added = simple.NURBSAddAttribute(Input=self.model, Source=wavelet,
                                         AttributeFrom='Data Set', PointArray='RTData',
                                         Basis='Uniform', ControlPoints=[12, 6, 6])
        added.UpdatePipeline()
        row, = report(added)
        self.assertEqual(int(row['ControlPoints']), 432)

    def test_what_does_not_parse_gives_one_error(self):
        added = simple.NURBSAddAttribute(Input=self.model, Expression='sqrt(x^2+')
        with common.messages() as texts:
            added.UpdatePipeline()
        self.assertEqual(len(texts), 1, texts)
        self.assertIn('does not parse', texts[0])
        self.assertEqual(added.GetDataInformation().GetNumberOfPoints(), 0)


if __name__ == '__main__':
    unittest.main()
