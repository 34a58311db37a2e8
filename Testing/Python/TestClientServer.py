# SPDX-License-Identifier: BSD-3-Clause
"""A client of a server with one or two processes sees what one process alone sees."""
import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import common
import numpy
from paraview import simple

MODES = ('alone', 'one', 'two')
# A server that has not answered by then never will; everything else takes seconds.
TIMEOUT = 60


def ranges(arrays):
    return {array.Name: [list(array.GetRange(c)) for c in range(array.GetNumberOfComponents())]
            for array in arrays}


def client(folder, port):
    """What the client of a server does (without one if the port is 0): writes what it sees."""
    if port:
        simple.Connect('127.0.0.1', port, timeout=TIMEOUT)
        # Loading on the server alone leaves the client without the representation.
        for remote in (True, False):
            simple.LoadPlugin(os.environ['HYPERPATCH_PLUGIN'], remote=remote)
    model = common.open_file(common.PIPE)
    seen = {}
    filters = common.four_filters(model, common.ATTRIBUTE, common.ISOVALUE, common.ORIGIN)
    for name, proxy in filters.items():
        information = proxy.GetDataInformation()
        # Cut at other places, slices and isosurfaces are triangulated otherwise.
        same = name not in ('slice', 'contour')
        seen[name] = {'cells': information.GetNumberOfCells() if same else 0,
                      'bounds': information.GetBounds() if same else [],
                      'points': ranges(proxy.PointData) if same else sorted(ranges(proxy.PointData)),
                      'cell data': sorted(ranges(proxy.CellData))}
        numpy.save(os.path.join(folder, name + '.npy'), common.cell_corners(common.fetch(proxy)))
    information = model.GetDataInformation()
    seen['model'] = {'type': information.GetCompositeDataClassName(),
                     'datasets': information.GetNumberOfDataSets() > 0,
                     'bounds': information.GetBounds(), 'points': ranges(model.PointData)}

    view = common.view()
    display = simple.Show(model, view)
    seen['representation'] = [display.SMProxy.GetXMLName(), display.Representation.GetData()]
    simple.ColorBy(display, ('POINTS', common.ATTRIBUTE))
    display.RescaleTransferFunctionToDataRange(False, True)
    colors = simple.GetColorTransferFunction(common.ATTRIBUTE).RGBPoints
    seen['legend'] = [colors[0], colors[-4]]
    view.CameraPosition = [-2.0, -1.2, 1.6]
    view.ResetCamera(True)
    # The server renders, or it sends the triangles to the client.
    for name, threshold in (('remote', 0.0), ('local', 1e6)):
        view.RemoteRenderThreshold = threshold
        display.Representation = 'NURBS Solid With Edges'
        numpy.save(os.path.join(folder, name + '.npy'), common.pixels(view))
    drawn = display.SMProxy.GetRepresentedDataInformation()
    seen['drawn'] = [drawn.GetNumberOfCells(), drawn.GetBounds()]

    with common.messages() as texts:  # those of a server arrive at its terminal
        broken = simple.NURBSSlice(Input=simple.PassArrays(
            Input=model, PointDataArrays=['Temperature'], FieldDataArrays=['SplineLayout', 'Knots']))
        broken.UpdatePipeline()
    seen['broken'] = broken.GetDataInformation().GetNumberOfCells()
    assert port or len(texts) == 1
    with open(os.path.join(folder, 'seen.json'), 'w', encoding='ascii') as file:
        json.dump(seen, file)
    simple.Delete(view)
    if port:
        simple.Disconnect()


def environment():
    """Ours without what says that we are an MPI process, as pvpython is one."""
    return {name: value for name, value in os.environ.items()
            if not name.startswith(('OMPI_', 'ORTE_', 'PMIX_'))}


@contextlib.contextmanager
def server(ranks):
    """Runs a server of that many processes; gives its port."""
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        port = probe.getsockname()[1]
    launcher = ['mpirun', '--allow-run-as-root', '--oversubscribe', '-np', str(ranks)]
    with tempfile.TemporaryFile('w+') as log:
        process = subprocess.Popen(
            launcher + [os.environ.get('PVSERVER', 'pvserver'), f'--server-port={port}',
                        '--hostname=127.0.0.1'],
            env=environment(), stdout=log, stderr=subprocess.STDOUT)

        def said():
            log.seek(0)
            return log.read()

        try:
            end = time.monotonic() + TIMEOUT
            while 'Accepting connection' not in said():
                assert process.poll() is None and time.monotonic() < end, said()
                time.sleep(0.1)
            yield port
            # It ends with its client.
            assert process.wait(TIMEOUT) == 0, said()
            assert said().count('has no point data array Weight') == 1, said()
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait(TIMEOUT)


