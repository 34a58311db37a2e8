# SPDX-License-Identifier: BSD-3-Clause
"""Sampled data become splines: NURBS Fit in ParaView."""
import os
import subprocess
import tempfile
import unittest

import numpy as np

import common  # loads the plugin
from common import report
from paraview import simple

VOLUMES = os.path.join(common.SHARED, 'volumes')


def volume(name):
    path = os.path.join(VOLUMES, name)
    if not os.path.exists(path):
        raise unittest.SkipTest(f'{path} is not there')
    return path


class Fit(unittest.TestCase):
    def setUp(self):
        self.wavelet = simple.Wavelet(WholeExtent=[-8, 8, -8, 8, -8, 8])
        self.wavelet.UpdatePipeline()

    def test_an_image_is_interpolated(self):
        fit = simple.NURBSFit(Input=self.wavelet)
        # All arrays, at first.
        self.assertEqual(list(fit.PointArrays), ['RTData'])
        fit.UpdatePipeline()
        row, = report(fit)
        self.assertEqual(row['Attribute'], 'RTData')
        self.assertEqual(int(row['ControlPoints']), 17 ** 3)
        self.assertLess(float(row['RelativeError']), 1e-13)

    def test_what_is_fitted_shows_as_a_solid_and_is_contoured(self):
        view = common.view()
        self.addCleanup(simple.Delete, view)
        fit = simple.NURBSFit(Input=self.wavelet)
        display = simple.Show(fit, view)
        self.assertEqual(display.Representation, 'NURBS Solid')
        simple.ColorBy(display, ('POINTS', 'RTData'))
        simple.ResetCamera(view)
        self.assertGreater(common.silhouette(view).sum(), 1000)

        contour = simple.NURBSContour(Input=fit, ContourBy=['POINTS', 'RTData'], Isosurfaces=[200])
        surface = common.fetch(contour)
        self.assertGreater(surface.GetNumberOfCells(), 100)
        np.testing.assert_allclose(common.point_array(surface, 'RTData'), 200, rtol=1e-10)
        # The stock filter sees linear interpolation: close by.
        stock = common.fetch(simple.Contour(Input=self.wavelet, ContourBy=['POINTS', 'RTData'],
                                            Isosurfaces=[200]))
        np.testing.assert_allclose(surface.GetBounds(), stock.GetBounds(), atol=0.5)

    def test_least_squares_to_a_target_error(self):
        fit = simple.NURBSFit(Input=self.wavelet, Method='Least Squares', FitTo='Target Error',
                              TargetError=0.05)
        fit.UpdatePipeline()
        row, = report(fit)
        self.assertLessEqual(float(row['RelativeError']), 0.05)
        self.assertLess(int(row['ControlPoints']), 17 ** 3)

    def test_scattered_points(self):
        points = simple.PointSource(NumberOfPoints=3000, Radius=2)
        field = simple.Calculator(Input=points, ResultArrayName='Field',
                                  Function='sin(coordsX)+coordsY*coordsZ')
        fit = simple.NURBSFit(Input=field, PointArrays=['Field'], Degree=[2, 3, 3])
        fit.UpdatePipeline()
        row, = report(fit)
        self.assertLess(float(row['RelativeError']), 0.1)

    def test_bad_input_gives_one_error(self):
        thin = simple.Wavelet(WholeExtent=[-8, 8, -8, 8, 0, 1])
        nan = simple.Calculator(Input=self.wavelet, ResultArrayName='Bad',
                                Function='ln(coordsX-100)', ReplaceInvalidResults=1,
                                ReplacementValue=float('nan'))
        for arguments, text in (({'Input': thin}, '2 samples are too few for degree 3'),
                                ({'Input': nan, 'PointArrays': ['Bad']},
                                 'Bad has a value that is not finite at point 0 (0, 0, 0)')):
            fit = simple.NURBSFit(**arguments)
            with common.messages() as texts:
                fit.UpdatePipeline()
            self.assertEqual(len(texts), 1, texts)
            self.assertIn(text, texts[0])
            self.assertEqual(fit.GetDataInformation().GetNumberOfPoints(), 0)

    def test_a_state_keeps_the_fit(self):
        fit = simple.NURBSFit(Input=self.wavelet, Method='Least Squares', ControlPoints=[9, 8, 7])
        fit.UpdatePipeline()
        before = report(fit)
        with tempfile.TemporaryDirectory() as folder:
            state = os.path.join(folder, 'fit.pvsm')
            simple.SaveState(state)
            simple.ResetSession()
            simple.LoadState(state)
        again = next(source for source in simple.GetSources().values()
                     if source.SMProxy.GetXMLName() == 'NURBSFit')
        again.UpdatePipeline()
        self.assertEqual(report(again), before)


class RealVolumes(unittest.TestCase):
    def test_protein_density_is_contoured_smoothly(self):
        data = simple.OpenDataFile(volume('ironProt.vtk'))
        exact = simple.NURBSFit(Input=data)
        exact.UpdatePipeline()
        self.assertLess(float(report(exact)[0]['RelativeError']), 1e-12)
        smooth = simple.NURBSFit(Input=data, Method='Least Squares', ControlPoints=[68] * 3,
                                 Smoothing=0.1)
        contour = simple.NURBSContour(Input=smooth, ContourBy=['POINTS', 'scalars'],
                                      Isosurfaces=[128])
        surface = common.fetch(contour)
        self.assertGreater(surface.GetNumberOfCells(), 5000)

    def test_the_example_draws_a_smooth_scan(self):
        script = os.path.join(os.path.dirname(common.DATA), 'Examples', 'smooth_scan.py')
        plugins = os.path.dirname(os.path.dirname(os.environ['HYPERPATCH_PLUGIN']))
        with tempfile.TemporaryDirectory() as folder:
            picture = os.path.join(folder, 'scan.png')
            run = subprocess.run([common.PVPYTHON, script, volume('ironProt.vtk'), '128', picture],
                                 env={**os.environ, 'PV_PLUGIN_PATH': plugins}, text=True,
                                 capture_output=True, check=True)
            self.assertIn('ControlPoints: 314432', run.stdout)
            drawn = (common.read_picture(picture) != 255).any(axis=2)
            left, right = drawn[:, :600].sum(), drawn[:, 600:].sum()
            self.assertGreater(left, 10000)
            # Two views of about the same: perspective, and what smoothing takes off.
            self.assertAlmostEqual(right / left, 1, delta=0.1)

    def test_flow_grids_are_compressed_with_their_fields(self):
        for name in 'comb', 'bluntfin':
            data = simple.PLOT3DReader(FileName=volume(name + 'xyz.bin'),
                                       QFileName=[volume(name + 'q.bin')])
            fit = simple.NURBSFit(Input=data, Method='Least Squares', ControlPoints=[8, 8, 8])
            fit.UpdatePipeline()
            rows = {row['Attribute']: row for row in report(fit)}
            points = rows.pop('Points')
            self.assertEqual(int(points['ControlPoints']), 512)
            self.assertGreater(int(points['Samples']), 40000)
            self.assertLess(float(points['RelativeError']), 0.02)
            self.assertGreater(float(points['JacobianLower']), 0)
            self.assertEqual(points['InvalidElements'], '0')
            self.assertEqual(points['UndecidedElements'], '0')
            self.assertIn('Density', rows)


if __name__ == '__main__':
    unittest.main()
