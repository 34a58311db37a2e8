// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianTetrahedra_h
#define hyperpatch_JacobianTetrahedra_h

#include "JacobianTree.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace hyperpatch
{

/// What is done where a cell abuts on smaller ones.
enum class CrackRepair
{
  None,      ///< nothing: the surface may have cracks there (FIGURES 5 and 7)
  AsPrinted, ///< section 7 of the paper: the face of the smaller cell takes over the triangles of
             ///< the larger one's, with J interpolated on it (FIGURE 9)
  Conforming ///< both sides take over all corners that lie on the face, with their exact J
};

/// The sheet det J = 0 as Joy & Duchaineau 1999 draw it, section 7: the image of every cell of the
/// queue is split into twelve tetrahedra, two per face, joined to the image of the cell's centre,
/// and each tetrahedron is cut where the linear interpolant of J is 0. det J = 0 at a corner counts
/// as positive.
///
/// Vertices are interpolated in space and lie near the sheet, not on it: this is the method of the
/// paper, for comparison; ZeroSet draws the sheet to a tolerance.
///
/// Cracks. AsPrinted does what the paper prints: a face that lies in the face of a larger cell is
/// split along the larger one's diagonal (a half of it into three triangles), its corners are moved
/// onto the larger face and take J from it. That closes faces, yet not the edges where faces of
/// three cells meet, nor faces that overlap without one holding the other. Conforming closes all
/// of them: where two cells share a part of a face, that part is triangulated once for both, with
/// every corner of any cell on its border. The surface then ends on the faces of the domain only.
/// (Next to a discarded cell J has one sign at all corners, so that nothing is cut there.)
struct JacobianTetrahedra
{
  Eigen::Matrix3Xd Parameters; ///< of the vertices, interpolated like the points
  Eigen::Matrix3Xd Points;
  /// Point indices, counter-clockwise seen from growing J in the parameter domain. Triangles of no
  /// extent, where J = 0 at a corner, are among them.
  Eigen::Matrix<std::int64_t, 3, Eigen::Dynamic> Triangles;
  std::vector<int> Cells; ///< per triangle: the cell of the tree

  std::int64_t Tetrahedra = 0;    ///< of all cells
  std::int64_t RepairedCells = 0; ///< with faces that are not the two default triangles
  std::int64_t OpenEdges = 0;     ///< edges of one triangle alone, not on a face of the domain
};

/// \param geometry that of the tree
[[nodiscard]] JacobianTetrahedra MarchTetrahedra(
  const Spline& geometry, const JacobianTree& tree, CrackRepair repair = CrackRepair::Conforming);

}

#endif
