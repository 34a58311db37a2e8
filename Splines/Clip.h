// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Clip_h
#define hyperpatch_Clip_h

#include "Aggregate.h"
#include "Parallel.h"
#include "Prepared.h"
#include "ScalarField.h"
#include "Tessellation.h"
#include "ZeroSet.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace hyperpatch
{

struct ClipOptions
{
  /// Largest distance, in physical space, between linear interpolation in a cell and the exact
  /// geometry, and between the cut and the exact zero set.
  double Tolerance = 1e-3;
  /// As in ZeroSetOptions.
  std::vector<double> AttributeTolerances;
  /// Which side is kept: where all fields are negative or 0 (true), or where one is positive.
  bool KeepInside = true;
  /// MakeSolidGrid() of the patch with these tolerances, where it is known: it takes much of the
  /// time, and depends on nothing else.
  const SolidGrid* Grid = nullptr;
  /// No cell is refined when there are so many.
  double MaximumCells = 2e7;
  /// +1 or -1: the sign of det J of the patch, which orients the cells.
  int Handedness = 1;
  ParallelFor For = SerialFor;
  /// Called between steps; true stops the work.
  std::function<bool()> Abort = [] { return false; };
};

/// A part of a patch as a mesh: tetrahedra of a volume, triangles of a surface, segments of a
/// curve.
struct ClipMesh
{
  Eigen::Matrix3Xd Parameters;             ///< in the patch's own knots
  Eigen::Matrix3Xd Points;                 ///< physical, exact for their parameters
  std::vector<Eigen::MatrixXd> Attributes; ///< components x points, in the order of the aggregate
  /// (dimension + 1) x cells of point indices; tetrahedra have positive volume.
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic> Cells;
  /// Per cell, the non-empty knot span of the geometry in each direction, counted from 0.
  Eigen::Matrix3Xi Elements;
  /// As of a zero set. Certified and undecided cells are those at the cut, before they are cut;
  /// errors are measured at the middles of edges, faces and cells.
  ZeroSetCertificate Certificate;
};

/// The part of a patch on one side of the zero sets of fields (of their maximum: a convex body), to
/// a tolerance.
///
/// Simplices on the grid of TessellateSolid(), which meets the tolerances for trilinear
/// interpolation, are bisected where linear interpolation misses them, and at the cut until f is
/// certainly not 0 in a simplex, or f is certainly a single sheet there and its linear interpolant
/// near enough. Then those at the cut are cut (SimplexCut): their new points lie on f = 0 to
/// round-off. The mesh is conforming: no point lies inside an edge or face of another cell.
///
/// Fields without bounds are sampled at the nodes of simplices that are no wider than a sixteenth
/// of the patch.
///
/// \returns the mesh; an empty one if aborted
/// \throws Error as MakeSolidGrid(), and if there are more than SimplexCut::MaximumFields
[[nodiscard]] ClipMesh Clip(const Patch& patch, std::shared_ptr<const PreparedAggregate> body,
  const std::vector<std::shared_ptr<const ScalarField>>& fields, const ClipOptions& options);

}

#endif
