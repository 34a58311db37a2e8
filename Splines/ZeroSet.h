// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSet_h
#define hyperpatch_ZeroSet_h

#include "Aggregate.h"
#include "ControlBounds.h"
#include "Parallel.h"
#include "Prepared.h"
#include "ScalarField.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace hyperpatch
{

struct ZeroSetOptions
{
  /// Largest distance, in physical space, between a cell of the mesh and the exact zero set.
  double Tolerance = 1e-3;
  /// Largest difference, per component, between linear interpolation in a cell and the exact value;
  /// one number per attribute of the patch, 0 where it does not matter, or empty.
  std::vector<double> AttributeTolerances;
  /// No more than about so many undecided cells are refined further, and so many cells of the mesh
  /// are made.
  double MaximumCells = 2e7;
  /// +1 or -1: the sign of det J of the patch, which orients normals and cells.
  int Handedness = 1;
  ParallelFor For = SerialFor;
  /// Called between steps and, on one thread, inside long ones; true stops the work.
  std::function<bool()> Abort = [] { return false; };
};

/// What is known, and what is not, about a zero-set mesh.
struct ZeroSetCertificate
{
  /// Parameter boxes that hold a piece of the mesh and in which the gradient test proves that the
  /// zero set is one sheet, a graph over a coordinate plane.
  std::int64_t CertifiedCells = 0;
  /// Parameter boxes in which a zero can neither be excluded nor proven to be a simple sheet; all
  /// boxes where f has no bounds. No wider than the tolerance unless a maximum stopped refinement
  /// or f is 0 all over them. Also boxes where the surface is within the tolerance, but meets
  /// itself in a point or an edge or could not be meshed as one sheet; these may be wider.
  std::int64_t UndecidedCells = 0;
  double LargestResidual = 0.0;       ///< of |f| at vertices over the largest |f| at box corners
  double LargestError = 0.0;          ///< physical distance, measured inside every cell
  double LargestAttributeError = 0.0; ///< as a multiple of its tolerance
  bool ToleranceReached = true;       ///< false where a maximum stopped refinement
  /// Edges of triangles that no other triangle has, by where they are: on sides beyond which there
  /// is nothing; on sides beyond which the model goes on, but the field or the geometry does not
  /// agree; anywhere else. The last are cracks: there are none where nothing is undecided.
  std::int64_t OpenEdgesOnBoundary = 0;
  std::int64_t OpenEdgesOnInterfaces = 0;
  std::int64_t OpenEdgesInside = 0;

  /// The certificate of both meshes together.
  void Add(const ZeroSetCertificate& other);
};

/// A zero set as a mesh: triangles in a volume, segments in a surface, points on a curve.
///
/// Along creases (knot planes where the geometry, the field or an attribute is only C0) points
/// occur once per side, with the same bits in their coordinates and the normal of their side.
struct ZeroSetMesh
{
  Eigen::Matrix3Xd Parameters;             ///< in the patch's own knots
  Eigen::Matrix3Xd Points;                 ///< physical, exact for their parameters
  Eigen::Matrix3Xd Normals;                ///< unit, towards growing f
  std::vector<Eigen::MatrixXd> Attributes; ///< components x points, in the order of the aggregate
  /// axes x cells (3, 2 or 1 rows) of point indices; they turn counter-clockwise around the
  /// normals.
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic> Cells;
  /// Per cell, the non-empty knot span of the geometry in each direction, counted from 0, that
  /// holds its centre.
  Eigen::Matrix3Xi Elements;
};

/// The zero set of a field on one patch, to a tolerance.
///
/// An octree of parameter boxes is refined until, on each leaf, either the hull of f excludes a
/// zero, or the hull of one partial derivative of f does, so that the zero set is one sheet, a
/// graph in that direction. The same holds on the faces that lie in the domain's boundary or in
/// creases, for f restricted to them. Where the sheet could pass through more than one face or edge
/// unseen by the signs at the corners, the test of Plantinga & Vegter 2004 has to hold too: no two
/// gradients at a right angle. What passes through one is a bulge of the sheet beside, which draws
/// it; where the box beside is undecided, so is this one. (The tree is not balanced as theirs is:
/// each piece is proven, not that the whole is isotopic to the zero set.)
/// Leaves may hold many knot spans or a small part of one. The sheet meets the faces between leaves
/// in curves that both sides share; inside its leaf it is meshed by a constrained Delaunay
/// triangulation in the metric of its curvature and of the attributes. Vertices are on f = 0 to
/// round-off, the error of each cell is measured, and cells that miss the tolerance get more
/// vertices. Patches that meet are drawn together by ZeroSetGroup.
class ZeroSet
{
public:
  /// Keeps references to `body` and `field`, which must outlive it.
  ZeroSet(const Aggregate& body, const ScalarField& field, ZeroSetOptions options);
  /// The same with what was prepared for earlier zero sets of the body.
  ZeroSet(std::shared_ptr<const PreparedAggregate> body, const ScalarField& field,
    ZeroSetOptions options);
  ~ZeroSet();

  /// All at once, for a patch alone. False if aborted.
  bool Extract();

  [[nodiscard]] const ZeroSetMesh& Mesh() const;
  [[nodiscard]] const ZeroSetCertificate& Certificate() const;
  /// No more undecided cells are listed than that.
  static constexpr std::size_t MostListed = 100000;
  /// Those that ZeroSetCertificate::UndecidedCells counts, or the first MostListed of them.
  [[nodiscard]] const std::vector<ParameterBox>& UndecidedBoxes() const;

private:
  friend class ZeroSetGroup;
  class Worker;
  std::unique_ptr<Worker> W;
};

}

#endif
