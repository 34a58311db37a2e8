# SPDX-License-Identifier: BSD-3-Clause
"""Renders the pictures of the help pages in Documentation/, each named after its proxy.

    PV_PLUGIN_PATH=<build>/lib/paraview-5.11/plugins xvfb-run -a pvpython Plugin/make_pictures.py
"""
import os
import sys

from paraview import simple as s

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDER = os.path.join(HERE, 'Documentation')
DATA = os.path.join(HERE, '..', 'Data')
if not hasattr(s, 'NURBSSlice'):
    sys.exit('The plugin is not loaded: set PV_PLUGIN_PATH to the folder that has Hyperpatch in it')

s.LoadPalette('WhiteBackground')
view = s.CreateView('RenderView')
view.ViewSize = [420, 260]
view.OrientationAxesVisibility = 0
pipe = s.OpenDataFile(os.path.join(DATA, 'heated_pipe_bend.vtpc'))
tube = s.OpenDataFile(os.path.join(DATA, 'tube_on_block.xml'))
colors = s.GetColorTransferFunction('Temperature')
colors.ApplyPreset('Fast', True)


def show(proxy, **properties):
    """Shows it in the colours of Temperature where it has that."""
    proxy.UpdatePipeline()
    display = s.Show(proxy, view, Ambient=0.15, **properties)
    name = 'Temperature' if proxy.PointData['Temperature'] else None
    s.ColorBy(display, ('POINTS', name))
    if not name:
        display.DiffuseColor = display.AmbientColor = [0.45, 0.62, 0.8]
    colors.RescaleTransferFunction(20, 220)
    return display


def glass(model):
    """Shows a model around what is inside."""
    s.ColorBy(s.Show(model, view, Representation='NURBS Solid', Opacity=0.15), ('POINTS', None))


def save(name, toward=(-2.0, -1.2, 1.6), zoom=1.4):
    view.CameraPosition = toward
    view.CameraFocalPoint = [0, 0, 0]
    view.CameraViewUp = [0, 0, 1]
    s.Render(view)
    view.ResetCamera(True)
    view.GetActiveCamera().Dolly(zoom)
    s.SaveScreenshot(os.path.join(FOLDER, name + '.png'), view, CompressionLevel='9')
    for source in s.GetSources().values():
        s.Hide(source, view)


show(pipe, Representation='NURBS Solid With Edges', EdgeColor=[0, 0, 0.2], LineWidth=1.5)
save('BSplineReader')

show(s.NURBSTessellate(Input=pipe, Tolerance=0.01), Representation='Surface With Edges')
save('NURBSTessellate')

for x in (0.6, 1.5, 2.4):
    cut = s.NURBSSlice(Input=pipe)
    cut.SliceType.Origin = [x, 1.5, 0]
    cut.SliceType.Normal = [1, 0, 0]
    show(cut)
glass(pipe)
save('NURBSSlice')

show(s.NURBSContour(Input=pipe, ContourBy=['POINTS', 'Temperature'],
                    Isosurfaces=[60, 100, 140, 180]), Opacity=0.7)
glass(pipe)
save('NURBSContour')

for side in (1, 0):
    clip = s.NURBSClip(Input=pipe, Invert=side)
    clip.ClipType.Origin = [1.5, 1.5, 0]
    clip.ClipType.Normal = [0, 0, 1]
    clipped = show(clip)
s.ColorBy(clipped, ('POINTS', None))
clipped.Opacity = 0.15
save('NURBSClip')

show(s.NURBSJacobianBoundary(Input=pipe, Faces=0))
show(s.NURBSJacobianBoundary(Input=pipe, Sheet=0), Opacity=0.15)
save('NURBSJacobianBoundary')

RED = [0.75, 0.15, 0.1]
validity = s.NURBSValidity(Input=pipe)
for verdict, look in ((1, {'Opacity': 0.2}), (-1, {
        'Representation': 'Surface With Edges', 'EdgeColor': [0, 0, 0.2],
        'DiffuseColor': RED, 'AmbientColor': RED})):
    elements = s.Threshold(Input=validity, Scalars=['CELLS', 'Verdict'], LowerThreshold=verdict,
                           UpperThreshold=verdict)
    s.ColorBy(s.Show(elements, view, Ambient=0.15, NonlinearSubdivisionLevel=4, **look),
              ('POINTS', None))
save('NURBSValidity')

show(s.NURBSExtractPatches(Input=tube, PatchIds=[1]), Representation='NURBS Solid With Edges',
     EdgeColor=[0, 0, 0.2], LineWidth=1.5)
