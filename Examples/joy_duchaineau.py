# SPDX-License-Identifier: BSD-3-Clause
"""Makes the figures of Joy & Duchaineau, Boundary Determination for Trivariate Solids (Pacific
Graphics 1999), again, with NURBS Jacobian Boundary.

    xvfb-run -a pvpython Examples/joy_duchaineau.py [--output DIR]

Pictures are named after the figures of the paper; FIGURE 12 is also a table, and the counts of
FIGURES 10 and 11 and the widths of cracks are printed. The paper does not give the control points of
FIGURES 10, 11 and 13: these are solids made in the way that it describes.
"""
import argparse
import csv
import glob
import math
import os
import sys
import tempfile

import numpy
from paraview.simple import *
from paraview import servermanager
from paraview.vtk.util.numpy_support import vtk_to_numpy

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
JOY = 'Joy & Duchaineau 1999'
METHODS = ['Cones', 'Cones in Three Orders', 'Bernstein Coefficients']
REPAIRS = ['None', 'As Printed', 'Conforming']
SHEET, CELLS = 7, 10  # in the cell array Piece
SIZE = [800, 600]

parser = argparse.ArgumentParser(description='Makes the figures of Joy & Duchaineau again.')
parser.add_argument('--output', default='.', help='the folder for pictures and tables')
arguments = parser.parse_args()
os.makedirs(arguments.output, exist_ok=True)

plugin = os.environ.get('HYPERPATCH_PLUGIN') or ''.join(
    glob.glob(os.path.join(ROOT, 'build', 'lib', 'paraview-*', 'plugins', '*', 'Hyperpatch.so')))
if not plugin:
    sys.exit('The plugin is not built; build it, or set HYPERPATCH_PLUGIN to Hyperpatch.so')
LoadPlugin(plugin, remote=False, ns=globals())
LoadPalette('WhiteBackground')
folder = tempfile.TemporaryDirectory()


# --- Models --------------------------------------------------------------------------------------

def clamped(degree, size):
    """Clamped, equally spaced knots on [0, 1]."""
    spans = size - degree
    return [0.0] * degree + [i / spans for i in range(spans + 1)] + [1.0] * degree


def volume(name, degrees, points):
    """A reader of the volume with these control points, an array (w, v, u, 3), as a .g2 file."""
    path = os.path.join(folder.name, name + '.g2')
    sizes = points.shape[2::-1]
    with open(path, 'w', encoding='ascii') as file:
        file.write('700 1 0 0\n3 0\n')
        for degree, size in zip(degrees, sizes):
            file.write(f'{size} {degree + 1}\n')
            file.write(' '.join(map(repr, clamped(degree, size))) + '\n')
        for point in points.reshape(-1, 3):
            file.write(' '.join(repr(float(x)) for x in point) + '\n')
    reader = OpenDataFile(path)
    reader.UpdatePipeline()
    return reader


def arched_sheet():
    """The section of FIGURES 10 and 11, an array (v, u, 3): arched over v, straight in u."""
    profile = numpy.array([[-1.0, 0.0], [-0.6, 1.3], [0.5, 1.1], [1.0, 0.0]])
    return numpy.array([[[x, y, z] for z in (0.0, 1.2)] for x, y in profile])


def rotation(axis, degrees):
    """The matrix of a rotation about a coordinate axis."""
    angle = math.radians(degrees)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = numpy.eye(3)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[j, i] = math.sin(angle)
    matrix[i, j] = -math.sin(angle)
    return matrix


def loft(sections):
    """Control points (w, v, u, 3) of the cubic through sections, averaged as their number asks."""
    count = len(sections)
    knots = clamped(3, count)
    sites = [sum(knots[i + 1:i + 4]) / 3 for i in range(count)]
    matrix = numpy.array([[basis(knots, 3, i, t) for i in range(count)] for t in sites])
    return numpy.linalg.solve(matrix, numpy.array(sections).reshape(count, -1)).reshape(
        numpy.shape(sections))


