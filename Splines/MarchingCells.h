// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_MarchingCells_h
#define hyperpatch_MarchingCells_h

#include <vector>

namespace hyperpatch
{

/// An edge of a unit cell: from the corner with bits `Corner` (bit a = coordinate along axis a) one
/// step along `Axis`.
struct CellEdge
{
  int Corner;
  int Axis;
};

/// The pieces of a zero set in one cell: each a closed polygon over crossed edges in a cube, a
/// segment in a square, a point on an interval.
using CellPieces = std::vector<std::vector<CellEdge>>;

/// Pieces for a cell of 1, 2 or 3 axes whose corner c is positive where bit c of `positive` is set.
///
/// Polygons turn counter-clockwise seen from the positive side; segments have it on their left. On
/// a face whose diagonals disagree the positive corners are cut off one by one, a rule that depends
/// on the face alone: neighbours agree and leave no hole (derived here instead of a printed table;
/// Lorensen & Cline 1987, with Duerst's repair of 1988).
[[nodiscard]] const CellPieces& PiecesOfCell(int axes, unsigned positive);

}

#endif
