// SPDX-License-Identifier: BSD-3-Clause
#include "Measures.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyperpatch
{

namespace
{

/// A homogeneous point in space.
using Sum = std::array<double, 4>;

void Add(double factor, const Sum& term, Sum& sum)
{
  for (std::size_t e = 0; e < sum.size(); ++e)
  {
    sum[e] += factor * term[e];
  }
}

/// The first derivatives, as columns, of a volume in space at one point.
Eigen::Matrix3d JacobianAt(const Spline& geometry, const Eigen::Vector3d& at)
{
  std::array<int, 3> first{};
  double basis[3][2 * (MaxDegree + 1)]; // values, slopes
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& knots = geometry.Knots(d);
    const int span = knots.FindSpan(at[d]);
    first[static_cast<std::size_t>(d)] = span - knots.Degree();
    knots.BasisDerivatives(span, at[d], 1, basis[d]);
  }
  const auto n = geometry.Sizes();
  const auto p = geometry.Degrees();
  const double* const points = geometry.Coefficients().data();
  const double* const weights = geometry.IsRational() ? geometry.Weights().data() : nullptr;
  std::array<Sum, 4> sums{}; // the point and its three derivatives
  for (int c = 0; c <= p[2]; ++c)
  {
    std::array<Sum, 3> plane{}; // the point and its derivatives by u and v
    for (int b = 0; b <= p[1]; ++b)
    {
      const Eigen::Index row =
        first[0] + n[0] * (first[1] + b + static_cast<Eigen::Index>(n[1]) * (first[2] + c));
      std::array<Sum, 2> line{}; // the point and its derivative by u
      for (int a = 0; a <= p[0]; ++a)
      {
        const double w = weights ? weights[row + a] : 1.0;
        const double* x = points + 3 * (row + a);
        const Sum point{ w * x[0], w * x[1], w * x[2], w };
        Add(basis[0][a], point, line[0]);
        Add(basis[0][p[0] + 1 + a], point, line[1]);
      }
      Add(basis[1][b], line[0], plane[0]);
      Add(basis[1][b], line[1], plane[1]);
      Add(basis[1][p[1] + 1 + b], line[0], plane[2]);
    }
    Add(basis[2][c], plane[0], sums[0]);
    Add(basis[2][c], plane[1], sums[1]);
    Add(basis[2][c], plane[2], sums[2]);
    Add(basis[2][p[2] + 1 + c], plane[0], sums[3]);
  }
  const double w = sums[0][3];
  const Eigen::Vector3d position = Eigen::Vector3d(sums[0].data()) / w;
  Eigen::Matrix3d jacobian;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const Sum& slope = sums[d + 1];
    jacobian.col(static_cast<Eigen::Index>(d)) =
      (Eigen::Vector3d(slope.data()) - slope[3] * position) / w;
  }
  return jacobian;
}

/// The ends of at most 8 blocks of elements, the same from both ends.
std::vector<double> BlockEnds(const KnotVector& knots)
{
  const std::vector<double> breaks = knots.Breaks();
  const std::size_t n = breaks.size() - 1;
  const std::size_t blocks = n <= 8 ? n : 8 - n % 2;
  std::vector<double> ends;
  for (std::size_t i = 0; i <= blocks; ++i)
  {
    ends.push_back(breaks[2 * i <= blocks ? i * n / blocks : n - (blocks - i) * n / blocks]);
  }
  return ends;
}

}

int Handedness(const Spline& geometry)
{
  if (geometry.Dimension() < 3 || geometry.Components() < 3)
  {
    return 0;
  }
  std::array<std::vector<double>, 3> ends;
  for (std::size_t d = 0; d < 3; ++d)
  {
    ends[d] = BlockEnds(geometry.Knots()[d]);
  }
  double sum = 0.0;
  double largest = 0.0; // what the sum could be, as measure of its rounding
  for (std::size_t k = 1; k < ends[2].size(); ++k)
  {
    for (std::size_t j = 1; j < ends[1].size(); ++j)
    {
      for (std::size_t i = 1; i < ends[0].size(); ++i)
      {
        const Eigen::Vector3d low(ends[0][i - 1], ends[1][j - 1], ends[2][k - 1]);
        const Eigen::Vector3d high(ends[0][i], ends[1][j], ends[2][k]);
        const Eigen::Matrix3d jacobian = JacobianAt(geometry, 0.5 * (low + high));
        const double volume = (high - low).prod();
        sum += jacobian.determinant() * volume;
        largest += jacobian.colwise().norm().prod() * volume;
      }
    }
  }
  if (std::abs(sum) <= 1e-13 * largest)
  {
    return 0;
  }
  return sum > 0.0 ? 1 : -1;
}

int Handedness(const Patch& patch)
{
  return patch.WholeHandedness != 0 ? patch.WholeHandedness : Handedness(patch.Body.Geometry());
}

Bounds ControlPointBounds(const MultiPatch& model)
{
  Bounds bounds;
  bounds.Low.fill(std::numeric_limits<double>::infinity());
  bounds.High.fill(-std::numeric_limits<double>::infinity());
  for (const Patch& patch : model.Patches)
  {
    const auto points = patch.Body.Geometry().Coefficients();
    const Eigen::Index rows = points.rows();
    // One pass over memory; coordinates that are not there are 0.
    Eigen::Array3d low = Eigen::Array3d::Zero();
    low.head(rows).setConstant(INFINITY);
    Eigen::Array3d high = -low;
    const double* x = points.data();
    for (Eigen::Index i = 0; i < points.cols(); ++i, x += rows)
    {
      for (Eigen::Index e = 0; e < rows; ++e)
      {
        low[e] = std::min(low[e], x[e]);
        high[e] = std::max(high[e], x[e]);
      }
    }
    for (std::size_t d = 0; d < 3; ++d)
    {
      bounds.Low[d] = std::min(bounds.Low[d], low[static_cast<Eigen::Index>(d)]);
      bounds.High[d] = std::max(bounds.High[d], high[static_cast<Eigen::Index>(d)]);
    }
  }
  return bounds;
}

}
