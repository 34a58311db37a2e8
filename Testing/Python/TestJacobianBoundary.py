# SPDX-License-Identifier: BSD-3-Clause
"""NURBS Jacobian Boundary: its panel, and its pieces on one and on several processes."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import common
import numpy
from paraview import simple
from paraview.vtk.util.numpy_support import vtk_to_numpy

KNOT_PLANE, SHEET = 6, 7
PAPER = 'Joy & Duchaineau 1999'


def dent(folder):
    """A block that turns back above the C0 knot plane u = 1/2 where (v, w) is in a circle of radius
    0.3 around the middle, as a file."""
    square = [0.25, -0.25, 0.25]
    path = os.path.join(folder, 'dent.g2')
    with open(path, 'w', encoding='ascii') as file:
        file.write('700 1 0 0\n3 0\n3 2\n0 0 0.5 1 1\n' + 2 * '3 3\n0 0 0 1 1 1\n')
        for k in range(3):
            for j in range(3):
                top = 1 + 0.5 * (square[j] + square[k] - 0.09)
                file.writelines(f'{x!r} {j / 2} {k / 2}\n' for x in (0.0, 1.0, top))
    return path


def pieces(proxy):
    """Triangles with their pieces: corners (n x 3 x 3), Piece and PieceId (n x 2)."""
    data = proxy.GetClientSideObject().GetOutputDataObject(0)
    if data.GetNumberOfCells() == 0:
        return numpy.zeros((0, 3, 3)), numpy.zeros((0, 2))
    labels = [vtk_to_numpy(data.GetCellData().GetArray(name)) for name in ('Piece', 'PieceId')]
    return common.cell_corners(data), numpy.stack(labels, axis=1)


def rank():
    """What every process of the parallel run does: saves its part."""
    from mpi4py import MPI
    folder, file = sys.argv[1:]
    number = MPI.COMM_WORLD.rank
    boundary = simple.NURBSJacobianBoundary(Input=common.open_file(file))
    boundary.UpdatePipeline()
    corners, labels = pieces(boundary)
    numpy.savez(os.path.join(folder, f'{MPI.COMM_WORLD.size}-{number}.npz'), corners=corners,
                labels=labels)
    # Split patches are nothing for the method of the paper; no process may wait for ever.
    boundary.Method = PAPER
    boundary.UpdatePipeline()
    print('reached the end')


def run(folder, ranks, file):
    command = ['mpirun', '--allow-run-as-root', '--oversubscribe', '-np', str(ranks),
               common.PVBATCH, '--symmetric', os.path.abspath(__file__), folder, file]
    # pvpython is an MPI process itself, and says so in the environment.
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith(('OMPI_', 'ORTE_', 'PMIX_'))}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=200, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert done.stdout.count('reached the end') == ranks, done.stdout
    return done.stdout


def everything(folder, ranks):
    """Triangles of all processes, one a row in an order that round-off leaves alone: least corner
    and centre, rounded, then Piece and PieceId."""
    rows = []
    for number in range(ranks):
        part = numpy.load(os.path.join(folder, f'{ranks}-{number}.npz'))
        corners = part['corners']
        rows.append(numpy.concatenate([corners.min(axis=1), corners.max(axis=1),
                                       corners.mean(axis=1), part['labels']], axis=1))
    rows = numpy.concatenate(rows)
    return rows[numpy.lexsort((numpy.round(rows, 7) + 0.0).T)]


class JacobianBoundary(unittest.TestCase):
    def test_parameters_of_the_paper_show_with_its_method(self):
        with tempfile.TemporaryDirectory() as folder:
            proxy = simple.NURBSJacobianBoundary(Input=common.open_file(dent(folder)))
            hidden = {'IntervalsFrom', 'MinimumWidth', 'MaximumCells', 'CrackRepair', 'ShowCells'}
            for name in hidden:
                hints = proxy.GetProperty(name).SMProperty.GetHints()
                decorator = hints.FindNestedElementByName('PropertyWidgetDecorator')
                self.assertEqual(decorator.GetAttribute('property'), 'Method')
                self.assertEqual(decorator.GetAttribute('value'), '1')
            proxy.Method = PAPER
            proxy.ShowCells = 1
            proxy.UpdatePipeline()
            data = common.fetch(proxy)
            self.assertGreater(data.GetNumberOfLines(), 0)
            self.assertGreater(data.GetFieldData().GetArray('Cells').GetTuple1(0), 0)

    def test_everything_can_be_coloured(self):
        boundary = simple.NURBSJacobianBoundary(Input=common.open_file(common.PIPE))
        boundary.UpdatePipeline()
        self.assertIn(common.ATTRIBUTE, boundary.PointData.keys())
        self.assertIn('JacobianDeterminant', boundary.PointData.keys())
        for name in ('Piece', 'PieceId', 'PatchId', 'ElementId'):
            self.assertIn(name, boundary.CellData.keys())

    @unittest.skipUnless(shutil.which('mpirun'), 'mpirun is not here')
    def test_pieces_are_the_same_on_several_processes(self):
        with tempfile.TemporaryDirectory() as folder:
            # Two processes cut the dented block at its knot plane.
            for file, counts in ((dent(folder), (2, 3)), (common.PIPE, (3,))):
                run(folder, 1, file)
                one = everything(folder, 1)
                for ranks in counts:
                    output = run(folder, ranks, file)
                    self.assertEqual(output.count('split over several processes'), 1, output)
                    many = everything(folder, ranks)
                    self.assertEqual(one.shape, many.shape)
                    self.assertLess(abs(one - many).max(), 1e-10)
                self.assertEqual(set(one[:, -1]), set(range(len(set(one[:, -1])))))
                if file != common.PIPE:
                    self.assertEqual(set(one[:, -2]), set(range(8)))


if __name__ == '__main__':
    if len(sys.argv) == 3:
        rank()
    else:
        unittest.main()
