// SPDX-License-Identifier: BSD-3-Clause
#include "ChordBound.h"

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

namespace
{

// Beyond this degree the coefficients of second derivatives are no longer close to their values.
constexpr int DegreeOfTightCoefficients = 3;

std::array<Eigen::Index, 3> Strides(const std::array<int, 3>& degrees)
{
  return { 1, degrees[0] + 1, static_cast<Eigen::Index>(degrees[0] + 1) * (degrees[1] + 1) };
}

/// Raises the degree of every direction that is there by one. Behind the rows of `points` come
/// three more, for the products of the last row (the weight) with the three parameters.
void Elevate(const Eigen::MatrixXd& points, std::array<int, 3>& degrees, Eigen::MatrixXd& raised,
  Eigen::MatrixXd& scratch)
{
  const Eigen::Index weight = points.rows() - 1;
  raised.setZero(points.rows() + 3, points.cols());
  raised.topRows(points.rows()) = points;
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (degrees[d] == 0)
    {
      continue;
    }
    const Eigen::Index stride = Strides(degrees)[d];
    const int n = degrees[d] + 1;
    const Eigen::Index above = raised.cols() / (stride * n);
    scratch.resize(raised.rows(), raised.cols() / n * (n + 1));
    for (Eigen::Index a = 0; a < above; ++a)
    {
      for (Eigen::Index b = 0; b < stride; ++b)
      {
        for (int i = 0; i <= n; ++i)
        {
          const double t = static_cast<double>(i) / n;
          const Eigen::Index from = b + stride * (n * a);
          const auto before = raised.col(from + stride * std::max(i - 1, 0));
          auto to = scratch.col(b + stride * ((n + 1) * a + i));
          to = t * before + (1.0 - t) * raised.col(from + stride * std::min(i, n - 1));
          to[weight + 1 + static_cast<Eigen::Index>(d)] = t * before[weight];
        }
      }
    }
    ++degrees[d];
    raised.swap(scratch);
  }
}

/// De Casteljau at 1/2 in one direction; `low` is overwritten by the lower half.
void Halve(Eigen::MatrixXd& low, Eigen::MatrixXd& high, const std::array<int, 3>& degrees, int d)
{
  const auto strides = Strides(degrees);
  const auto stride = strides[static_cast<std::size_t>(d)];
  const int p = degrees[static_cast<std::size_t>(d)];
  high.resize(low.rows(), low.cols());
  for (Eigen::Index line = 0; line < low.cols(); ++line)
  {
    if ((line / stride) % (p + 1) != 0)
    {
      continue;
    }
    high.col(line + p * stride) = low.col(line + p * stride);
    for (int r = 1; r <= p; ++r)
    {
      for (int i = p; i >= r; --i)
      {
        low.col(line + i * stride) =
          0.5 * (low.col(line + i * stride) + low.col(line + (i - 1) * stride));
      }
      high.col(line + (p - r) * stride) = low.col(line + p * stride);
    }
  }
}

}

const std::vector<ChordBound::Bound>& ChordBound::operator()(
  const Eigen::MatrixXd& points, std::array<int, 3> degrees, bool rational, Norm norm, int halvings)
{
  this->Degrees = degrees;
  this->Rational = rational;
  this->Measure = norm;
  const Eigen::Index components = points.rows() - (rational ? 1 : 0);
  this->Result.assign(norm == Norm::Vector ? 1 : static_cast<std::size_t>(components), Bound{});
  this->Splits.clear();
  const auto strides = Strides(degrees);
  for (std::size_t d = 0; d < 3; ++d)
  {
    // A direction in which the weight is constant is as good as a polynomial one.
    bool bends = degrees[d] > DegreeOfTightCoefficients;
    for (Eigen::Index i = 0; rational && degrees[d] > 0 && !bends && i < points.cols(); ++i)
    {
      bends = (i / strides[d]) % (degrees[d] + 1) > 0 &&
        std::abs(points(components, i) - points(components, i - strides[d])) >
          1e-14 * points(components, i);
    }
    this->Splits.insert(
      this->Splits.end(), bends ? static_cast<std::size_t>(halvings) : 0, static_cast<int>(d));
  }
  this->Levels.resize(std::max(this->Levels.size(), this->Splits.size() + 1));
  this->Levels[0] = points;
  for (Eigen::Index c = 0; c < components; ++c)
  {
    const auto row = points.row(c).array();
    const double radius = rational ? 0.5 *
        ((row / points.row(components).array()).maxCoeff() -
          (row / points.row(components).array()).minCoeff())
                                   : 0.5 * (row.maxCoeff() - row.minCoeff());
    double& bounded = this->Result[norm == Norm::Vector ? 0 : static_cast<std::size_t>(c)].Radius;
    bounded = std::hypot(bounded, radius);
  }
  this->Recurse(0);
  // From the parameters of the parts to those of the piece.
  std::array<double, 3> scale{ 1.0, 1.0, 1.0 };
  for (int d : this->Splits)
  {
    scale[static_cast<std::size_t>(d)] *= 2.0;
  }
  for (Bound& bound : this->Result)
  {
    std::size_t pair = 0;
    for (std::size_t d = 0; d < 3; ++d)
    {
      for (std::size_t e = d; e < 3; ++e, ++pair)
      {
        bound.Second[pair] *= scale[d] * scale[e];
      }
    }
  }
  return this->Result;
}

