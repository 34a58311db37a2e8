# SPDX-License-Identifier: BSD-3-Clause
"""Opens a spline file; slices it, draws two isosurfaces of Temperature and its boundary; writes the
surfaces (.vtp) and a picture of them in the colours of Temperature into a folder.

    PV_PLUGIN_PATH=<prefix>/lib/paraview-5.11/plugins pvpython Examples/pipeline.py \\
        Data/heated_pipe_bend.vtpc FOLDER [--state FILE.pvsm]

With --state the pipeline is saved as a state of ParaView, too; pipeline.pvsm is made that way.
"""
import argparse
import os
import sys

from paraview import simple

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument('file', help='Data/heated_pipe_bend.vtpc')
parser.add_argument('folder', help='where the surfaces and the picture go')
parser.add_argument('--state', help='the state file to write')
arguments = parser.parse_args()
os.makedirs(arguments.folder, exist_ok=True)

# PV_PLUGIN_PATH has loaded the plugin; simple.LoadPlugin(FILE) is the way without it.
if not hasattr(simple, 'NURBSSlice'):
    sys.exit('The plugin is not loaded: set PV_PLUGIN_PATH to the folder that has Hyperpatch in it')

data = os.path.abspath(arguments.file)
model = simple.OpenDataFile(data, registrationName='Pipe')

cut = simple.NURBSSlice(registrationName='slice', Input=model)
cut.SliceType.Origin = [1.5, 1.5, 0.0]
cut.SliceType.Normal = [0.0, 1.0, 0.0]

contour = simple.NURBSContour(registrationName='contour', Input=model)
contour.ContourBy = ['POINTS', 'Temperature']
contour.Isosurfaces = [100.0, 180.0]

boundary = simple.NURBSJacobianBoundary(registrationName='boundary', Input=model)
boundary.UpdatePipeline()
colors = simple.GetColorTransferFunction('Temperature')
colors.RescaleTransferFunction(*boundary.PointData['Temperature'].GetRange())

view = simple.CreateView('RenderView')
view.ViewSize = [800, 600]
for name, proxy, opacity in (('slice', cut, 1.0), ('contour', contour, 1.0),
                             ('boundary', boundary, 0.2)):
    # Readers on some systems stumble over raw appended data.
    simple.SaveData(os.path.join(arguments.folder, name + '.vtp'), proxy, DataMode='Binary')
    display = simple.Show(proxy, view, Opacity=opacity)
    simple.ColorBy(display, ('POINTS', 'Temperature'))

view.CameraPosition = [-2.0, -1.2, 1.6]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraViewUp = [0.0, 0.0, 1.0]
view.ResetCamera(True)
simple.SaveScreenshot(os.path.join(arguments.folder, 'picture.png'), view)

if arguments.state:
    simple.SaveState(arguments.state)
    # A path that does not depend on the machine; LoadState(data_directory=...), or File > Load State
    # > Search files under specified directory, finds the file wherever it is.
    with open(arguments.state, encoding='utf-8') as file:
        state = file.read()
    relative = os.path.relpath(data, os.path.dirname(os.path.abspath(arguments.state)))
    with open(arguments.state, 'w', encoding='utf-8') as file:
        file.write(state.replace(data, relative))
