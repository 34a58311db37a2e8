// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianRounding.h"

#include <algorithm>
#include <limits>

namespace hyperpatch
{

namespace
{

/// Extremes over the control points that a slab of knot spans depends on.
struct Extremes
{
  double Point = 0.0;
  double Weighted = 0.0;
  double LargestWeight = 0.0;
  double LeastWeight = std::numeric_limits<double>::max();

  void Add(double point, double weight)
  {
    this->Point = std::max(this->Point, point);
    this->Weighted = std::max(this->Weighted, weight * point);
    this->LargestWeight = std::max(this->LargestWeight, weight);
    this->LeastWeight = std::min(this->LeastWeight, weight);
  }
  void Add(const Extremes& other)
  {
    this->Point = std::max(this->Point, other.Point);
    this->Weighted = std::max(this->Weighted, other.Weighted);
    this->LargestWeight = std::max(this->LargestWeight, other.LargestWeight);
    this->LeastWeight = std::min(this->LeastWeight, other.LeastWeight);
  }
};

}

JacobianRounding::JacobianRounding(const Spline& geometry)
{
  const auto sizes = geometry.Sizes();
  std::array<std::vector<Extremes>, 3> layers;
  for (std::size_t d = 0; d < 3; ++d)
  {
    layers[d].resize(static_cast<std::size_t>(sizes[d]));
  }
  Eigen::Index column = 0;
  for (int k = 0; k < sizes[2]; ++k)
  {
    for (int j = 0; j < sizes[1]; ++j)
    {
      for (int i = 0; i < sizes[0]; ++i, ++column)
      {
        const double point = geometry.Coefficients().col(column).norm();
        const double weight = geometry.IsRational() ? geometry.Weights()[column] : 1.0;
        layers[0][static_cast<std::size_t>(i)].Add(point, weight);
        layers[1][static_cast<std::size_t>(j)].Add(point, weight);
        layers[2][static_cast<std::size_t>(k)].Add(point, weight);
      }
    }
  }

  const auto degrees = geometry.Degrees();
  this->Operations = 4.0 + 2.0 * (degrees[0] + degrees[1] + degrees[2]);
  for (std::size_t d = 0; d < 3; ++d)
  {
    Slabs& slabs = this->Directions[d];
    slabs.Knots = geometry.Knots()[d];
    const KnotVector& knots = slabs.Knots;
    slabs.Factor.resize(knots.Knots().size());
    slabs.Magnitude.resize(knots.Knots().size());
    for (const int span : knots.Spans())
    {
      // The derivatives of the basis functions on a span are in sum no more than twice that.
      double factor = 0.0;
      Extremes slab;
      for (int i = span - knots.Degree(); i <= span; ++i)
      {
        slab.Add(layers[d][static_cast<std::size_t>(i)]);
        if (i > span - knots.Degree())
        {
          factor = std::max(factor, 2.0 * knots.Degree() / (knots[i + knots.Degree()] - knots[i]));
        }
      }
      // Of a quotient: (A' - w' P) / w.
      const double magnitude = geometry.IsRational()
        ? (slab.Weighted + slab.LargestWeight * slab.Point) / slab.LeastWeight
        : slab.Point;
      slabs.Factor[static_cast<std::size_t>(span)] = factor;
      slabs.Magnitude[static_cast<std::size_t>(span)] = magnitude;
      slabs.LargestFactor = std::max(slabs.LargestFactor, factor);
      this->LargestMagnitude = std::max(this->LargestMagnitude, magnitude);
    }
  }
}

double JacobianRounding::BoundOf(const Eigen::Matrix3d& J, const Eigen::Vector3d& terms) const
{
  constexpr double UnitRoundoff = 0.5 * std::numeric_limits<double>::epsilon();
  const double rounding = UnitRoundoff * this->Operations;
  double product = 1.0;
  double widened = 1.0;
  for (int d = 0; d < 3; ++d)
  {
    const double norm = J.col(d).norm();
    product *= norm;
    widened *= norm + rounding * terms[d];
  }
  return widened - product + rounding * product;
}

double JacobianRounding::Bound(const Eigen::Matrix3d& J, const double* parameters) const
{
  Eigen::Vector3d factors;
  double magnitude = this->LargestMagnitude;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const Slabs& slabs = this->Directions[d];
    const auto span = static_cast<std::size_t>(slabs.Knots.FindSpan(parameters[d]));
    factors[static_cast<Eigen::Index>(d)] = slabs.Factor[span];
    magnitude = std::min(magnitude, slabs.Magnitude[span]);
  }
  return this->BoundOf(J, factors * magnitude);
}

double JacobianRounding::LargestBound(const Eigen::Matrix3d& J) const
{
  const Eigen::Vector3d factors(this->Directions[0].LargestFactor,
    this->Directions[1].LargestFactor, this->Directions[2].LargestFactor);
  return this->BoundOf(J, factors * this->LargestMagnitude);
}

}