glass(s.NURBSExtractPatches(Input=tube, PatchIds=[0]))
save('NURBSExtractPatches')

# Some 300 samples, the isosurface of their interpolant, and what linear interpolation makes of them.
samples = s.ExtractSubset(Input=s.Wavelet(), VOI=[-10, 10, -10, 10, -10, 10],
                          SampleRateI=3, SampleRateJ=3, SampleRateK=3)
iso = {'ContourBy': ['POINTS', 'RTData'], 'Isosurfaces': [170]}
show(s.NURBSContour(Input=s.NURBSFit(Input=samples), **iso))
s.ColorBy(s.Show(s.Contour(Input=samples, **iso), view, Representation='Wireframe',
                 AmbientColor=[0.6, 0.1, 0.1], LineWidth=1.5), ('POINTS', None))
s.Show(samples, view, Representation='Outline')
save('NURBSFit')

added = s.NURBSAddAttribute(Input=pipe, AttributeName='Waves', Expression='sin(8*x)*cos(8*y) + z',
                            Basis='Uniform', ControlPoints=[24, 24, 12])
s.ColorBy(show(added, Representation='NURBS Solid'), ('POINTS', 'Waves'))
save('NURBSAddAttribute')

# Modelling: what goes in is drawn red.
EDGES = {'Representation': 'NURBS Solid With Edges', 'EdgeColor': [0, 0, 0.2], 'LineWidth': 1.5}


def section(*models):
    for model in models:
        s.ColorBy(s.Show(model, view, Representation='NURBS Solid', LineWidth=5,
                         DiffuseColor=RED, AmbientColor=RED, Ambient=0.3), ('POINTS', None))


for index, shape in enumerate(('Sphere', 'Tube', 'Wedge', 'Torus')):
    show(s.NURBSPrimitive(Shape=shape, Radius=0.5, MajorRadius=1, Center=[
        (0, 1.3, 0, 1.3)[index], (0, 0, -1.3, -1.8)[index], 0]), **EDGES)
save('NURBSPrimitive')

upright = {'AxisDirection': [0, 0, 1]}
profile = s.NURBSCurve(Points=[1, 0, 0, 2, 0, 0.5, 0.25, 0, 1, 1, 0, 2])
section(profile)
s.Show(s.PolyLineSource(Points=profile.Points), view, AmbientColor=[0.5, 0.5, 0.5],
       DiffuseColor=[0.5, 0.5, 0.5])
save('NURBSCurve', (0.3, -3, 0.3), zoom=1.05)

line = s.PolyLineSource(Points=[1, 0, 0, 1.6, 0, 0.5, 0.6, 0, 1.2, 0.9, 0, 2, 1.5, 0, 2.1])
section(s.NURBSCurveThroughPoints(Input=line))
s.Show(line, view, AmbientColor=[0.5, 0.5, 0.5], DiffuseColor=[0.5, 0.5, 0.5])
save('NURBSCurveThroughPoints', (0.3, -3, 0.3), zoom=1.05)

show(s.NURBSRevolve(Input=profile, Angle=250, **upright), **EDGES)
section(profile)
save('NURBSRevolve', zoom=1.1)

show(s.NURBSExtrude(Input=profile, Vector=[0, 2, 0]), **EDGES)
section(profile)
save('NURBSExtrude', zoom=1.1)

disks = [s.NURBSRevolve(Input=s.NURBSCurve(Points=[0.2, 0, z, r, 0, z]), **upright)
         for z, r in ((0, 1), (0.8, 1.5), (1.6, 0.7), (2.4, 1))]
show(s.NURBSRule(Input=[disks[0], disks[2]]), **EDGES)
save('NURBSRule', zoom=1.1)

show(s.NURBSLoft(Input=disks), Opacity=0.5)
section(*disks[1:3])
save('NURBSLoft', zoom=1.1)

bar = s.NURBSExtrude(Input=s.NURBSCurve(Points=[-0.5, -0.2, 0, 0.5, -0.2, 0]), Vector=[0, 0.4, 0])
path = s.NURBSCurve(Points=[0, 0, 0, 0, 0, 2, 0, 2, 3, 2, 2, 3])
show(s.NURBSSweep(Input=bar, Path=path, Twist=120), **EDGES)
section(bar)
save('NURBSSweep', (2.5, -1.5, 1.2))

show(s.NURBSRefine(Input=pipe), **EDGES)
save('NURBSRefine')

show(s.NURBSAppend(Input=[s.NURBSPrimitive(Shape='Cylinder', Center=[0, 0, z]) for z in (0, 1)]),
     **EDGES)
save('NURBSAppend', zoom=1.1)
