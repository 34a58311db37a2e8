# SPDX-License-Identifier: BSD-3-Clause
"""Makes the sample volumes beside this script: pvpython make_data.py

Needs nothing but the VTK modules of Python. The .vtpc file also shows how to write the data model
(DataModel/NURBSConversion.h) without the library.
"""

import math
import os

from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkIntArray, vtkPoints
from vtkmodules.vtkCommonDataModel import (
    vtkCompositeDataSet, vtkPartitionedDataSetCollection, vtkStructuredGrid)
from vtkmodules.vtkIOParallelXML import vtkXMLPartitionedDataSetCollectionWriter

HERE = os.path.dirname(os.path.abspath(__file__))


def uniform_knots(degree, size):
    """Clamped, equally spaced knots on [0, 1]."""
    spans = size - degree
    return [0.0] * degree + [i / spans for i in range(spans + 1)] + [1.0] * degree


def greville(knots, degree):
    return [sum(knots[i + 1:i + degree + 1]) / degree
            for i in range(len(knots) - degree - 1)]


def circle(begin, end, arcs):
    """A circular arc as a rational quadratic: points (cos, sin, weight) and knots on [0, 1]."""
    half = (end - begin) / arcs / 2
    points = []
    for i in range(2 * arcs + 1):
        weight = math.cos(half) if i % 2 else 1.0
        angle = begin + i * half
        points.append((math.cos(angle) / weight, math.sin(angle) / weight, weight))
    knots = [0.0] * 3
    for i in range(1, arcs):
        knots += [i / arcs] * 2
    return points, knots + [1.0] * 3


def lattice(role, degrees, knots, points, weights):
    """One patch (id 0, whole) as a structured grid; role 0 is a geometry, 1 an attribute."""
    sizes = [len(k) - p - 1 for k, p in zip(knots, degrees)]
    grid = vtkStructuredGrid()
    grid.SetDimensions(*sizes)
    coordinates = vtkPoints()
    coordinates.SetDataTypeToDouble()
    for point in points:
        coordinates.InsertNextPoint(*point)
    grid.SetPoints(coordinates)
    if weights:
        add(grid.GetPointData(), vtkDoubleArray(), "Weight", [(w,) for w in weights])
    every_face, same_handedness = 63, 1
    header = ([1, role, 0] + sizes + list(degrees) + [1 if weights else 0] + [0] * 6
              + [every_face, same_handedness])
    add(grid.GetFieldData(), vtkIntArray(), "SplineLayout", [(h,) for h in header])
    add(grid.GetFieldData(), vtkDoubleArray(), "Knots", [(k,) for kk in knots for k in kk])
    return grid


def add(attributes, array, name, tuples):
    array.SetName(name)
    array.SetNumberOfComponents(len(tuples[0]))
    for values in tuples:
        for value in values:
            array.InsertNextValue(value)
    attributes.AddArray(array)


