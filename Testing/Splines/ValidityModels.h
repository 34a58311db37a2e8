// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_ValidityModels_h
#define hyperpatch_testing_ValidityModels_h

#include "Spline.h"

#include <algorithm>
#include <array>
#include <vector>

/// Volumes that tests of validity share.
namespace models
{

using namespace hyperpatch;

/// A volume on one polynomial element of the unit cube, from a function of the lattice indices.
template <class Function>
Spline BezierVolume(std::array<int, 3> degrees, const Function& point)
{
  Eigen::Matrix3Xd points(3, (degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1));
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) = point(i % (degrees[0] + 1), i / (degrees[0] + 1) % (degrees[1] + 1),
      i / (degrees[0] + 1) / (degrees[1] + 1));
  }
  return Spline({ KnotVector::Uniform(degrees[0], degrees[0] + 1),
                  KnotVector::Uniform(degrees[1], degrees[1] + 1),
                  KnotVector::Uniform(degrees[2], degrees[2] + 1) },
    points);
}

/// Unit knots without end: a uniform B-spline whose domain begins at 0.
inline KnotVector Unclamped(int degree, int size)
{
  std::vector<double> knots;
  for (int i = -degree; i <= size; ++i)
  {
    knots.push_back(i);
  }
  return KnotVector(degree, knots);
}

/// Conde & Torres' theorem calls this valid: locally ordered spans, disjoint parallel skins.
inline Spline OrderedButInvalid(double epsilon)
{
  const int m[4][2][2] = { { { 10, 30 }, { 1, 10 } }, { { 3, 1 }, { 1, 3 } },
    { { 10, 1 }, { 30, 10 } }, { { 40, 1 }, { 30, 40 } } };
  Eigen::Matrix3Xd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    const int r = i % 4;
    const int s = i / 4 % 4;
    const int t = i / 16;
    points.col(i) << m[t][0][0] * r + m[t][0][1] * s + 200 * t,
      m[t][1][0] * r + m[t][1][1] * s + 200 * t, 100 * t + epsilon * (r + s);
  }
  return Spline({ Unclamped(3, 4), Unclamped(3, 4), Unclamped(3, 4) }, points);
}

/// Two elements that share three slices of control points, each with det J > 0 and injective, that
/// cross all the same. Conde & Torres say that such elements need not be tested.
inline Spline CrossingNeighbours()
{
  const Eigen::Vector2d c[5] = { { 2, 5 }, { -4, 1 }, { 1, -4 }, { -3, 2 }, { -5, -1 } };
  Eigen::Matrix3Xd points(3, 80);
  for (int i = 0; i < 80; ++i)
  {
    const int r = i % 5;
    const int s = i / 5 % 4;
    const int t = i / 20;
    const Eigen::Vector2d along = (c[std::min(r + 1, 4)] - c[std::max(r - 1, 0)]).normalized();
    points.col(i) << c[r] + (s - 1.5) * 0.05 * Eigen::Vector2d(-along.y(), along.x()), 0.1 * t;
  }
  return Spline({ Unclamped(3, 5), Unclamped(3, 4), Unclamped(3, 4) }, points);
}

}

#endif
