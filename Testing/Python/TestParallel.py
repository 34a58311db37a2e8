# SPDX-License-Identifier: BSD-3-Clause
"""Three processes draw the surface that one draws; an error stops nobody."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import common
import numpy
from paraview import simple

FILTERS = ('tessellate', 'slice', 'contour', 'boundary', 'extract')
COUNTS = ('OpenEdgesInside', 'OpenEdgesOnInterfaces', 'CertifiedCells')
# Position and length of a box that meets one end of either model.
BOX = [0.0, 0.0, 0.0], [0.5, 1.0, 0.5]


LENS = 'lens'


def lens():
    """A model from a source and modelling filters, of two patches with more elements than ranks."""
    line = simple.NURBSCurve(Points=[0, 0, 0, 1, 0, 0], AttributeName='Index',
                             AttributeValues=[1.6, 1.6, 1.5, 1.4])
    disk = simple.NURBSRevolve(Input=line, AxisDirection=[0, 0, 1])
    layers = [simple.NURBSExtrude(Input=disk, Vector=[0, 0, z]) for z in (0.5, -0.5)]
    return simple.NURBSRefine(Input=simple.NURBSAppend(Input=layers))


def rank():
    """What every process of the parallel run does: saves its part of each surface."""
    from mpi4py import MPI
    folder, file = sys.argv[1:]
    number, ranks = MPI.COMM_WORLD.rank, MPI.COMM_WORLD.size
    model = lens() if file == LENS else common.open_file(file)
    # Ranges and bounds that a process knows of are those of its part: choose nothing by them.
    if file == common.PIPE:
        arguments = common.ATTRIBUTE, common.ISOVALUE, common.ORIGIN
    elif file == LENS:
        arguments = 'Index', 1.5, [0.3, 0.2, 0.3]
    else:
        model = simple.Calculator(Input=model, Function='coordsX+coordsY', ResultArrayName='Sum')
        arguments = 'Sum', 1.5, [1.2, 0.3, 0.5]
    for name, proxy in common.four_filters(model, *arguments).items():
        data = proxy.GetClientSideObject().GetOutputDataObject(0)
        corners = common.cell_corners(data) if data.GetNumberOfCells() else numpy.zeros((0, 3, 3))
        numpy.save(os.path.join(folder, f'{name}-{ranks}-{number}.npy'), corners)
        if name in ('slice', 'contour'):
            # All processes have the numbers of the whole.
            numpy.save(os.path.join(folder, f'{name}-counts-{ranks}-{number}.npy'),
                       [data.GetFieldData().GetArray(count).GetValue(0) for count in COUNTS])
    # The choice of a box is that of whole patches, whichever parts a process has.
    chosen = simple.NURBSExtractPatches(Input=model, ExtractBy='Box')
    chosen.Box.Position, chosen.Box.Length = BOX
    skin = simple.NURBSTessellate(Input=chosen)
    skin.UpdatePipeline()
    data = skin.GetClientSideObject().GetOutputDataObject(0)
    corners = common.cell_corners(data) if data.GetNumberOfCells() else numpy.zeros((0, 3, 3))
    numpy.save(os.path.join(folder, f'extract-{ranks}-{number}.npy'), corners)
    broken = simple.NURBSSlice(Input=simple.PassArrays(
        Input=model, PointDataArrays=[arguments[0]], FieldDataArrays=['SplineLayout', 'Knots']))
    broken.UpdatePipeline()
    assert broken.GetDataInformation().GetNumberOfCells() == 0
    view = common.view()
    simple.Show(model, view)
    view.CameraPosition = [-2.0, -1.2, 1.6]
    view.ResetCamera(True)
    simple.SaveScreenshot(os.path.join(folder, f'picture-{ranks}.png'), view)
    print('reached the end')


def run(folder, ranks, file):
    """Runs rank() in that many processes; returns all that they print."""
    command = ['mpirun', '--allow-run-as-root', '--oversubscribe', '-np', str(ranks),
               common.PVBATCH, '--symmetric', os.path.abspath(__file__), folder, file]
    # pvpython is an MPI process itself, and says so in the environment.
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith(('OMPI_', 'ORTE_', 'PMIX_'))}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=200, text=True, check=False)
    assert done.returncode == 0, done.stdout
    return done.stdout


def surface(folder, name, ranks):
    """Triangles of all processes, corners and triangles in an order that round-off leaves alone."""
    corners = numpy.concatenate([numpy.load(os.path.join(folder, f'{name}-{ranks}-{number}.npy'))
                                 for number in range(ranks)])
    keys = numpy.round(corners, 7) + 0.0
    order = numpy.lexsort(keys.transpose(2, 0, 1), axis=1)
    corners = numpy.take_along_axis(corners, order[:, :, None], axis=1)
    keys = numpy.round(corners, 7).reshape(len(corners), 9) + 0.0
    return corners[numpy.lexsort(keys.T)]


@unittest.skipUnless(shutil.which('mpirun'), 'mpirun is not here')
class Parallel(unittest.TestCase):
    def assert_closed(self, folder, name, ranks):
        """Only the boundary of the model leaves edges open, and all processes know."""
        counts = [numpy.load(os.path.join(folder, f'{name}-counts-{ranks}-{number}.npy')).tolist()
                  for number in range(ranks)]
        self.assertEqual(counts, ranks * counts[:1], name)
        self.assertEqual(counts[0][:2], [0, 0], name)
        self.assertGreater(counts[0][2], 0, name)

    def assert_same(self, file):
        with tempfile.TemporaryDirectory() as folder:
            for ranks in (1, 3):
                output = run(folder, ranks, file)
                self.assertEqual(output.count('reached the end'), ranks, output)
                self.assertGreater(output.count('has no point data array Weight'), 0, output)
            for name in FILTERS:
                one, three = (surface(folder, name, ranks) for ranks in (1, 3))
                self.assertGreater(len(one), 0, name)
                if name in ('slice', 'contour'):
                    # Cut at other places it is triangulated otherwise, to the same tolerance.
                    self.assertLess(common.differ_as_surfaces(one, three), 2e-3, name)
                    # A crack between parts would be outline.
                    edge = common.outline(one)
                    self.assertLess(abs(common.outline(three) - edge), 2e-3 * edge, name)
                    self.assert_closed(folder, name, 1)
                    self.assert_closed(folder, name, 3)
                    continue
                self.assertEqual(one.shape, three.shape, name)
                # The restriction of a spline to a piece changes its values by round-off.
                self.assertLess(abs(one - three).max(), 1e-10 * abs(one).max(), name)
            one, three = (common.read_picture(os.path.join(folder, f'picture-{ranks}.png'))
                          for ranks in (1, 3))
            drawn = (one != one[0, 0]).any(axis=2)
            self.assertGreater(drawn.sum(), 5000)
            # Pixels on edges may belong to either side.
            differ = (abs(one.astype(int) - three.astype(int)) > 32).any(axis=2)
            self.assertLess(differ.sum(), 0.02 * drawn.sum())

    def test_one_patch_on_three_ranks(self):
        self.assert_same(common.PIPE)

    def test_two_patches_on_three_ranks(self):
        self.assert_same(os.path.join(common.DATA, 'tube_on_block.xml'))

    def test_a_modelled_lens_on_three_ranks(self):
        self.assert_same(LENS)


if __name__ == '__main__':
    if len(sys.argv) == 3:
        rank()
    else:
        unittest.main()