def heated_pipe_bend():
    """A pipe bent by 90 degrees with a temperature in a basis of its own.

    u runs through the wall (inner radius 0.6, outer radius 1), v around the pipe, w along the bend
    (radius 2, axis z). Rational quadratic in all directions; inner and outer wall are exact tori.
    The middle layer of control points is pushed outwards at the intrados, as where a bent pipe
    wrinkles: there the map folds within the wall, so that det J = 0 on a sheet near the outer wall.
    """
    bend, radii, push = 2.0, (0.6, 0.8, 1.0), 0.9
    # Around the pipe clockwise, seen along the bend, for a positive det J.
    around, v_knots = circle(math.pi / 4, math.pi / 4 - 2 * math.pi, 4)
    along, w_knots = circle(0.0, math.pi / 2, 3)
    u_knots = [0.0] * 3 + [1.0] * 3
    points, weights, displacement = [], [], []
    for k, (cw, sw, ww) in enumerate(along):
        for cv, sv, wv in around:
            for i, radius in enumerate(radii):
                x, z = bend + radius * cv, radius * sv
                if i == 1 and cv < -1.2 and 2 <= k <= 4:  # the middle of the intrados
                    x -= push
                points.append((x * cw, x * sw, z))
                weights.append(wv * ww)
                stretch = 0.02 * k / (len(along) - 1)
                displacement.append((stretch * x * cw, stretch * x * sw, stretch * z))
    geometry = lattice(0, (2, 2, 2), (u_knots, v_knots, w_knots), points, weights)
    add(geometry.GetPointData(), vtkDoubleArray(), "Displacement", displacement)

    # A warm inner wall that cools along the pipe, and two hot spots in the wall.
    degrees, sizes = (3, 3, 3), (7, 13, 11)
    knots = [uniform_knots(p, n) for p, n in zip(degrees, sizes)]
    spots = (((0.5, 0.30, 0.40), 320.0), ((0.6, 0.55, 0.65), 260.0))
    temperature, places = [], []
    for w in greville(knots[2], 3):
        for v in greville(knots[1], 3):
            for u in greville(knots[0], 3):
                value = 20.0 + 90.0 * (1 - u) ** 2 * (1 - 0.4 * w)
                for (su, sv, sw), height in spots:
                    turn = abs(v - sv)
                    turn = min(turn, 1 - turn)
                    value += height * math.exp(
                        -((u - su) / 0.3) ** 2 - (turn / 0.13) ** 2 - ((w - sw) / 0.16) ** 2)
                temperature.append((value,))
                # Where the parameters would be without rational speed and wrinkle: near enough to
                # look at the lattice in place.
                radius = 0.6 + 0.4 * u
                phi, theta = math.pi / 4 - 2 * math.pi * v, math.pi / 2 * w
                x = bend + radius * math.cos(phi)
                places.append((x * math.cos(theta), x * math.sin(theta), radius * math.sin(phi)))
    attribute = lattice(1, degrees, knots, places, None)
    add(attribute.GetPointData(), vtkDoubleArray(), "Temperature", temperature)

    collection = vtkPartitionedDataSetCollection()
    collection.SetNumberOfPartitionedDataSets(2)
    for index, (name, grid) in enumerate((("Geometry", geometry), ("Temperature", attribute))):
        collection.SetPartition(index, 0, grid)
        collection.GetMetaData(index).Set(vtkCompositeDataSet.NAME(), name)
    writer = vtkXMLPartitionedDataSetCollectionWriter()
    writer.SetInputDataObject(collection)
    writer.SetFileName(os.path.join(HERE, "heated_pipe_bend.vtpc"))
    writer.SetDataModeToBinary()
    writer.Write()


def numbers(rows):
    return "\n".join(" ".join(repr(float(x)) for x in row) for row in rows)


def gismo_geometry(identifier, degrees, knots, points, weights):
    """One <Geometry> of G+Smo XML; control points are not multiplied by their weights."""
    bases = "\n".join(
        f'<Basis type="BSplineBasis" index="{d}"><KnotVector degree="{p}">'
        f'{numbers([k])}</KnotVector></Basis>' for d, (p, k) in enumerate(zip(degrees, knots)))
    return f"""<Geometry type="TensorNurbs3" id="{identifier}">
<Basis type="TensorNurbsBasis3">
<Basis type="TensorBSplineBasis3">
{bases}
</Basis>
<weights>
{numbers([[w] for w in weights])}
</weights>
</Basis>
<coefs geoDim="3">
{numbers(points)}
</coefs>
</Geometry>
"""


def write(name, text):
    with open(os.path.join(HERE, name), "w", encoding="ascii") as file:
        file.write(text)


def folded_sweep():
    """Joy & Duchaineau's Figure 1 (1999), a half cylinder swept along x, as a rational cubic.

    det J = 0 on u = 1/2, whose image is the rectangle y = 1, 0 <= x <= 3, 0 <= z <= 1.
    """
    arc = ((1, 0, 1), (1, 2, 1 / 3), (-1, 2, 1 / 3), (-1, 0, 1))
    points = [(x + 3 * k, y, j) for k in range(2) for j in range(2) for x, y, w in arc]
    weights = [w for k in range(2) for j in range(2) for x, y, w in arc]
    knots = ([0] * 4 + [1] * 4, [0, 0, 1, 1], [0, 0, 1, 1])
    write("folded_sweep.xml", f"""<?xml version="1.0" encoding="UTF-8"?>
<xml>
{gismo_geometry(0, (3, 1, 1), knots, points, weights)}</xml>
""")


def quarter_tube():
    """Radius 1 + u, angle pi/2 in v, height w: degrees, knots, points, weights."""
    arc, v_knots = circle(0.0, math.pi / 2, 1)
    rows = [((1 + i) * c, (1 + i) * s, k, w)
            for k in range(2) for c, s, w in arc for i in range(2)]
    line = [0.0, 0.0, 1.0, 1.0]
    return (1, 2, 1), (line, v_knots, line), [r[:3] for r in rows], [r[3] for r in rows]