void ChordBound::Recurse(std::size_t level)
{
  if (level == this->Splits.size())
  {
    this->Accumulate(this->Levels[level]);
    return;
  }
  // This level keeps the upper half while the next one works on the lower one.
  this->Levels[level + 1] = this->Levels[level];
  Halve(this->Levels[level + 1], this->Levels[level], this->Degrees, this->Splits[level]);
  this->Recurse(level + 1);
  this->Levels[level + 1] = this->Levels[level];
  this->Recurse(level + 1);
}

void ChordBound::Accumulate(const Eigen::MatrixXd& points)
{
  const Eigen::Index rows = points.rows();
  const Eigen::Index m = rows - (this->Rational ? 1 : 0);
  const std::size_t groups = this->Result.size();
  const auto squared = [&](const auto& column, std::size_t group)
  {
    return groups == 1 ? column.head(m).squaredNorm()
                       : std::pow(column[static_cast<Eigen::Index>(group)], 2);
  };

  std::array<int, 3> degrees = this->Degrees;
  Eigen::VectorXd& difference = this->Difference;
  double least = 1.0;
  Eigen::MatrixXd& x = this->Centred;
  if (this->Rational)
  {
    least = points.row(m).minCoeff();
    Elevate(points, degrees, x, this->Scratch);
    const auto weights = x.row(m).array();
    // X - (g . xi) W with g the difference of the outer control points; then the centre.
    for (std::size_t d = 0; d < 3; ++d)
    {
      const Eigen::Index last = this->Degrees[d] * Strides(this->Degrees)[d];
      const Eigen::Index corners = points.cols() - 1 - last;
      for (Eigen::Index c = 0; c < m; ++c)
      {
        const double slope = 0.5 *
          (points(c, last) / points(m, last) - points(c, 0) / points(m, 0) +
            points(c, points.cols() - 1) / points(m, points.cols() - 1) -
            points(c, corners) / points(m, corners));
        x.row(c) -= slope * x.row(m + 1 + static_cast<Eigen::Index>(d));
      }
    }
    for (Eigen::Index c = 0; c < m; ++c)
    {
      const auto projected = x.row(c).array() / weights;
      const double centre = 0.5 * (projected.minCoeff() + projected.maxCoeff());
      x.row(c) -= centre * x.row(m);
    }
  }
  else
  {
    x = points;
  }
  // Per group: r of the rational bounds, then those of |P_d|; per piece |W_d|.
  std::vector<double>& first = this->First;
  first.assign(4 * groups, 0.0);
  double weight[3] = {};
  for (Eigen::Index i = 0; this->Rational && i < x.cols(); ++i)
  {
    for (std::size_t g = 0; g < groups; ++g)
    {
      first[4 * g] = std::max(first[4 * g], std::sqrt(squared(x.col(i), g)) / x(m, i));
    }
  }

  const auto strides = Strides(degrees);
  // Calls body(difference) for every coefficient of a derivative; `order` has one number per
  // direction and the sum 1 or 2.
  const auto differences = [&](const std::array<int, 3>& order, const auto& body)
  {
    double factor = 1.0;
    for (std::size_t d = 0; d < 3; ++d)
    {
      for (int k = 0; k < order[d]; ++k)
      {
        factor *= degrees[d] - k;
      }
    }
    if (factor <= 0.0)
    {
      return;
    }
    std::array<Eigen::Index, 2> step{ 0, 0 };
    std::size_t steps = 0;
    for (std::size_t d = 0; d < 3; ++d)
    {
      for (int k = 0; k < order[d]; ++k)
      {
        step[steps++] = strides[d];
      }
    }
    for (int k = 0; k <= degrees[2] - order[2]; ++k)
    {
      for (int j = 0; j <= degrees[1] - order[1]; ++j)
      {
        for (int i = 0; i <= degrees[0] - order[0]; ++i)
        {
          const Eigen::Index at = i + strides[1] * j + strides[2] * k;
          difference = x.col(at + step[0]) - x.col(at);
          if (steps == 2)
          {
            difference = x.col(at + step[0] + step[1]) - x.col(at + step[1]) - difference;
          }
          body(factor * difference);
        }
      }
    }
  };

  if (this->Rational)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      std::array<int, 3> order{};
      order[d] = 1;
      differences(order,
        [&](const auto& coefficient)
        {
          weight[d] = std::max(weight[d], std::abs(coefficient[m]));
          for (std::size_t g = 0; g < groups; ++g)
          {
            first[4 * g + 1 + d] = std::max(first[4 * g + 1 + d], squared(coefficient, g));
          }
        });
      for (std::size_t g = 0; g < groups; ++g)
      {
        double& slope = first[4 * g + 1 + d];
        slope = (std::sqrt(slope) + weight[d] * first[4 * g]) / least;
      }
    }
  }
  std::size_t pair = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (std::size_t e = d; e < 3; ++e, ++pair)
    {
      std::array<int, 3> order{};
      ++order[d];
      ++order[e];
      double bend = 0.0;
      std::vector<double>& second = this->Second;
      second.assign(groups, 0.0);
      differences(order,
        [&](const auto& coefficient)
        {
          bend = this->Rational ? std::max(bend, std::abs(coefficient[m])) : 0.0;
          for (std::size_t g = 0; g < groups; ++g)
          {
            second[g] = std::max(second[g], squared(coefficient, g));
          }
        });
      for (std::size_t g = 0; g < groups; ++g)
      {
        const double* f = first.data() + 4 * g;
        const double bound =
          (std::sqrt(second[g]) + weight[d] * f[1 + e] + weight[e] * f[1 + d] + bend * f[0]) /
          least;
        this->Result[g].Second[pair] = std::max(this->Result[g].Second[pair], bound);
      }
    }
  }
}

}