def basis(knots, degree, i, t):
    """B-spline i at t (the recursion of Cox and de Boor; the domain is closed)."""
    if degree == 0:
        inside = knots[i] <= t < knots[i + 1] or (t == knots[-1] == knots[i + 1] > knots[i])
        return 1.0 if inside else 0.0
    left, right = knots[i + degree] - knots[i], knots[i + degree + 1] - knots[i + 1]
    value = (t - knots[i]) / left * basis(knots, degree - 1, i, t) if left > 0 else 0.0
    if right > 0:
        value += (knots[i + degree + 1] - t) / right * basis(knots, degree - 1, i + 1, t)
    return value


def swept():
    """FIGURE 10: the sheet along a line."""
    section = arched_sheet()
    return volume('swept', (1, 3, 1), numpy.array([section, section + [2.6, 0.0, 0.5]]))


def turned():
    """FIGURE 11: the sheet along the same line, turned by 35 degrees; four sections, lofted."""
    sections = [arched_sheet() @ rotation(2, 35 * i / 3).T + numpy.array([2.6, 0.0, 0.5]) * i / 3
                for i in range(4)]
    return volume('turned', (1, 3, 3), loft(sections))


def wavy():
    """FIGURES 5, 7 and 9: four control nets of a wavy sheet, turned by 35 degrees on their way."""
    sheet = numpy.array([[[u / 3, v / 3, 0.5 * math.sin(2.5 * u / 3) * math.cos(2 * v / 3)]
                          for u in range(4)] for v in range(4)])
    return volume('wavy', (3, 3, 3), numpy.array([
        sheet @ rotation(0, 35 * w / 3).T + numpy.array([0.6, 0.4, 0.5]) * w / 3 for w in range(4)]))


def along_a_curve():
    """FIGURE 13: the sheet along a bend; seven sections, lofted."""
    sections = []
    for i in range(7):
        angle = 110 * i / 6
        turn = rotation(2, -0.5 * angle)
        centre = 2.4 * numpy.array([math.sin(math.radians(angle)),
                                    math.cos(math.radians(angle)) - 1.0, 0.25 * i / 6])
        sections.append(arched_sheet() @ turn.T + centre)
    return volume('along-a-curve', (1, 3, 3), loft(sections))


# --- Pictures ------------------------------------------------------------------------------------

def boundary(model, **properties):
    """The updated filter."""
    result = NURBSJacobianBoundary(Input=model, **properties)
    result.UpdatePipeline()
    return result


def piece(proxy, first, last):
    """The cells of some pieces."""
    return Threshold(Input=proxy, Scalars=['CELLS', 'Piece'], LowerThreshold=first,
                     UpperThreshold=last)


def new_view():
    view = CreateView('RenderView')
    view.ViewSize = SIZE
    view.OrientationAxesVisibility = 0
    return view


def show(proxy, view, color, **properties):
    display = Show(proxy, view, Ambient=0.2, **properties)
    display.ColorArrayName = ['POINTS', '']
    display.DiffuseColor = display.AmbientColor = color
    display.Interpolation = 'Flat'  # as in the paper: "with Gouraud shading removed"
    return display


def save(view, name, direction, focus=None, radius=None):
    """Looks from a direction at everything, or at a ball, and saves a picture."""
    Render(view)  # the first one would reset the camera
    view.CameraFocalPoint = [0, 0, 0]
    view.CameraPosition = direction
    view.CameraViewUp = [0, 1, 0] if abs(direction[1]) < 0.9 else [1, 0, 0]
    view.ResetCamera(False)
    if focus is not None:
        view.CameraPosition = list(numpy.array(view.CameraPosition) -
                                   numpy.array(view.CameraFocalPoint) + focus)
        view.CameraFocalPoint = list(focus)
        view.CameraParallelProjection = 1
        view.CameraParallelScale = radius
    else:
        GetActiveCamera().Dolly(1.4)
    Render(view)
    SaveScreenshot(os.path.join(arguments.output, name + '.png'), view, ImageResolution=SIZE)


