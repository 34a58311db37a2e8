# SPDX-License-Identifier: BSD-3-Clause
"""Shows a spline file: its solid, slices, isosurfaces and Jacobian boundary, as pictures.

    xvfb-run -a pvpython Examples/demo.py [file] [--output DIR]

This is what a script of your own would do: load the plugin, open a file, apply filters, colour by
an attribute, save pictures.
"""
import argparse
import glob
import math
import os
import sys

from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SAMPLE = os.path.join(ROOT, 'Data', 'heated_pipe_bend.vtpc')

ASPECT = 8 / 5  # of every picture
LEGEND = 0.2  # of the width of its picture

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument('file', nargs='?', default=SAMPLE, help='a spline file; default: a pipe bend')
parser.add_argument('--output', default='.', help='the folder for the pictures')
arguments = parser.parse_args()
os.makedirs(arguments.output, exist_ok=True)

plugin = os.environ.get('HYPERPATCH_PLUGIN') or ''.join(
    glob.glob(os.path.join(ROOT, 'build', 'lib', 'paraview-*', 'plugins', '*', 'Hyperpatch.so')))
if not plugin:
    sys.exit('The plugin is not built; build it, or set HYPERPATCH_PLUGIN to Hyperpatch.so')
LoadPlugin(plugin, remote=False, ns=globals())

# A file opens as a model of splines: patches, and the attributes that live on them.
model = OpenDataFile(arguments.file)
model.UpdatePipeline()
if model.GetDataInformation().GetNumberOfPoints() == 0:
    sys.exit(f'{arguments.file} holds no splines that can be shown')

# Colour by the first scalar attribute.
attributes = [array.Name for array in model.PointData
              if array.Name != 'Weight' and array.GetNumberOfComponents() == 1]
if not attributes:
    # Functions of the coordinates that are linear may be computed on the control points.
    model = Calculator(Input=model, Function='coordsZ', ResultArrayName='Height')
    attributes = ['Height']
    print('The file has no scalar attribute; the pictures are coloured by height.')
attribute = attributes[0]

# The colours are for the values inside, too, not only for those on the skin.
inside = NURBSTessellate(Input=model, MeshType='Solid')
inside.UpdatePipeline()
bounds = inside.GetDataInformation().GetBounds()
points = vtk_to_numpy(servermanager.Fetch(inside).GetPoints().GetData())
size = [bounds[2 * i + 1] - bounds[2 * i] for i in range(3)]
low, high = inside.PointData[attribute].GetRange()
# Three digits of the range are enough to read, and round-off is none of them.
digits = 3 - math.ceil(math.log10(high - low)) if high > low else 3
low, high = (round(value, digits) + 0.0 for value in (low, high))
number = f'%.{max(digits - 1, 0)}f' if -6 < digits < 7 else '%.3g'
colors = GetColorTransferFunction(attribute)
colors.ApplyPreset('Fast', True)

# Four views in one window.
LoadPalette('WhiteBackground')
layout = CreateLayout('Hyperpatch')
layout.SplitHorizontal(0, 0.5)
layout.SplitVertical(1, 0.5)
layout.SplitVertical(2, 0.5)
layout.SetSize(1200, 750)
views = []
for cell in (3, 5, 4, 6):
    views.append(CreateView('RenderView'))
    layout.AssignView(cell, views[-1])
    views[-1].OrientationAxesVisibility = 0


def show(proxy, view, **properties):
    """Shows the output of a filter in the colours of the attribute."""
    display = Show(proxy, view, Ambient=0.15, **properties)
    ColorBy(display, ('POINTS', attribute))
    colors.RescaleTransferFunction(low, high)
    return display


def show_glass(view):
    """Shows the solid like glass around what is inside."""
    display = Show(model, view, Representation='NURBS Solid', Opacity=0.12)
    ColorBy(display, ('POINTS', None))


def frame(view, room):
    """Shows the whole model; a fraction `room` of the width stays free on the right."""
    view.CameraParallelProjection = 1
    view.CameraPosition = [-2.0, -1.2, 1.6]
    view.CameraFocalPoint = [0, 0, 0]
    view.CameraViewUp = [0, 0, 1]
    view.ResetCamera(True)
    matrix = view.GetActiveCamera().GetViewTransformMatrix()
    axes = [[matrix.GetElement(row, d) for d in range(3)] for row in (0, 1)]
    # The model in the picture, to the right and up.
    places = [points @ axis for axis in axes]
    width, height = (place.max() - place.min() for place in places)
    view.CameraParallelScale = 0.53 * max(height, width / (1.0 - room) / ASPECT)
    for place, axis, free in zip(places, axes, (room * ASPECT, 0.0)):
        middle = 0.5 * (place.min() + place.max()) + free * view.CameraParallelScale
        shift = middle - sum(view.CameraFocalPoint[d] * axis[d] for d in range(3))
        for end in (view.CameraPosition, view.CameraFocalPoint):
            for d in range(3):
                end[d] += shift * axis[d]


# Lattices show as NURBS Solid by themselves; the edges are those of the knot spans.
solid = show(model, views[0], Representation='NURBS Solid With Edges', EdgeColor=[0, 0, 0.2])
solid.SetScalarBarVisibility(views[0], True)
legend = GetScalarBar(colors, views[0])
legend.WindowLocation = 'Any Location'
legend.Position = [1.0 - LEGEND + 0.02, 0.2]
legend.ScalarBarLength = 0.6
legend.TitleFontSize = legend.LabelFontSize = 8
legend.AutomaticLabelFormat = 0
legend.LabelFormat = legend.RangeLabelFormat = number

# Slices through the middle, across the two longest sides of the model.
for axis in sorted(range(3), key=lambda i: size[i])[1:]:
    cut = NURBSSlice(Input=model)
    cut.SliceType.Origin = [0.5 * (bounds[2 * i] + bounds[2 * i + 1]) for i in range(3)]
    cut.SliceType.Normal = [float(i == axis) for i in range(3)]
    show(cut, views[1])
show_glass(views[1])

# Isosurfaces of the attribute.
contours = NURBSContour(Input=model, ContourBy=['POINTS', attribute])
contours.Isosurfaces = [low + (high - low) * t for t in (0.2, 0.4, 0.6, 0.8)]
show(contours, views[2], Opacity=0.6)
show_glass(views[2])

# The boundary: the faces, and the sheet where the Jacobian determinant vanishes if there is a fold.
sheet = NURBSJacobianBoundary(Input=model, Faces=0)
faces = NURBSJacobianBoundary(Input=model, Sheet=0)
sheet.UpdatePipeline()
if sheet.GetDataInformation().GetNumberOfCells() > 0:
    show(sheet, views[3])
else:
    print('The Jacobian determinant vanishes nowhere: the boundary is that of the patches.')
show(faces, views[3], Opacity=0.15)

for view in views:
    frame(view, LEGEND if view == views[0] else 0.0)
for name, picture in zip(('solid', 'slices', 'isosurfaces', 'boundary', 'overview'),
                         views + [layout]):
    path = os.path.join(arguments.output, name + '.png')
    SaveScreenshot(path, picture, ImageResolution=[1200, 750])
    print(path)
