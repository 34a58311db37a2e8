// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_FreeParametersWorker_h
#define hyperpatch_FreeParametersWorker_h

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

/// The parameters of a node of a mesh whose corners may lie in collapsed sides (CollapsedSides),
/// with a weight per direction: 0 if it is free in that one, 1 if nothing around is collapsed.
///
/// Parameters and weights together are homogeneous coordinates. Interpolated as such between the
/// corners of a simplex they run along straight lines through a pole, so that a simplex that has a
/// pole for a corner is as good as one that has none (the map of M. G. Duffy, Quadrature over a
/// pyramid or cube of integrands with a singularity at a vertex, SIAM J. Numer. Anal. 19, 1982),
/// and the parts of a simplex fill it.
struct FreeParameters
{
  Eigen::Vector3d Values = Eigen::Vector3d::Zero();
  Eigen::Vector3d Weights = Eigen::Vector3d::Ones();
};

/// The point of a simplex with these barycentric coordinates. What all corners share stays bit by
/// bit: sides of the domain, knot planes.
[[nodiscard]] inline FreeParameters Between(
  const FreeParameters* corners, const double* shares, int count)
{
  FreeParameters point;
  for (int d = 0; d < 3; ++d)
  {
    double low = INFINITY;
    double high = -INFINITY;
    double sum = 0.0;
    double weight = 0.0;
    for (int i = 0; i < count; ++i)
    {
      const double own = shares[i] * corners[i].Weights[d];
      const double value = corners[i].Values[d];
      sum += own * value;
      weight += own;
      low = corners[i].Weights[d] > 0.0 ? std::min(low, value) : low;
      high = corners[i].Weights[d] > 0.0 ? std::max(high, value) : high;
    }
    // Not beyond the corners by rounding, which may be the end of the domain.
    point.Values[d] = high < low     ? corners[0].Values[d]
      : low == high || weight == 0.0 ? low
                                     : std::min(std::max(sum / weight, low), high);
    point.Weights[d] = weight;
  }
  return point;
}

[[nodiscard]] inline FreeParameters Middle(const FreeParameters& a, const FreeParameters& b)
{
  const FreeParameters ends[] = { a, b };
  constexpr double Half[] = { 0.5, 0.5 };
  return Between(ends, Half, 2);
}

/// Gives corners of a simplex values in the directions in which they are free: the mean of the
/// others.
inline void FillFree(FreeParameters* corners, int count)
{
  for (int d = 0; d < 3; ++d)
  {
    double sum = 0.0;
    double low = INFINITY;
    double high = -INFINITY;
    int others = 0;
    for (int i = 0; i < count; ++i)
    {
      if (corners[i].Weights[d] > 0.0)
      {
        sum += corners[i].Values[d];
        low = std::min(low, corners[i].Values[d]);
        high = std::max(high, corners[i].Values[d]);
        ++others;
      }
    }
    for (int i = 0; i < count && others < count && others > 0; ++i)
    {
      corners[i].Values[d] = corners[i].Weights[d] > 0.0
        ? corners[i].Values[d]
        : std::min(std::max(sum / others, low), high);
    }
  }
}

}

#endif
