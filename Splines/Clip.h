// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Clip_h
#define hyperpatch_Clip_h

#include "Aggregate.h"
#include "Parallel.h"
#include "Prepared.h"
#include "ScalarField.h"
#include "ZeroSet.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace hyperpatch
{

class BendBounds;

struct ClipOptions
{
  /// Largest distance, in physical space, between linear interpolation in a cell and the exact
  /// geometry, and between the cut and the exact zero set.
  double Tolerance = 1e-3;
  /// As in ZeroSetOptions.
  std::vector<double> AttributeTolerances;
  /// Which side is kept: where all fields are negative or 0 (true), or where one is positive.
  bool KeepInside = true;
  /// No cell is refined when there are so many.
  double MaximumCells = 2e7;
  /// +1 or -1: the sign of det J of the patch, which orients the cells.
  int Handedness = 1;
  ParallelFor For = SerialFor;
  /// Called between steps and inside long ones that have no loop in parallel; true stops the work.
  std::function<bool()> Abort = [] { return false; };
};

/// A part of a patch as a mesh: tetrahedra of a volume, triangles of a surface, segments of a
/// curve.
struct ClipMesh
{
  /// In the patch's own knots; the low end of directions in which a pole has no parameter.
  Eigen::Matrix3Xd Parameters;
  Eigen::Matrix3Xd Points;                 ///< physical, exact for their parameters
  std::vector<Eigen::MatrixXd> Attributes; ///< components x points, in the order of the aggregate
  /// (dimension + 1) x cells of point indices; tetrahedra have positive volume where det J has the
  /// sign of the patch. One that has not, at an edge where det J is 0 or since a cut passes a pole
  /// at a tiny part of the tolerance, counts as undecided.
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic> Cells;
  /// Per cell, the non-empty knot span of the geometry in each direction, counted from 0.
  Eigen::Matrix3Xi Elements;
  /// As of a zero set, but for open edges. Certified and undecided cells are those at the cut,
  /// before they are cut; errors are measured at the middles of edges, faces and cells, where
  /// bounds do not exclude that they exceed the tolerances.
  ZeroSetCertificate Certificate;
};

/// The parts of patches on one side of the zero sets of fields (of their maximum: a convex body),
/// to a tolerance, as one conforming mesh where the patches meet.
///
/// Elements (cells of the breaks of geometry and attributes) that are certainly on the other side
/// are found in a tree and take no part. The others are divided into simplices. These are bisected
/// where bounds do not certify and measured errors of linear interpolation exceed the tolerances,
/// and at the cut until f is certainly not 0 in a simplex, or f is certainly a single sheet there
/// and its linear interpolant near enough. Then those at the cut are cut (SimplexCut): their new
/// points lie on f = 0 to round-off. The mesh is conforming: no point lies inside an edge or face
/// of another cell.
///
/// That also holds where patches meet at an interface (of any orientation, also with themselves) on
/// which position and fields agree to AgreementTolerance, of the extent of the model and of the
/// range of the field, at a grid of samples: both sides have the same faces there, whose corners
/// are equal bit by bit. They get the same breaks, their edges are halved together, and which
/// simplices there are follows from the positions of points alone. Other interfaces are left apart,
/// and the faces there counted.
///
/// Where a side or an edge of a patch is collapsed to a line or a point (an axis, a pole), all
/// parameters there are one point of the mesh, and cells at it are as good as others
/// (CollapsedSides, FreeParameters). An attribute that is not one value there (an angle on the
/// axis) has that of the low end; cells at it that miss their tolerance for that are refined to the
/// width of Tolerance and count as undecided. A field that is not one value counts as 0 if it has
/// both signs: its cut ends there. Two sides that meet and collapse across each other's directions
/// are one point in the shape of an L; the second of them is taken as it is, and cells there may be
/// flat.
///
/// Fields without bounds are sampled at the nodes of simplices that are no wider than a sixteenth
/// of the patch.
class ClipGroup
{
public:
  struct Member
  {
    const Patch* On;
    std::shared_ptr<const PreparedAggregate> Body; ///< of that patch
    std::vector<std::shared_ptr<const ScalarField>> Fields;
    ClipOptions Options;
  };
  /// What depends on the model and on which attributes have tolerances only: give it back for the
  /// next clip of the same patches.
  using Kept = std::vector<std::shared_ptr<BendBounds>>;

  static constexpr double AgreementTolerance = 1e-6;

  /// Keeps references to the patches, which must outlive it.
  /// \param kept empty, or what Bends() of an earlier group gave
  /// \throws Error as CheckTolerances(), and if there are more than SimplexCut::MaximumFields
  ClipGroup(std::vector<Member> members, const std::vector<Interface>& interfaces,
    ParallelFor parallelFor = SerialFor, Kept kept = {});
  ~ClipGroup();

  /// False if aborted.
  bool Extract();

  /// Of a member, in the order in which they were given; may be moved from.
  [[nodiscard]] ClipMesh& Mesh(std::size_t member);
  /// Of all together.
  [[nodiscard]] ZeroSetCertificate Certificate() const;
  /// Faces of tetrahedra (edges of triangles) on sides of interfaces, without an equal one on the
  /// other side.
  [[nodiscard]] std::int64_t OpenFacesOnInterfaces() const;
  [[nodiscard]] const Kept& Bends() const;

private:
  class Worker;
  std::unique_ptr<Worker> W;
};

/// The same of a patch alone.
/// \returns the mesh; an empty one if aborted
[[nodiscard]] ClipMesh Clip(const Patch& patch, std::shared_ptr<const PreparedAggregate> body,
  const std::vector<std::shared_ptr<const ScalarField>>& fields, const ClipOptions& options);

}

#endif
