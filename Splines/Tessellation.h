// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Tessellation_h
#define hyperpatch_Tessellation_h

#include "Aggregate.h"
#include "Parallel.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace hyperpatch
{

/// How fine a tessellation is, and who runs its loops.
struct TessellationOptions
{
  /// Largest distance between mesh and exact patch, both ways, in the geometry's unit. Positive.
  double Tolerance = 1e-3;
  /// Largest error of linear interpolation of an attribute in any cell, in the attribute's unit and
  /// the same for each of its components: one number per attribute of the aggregate, or none at
  /// all. 0 and infinity switch an attribute off (it is carried, but refines nothing).
  std::vector<double> AttributeTolerances;
  /// Also give the lines along the knots of the geometry on the boundary.
  bool KnotLines = false;
  /// Most segments along an element's edge or direction. Where it stops the refinement the mesh
  /// says LimitReached, and the tolerances do not hold there.
  int MaximumSubdivision = 1024;
  ParallelFor For = SerialFor;
};

/// Indices of points, one column per cell.
template <int N>
using CellArray = Eigen::Matrix<std::int64_t, N, Eigen::Dynamic>;

/// Triangles and lines on the boundary of a patch.
struct SurfaceMesh
{
  Eigen::Matrix3Xd Parameters; ///< in the patch's own knots
  Eigen::Matrix3Xd Points;     ///< coordinates that the geometry does not have are 0
  /// Unit vectors: out of a volume, P_u x P_v of a surface, 0 on a curve. At a break where the face
  /// is only C0 that of one side.
  Eigen::Matrix3Xd Normals;
  /// Per attribute of the aggregate: components x points.
  std::vector<Eigen::MatrixXd> Attributes;

  /// Counter-clockwise seen from where the normals point.
  CellArray<3> Triangles;
  std::vector<int> TriangleSides;    ///< 0..5; 4 (w first) for a surface
  Eigen::Matrix3Xi TriangleElements; ///< knot span of the geometry, counted in the whole patch

  /// Segments of the knot lines, or of the curve.
  CellArray<2> Lines;
  std::vector<int> LineSides;
  Eigen::Matrix3Xi LineElements;

  bool LimitReached = false;
};

/// Hexahedra that fill a volume.
struct SolidMesh
{
  Eigen::Matrix3Xd Parameters;
  Eigen::Matrix3Xd Points;
  std::vector<Eigen::MatrixXd> Attributes;
  CellArray<8> Hexahedra; ///< corners as in VTK_HEXAHEDRON
  Eigen::Matrix3Xi Elements;
  bool LimitReached = false;
};

/// \throws Error if a tolerance is not positive (attributes: negative or NaN), the number of
/// attribute tolerances does not fit, or a direction of degree 0 has more than one span
void CheckTolerances(
  const Patch& patch, double tolerance, const std::vector<double>& attributeTolerances);

/// Tessellates the domain faces of a volume (Patch::IsDomainFace), a surface, or a curve (as
/// lines), so that the tolerances hold everywhere, by bounds and not by samples.
///
/// An element here is a cell of the common breaks of geometry and attributes, where all of them are
/// single polynomial pieces. Each element has a grid inside and points on its edges, and the strips
/// between are triangulated by merging, as tessellation shaders do. The points of an edge follow
/// from the edge curve and its attributes alone, those of an element's face from that face alone:
/// patches, and parts of a patch on other ranks, that share a face or an edge have the same points
/// there. Points are shared inside a side; every side has its own points, because normals differ.
///
/// Triangles that vanish because an edge is collapsed are left out. Where a tangent vanishes the
/// normal is the limit from inside. An attribute that jumps (degree 0) has its upper value at
/// the jump.
///
/// Cost: output, plus the elements of the faces; the inside of a volume is not visited. The result
/// does not depend on the number of threads.
///
/// \param handedness +1 if det J > 0 in the volume, -1 if it is mirrored; of no effect otherwise
/// \throws Error if a tolerance is not positive (attributes: negative or NaN), the number of
/// attribute tolerances does not fit, MaximumSubdivision < 1, handedness is neither 1 nor -1, or a
/// direction of degree 0 has more than one span
[[nodiscard]] SurfaceMesh TessellateBoundary(
  const Patch& patch, int handedness, const TessellationOptions& options);

/// Tessellates a volume with hexahedra on a tensor grid: each layer of elements has the subdivision
/// that its most curved element needs. Trilinear interpolation of position and attributes is within
/// the tolerances in every cell. Neighbouring patches need not have the same points.
/// \throws Error as TessellateBoundary, and if the patch is not a volume
[[nodiscard]] SolidMesh TessellateSolid(
  const Patch& patch, int handedness, const TessellationOptions& options);

}

#endif
