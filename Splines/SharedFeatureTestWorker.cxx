// SPDX-License-Identifier: BSD-3-Clause
#include "SharedFeatureTestWorker.h"

#include "Bernstein.h"
#include "RoundingWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace hyperpatch
{

namespace
{

/// A narrow cone around vectors of any lengths, of which those that are zero to their error are
/// counted and left out.
struct Directions
{
  Cone Around;
  Eigen::Index Zeros = 0;
};

Directions FindDirections(const Eigen::Matrix3Xd& vectors, double error)
{
  Directions result;
  Eigen::Matrix3Xd units(3, vectors.cols());
  Eigen::Index n = 0;
  double uncertain = 0.0;
  for (Eigen::Index i = 0; i < vectors.cols(); ++i)
  {
    const double length = vectors.col(i).norm();
    if (length <= error)
    {
      ++result.Zeros;
      continue;
    }
    uncertain = std::max(uncertain, error / length);
    units.col(n++) = vectors.col(i) / length;
  }
  if (n == 0)
  {
    return result;
  }
  // Towards the axis of the least cone: a step to the vector that is furthest from it, shorter each
  // time (Badoiu & Clarkson 2003).
  const auto directions = units.leftCols(n);
  Eigen::Vector3d axis = directions.rowwise().mean();
  Eigen::Vector3d best = axis;
  double most = -1.0;
  for (int step = 1; step <= 12; ++step)
  {
    const double length = axis.norm();
    if (!(length > 1e-3))
    {
      break;
    }
    axis /= length;
    Eigen::Index furthest = 0;
    const double cosine = (axis.transpose() * directions).minCoeff(&furthest);
    if (cosine > most)
    {
      most = cosine;
      best = axis;
    }
    axis += (directions.col(furthest) - axis) / (step + 1);
  }
  // A vector moves by no more than this angle within its error.
  const double moved = 1.01 * uncertain;
  if (most > 0.0 && moved < 0.5)
  {
    result.Around = Cone(best, std::acos(std::min(1.0, most)) + moved + 32 * rounding::U);
  }
  return result;
}

/// Vectors whose cone holds that of the differences between a piece and its feature.
struct Differences
{
  Eigen::Matrix3Xd Vectors;
  double Error = 0.0;
  /// How many are zero because they belong to the feature.
  Eigen::Index OfFeature = 1;
};

/// For each control point the index of the one that it becomes where directions are fixed.
template <class Function>
void ForEachOntoFeature(
  const std::array<int, 3>& degrees, const std::array<int, 3>& ends, const Function& function)
{
  const Eigen::Index nu = degrees[0] + 1;
  const Eigen::Index nv = degrees[1] + 1;
  const auto onto = [&](std::size_t d, int i) { return ends[d] < 0 ? i : ends[d] * degrees[d]; };
  Eigen::Index index = 0;
  for (int k = 0; k <= degrees[2]; ++k)
  {
    for (int j = 0; j <= degrees[1]; ++j)
    {
      for (int i = 0; i <= degrees[0]; ++i, ++index)
      {
        function(index, onto(0, i) + nu * (onto(1, j) + nv * onto(2, k)));
      }
    }
  }
}

/// \param ends at which directions are fixed, -1 where they are not
Differences FromFeature(const BezierPiece& piece, const std::array<int, 3>& ends)
{
  Differences result;
  if (!piece.IsRational())
  {
    for (int d = 0; d < 3; ++d)
    {
      result.OfFeature *= ends[static_cast<std::size_t>(d)] < 0 ? piece.Degree(d) + 1 : 1;
    }
    result.Vectors.resize(3, piece.Points().cols());
    ForEachOntoFeature(piece.Degrees(), ends,
      [&](Eigen::Index i, Eigen::Index onto)
      { result.Vectors.col(i) = piece.Points().col(i) - piece.Points().col(onto); });
    result.Error = 2.0 * std::sqrt(3.0) * piece.Error() * rounding::Outward;
    return result;
  }
  // X / W - X0 / W0 = (X W0 - X0 W) / (W W0), about an origin nearby, where little cancels.
  BezierPiece feature = piece;
  for (int d = 0; d < 3; ++d)
  {
    const int end = ends[static_cast<std::size_t>(d)];
    if (end >= 0 && piece.Degree(d) > 0)
    {
      feature = feature.AtEnd(d, end);
    }
    result.OfFeature *= end < 0 ? 2 * piece.Degree(d) + 1 : 1;
  }
  const Eigen::Vector3d origin = piece.Projected().rowwise().mean();
  const auto component = [&origin](const BezierPiece& of, Eigen::Index row)
  {
    const Bernstein w(of.Degrees(), of.Points().row(3).transpose(), of.Error());
    return row == 3
      ? w
      : Bernstein(of.Degrees(), of.Points().row(row).transpose(), of.Error()) - origin[row] * w;
  };
  const Bernstein w = component(piece, 3);
  const Bernstein w0 = component(feature, 3);
  double square = 0.0;
  for (Eigen::Index row = 0; row < 3; ++row)
  {
    const Bernstein n = component(piece, row) * w0 - component(feature, row) * w;
    result.Vectors.conservativeResize(3, n.Coefficients().size());
    result.Vectors.row(row) = n.Coefficients().transpose();
    square += n.RoundingBound() * n.RoundingBound();
  }
  result.Error = std::sqrt(square) * rounding::Outward;
  return result;
}

/// Whether all vectors but `zeros` rise above planes across a normal, by a greater angle than
/// `slope`, the sine of what leaves the plane.
bool Rise(const Eigen::Matrix3Xd& vectors, double error, Eigen::Index zeros,
  const Eigen::Vector3d& normal, double slope)
{
  Eigen::Index onPlane = 0;
  for (Eigen::Index i = 0; i < vectors.cols(); ++i)
  {
    const double length = vectors.col(i).norm();
    if (length <= error)
    {
      ++onPlane;
    }
    else if (!(normal.dot(vectors.col(i)) - error > (slope + 16 * rounding::U) * (length + error)))
    {
      return false;
    }
  }
  return onPlane <= zeros;
}

/// Independence of t and f where t and f may be nearly parallel, as at an edge where two faces run
/// on into each other: in the plane across f all t are on one side of a line.
bool RiseFromEdge(
  const Eigen::Matrix3Xd& vectors, double error, Eigen::Index zeros, const Cone& edge)
{
  if (edge.IsEverything())
  {
    return false;
  }
  const Eigen::Vector3d along = edge.Axis();
  const Eigen::Matrix3Xd across = vectors - along * (along.transpose() * vectors);
  const Directions directions = FindDirections(across, error);
  return !directions.Around.IsEverything() &&
    Rise(vectors, error, zeros, directions.Around.Axis(),
      edge.Sine() + std::abs(along.dot(directions.Around.Axis())));
}

/// The same at a face that is plane, whatever its tangents do.
bool RiseFromPlane(
  const Eigen::Matrix3Xd& vectors, double error, Eigen::Index zeros, const BezierPiece& face)
{
  const Eigen::Matrix3Xd& points = face.Projected();
  const int d = face.Degree(0) > 0 ? 1 : 2;
  const Eigen::Vector3d first = points.col(face.Corner(7)) - points.col(face.Corner(0));
  const Eigen::Vector3d second = points.col(face.Corner(d)) - points.col(face.Corner(7 - d));
  Eigen::Vector3d normal = first.cross(second).stableNormalized();
  const double flat =
    4.0 * (face.ProjectedError() + 8 * rounding::U * points.cwiseAbs().maxCoeff());
  const auto heights = (normal.transpose() * (points.colwise() - points.col(0))).cwiseAbs();
  if (heights.maxCoeff() > flat)
  {
    return false;
  }
  normal *= normal.dot(vectors.rowwise().sum()) < 0.0 ? -1.0 : 1.0;
  return Rise(vectors, error, zeros, normal, 0.0);
}

}

bool AreIndependent(const std::vector<Cone>& cones)
{
  if (std::any_of(cones.begin(), cones.end(), [](const Cone& cone) { return cone.IsEverything(); }))
  {
    return false;
  }
  return cones.size() < 2 ||
    (cones.size() == 2 ? !Cross(cones[0], cones[1]).IsEverything()
                       : TripleProductSign(cones[0], cones[1], cones[2]) != 0);
}

bool MeetOnlyAt(
  const SharedFeature& feature, const BezierPiece& a, const BezierPiece& b, bool mayVanish)
{
  const Differences ofA = FromFeature(a, feature.EndA);
  const Differences ofB = FromFeature(b, feature.EndB);
  Eigen::Matrix3Xd vectors(3, ofA.Vectors.cols() + ofB.Vectors.cols());
  // Numerators of rational pieces carry weights: only directions count.
  vectors << ofA.Vectors, -ofB.Vectors;
  const double error = std::max(ofA.Error, ofB.Error);
  const Directions directions = FindDirections(vectors, error);
  if (directions.Zeros > ofA.OfFeature + ofB.OfFeature && !mayVanish)
  {
    return false;
  }
  std::vector<Cone> cones{ directions.Around };
  BezierPiece shared = a;
  for (int d = 0; d < 3; ++d)
  {
    const int end = feature.EndA[static_cast<std::size_t>(d)];
    if (end >= 0 && shared.Degree(d) > 0)
    {
      shared = shared.AtEnd(d, end);
    }
  }
  for (const int d : feature.Tangents)
  {
    if (shared.Degree(d) > 0)
    {
      cones.push_back(DerivativeCone(shared.Points(), shared.Degrees(), d, shared.Error()));
      if (cones.back().ZeroVectors() > 0 && !mayVanish)
      {
        return false;
      }
    }
  }
  if (AreIndependent(cones))
  {
    return true;
  }
  if (cones.size() == 2)
  {
    return RiseFromEdge(vectors, error, ofA.OfFeature + ofB.OfFeature, cones[1]);
  }
  return cones.size() == 3 && RiseFromPlane(vectors, error, ofA.OfFeature + ofB.OfFeature, shared);
}

}