def sort(corners):
    """Corners and triangles in an order that round-off leaves alone."""
    keys = numpy.round(corners, 7) + 0.0
    order = numpy.lexsort(keys.transpose(2, 0, 1), axis=1)
    corners = numpy.take_along_axis(corners, order[:, :, None], axis=1)
    return corners[numpy.lexsort(numpy.round(corners, 7).reshape(len(corners), 9).T + 0.0)]


@unittest.skipUnless(shutil.which('mpirun') and shutil.which('pvserver'), 'there is no server here')
class ClientServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        for ranks, mode in enumerate(MODES):
            os.mkdir(cls.path(mode))
            with server(ranks) if ranks else contextlib.nullcontext(0) as port:
                done = subprocess.run(
                    [common.PVPYTHON, os.path.abspath(__file__), cls.path(mode), str(port)],
                    env=environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                    timeout=2 * TIMEOUT, text=True, check=False)
                assert done.returncode == 0, done.stdout

    @classmethod
    def path(cls, *parts):
        return os.path.join(cls.folder.name, *parts)

    def seen(self, mode):
        with open(self.path(mode, 'seen.json'), encoding='ascii') as file:
            return json.load(file)

    def assert_close(self, a, b, place):
        """The same, up to the round-off by which a piece of a spline differs from the whole."""
        if isinstance(a, dict):
            self.assertEqual(sorted(a), sorted(b), place)
            for key in a:
                self.assert_close(a[key], b[key], f'{place}/{key}')
        elif isinstance(a, list):
            self.assertEqual(len(a), len(b), place)
            for i, pair in enumerate(zip(a, b)):
                self.assert_close(*pair, f'{place}[{i}]')
        elif isinstance(a, float):
            self.assertLess(abs(a - b), 1e-10 * max(1.0, abs(a)), (place, a, b))
        else:
            self.assertEqual(a, b, place)

    def test_information_and_representation_are_the_same(self):
        alone = self.seen('alone')
        self.assertEqual(alone['representation'], ['NURBSRepresentation', 'NURBS Solid'])
        self.assertEqual(alone['broken'], 0)
        for mode in MODES[1:]:
            self.assert_close(alone, self.seen(mode), mode)

    def test_surfaces_are_the_same(self):
        for name in ('tessellate', 'slice', 'contour', 'boundary'):
            alone, *others = (sort(numpy.load(self.path(mode, name + '.npy'))) for mode in MODES)
            self.assertGreater(len(alone), 0, name)
            for other in others:
                if name in ('slice', 'contour'):
                    # Cut at other places it is triangulated otherwise, to the same tolerance.
                    self.assertLess(common.differ_as_surfaces(alone, other), 2e-3, name)
                    # A crack between parts would be outline.
                    edge = common.outline(alone)
                    self.assertLess(abs(common.outline(other) - edge), 2e-3 * edge, name)
                    continue
                self.assertEqual(alone.shape, other.shape, name)
                self.assertLess(abs(alone - other).max(), 1e-10 * abs(alone).max(), name)

    def test_pictures_are_the_same(self):
        alone = numpy.load(self.path('alone', 'local.npy')).astype(int)
        drawn = (alone != 255).any(axis=2)
        self.assertGreater(drawn.sum(), 5000)
        for mode in MODES[1:]:
            for name in ('local', 'remote'):
                other = numpy.load(self.path(mode, name + '.npy')).astype(int)
                # Pixels on edges may belong to either side, and a picture may come compressed.
                differ = (abs(alone - other) > 32).any(axis=2)
                self.assertLess(differ.sum(), 0.02 * drawn.sum(), (mode, name))


if __name__ == '__main__':
    if len(sys.argv) == 3:
        client(sys.argv[1], int(sys.argv[2]))
    else:
        unittest.main()