FACES, FOLD, INSIDE = [0.55, 0.65, 0.85], [0.95, 0.6, 0.25], [0.45, 0.75, 0.45]


def two_views(name, result, direction):
    """The faces alone, and the full solid."""
    for suffix, last in (('a', 5), ('b', SHEET)):
        view = new_view()
        show(piece(result, 0, 5), view, FACES)
        if last == SHEET:
            show(piece(result, 6, SHEET), view, FOLD)
        save(view, name + suffix, direction)


def field(result, name):
    data = servermanager.Fetch(result).GetFieldData().GetArray(name)
    return vtk_to_numpy(data)


# --- Cracks --------------------------------------------------------------------------------------

def open_edges(result):
    """Ends (n x 2 x 3) of the edges of the sheet that belong to one triangle alone and are not on a
    face of the domain [0, 1]^3."""
    data = servermanager.Fetch(result)
    points = vtk_to_numpy(data.GetPoints().GetData())
    at = vtk_to_numpy(data.GetPointData().GetArray('ParametricCoordinates'))
    triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    edges = numpy.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, uses = numpy.unique(edges, axis=0, return_counts=True)
    edges = edges[uses == 1]
    first, second = at[edges[:, 0]], at[edges[:, 1]]
    on_face = ((first == second) & ((first == 0) | (first == 1))).any(axis=1)
    ends = points[edges[~on_face]]
    return ends[numpy.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) > 1e-12]


