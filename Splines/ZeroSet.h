// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSet_h
#define hyperpatch_ZeroSet_h

#include "Aggregate.h"
#include "Parallel.h"
#include "Prepared.h"
#include "ScalarField.h"

#include <Eigen/Core>

#include <array>
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
  /// Per side (0..5), whether the model goes on beyond it: cuts between parts, interfaces.
  std::array<bool, 6> GoesOn{};
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
  /// Parameter boxes, no wider than the tolerance unless a maximum stopped refinement, in which a
  /// zero can neither be excluded nor proven to be a simple sheet; all boxes where f has no bounds.
  std::int64_t UndecidedCells = 0;
  double LargestResidual = 0.0;       ///< of |f| at vertices over the largest |f| at box corners
  double LargestError = 0.0;          ///< physical distance, measured inside every cell
  double LargestAttributeError = 0.0; ///< as a multiple of its tolerance
  bool ToleranceReached = true;       ///< false where a maximum stopped refinement

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
/// creases, for f restricted to them. (A weaker test than that of Plantinga & Vegter 2004, which
/// needs no balanced tree: bulges of a sheet through a face or edge between leaves stay sheets.)
/// Leaves may hold many knot spans or a small part of one. The sheet meets the faces between leaves
/// in curves that both sides share; inside its leaf it is meshed by a constrained Delaunay
/// triangulation in the metric of its curvature and of the attributes. Vertices are on f = 0 to
/// round-off, the error of each cell is measured, and cells that miss the tolerance get more
/// vertices.
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

  /// Patches that meet, or parts of one, give a surface without cracks if their boxes are halved
  /// alike on the common face. For that they need the same lines in it, which follow from the
  /// breaks and from the numbers of root boxes; and each has to know where the other halved.
  ///
  ///   a.SetRoots(...), b.SetRoots(...);             // the same along the face
  ///   a.Search(), b.Search();
  ///   b.AddNodes(side of b, a.NodesOn(side of a));  // and back
  ///   a.Finish(), b.Finish();
  ///
  /// The number of root boxes per direction, 0 for one that is not there; creases come on top.
  [[nodiscard]] const std::array<int, 3>& Roots() const;
  /// \param mirrored per direction, whether lines are counted from the end
  void SetRoots(const std::array<int, 3>& roots, const std::array<bool, 3>& mirrored);
  /// False if aborted.
  bool Search();
  /// Where boxes have corners on a side (0..5): line numbers in the two other directions,
  /// ascending.
  [[nodiscard]] std::vector<std::array<int, 2>> NodesOn(int side) const;
  /// \returns whether any of them is new
  bool AddNodes(int side, const std::vector<std::array<int, 2>>& nodes);
  /// False if aborted.
  bool Finish();
  /// After Finish(): halves the boxes in which a tolerance was missed or the sheet could not be
  /// meshed. True if there were any; then tell the neighbors and Finish() again.
  bool Refine();
  /// How often that is worth while.
  static constexpr int MostRefinements = 6;

  [[nodiscard]] const ZeroSetMesh& Mesh() const;
  [[nodiscard]] const ZeroSetCertificate& Certificate() const;

private:
  class Worker;
  std::unique_ptr<Worker> W;
};

}

#endif
