# SPDX-License-Identifier: BSD-3-Clause
"""How well real volumes are fitted: pvpython fit_volumes.py <plugin> <folder of volumes>.

The folder has VTK's test data ironProt.vtk, headsq.vti, combxyz.bin, combq.bin, bluntfinxyz.bin and
bluntfinq.bin. Prints rows of a Markdown table.
"""
import os
import sys
import time

from paraview import servermanager, simple

PLUGIN, FOLDER = sys.argv[1:]
simple.LoadPlugin(PLUGIN, remote=False)


def read(name):
    path = os.path.join(FOLDER, name)
    if name.endswith('.bin'):
        return simple.PLOT3DReader(FileName=path.replace('q.bin', 'xyz.bin'), QFileName=[path])
    return simple.OpenDataFile(path)


def fit(name, how, **arguments):
    data = read(name)
    data.UpdatePipeline()
    proxy = simple.NURBSFit(Input=data, **arguments)
    start = time.perf_counter()
    proxy.UpdatePipeline()
    seconds = time.perf_counter() - start
    table = servermanager.Fetch(proxy, idx=1)
    for row in range(table.GetNumberOfRows()):
        value = {column: table.GetValueByName(row, column) for column in (
            'Attribute', 'Components', 'Samples', 'ControlPoints', 'RMSError', 'MaximumError',
            'RelativeError', 'JacobianLower', 'JacobianUpper', 'InvalidElements')}
        number = {column: item.ToDouble() for column, item in value.items()}
        # Of constant arrays there is nothing to see.
        spread = number['MaximumError'] / number['RelativeError'] if number['RelativeError'] else 0
        if spread == 0:
            continue
        low, high = number['JacobianLower'], number['JacobianUpper']
        jacobian = '' if low != low else f'{low:.3g} to {high:.3g}'
        if number['InvalidElements'] > 0:
            jacobian += f", {value['InvalidElements'].ToString()} folded elements"
        print(f"| {name} | {how} | {value['Attribute'].ToString()} "
              f"| {value['Samples'].ToString()} | {value['ControlPoints'].ToString()} "
              f"| {number['Samples'] / number['ControlPoints']:.1f} "
              f"| {100 * number['RMSError'] / spread:.2g} % | {100 * number['RelativeError']:.2g} % "
              f"| {jacobian} | {1000 * seconds:.0f} |")
        seconds = 0


print('| file | fit | array | samples | control points | ratio | RMS | largest | least det J | ms |')
print('| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |')
for volume in ('ironProt.vtk', 'headsq.vti'):
    fit(volume, 'interpolate')
    fit(volume, 'target 10 %', Method='Least Squares', FitTo='Target Error', TargetError=0.1)
    fit(volume, 'RMS 2 %', Method='Least Squares', FitTo='Target Error', TargetError=0.02,
        ErrorMeasure='Root Mean Square')
    fit(volume, '32^3', Method='Least Squares', ControlPoints=[32] * 3)
for grid in ('combq.bin', 'bluntfinq.bin'):
    fit(grid, 'interpolate')
    fit(grid, '8^3', Method='Least Squares', ControlPoints=[8] * 3)
    fit(grid, '16^3', Method='Least Squares', ControlPoints=[16] * 3)
    fit(grid, 'target 5 %', Method='Least Squares', FitTo='Target Error', TargetError=0.05)
    fit(grid, 'RMS 2 %', Method='Least Squares', FitTo='Target Error', TargetError=0.02,
        ErrorMeasure='Root Mean Square')
