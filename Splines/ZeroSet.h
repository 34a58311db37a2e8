// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSet_h
#define hyperpatch_ZeroSet_h

#include "Aggregate.h"
#include "Parallel.h"
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
  /// Cells wider than this whose bounds leave open whether f vanishes in them are refined, narrower
  /// ones are counted as undecided. 0: 16 times the tolerance.
  double FeatureSize = 0.0;
  /// A knot span is divided at most into so many cells in each direction.
  int MaximumSubdivision = 256;
  /// No refinement that would give about more crossed cells than this.
  double MaximumCells = 1e6;
  /// +1 or -1: the sign of det J of the patch, which orients normals and cells.
  int Handedness = 1;
  ParallelFor For = SerialFor;
  /// Called between steps and, on one thread, inside long ones; true stops the work.
  std::function<bool()> Abort = [] { return false; };
};

/// What is known, and what is not, about a zero-set mesh.
struct ZeroSetCertificate
{
  std::int64_t CrossedCells = 0;   ///< cells that hold a piece of the mesh
  std::int64_t UndecidedCells = 0; ///< no sign change at corners, yet bounds do not exclude a zero;
                                   ///< or f has no bounds
  double LargestResidual = 0.0;    ///< of |f| at vertices over the largest |f| at cell corners
  double LargestError = 0.0;       ///< physical distance, measured at midpoints of edges and cells
  double LargestAttributeError = 0.0; ///< as a multiple of its tolerance
  bool ToleranceReached = true;       ///< false where a maximum stopped refinement

  /// The certificate of both meshes together.
  void Add(const ZeroSetCertificate& other);
};

/// A zero set as a mesh: triangles in a volume, segments in a surface, points on a curve.
struct ZeroSetMesh
{
  Eigen::Matrix3Xd Parameters;             ///< in the patch's own knots
  Eigen::Matrix3Xd Points;                 ///< physical, exact for their parameters
  Eigen::Matrix3Xd Normals;                ///< unit, towards growing f
  std::vector<Eigen::MatrixXd> Attributes; ///< components x points, in the order of the aggregate
  /// axes x cells (3, 2 or 1 rows) of point indices; they turn counter-clockwise around the
  /// normals.
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic> Cells;
  /// Per cell, the non-empty knot span of the geometry in each direction, counted from 0.
  Eigen::Matrix3Xi Elements;
};

/// The grid of cells that a zero set is extracted on: every interval between two breaks is divided
/// into `Counts` equal parts. The same counts on both sides of a break plane, patch interface or
/// cut between pieces leave no crack.
struct CellGrid
{
  std::array<std::vector<double>, 3> Breaks; ///< of geometry, field and attributes together
  std::array<std::vector<int>, 3> Counts;    ///< one per interval
};

/// The zero set of a field on one patch.
///
/// Extract() works on the current grid: boxes that the convex hull property excludes are dropped by
/// bisection down to single cells; the others are polygonised from the signs at their corners, with
/// vertices on f = 0 to round-off, found on the edges of cells. It then measures the error of the
/// mesh and asks for the counts that would meet the tolerances. The caller repeats (and, where a
/// patch is spread over processes, takes the larger counts of all) until nothing more is wanted:
///
///   ZeroSet zeroSet(patch.Body, field, options);
///   while (zeroSet.Extract() && zeroSet.Refine()) {}
///
/// Cost is proportional to the number of spans (a cheap hull test each) plus the cells near the
/// surface.
class ZeroSet
{
public:
  /// Keeps references to `body` and `field`, which must outlive it.
  ZeroSet(const Aggregate& body, const ScalarField& field, ZeroSetOptions options);
  /// The same with what was prepared for earlier zero sets of the body.
  ZeroSet(std::shared_ptr<const PreparedAggregate> body, const ScalarField& field,
    ZeroSetOptions options);
  ~ZeroSet();

  /// The grid of the next extraction.
  [[nodiscard]] const CellGrid& Grid() const;
  /// After Extract(): the counts wanted next. Equal to Grid().Counts where all is well.
  [[nodiscard]] std::array<std::vector<int>, 3>& Wanted();
  /// Makes the wanted counts the grid's. False where they are already.
  bool Refine();

  /// False if aborted.
  bool Extract();

  [[nodiscard]] const ZeroSetMesh& Mesh() const;
  [[nodiscard]] const ZeroSetCertificate& Certificate() const;

private:
  class Worker;
  std::unique_ptr<Worker> W;
};

}

#endif
