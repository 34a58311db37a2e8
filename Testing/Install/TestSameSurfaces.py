# SPDX-License-Identifier: BSD-3-Clause
"""The C++ program, the pvpython script and the state of an example give the same surfaces: those of
the installed tree, and the script of the unpacked package as well.
"""
import os
import unittest

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

FOLDER = os.environ['HYPERPATCH_RESULTS']
SURFACES = os.environ['HYPERPATCH_SURFACES'].split()
ATTRIBUTE = os.environ['HYPERPATCH_ATTRIBUTE']
WAYS = ('cxx', 'script', 'package', 'state')


def surface(way, name):
    """Number of points, bounds, area and range of the attribute of a written surface."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(os.path.join(FOLDER, way, name + '.vtp'))
    reader.Update()
    data = reader.GetOutput()
    points = vtk_to_numpy(data.GetPoints().GetData())
    corners = points[vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * numpy.linalg.norm(normals, axis=1).sum()
    return len(points), numpy.array(data.GetBounds()), area, numpy.array(
        data.GetPointData().GetArray(ATTRIBUTE).GetRange())


class SameSurfaces(unittest.TestCase):
    def test_all_ways_give_the_same_surfaces(self):
        for name in SURFACES:
            number, bounds, area, values = surface(WAYS[0], name)
            print(f'{name}: {number} points, area {area:.12g}')
            self.assertGreater(area, 0.1)
            # Adding up n areas in another order changes the sum by n eps at most.
            area_tolerance = number * numpy.finfo(float).eps * area
            for way in WAYS[1:]:
                with self.subTest(surface=name, way=way):
                    other = surface(way, name)
                    self.assertEqual(other[0], number)
                    # Each coordinate and value is the result of the same operations; the compiler
                    # is free in a few of them.
                    numpy.testing.assert_allclose(other[1], bounds, rtol=0, atol=1e-14)
                    numpy.testing.assert_allclose(other[3], values, rtol=1e-14)
                    self.assertLess(abs(other[2] - area), area_tolerance)

    def test_all_ways_give_a_picture(self):
        for way in WAYS:
            with self.subTest(way=way):
                reader = vtkPNGReader()
                reader.SetFileName(os.path.join(FOLDER, way, 'picture.png'))
                reader.Update()
                pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, :3]
                self.assertEqual(len(pixels), 800 * 600)
                # Something was drawn, in more than one colour, and does not fill the view.
                drawn = (pixels != pixels[0]).any(axis=1).mean()
                self.assertGreater(drawn, 0.05)
                self.assertLess(drawn, 0.95)
                self.assertGreater(len(numpy.unique(pixels, axis=0)), 100)


if __name__ == '__main__':
    unittest.main()