def tube_on_block():
    """Two patches: a block (1) stands on the side v = 0 of a quarter of a tube (0)."""
    line = [0.0, 0.0, 1.0, 1.0]
    block = [(1 + i, j - 1, k) for k in range(2) for j in range(2) for i in range(2)]
    write("tube_on_block.xml", f"""<?xml version="1.0" encoding="UTF-8"?>
<xml>
<MultiPatch parDim="3" id="10">
<patches type="id_range">0 1</patches>
<interfaces>
0 3 1 4 0 1 2 1 1 1
</interfaces>
<boundary>
0 1
0 2
0 4
0 5
0 6
1 1
1 2
1 3
1 5
1 6
</boundary>
</MultiPatch>
{gismo_geometry(0, *quarter_tube())}{gismo_geometry(1, (1, 1, 1), (line,) * 3, block, [1.0] * 8)}\
</xml>
""")


def tube_g2():
    """GoTools g2: orders instead of degrees, points multiplied by their weights."""
    degrees, knots, points, weights = quarter_tube()
    bases = "\n".join(f"{len(k) - p - 1} {p + 1}\n{numbers([k])}"
                      for p, k in zip(degrees, knots))
    rows = [[w * x for x in point] + [w] for point, w in zip(points, weights)]
    write("quarter_tube.g2", f"700 1 0 0\n3 1\n{bases}\n{numbers(rows)}\n")


def tube_itd():
    """IRIT: orders, and the weight of a point before its coordinates, multiplied by it."""
    degrees, knots, points, weights = quarter_tube()
    sizes = " ".join(str(len(k) - p - 1) for p, k in zip(degrees, knots))
    orders = " ".join(str(p + 1) for p in degrees)
    rows = [f"[KV {numbers([k])}]" for k in knots]
    rows += [f"[{numbers([[w] + [w * x for x in point]])}]" for point, w in zip(points, weights)]
    write("quarter_tube.itd", "[OBJECT TUBE\n[TRIVAR BSPLINE {} {} P3\n{}\n]\n]\n".format(
        sizes, orders, "\n".join(rows)))


def two_blocks():
    """GeoPDEs: two unit cubes side by side, the second one with its u along y."""
    line = [0.0, 0.0, 1.0, 1.0]
    first = [(i, j, k) for k in range(2) for j in range(2) for i in range(2)]
    second = [(2 - j, i, k) for k in range(2) for j in range(2) for i in range(2)]
    patches = "".join("PATCH {}\n1 1 1\n2 2 2\n{}\n{}\n".format(
        number, numbers([line] * 3), numbers(list(zip(*points)) + [[1] * 8]))
                      for number, points in ((1, first), (2, second)))
    write("two_blocks.txt", f"""# nurbs mesh v.2.1
# parameters, coordinates, patches, interfaces, subdomains
3 3 2 1 1
{patches}INTERFACE 1
1 2
2 4
1 1 1
SUBDOMAIN 1
1 2
BOUNDARY left
1
1 1
BOUNDARY right
1
2 3
""")


def twisted_bar():
    """An MFEM NURBS mesh: a polynomial bar of degrees 1, 1, 2 with a quarter turn."""
    rows = []
    for z, (cosine, sine) in enumerate(((1, 0), (1, 1), (0, 1))):
        for y in (-0.5, 0.5):
            for x in (-0.5, 0.5):
                rows.append((x * cosine - y * sine, x * sine + y * cosine, 1.5 * z, 1))
    write("twisted_bar.mesh", f"""MFEM NURBS mesh v1.0

dimension
3

elements
1
1 5 0 1 2 3 4 5 6 7

boundary
6
1 3 3 2 1 0
2 3 4 5 6 7
3 3 0 1 5 4
3 3 1 2 6 5
3 3 2 3 7 6
3 3 3 0 4 7

edges
12
0 0 1
0 3 2
0 4 5
0 7 6
1 0 3
1 1 2
1 4 7
1 5 6
2 0 4
2 1 5
2 2 6
2 3 7

vertices
8

patches

knotvectors
3
1 2 0 0 1 1
1 2 0 0 1 1
2 3 0 0 0 1 1 1
dimension
3
controlpoints_cartesian
{numbers(rows)}
""")


heated_pipe_bend()
folded_sweep()
tube_on_block()
tube_g2()
tube_itd()
two_blocks()
twisted_bar()
