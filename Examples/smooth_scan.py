# SPDX-License-Identifier: BSD-3-Clause
"""Contours a scan smoothly: the image is fitted by a smoothing spline with as many control points as
voxels, and the isosurface is that of the spline. Prints what the fit changed, and writes a picture:
the isosurface of the voxels on the left, that of the spline on the right.

    PV_PLUGIN_PATH=<prefix>/lib/paraview-5.11/plugins pvpython Examples/smooth_scan.py \\
        headsq.vti 1150 picture.png --up 0 0 -1 --from -1.2 -2 -0.4

headsq.vti and ironProt.vtk, for instance, are among the test data of VTK.
"""
import argparse
import sys

from paraview import servermanager, simple

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument('file', help='an image with one scalar point array')
parser.add_argument('value', type=float, help='that of the isosurface')
parser.add_argument('picture', help='the PNG file to write')
parser.add_argument('--smoothing', type=float, default=0.1, help='0 interpolates')
parser.add_argument('--up', type=float, nargs=3, default=[0, 0, 1], help='in the picture')
parser.add_argument('--from', dest='origin', type=float, nargs=3, default=[-1.2, -2, 0.4],
                    help='direction from which the picture is taken')
arguments = parser.parse_args()

# PV_PLUGIN_PATH has loaded the plugin; simple.LoadPlugin(FILE) is the way without it.
if not hasattr(simple, 'NURBSFit'):
    sys.exit('The plugin is not loaded: set PV_PLUGIN_PATH to the folder that has Hyperpatch in it')

scan = simple.OpenDataFile(arguments.file)
scan.UpdatePipeline()
array = scan.PointData[0].GetName()
information = scan.GetDataInformation().DataInformation
extent = information.GetExtent()

fit = simple.NURBSFit(Input=scan, PointArrays=[array], Method='Least Squares',
                      ControlPoints=[extent[2 * d + 1] - extent[2 * d] + 1 for d in range(3)],
                      Smoothing=arguments.smoothing)
by = {'ContourBy': ['POINTS', array], 'Isosurfaces': [arguments.value]}
surfaces = simple.Contour(Input=scan, **by), simple.NURBSContour(Input=fit, **by)

report = servermanager.Fetch(fit, idx=1)
for column in ('Attribute', 'Samples', 'ControlPoints', 'RMSError', 'MaximumError'):
    print(f'{column}: {report.GetValueByName(0, column).ToString()}')

view = simple.CreateView('RenderView')
view.ViewSize = [1200, 480]
view.OrientationAxesVisibility = 0
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.CameraViewUp = arguments.up
view.CameraFocalPoint = [0, 0, 0]
view.CameraPosition = arguments.origin
bounds = information.GetBounds()
sides = [bounds[2 * d + 1] - bounds[2 * d] for d in range(3)]
# One beside the other, across the line of sight.
u, o = arguments.up, arguments.origin
right = [u[1] * o[2] - u[2] * o[1], u[2] * o[0] - u[0] * o[2], u[0] * o[1] - u[1] * o[0]]
scale = 0.55 * max(sides) / sum(c * c for c in right) ** 0.5
for surface, sign in zip(surfaces, (-1, 1)):
    display = simple.Show(surface, view, Representation='Surface', DiffuseColor=[0.9, 0.8, 0.7],
                          Position=[sign * scale * c for c in right])
    display.SetScalarColoring(None, 0)
view.ResetCamera(True)
view.GetActiveCamera().Zoom(1.5)
simple.SaveScreenshot(arguments.picture, view)