def gaps(ends):
    """The distance of the middle of every open edge from the nearest other one: the crack there."""
    result = []
    for i, (a, b) in enumerate(ends):
        others = numpy.delete(ends, i, axis=0)
        middle = 0.5 * (a + b)
        along = others[:, 1] - others[:, 0]
        t = numpy.clip(((middle - others[:, 0]) * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
        result.append(numpy.linalg.norm(others[:, 0] + t[:, None] * along - middle, axis=1).min())
    return numpy.array(result)


# --- Figures -------------------------------------------------------------------------------------

def figure_1():
    model = OpenDataFile(os.path.join(ROOT, 'Data', 'folded_sweep.xml'))
    model.UpdatePipeline()
    two_views('figure-1', boundary(model), (0.5, 0.6, 1.0))


def figure_10(model):
    result = boundary(model, Method=JOY)
    triangles = servermanager.Fetch(piece(result, SHEET, SHEET)).GetNumberOfCells()
    print(f'FIGURE 10: {field(result, "Cells")[0]} cell, {field(result, "Tetrahedra")[0]} '
          f'tetrahedra, {triangles} triangles (paper: 1, 12, 14)')
    two_views('figure-10', result, (0.3, 0.5, 1.0))


def figure_11(model):
    for method in METHODS:
        result = boundary(model, Method=JOY, MinimumWidth=0.0, MaximumCells=900,
                          IntervalsFrom=method)
        triangles = servermanager.Fetch(piece(result, SHEET, SHEET)).GetNumberOfCells()
        print(f'FIGURE 11, {method}: {field(result, "Cells")[0]} cells, {triangles} triangles '
              '(paper: 900, 5161)')
        if method == METHODS[0]:
            two_views('figure-11', result, (0.3, 0.5, 1.0))


def figure_12(model):
    """The widest interval before every split, for each of the bounds, as parts of the first."""
    columns = []
    for method in METHODS:
        result = boundary(model, Method=JOY, MinimumWidth=0.0, MaximumCells=900,
                          IntervalsFrom=method, Faces=0, Sheet=1)
        width = field(result, 'IntervalWidth')
        columns.append((width / width[0], field(result, 'CellsInQueue')))
    length = max(len(width) for width, _ in columns)
    with open(os.path.join(arguments.output, 'figure-12.csv'), 'w', newline='',
              encoding='ascii') as file:
        table = csv.writer(file)
        table.writerow(['Splits'] + [f'{what}, {method}' for method in METHODS
                                     for what in ('Width', 'Cells')])
        for i in range(length):
            row = [i]
            for width, cells in columns:
                row += [f'{width[i]:.6g}', cells[i]] if i < len(width) else ['', '']
            table.writerow(row)
    print('FIGURE 12, widest interval as a part of the first one after so many splits:')
    print('  splits  ' + '  '.join(f'{method:>24}' for method in METHODS))
    for i in (0, 1, 10, 30, 100, 300, 1000, length - 1):
        print(f'  {i:6}  ' + '  '.join(
            f'{width[i]:16.4f} in {cells[i]:4}' if i < len(width) else ' ' * 24
            for width, cells in columns))
    try:
        import matplotlib
    except ImportError:
        print('FIGURE 12 is a table only: there is no matplotlib')
        return
    matplotlib.use('Agg')
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(8, 6), dpi=100)
    for method, (width, _) in zip(METHODS, columns):
        axes.plot(width, label=method)
    axes.set_yscale('log')
    axes.set_xlabel('splits')
    axes.set_ylabel('widest interval of det J, part of the first')
    axes.legend()
    axes.grid(alpha=0.3)
    figure.savefig(os.path.join(arguments.output, 'figure-12.png'))


def figures_5_7_9():
    """Cracks where cells of different size meet, and the same place after both repairs."""
    model = wavy()
    coarse = dict(Method=JOY, MinimumWidth=0.0, MaximumCells=30, Faces=0, KnotPlanes=0)
    print('FIGURES 5, 7, 9: cracks of 30 cells')
    results = [boundary(model, CrackRepair=repair, **coarse) for repair in REPAIRS]
    ends = open_edges(results[0])
    widths = gaps(ends)
    focus = ends[widths.argmax()].mean(axis=0)
    data = servermanager.Fetch(results[0])
    near = data.FindPoint(focus)
    direction = data.GetPointData().GetNormals().GetTuple(near)
    bounds = data.GetBounds()
    diagonal = math.dist(bounds[0::2], bounds[1::2])
    for repair, result in zip(REPAIRS, results):
        left = open_edges(result)
        widest = gaps(left).max() if len(left) > 1 else 0.0
        print(f'  {repair:10}: {field(result, "Tetrahedra")[0]} tetrahedra, '
              f'{field(result, "RepairedCells")[0]} cells repaired, widest crack '
              f'{100 * widest / diagonal:.2f} % of the diagonal')
        view = new_view()
        display = show(result, view, FOLD)
        display.SetRepresentationType('Surface With Edges')
        display.EdgeColor = [0.2, 0.2, 0.2]
        save(view, 'figure-9-' + repair.lower().replace(' ', '-'), direction, focus,
             8 * widths.max())
    # Something green behind the sheet, as in the paper, shows the crack.
    behind = Transform(Input=results[2])
    behind.Transform.Translate = list(-0.1 * diagonal * numpy.array(direction))
    view = new_view()
    show(results[0], view, FOLD)
    show(behind, view, INSIDE)
    save(view, 'figure-5', direction, focus, 8 * widths.max())
    cells = boundary(model, CrackRepair='None', ShowCells=1, **coarse)
    view = new_view()
    show(piece(cells, SHEET, SHEET), view, FOLD)
    show(piece(cells, CELLS, CELLS), view, [0.3, 0.3, 0.3])
    save(view, 'figure-7', direction, focus, 40 * widths.max())


def figure_13():
    model = along_a_curve()
    result = boundary(model, Method=JOY, MinimumWidth=0.0, MaximumCells=2000)
    two_views('figure-13', result, (0.2, 0.4, 1.0))


figure_1()
figure_10(swept())
lofted = turned()
figure_11(lofted)
figure_12(lofted)
figures_5_7_9()
figure_13()
