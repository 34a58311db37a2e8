# SPDX-License-Identifier: BSD-3-Clause
"""Models a lens whose index of refraction varies with the radius (Martin and Cohen, 2001, Figure
1): a line with an attribute curve is revolved to a disk, and the disk extruded to a volume. Writes
the disk, the volume and two isosurfaces of the index (.vtp), and a picture of them, into a folder.

    PV_PLUGIN_PATH=<prefix>/lib/paraview-5.11/plugins pvpython Examples/lens.py FOLDER \\
        [--state FILE.pvsm]

With --state the pipeline is saved as a state of ParaView, too; lens.pvsm is made that way. Load it,
change the attribute values or the points of `line`, and the lens follows.
"""
import argparse
import os
import sys

from paraview import simple

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument('folder', help='where the surfaces and the picture go')
parser.add_argument('--state', help='the state file to write')
arguments = parser.parse_args()
os.makedirs(arguments.folder, exist_ok=True)

# PV_PLUGIN_PATH has loaded the plugin; simple.LoadPlugin(FILE) is the way without it.
if not hasattr(simple, 'NURBSCurve'):
    sys.exit('The plugin is not loaded: set PV_PLUGIN_PATH to the folder that has Hyperpatch in it')

line = simple.NURBSCurve(registrationName='line', Points=[0, 0, 0, 1, 0, 0])
line.AttributeName = 'Index'
line.AttributeValues = [1.62, 1.62, 1.4, 1.58, 1.46]
line.AttributeDegree = 3

disk = simple.NURBSRevolve(registrationName='disk', Input=line, AxisDirection=[0, 0, 1])
lens = simple.NURBSExtrude(registrationName='lens', Input=disk, Vector=[0, 0, 0.5])

# As meshes, for files; in the view the models are shown themselves.
disk_surface = simple.NURBSTessellate(registrationName='disk_surface', Input=disk)
lens_surface = simple.NURBSTessellate(registrationName='lens_surface', Input=lens)
contour = simple.NURBSContour(registrationName='contour', Input=lens,
                              ContourBy=['POINTS', 'Index'], Isosurfaces=[1.5, 1.56])
for name, proxy in (('disk_surface', disk_surface), ('lens_surface', lens_surface),
                    ('contour', contour)):
    # Readers on some systems stumble over raw appended data.
    simple.SaveData(os.path.join(arguments.folder, name + '.vtp'), proxy, DataMode='Binary')

view = simple.CreateView('RenderView')
view.ViewSize = [1200, 400]
view.OrientationAxesVisibility = 0
for proxy, x in ((line, -4.4), (disk, -2.2), (lens, 0.4), (contour, 2.6)):
    display = simple.Show(proxy, view, Position=[x, 0, 0], LineWidth=6)
    simple.ColorBy(display, ('POINTS', 'Index'))
colors = simple.GetColorTransferFunction('Index')
colors.RescaleTransferFunction(*disk_surface.PointData['Index'].GetRange())

view.CameraPosition = [0.0, -2.0, 1.2]
view.CameraFocalPoint = [0.0, 0.0, 0.0]
view.CameraViewUp = [0.0, 0.0, 1.0]
view.ResetCamera(True)
simple.SaveScreenshot(os.path.join(arguments.folder, 'picture.png'), view)

if arguments.state:
    simple.SaveState(arguments.state)
