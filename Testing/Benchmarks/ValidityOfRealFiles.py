# SPDX-License-Identifier: BSD-3-Clause
"""The table of real files in Documentation/NURBSValidity.md, as Markdown.

    HYPERPATCH_PLUGIN=.../Hyperpatch.so pvpython ValidityOfRealFiles.py folder... 2>/dev/null

Runs NURBS Validity on every spline volume in the folders and below. Times are of the filter alone,
on all cores.
"""
import os
import sys
import time

from paraview import servermanager, simple

EXTENSIONS = ('.xml', '.mesh', '.g2', '.txt', '.itd', '.vtpc')


def files(folders):
    for folder in folders:
        for path, _, names in sorted(os.walk(folder)):
            for name in sorted(names):
                if name.endswith(EXTENSIONS) and name != 'README.md':
                    yield os.path.join(path, name)


def verdict_of(row):
    def of(name):
        return row.GetValueByName(row.GetNumberOfRows() - 1, name)
    return {name: of(name).ToDouble() for name in (
        'Elements', 'Valid', 'Invalid', 'Undecided', 'Degenerate', 'Handedness',
        'MinimumJacobianLower', 'MinimumJacobianUpper', 'ScaledJacobianLower', 'CondeTorres')}


def handedness(table):
    signs = {table.GetValueByName(i, 'Handedness').ToInt()
             for i in range(table.GetNumberOfRows() - 1)}
    return {(1,): 'right', (-1,): 'left'}.get(tuple(signs), 'both')


def main():
    simple.LoadPlugin(os.environ['HYPERPATCH_PLUGIN'], remote=False)
    print('| file | patches | elements | valid | invalid | undecided | degenerate | handed '
          '| least det J | least scaled | one to one | Conde & Torres pass | s |')
    print('| --- ' * 13 + '|')
    for file in files(sys.argv[1:]):
        try:
            reader = simple.OpenDataFile(file)
        except RuntimeError:
            continue
        if reader is None or reader.SMProxy.GetXMLName() != 'BSplineReader':
            continue
        reader.UpdatePipeline()
        begin = time.time()
        validity = simple.NURBSValidity(Input=reader)
        validity.UpdatePipeline()
        seconds = time.time() - begin
        table = servermanager.Fetch(validity, idx=1)
        if table.GetNumberOfRows() < 2:
            continue
        row = verdict_of(table)
        injective = table.GetFieldData().GetArray('GloballyInjective').GetValue(0)
        counts = ' | '.join('%d' % row[name] for name in (
            'Elements', 'Valid', 'Invalid', 'Undecided', 'Degenerate'))
        name = os.path.join(os.path.basename(os.path.dirname(file)), os.path.basename(file))
        print('| %s | %d | %s | %s | %.4g to %.4g | %.3f | %s | %d | %.2f |' % (
            name, table.GetNumberOfRows() - 1, counts, handedness(table),
            row['MinimumJacobianLower'], row['MinimumJacobianUpper'], row['ScaledJacobianLower'],
            {1: 'yes', 0: 'undecided', -1: 'no'}[injective], row['CondeTorres'], seconds))
        sys.stdout.flush()
        simple.Delete(validity)
        simple.Delete(reader)


if __name__ == '__main__':
    main()
