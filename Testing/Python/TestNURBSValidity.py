# SPDX-License-Identifier: BSD-3-Clause
"""NURBS Validity: verdicts on samples and real files, its table, edits, and its picture."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import common
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy


def verdicts(validity):
    """How many elements are valid, undecided, invalid; and whether the model is one to one."""
    mesh = common.fetch(validity)
    array = vtk_to_numpy(mesh.GetCellData().GetArray('Verdict'))
    injective = mesh.GetFieldData().GetArray('GloballyInjective')
    return ([int((array == value).sum()) for value in (1, 0, -1)],
            injective.GetValue(0) if injective else None)


# A patch that is cut over the processes, a folded one, and two patches.
FILES = (common.PIPE, os.path.join(common.DATA, 'folded_sweep.xml'),
         os.path.join(common.DATA, 'tube_on_block.xml'))


def results_of(file):
    """What a process knows of its elements, and of the model."""
    validity = simple.NURBSValidity(Input=common.open_file(file), Tolerance=0.1)
    validity.UpdatePipeline()
    mesh = validity.GetClientSideObject().GetOutputDataObject(0)
    table = validity.GetClientSideObject().GetOutputDataObject(1)
    cells = []
    if mesh.GetNumberOfCells():
        names = ('PatchId', 'ElementId', 'Verdict', 'Handedness', 'CondeTorres')
        cells = list(zip(*(vtk_to_numpy(mesh.GetCellData().GetArray(name)).tolist()
                           for name in names)))
    fields = {name: mesh.GetFieldData().GetArray(name).GetValue(0)
              for name in ('GloballyInjective', 'InvalidElements', 'UndecidedInjectivity')}
    rows = [[table.GetValueByName(row, name).ToString()
             for name in ('Name', 'Elements', 'Valid', 'Invalid', 'CondeTorres', 'Note')]
            for row in range(table.GetNumberOfRows())]
    return {'cells': cells, 'fields': fields, 'rows': rows}


def rank():
    """What every process of a parallel run does: writes its results for all files."""
    from mpi4py import MPI
    name = os.path.join(sys.argv[1], f'{MPI.COMM_WORLD.rank}.json')
    with open(name, 'w', encoding='ascii') as output:
        json.dump([results_of(file) for file in FILES], output)


def run(ranks):
    """For each file what the processes of rank() wrote, in the order of their numbers."""
    with tempfile.TemporaryDirectory() as folder:
        command = ['mpirun', '--allow-run-as-root', '--oversubscribe', '-np', str(ranks),
                   common.PVBATCH, '--symmetric', os.path.abspath(__file__), folder]
        # pvpython is an MPI process itself, and says so in the environment.
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith(('OMPI_', 'ORTE_', 'PMIX_'))}
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=200, text=True, check=False)
        assert done.returncode == 0, done.stdout
        results = []
        for number in range(ranks):
            with open(os.path.join(folder, f'{number}.json'), encoding='ascii') as file:
                results.append(json.load(file))
        return list(zip(*results))


@unittest.skipUnless(shutil.which('mpirun'), 'mpirun is not here')
class Parallel(unittest.TestCase):
    def test_three_processes_find_what_one_finds(self):
        for file, (one,), three in zip(FILES, run(1), run(3)):
            self.assertGreater(len(one['cells']), 0)
            self.assertEqual(sorted(cell for part in three for cell in part['cells']),
                             sorted(one['cells']), file)
            for part in three:
                self.assertEqual(part['fields'], one['fields'], file)
            self.assertEqual(three[0]['rows'], one['rows'], file)
            self.assertEqual(three[1]['rows'], [], file)


class Validity(unittest.TestCase):
    def test_samples(self):
        tube = common.open_file(os.path.join(common.DATA, 'tube_on_block.xml'))
        counts, injective = verdicts(simple.NURBSValidity(Input=tube))
        self.assertEqual(counts[1:], [0, 0])
        self.assertEqual(injective, 1)
        folded = common.open_file(os.path.join(common.DATA, 'folded_sweep.xml'))
        counts, injective = verdicts(simple.NURBSValidity(Input=folded))
        self.assertGreater(counts[2], 0)
        self.assertEqual(injective, -1)

    def test_the_table_adds_up(self):
        pipe = common.open_file(common.PIPE)
        validity = simple.NURBSValidity(Input=pipe)
        table = servermanager.Fetch(validity, idx=1)
        self.assertEqual(table.GetNumberOfRows(), 2)
        last = table.GetNumberOfRows() - 1
        numbers = {name: table.GetValueByName(last, name).ToInt()
                   for name in ('Elements', 'Valid', 'Invalid', 'Undecided')}
        self.assertEqual(numbers['Elements'], common.fetch(validity).GetNumberOfCells())
        self.assertEqual(numbers['Elements'],
                         numbers['Valid'] + numbers['Invalid'] + numbers['Undecided'])
        self.assertEqual(table.GetValueByName(last, 'Name').ToString(), 'All')

    def test_an_affine_edit_upstream_changes_what_it_must(self):
        pipe = common.open_file(common.PIPE)
        mirror = simple.Transform(Input=pipe)
        mirror.Transform.Scale = [1.0, 1.0, -2.0]
        before, after = (common.fetch(simple.NURBSValidity(Input=model))
                         for model in (pipe, mirror))

        def array(mesh, name):
            return vtk_to_numpy(mesh.GetCellData().GetArray(name))

        self.assertTrue((array(before, 'Handedness') == -array(after, 'Handedness')).all())
        self.assertTrue((array(before, 'Verdict') == array(after, 'Verdict')).all())
        # det J is -2 times what it was; both are certain to 1 %.
        scale = abs(array(before, 'MaximumJacobianUpper')).max()
        difference = (array(after, 'MinimumJacobianLower') +
                      2 * array(before, 'MaximumJacobianUpper'))
        self.assertLess(abs(difference).max(), 0.05 * scale)

    def test_verdict_colours_the_elements(self):
        view = common.view()
        self.addCleanup(simple.Delete, view)
        folded = common.open_file(os.path.join(common.DATA, 'folded_sweep.xml'))
        validity = simple.NURBSValidity(Input=folded)
        display = simple.Show(validity, view)
        simple.ColorBy(display, ('CELLS', 'Verdict'))
        simple.ResetCamera(view)
        self.assertGreater(common.silhouette(view).sum(), 1000)

    def test_a_changed_lattice_is_one_error(self):
        pipe = common.open_file(common.PIPE)
        broken = simple.NURBSValidity(Input=simple.PassArrays(
            Input=pipe, PointDataArrays=[common.ATTRIBUTE],
            FieldDataArrays=['SplineLayout', 'Knots']))
        with common.messages() as texts:
            broken.UpdatePipeline()
        self.assertEqual(len(texts), 1, texts)
        self.assertEqual(broken.GetDataInformation().GetNumberOfCells(), 0)


@unittest.skipUnless(os.path.isdir(common.SHARED), 'the folder of real files is not here')
class RealFiles(unittest.TestCase):
    """Known: which of them are folded, and where."""

    def validity(self, *names, **arguments):
        model = common.open_file(os.path.join(common.SHARED, *names))
        return verdicts(simple.NURBSValidity(Input=model, ScaledTolerance=0.0, **arguments))

    def test_folded_files(self):
        # The last one is folded on faces of its patches only.
        for names in (('gismo', 'tensorBSpline.xml'), ('irit', 'tensorBSpline.itd'),
                      ('irit', 'skeletal_muscle.itd'), ('gismo', 'water_passage_3p.xml'),
                      ('gismo', 'terrificPart02_vol.xml')):
            counts, injective = self.validity(*names)
            self.assertGreater(counts[2], 0, names)
            self.assertEqual(injective, -1, names)

    def test_proper_files(self):
        for names in (('mfem', 'pipe-nurbs.mesh'), ('gismo', 'bent_pipe.xml'),
                      ('gismo', 'twisted_pipe.xml'), ('gismo', 'horseshoe.xml'),
                      ('gismo', 'camembert.xml'), ('gismo', 'pole_u2p.xml'),
                      ('gismo', 'cylinder.xml'), ('splipy', 'cube-8-orient3.g2'),
                      ('gismo', 'thbcube.xml'), ('geopdes', 'geo_2cubesb.txt'),
                      ('geopdes', 'geo_thick_ring.txt'), ('gotools', 'midship_stiff1.g2')):
            counts, injective = self.validity(*names)
            self.assertEqual(counts[1:], [0, 0], names)
            self.assertEqual(injective, 1, names)

    def test_patches_that_match_to_their_files_tolerance(self):
        # 54 patches whose common faces differ by up to 1e-4.
        counts, injective = self.validity('gotools', 'nut.g2', ContactTolerance=1e-5)
        self.assertEqual(counts[1:], [0, 0])
        self.assertEqual(injective, 1)


if __name__ == '__main__':
    if len(sys.argv) == 2:
        rank()
    else:
        unittest.main()
