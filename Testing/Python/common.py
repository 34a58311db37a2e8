# SPDX-License-Identifier: BSD-3-Clause
"""What the pvpython tests share: the plugin, the sample files, and ways to look at results."""
import contextlib
import os
import tempfile

import numpy
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkIOImage import vtkPNGReader

DATA = os.environ['HYPERPATCH_DATA']
SHARED = os.environ.get('HYPERPATCH_SHARED_DATA', '')
PVPYTHON = os.environ.get('PVPYTHON', 'pvpython')
PVBATCH = os.environ.get('PVBATCH', 'pvbatch')
# A rational volume with a scalar attribute in a basis of its own.
PIPE = os.path.join(DATA, 'heated_pipe_bend.vtpc')
ATTRIBUTE = 'Temperature'
# Arguments of four_filters for it: an isovalue, and a point whose slices are away from the fold.
ISOVALUE = 100.0
ORIGIN = [1.7, 1.7, 0.0]

simple.LoadPlugin(os.environ['HYPERPATCH_PLUGIN'], remote=False)


def open_file(path):
    """The reader of a file, as File > Open makes it, updated."""
    reader = simple.OpenDataFile(path)
    reader.UpdatePipeline()
    return reader


def four_filters(model, attribute, value, origin):
    """Tessellation, slice, isosurface and Jacobian boundary of a model, updated."""
    filters = {
        'tessellate': simple.NURBSTessellate(Input=model),
        'slice': simple.NURBSSlice(Input=model),
        'contour': simple.NURBSContour(Input=model, ContourBy=['POINTS', attribute],
                                       Isosurfaces=[value]),
        'boundary': simple.NURBSJacobianBoundary(Input=model),
    }
    filters['slice'].SliceType.Origin = origin
    for proxy in filters.values():
        proxy.UpdatePipeline()
    return filters


def fetch(proxy):
    return servermanager.Fetch(proxy)


def report(proxy):
    """The rows of the second output of a fit, as dictionaries of texts."""
    table = servermanager.Fetch(proxy, idx=1)
    names = [table.GetColumnName(i) for i in range(table.GetNumberOfColumns())]
    return [{name: table.GetValueByName(row, name).ToString() for name in names}
            for row in range(table.GetNumberOfRows())]


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def point_array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def cell_corners(data):
    """Coordinates of the corners of each triangle: n x 3 x 3."""
    return points(data)[vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)]


def area(corners):
    a, b, c = corners.transpose(1, 0, 2)
    return 0.5 * numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum()


def outline(corners):
    """The length of all edges that belong to one triangle only, where points are the same if their
    coordinates have the same bits: a crack is outline."""
    bits = numpy.ascontiguousarray(corners.reshape(-1, 3) + 0.0).view('V24').ravel()
    _, ids = numpy.unique(bits, return_inverse=True)
    ids = ids.reshape(-1, 3)
    edges = numpy.concatenate([ids[:, [i, (i + 1) % 3]] for i in range(3)])
    ends = numpy.concatenate([corners[:, [i, (i + 1) % 3]] for i in range(3)])
    _, first, count = numpy.unique(numpy.sort(edges, axis=1), axis=0, return_index=True,
                                   return_counts=True)
    single = ends[first[count == 1]]
    return numpy.linalg.norm(single[:, 1] - single[:, 0], axis=1).sum()


def differ_as_surfaces(one, other):
    """How much the areas and bounds of two triangulations differ, relatively."""
    area_of_one = area(one)
    size = numpy.ptp(one.reshape(-1, 3), axis=0).max()
    ends = [numpy.array([c.reshape(-1, 3).min(axis=0), c.reshape(-1, 3).max(axis=0)])
            for c in (one, other)]
    return max(abs(area_of_one - area(other)) / area_of_one, abs(ends[0] - ends[1]).max() / size)


@contextlib.contextmanager
def messages():
    """Catches errors and warnings; the list has one text each when the block is left.

    What the pipeline adds to an error of an algorithm ("returned failure for request") is no
    message of its own.
    """
    caught = []
    window = vtkStringOutputWindow()
    before = vtkOutputWindow.GetInstance()
    vtkOutputWindow.SetInstance(window)
    try:
        yield caught
    finally:
        vtkOutputWindow.SetInstance(before)
        for text in window.GetOutput().replace('Warning: In', 'ERROR: In').split('ERROR: In')[1:]:
            if 'returned failure for request' not in text:
                caught.append(text.strip())


def view(size=(400, 300)):
    """A new render view without decorations on white."""
    result = simple.CreateView('RenderView')
    result.ViewSize = size
    result.OrientationAxesVisibility = 0
    result.UseColorPaletteForBackground = 0
    result.Background = [1, 1, 1]
    return result


def read_picture(name):
    """The pixels of a PNG file: height x width x 3."""
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    columns, rows, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)[:, :, :3]


def pixels(render_view):
    """The rendered picture: height x width x 3."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, 'picture.png')
        simple.SaveScreenshot(name, render_view, ImageResolution=render_view.ViewSize)
        return read_picture(name)


def silhouette(render_view):
    """Which pixels are not background: height x width."""
    return (pixels(render_view) != 255).any(axis=2)
