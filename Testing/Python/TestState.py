# SPDX-License-Identifier: BSD-3-Clause
"""A state file brings the pipeline and the picture back in a fresh process."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import common
import numpy
from paraview import simple


def sources():
    """Points, cells and bounds of everything in the pipeline, by the name of the proxy."""
    result = {}
    for (name, _), proxy in simple.GetSources().items():
        proxy.UpdatePipeline()
        data = proxy.GetDataInformation()
        result[name] = [data.GetNumberOfPoints(), data.GetNumberOfCells(), list(data.GetBounds())]
    return result


def restore(folder):
    """The fresh process: loads the state, writes what it sees."""
    simple.LoadState(os.path.join(folder, 'state.pvsm'))
    with open(os.path.join(folder, 'restored.json'), 'w', encoding='ascii') as file:
        json.dump(sources(), file)
    view = simple.GetActiveView()
    numpy.save(os.path.join(folder, 'restored.npy'), common.pixels(view))
    simple.Delete(view)


class State(unittest.TestCase):
    def test_a_state_comes_back_in_a_fresh_process(self):
        model = common.open_file(common.PIPE)
        filters = common.four_filters(
            model, common.ATTRIBUTE, common.ISOVALUE, common.ORIGIN)
        filters['slice'].SliceType.Normal = [0.0, 1.0, 0.0]
        filters['slice'].SliceOffsetValues = [-0.1, 0.3]
        filters['tessellate'].MeshType = 'Solid'
        filters['boundary'].Faces = 0
        view = common.view()
        self.addCleanup(simple.Delete, view)
        for proxy in (model, filters['slice']):
            display = simple.Show(proxy, view)
            simple.ColorBy(display, ('POINTS', common.ATTRIBUTE))
        display = simple.GetDisplayProperties(model, view)
        display.RescaleTransferFunctionToDataRange(False, True)
        display.SolidTolerance = 0.005
        view.CameraPosition = [-2.0, -1.2, 1.6]
        view.ResetCamera(True)
        picture = common.pixels(view)
        with tempfile.TemporaryDirectory() as folder:
            simple.SaveState(os.path.join(folder, 'state.pvsm'))
            subprocess.run([common.PVPYTHON, os.path.abspath(__file__), folder], check=True)
            with open(os.path.join(folder, 'restored.json'), encoding='ascii') as file:
                restored = json.load(file)
            again = numpy.load(os.path.join(folder, 'restored.npy'))
        self.assertEqual(len(restored), 5)
        self.assertEqual(restored, sources())
        self.assertGreater((picture != 255).sum(), 5000)
        self.assertEqual((picture != again).sum(), 0)


if __name__ == '__main__':
    if len(sys.argv) == 2 and os.path.isdir(sys.argv[1]):
        restore(sys.argv[1])
    else:
        unittest.main()
