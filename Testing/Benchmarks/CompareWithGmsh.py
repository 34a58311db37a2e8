#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Gmsh's AnalyseMeshQuality on the random tricubic cells of ValidityBenchmark, beside it.

    python3 CompareWithGmsh.py [ValidityBenchmark]

The cells are the same to the bit: a lattice of spacing 1 with uniform noise from std::mt19937(1).
Gmsh gets them as hexahedra of 64 nodes, which it reads before the clock starts. Needs the program
gmsh (Debian's package of that name) and numpy. Both run on one thread; times are of the CPU.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from itertools import product
from pathlib import Path

import numpy

CELLS = 4096
NOISES = (15, 30, 40)


def control_points(noise):
    """CELLS x 64 x 3 Bezier points, u fastest."""
    generator = numpy.random.RandomState(1)._bit_generator
    raw = generator.random_raw(2 * CELLS * 64 * 3).astype(float)
    # std::generate_canonical and std::uniform_real_distribution of libstdc++.
    canonical = (raw[0::2] + raw[1::2] * 2.0 ** 32) / 2.0 ** 64
    move = (canonical * (2 * noise) - noise).reshape(CELLS, 64, 3)
    lattice = numpy.array([(i % 4, i // 4 % 4, i // 16) for i in range(64)], dtype=float)
    return lattice + move


def hexahedron_nodes(order):
    """Where Gmsh has the nodes of a hexahedron, on a grid of order + 1 points: corners, edges,
    faces, inside, each as the nodes of a smaller shape."""
    if order == 0:
        return [(0, 0, 0)]
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
               (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    edges = [(0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3),
             (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7)]
    faces = [(0, 3, 2, 1), (0, 1, 5, 4), (0, 4, 7, 3), (1, 2, 6, 5), (2, 3, 7, 6), (4, 5, 6, 7)]
    points = [numpy.array(corner) * order for corner in corners]
    nodes = [tuple(point) for point in points]
    for a, b in edges:
        nodes += [tuple(points[a] + (points[b] - points[a]) * k // order) for k in range(1, order)]
    for a, b, _, d in faces:
        along, across = (points[b] - points[a]) // order, (points[d] - points[a]) // order
        start = points[a] + along + across
        nodes += [tuple(start + i * along + j * across)
                  for i, j in quadrangle_nodes(order - 2)]
    if order >= 2:
        nodes += [tuple(numpy.array(node) + 1) for node in hexahedron_nodes(order - 2)]
    return nodes


def quadrangle_nodes(order):
    if order < 0:
        return []
    if order == 0:
        return [(0, 0)]
    nodes = [(0, 0), (order, 0), (order, order), (0, order)]
    for k in range(1, order):
        nodes.append((k, 0))
    for k in range(1, order):
        nodes.append((order, k))
    for k in range(1, order):
        nodes.append((order - k, order))
    for k in range(1, order):
        nodes.append((0, order - k))
    return nodes + [(i + 1, j + 1) for i, j in quadrangle_nodes(order - 2)]


def write_mesh(path, points):
    """The polynomial cells by their values at uniform nodes, format MSH 2."""
    t = numpy.arange(4) / 3.0
    basis = numpy.stack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t ** 2 * (1 - t), t ** 3])
    grid = numpy.einsum('ai,bj,ck,ncbad->nkjid', basis, basis, basis,
                        points.reshape(CELLS, 4, 4, 4, 3))
    nodes = hexahedron_nodes(3)
    assert sorted(nodes) == sorted(product(range(4), repeat=3))
    values = numpy.stack([grid[:, k, j, i] for i, j, k in nodes], axis=1).reshape(-1, 3)
    with open(path, 'w', encoding='ascii') as file:
        file.write('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n' % len(values))
        for number, value in enumerate(values, 1):
            file.write('%d %.17g %.17g %.17g\n' % (number, *value))
        file.write('$EndNodes\n$Elements\n%d\n' % CELLS)
        for cell in range(CELLS):
            numbers = ' '.join(str(64 * cell + k) for k in range(1, 65))
            file.write('%d 92 2 1 1 %s\n' % (cell + 1, numbers))
        file.write('$EndElements\n')


def run_gmsh(points):
    """Seconds, and what it says of the cells."""
    with tempfile.TemporaryDirectory() as folder:
        mesh, script = Path(folder, 'cells.msh'), Path(folder, 'analyse.geo')
        write_mesh(mesh, points)
        script.write_text(f'''Merge "{mesh}";
General.NumThreads = 1;
begin = Cpu;
Plugin(AnalyseMeshQuality).JacobianDeterminant = 1;
Plugin(AnalyseMeshQuality).IGEMeasure = 0;
Plugin(AnalyseMeshQuality).ICNMeasure = 0;
Plugin(AnalyseMeshQuality).CreateView = 0;
Plugin(AnalyseMeshQuality).Recompute = 1;
Plugin(AnalyseMeshQuality).DimensionOfElements = 3;
Plugin(AnalyseMeshQuality).Run;
Printf("seconds %g", Cpu - begin);
''', encoding='ascii')
        output = subprocess.run(['gmsh', '-nt', '1', '-v', '5', str(script), '-'], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=True).stdout
    seconds = float(re.search(r'seconds ([-+.e\d]+)', output)[1])
    lines = [line for line in output.splitlines()
             if re.search('inver|valid|negative|[Jj]acobian|minJ', line)]
    return seconds, lines


def run_ours(program):
    output = subprocess.run([program, '--benchmark_filter=RandomTricubicCells'], text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout
    return [line for line in output.splitlines() if line.startswith('RandomTricubicCells')]


def main():
    if not shutil.which('gmsh'):
        sys.exit('gmsh is not here')
    for noise in NOISES:
        seconds, lines = run_gmsh(control_points(0.01 * noise))
        print(f'noise {noise} %: gmsh {CELLS / seconds / 1000:.1f} thousand cells/s')
        for line in lines:
            print('   ', line)
    for line in run_ours(sys.argv[1]) if len(sys.argv) > 1 else []:
        print(line)


if __name__ == '__main__':
    main()
