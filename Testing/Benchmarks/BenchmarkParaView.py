# SPDX-License-Identifier: BSD-3-Clause
"""What NURBS Solid costs ParaView: many patches, a large one, the first picture, another colour.

    PV_PLUGIN_PATH=<build>/lib/paraview-5.11/plugins \\
        xvfb-run -a pvpython Testing/Benchmarks/BenchmarkParaView.py [many] [big] [first] [color]

Times are seconds of CPU of the one process, on all its threads: on a shared machine the clock on the
wall tells little. Files are in the page cache.
"""
import os
import sys
import tempfile
import time

import numpy
from paraview import simple
from paraview.vtk.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkCompositeDataSet, vtkPartitionedDataSetCollection, vtkStructuredGrid)

if not hasattr(simple, 'NURBSTessellate'):
    sys.exit('The plugin is not loaded: set PV_PLUGIN_PATH to the folder that has Hyperpatch in it')


def array(name, values, kind=float):
    result = numpy_to_vtk(numpy.ascontiguousarray(values, dtype=kind), deep=True)
    result.SetName(name)
    return result


def uniform_knots(degree, size):
    spans = size - degree
    return [0.0] * degree + [i / spans for i in range(spans + 1)] + [1.0] * degree


def lattice(patch, degree, size, offset, bulge, spline=True):
    """A cube with one value per control point; a bare grid, if it is to be no spline."""
    places = numpy.array([numpy.mean(uniform_knots(degree, size)[i + 1:i + degree + 1])
                          for i in range(size)])
    w, v, u = numpy.meshgrid(places, places, places, indexing='ij')
    points = numpy.stack([u, v, w], axis=-1).reshape(-1, 3)
    points += bulge * numpy.sin(3 * points[:, [1, 2, 0]]) + offset
    grid = vtkStructuredGrid()
    grid.SetDimensions(size, size, size)
    coordinates = vtkPoints()
    coordinates.SetData(array('Points', points))
    grid.SetPoints(coordinates)
    grid.GetPointData().AddArray(array('Weight', 1 + 0.2 * numpy.sin(points[:, 0])))
    grid.GetPointData().AddArray(array('Value', numpy.cos(2 * points).sum(axis=1)))
    if spline:
        header = [1, 0, patch] + 3 * [size] + 3 * [degree] + [1] + 6 * [0] + [63, 1]
        grid.GetFieldData().AddArray(array('SplineLayout', header, numpy.int32))
        grid.GetFieldData().AddArray(array('Knots', 3 * uniform_knots(degree, size)))
    return grid


def collection(grids):
    result = vtkPartitionedDataSetCollection()
    result.SetNumberOfPartitionedDataSets(1)
    result.GetMetaData(0).Set(vtkCompositeDataSet.NAME(), 'Geometry')
    for i, grid in enumerate(grids):
        result.SetPartition(0, i, grid)
    return result


def producer(data):
    """A source of the pipeline that has these data."""
    source = simple.PVTrivialProducer()
    source.GetClientSideObject().SetOutput(data)
    return source


def timed(function, *arguments):
    begin = time.process_time()
    result = function(*arguments)
    return time.process_time() - begin, result


def view():
    result = simple.CreateView('RenderView')
    result.ViewSize = [800, 600]
    simple.Render(result)
    return result


def first_render(source, style):
    """Time from Show to the picture."""
    window = view()

    def show():
        display = simple.Show(source, window)
        display.Representation = style
        simple.ColorBy(display, ('POINTS', None))
        simple.ResetCamera(window)
        simple.Render(window)
        return display

    seconds, display = timed(show)
    return seconds, display, window


def many():
    """15,000 patches, and as many bare grids."""
    count = 15000
    print(f'{count} patches of 3^3 control points: update, information, first render')
    for spline, style in ((False, 'Surface'), (True, 'NURBS Solid'), (False, 'Surface'),
                          (True, 'NURBS Solid')):
        side = 25
        data = collection([
            lattice(i, 2, 3, numpy.array([i % side, i // side % side, i // side ** 2]) * 1.2, 0.05,
                    spline) for i in range(count)])
        source = producer(data)
        update, _ = timed(source.UpdatePipeline)
        information, _ = timed(source.GetDataInformation().GetNumberOfCells)
        render, _, window = first_render(source, style)
        print(f'  {style:12} {update:6.2f} {information:6.2f} {render:6.2f}   '
              f'sum {update + information + render:6.2f}')
        simple.Delete(window)
        simple.Delete(source)


def big():
    """One lattice of 200^3 control points: from the file to the picture."""
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, 'big.vtpc')
        simple.SaveData(name, producer(collection([lattice(0, 3, 200, 0.0, 0.05)])),
                        DataMode='Binary', CompressorType='None')
        size = 0

        def read():
            total = 0
            for parent, _, files in os.walk(folder):
                for file in files:
                    with open(os.path.join(parent, file), 'rb') as stream:
                        total += len(stream.read())
            return total

        read()
        raw, size = timed(read)
        source = simple.OpenDataFile(name)
        opening, _ = timed(source.UpdatePipeline)
        render, _, _ = first_render(source, 'NURBS Solid')
        stock = simple.XMLPartitionedDatasetCollectionReader(FileName=[name])
        stock_opening, _ = timed(stock.UpdatePipeline)
        surface = simple.NURBSTessellate(Input=source)
        surface.UpdatePipeline()
        surface.Tolerance = 0.00101  # the model is converted by now
        tessellation, _ = timed(surface.UpdatePipeline)
    print(f'200^3 control points, {size / 1e6:.0f} MB: open {opening:.2f}, first render {render:.2f}')
    print(f"  its bytes {raw:.2f}, VTK's reader of them {stock_opening:.2f}, "
          f'tessellation of six faces {tessellation:.2f}')


def first():
    """20^3 control points, and a file of the same triangles."""
    source = producer(collection([lattice(0, 3, 20, 0.0, 0.05)]))
    source.UpdatePipeline()
    view()  # what ParaView does once
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, 'triangles.vtp')
        simple.SaveData(name, simple.NURBSTessellate(Input=source), DataMode='Binary')
        for _ in range(3):
            triangles = simple.OpenDataFile(name)
            update, _ = timed(triangles.UpdatePipeline)
            stock, _, window = first_render(triangles, 'Surface')
            simple.Delete(window)
            fresh = producer(collection([lattice(0, 3, 20, 0.0, 0.05)]))
            fresh.UpdatePipeline()
            ours, display, window = first_render(fresh, 'NURBS Solid')
            cells = display.SMProxy.GetRepresentedDataInformation().GetNumberOfCells()
            print(f'20^3 control points, {cells} triangles: NURBS Solid {ours * 1e3:.0f} ms, '
                  f'from a file {(update + stock) * 1e3:.0f} ms')
            simple.Delete(window)


def color():
    """Another colour."""
    source = producer(collection([lattice(0, 3, 100, 0.0, 0.05)]))
    before, display, window = first_render(source, 'NURBS Solid')

    def change():
        simple.ColorBy(display, ('POINTS', 'Value'))
        simple.Render(window)

    seconds, _ = timed(change)
    print(f'100^3 control points: first render {before * 1e3:.0f} ms, '
          f'another colour {seconds * 1e3:.0f} ms')


for case in sys.argv[1:] or ('many', 'big', 'first', 'color'):
    {'many': many, 'big': big, 'first': first, 'color': color}[case]()
