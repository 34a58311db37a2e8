// SPDX-License-Identifier: BSD-3-Clause
#include "ChordBound.h"

#include "Range.h"

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
  const Eigen::Index rows = raised.rows();
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
          const double* before = raised.data() + rows * (from + stride * std::max(i - 1, 0));
          const double* after = raised.data() + rows * (from + stride * std::min(i, n - 1));
          double* to = scratch.data() + rows * (b + stride * ((n + 1) * a + i));
          for (Eigen::Index r = 0; r < rows; ++r)
          {
            to[r] = t * before[r] + (1.0 - t) * after[r];
          }
          to[weight + 1 + static_cast<Eigen::Index>(d)] = t * before[weight];
        }
      }
    }
    ++degrees[d];
    raised.swap(scratch);
  }
}

/// Calls body(d) for every coefficient d, of `n` numbers, of a derivative of the first so many rows
/// of Bezier points. \param order how often by each direction; the sum is 1 or 2
/// \tparam N the number of rows where the compiler should know it, or 0
template <int N, typename Body>
void ForDerivative(const Eigen::MatrixXd& points, int rows, const std::array<int, 3>& degrees,
  const std::array<int, 3>& order, double* scratch, const Body& body)
{
  const int n = N > 0 ? N : rows;
  const auto strides = Strides(degrees);
  double factor = 1.0;
  std::array<Eigen::Index, 2> step{ 0, 0 };
  std::size_t steps = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (int k = 0; k < order[d]; ++k)
    {
      factor *= degrees[d] - k;
      step[steps++] = points.rows() * strides[d];
    }
  }
  if (factor <= 0.0)
  {
    return;
  }
  double fixed[N > 0 ? N : 1];
  double* const difference = N > 0 ? fixed : scratch;
  for (int k = 0; k <= degrees[2] - order[2]; ++k)
  {
    for (int j = 0; j <= degrees[1] - order[1]; ++j)
    {
      const double* x = points.data() + points.rows() * (strides[1] * j + strides[2] * k);
      for (int i = 0; i <= degrees[0] - order[0]; ++i, x += points.rows())
      {
        for (int c = 0; c < n; ++c)
        {
          difference[c] = x[c + step[0]] - x[c];
        }
        for (int c = 0; steps == 2 && c < n; ++c)
        {
          difference[c] = x[c + step[0] + step[1]] - x[c + step[1]] - difference[c];
        }
        for (int c = 0; c < n; ++c)
        {
          difference[c] *= factor;
        }
        body(difference);
      }
    }
  }
}

/// De Casteljau at 1/2 in one direction; `low` is overwritten by the lower half.
void Halve(Eigen::MatrixXd& low, Eigen::MatrixXd& high, const std::array<int, 3>& degrees, int d)
{
  const auto strides = Strides(degrees);
  const auto stride = strides[static_cast<std::size_t>(d)];
  const int p = degrees[static_cast<std::size_t>(d)];
  const Eigen::Index rows = low.rows();
  high.resize(rows, low.cols());
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
        double* upper = low.data() + rows * (line + i * stride);
        const double* lower = upper - rows * stride;
        for (Eigen::Index c = 0; c < rows; ++c)
        {
          upper[c] = 0.5 * (upper[c] + lower[c]);
        }
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
    const Range range = RangeOf(points.cols(),
      [&points, rational, components, c](std::ptrdiff_t i)
      { return rational ? points(c, i) / points(components, i) : points(c, i); });
    const double radius = 0.5 * (range.High - range.Low);
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

template <int Rows>
void ChordBound::Accumulate(const Eigen::MatrixXd& points)
{
  const int rows = static_cast<int>(points.rows());
  const int m = (Rows > 0 ? Rows : rows) - (this->Rational ? 1 : 0);
  const std::size_t groups = this->Result.size();
  const auto squared = [m, groups](const double* column, std::size_t group)
  {
    if (groups > 1)
    {
      return column[group] * column[group];
    }
    double sum = 0.0;
    for (int c = 0; c < m; ++c)
    {
      sum += column[c] * column[c];
    }
    return sum;
  };

  std::array<int, 3> degrees = this->Degrees;
  double least = 1.0;
  Eigen::MatrixXd& x = this->Centred;
  if (this->Rational)
  {
    least = points.row(m).minCoeff();
    Elevate(points, degrees, x, this->Scratch);
    // X - (g . xi) W with g the difference of the outer control points; then the centre.
    for (std::size_t d = 0; d < 3; ++d)
    {
      const Eigen::Index last = this->Degrees[d] * Strides(this->Degrees)[d];
      const Eigen::Index corners = points.cols() - 1 - last;
      for (int c = 0; c < m; ++c)
      {
        const double slope = 0.5 *
          (points(c, last) / points(m, last) - points(c, 0) / points(m, 0) +
            points(c, points.cols() - 1) / points(m, points.cols() - 1) -
            points(c, corners) / points(m, corners));
        x.row(c) -= slope * x.row(m + 1 + static_cast<Eigen::Index>(d));
      }
    }
    for (int c = 0; c < m; ++c)
    {
      const Range projected =
        RangeOf(x.cols(), [&x, c, m](std::ptrdiff_t i) { return x(c, i) / x(m, i); });
      x.row(c) -= 0.5 * (projected.Low + projected.High) * x.row(m);
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
      first[4 * g] = std::max(first[4 * g], std::sqrt(squared(x.col(i).data(), g)) / x(m, i));
    }
  }

  this->Difference.resize(rows);
  const auto differences = [&](const std::array<int, 3>& order, const auto& body)
  { ForDerivative<Rows>(x, rows, degrees, order, this->Difference.data(), body); };

  if (this->Rational)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      std::array<int, 3> order{};
      order[d] = 1;
      differences(order,
        [&](const double* coefficient)
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
        [&](const double* coefficient)
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

void ChordBound::Recurse(std::size_t level)
{
  if (level == this->Splits.size())
  {
    const Eigen::MatrixXd& points = this->Levels[level];
    switch (points.rows())
    {
      case 1:
        return this->Accumulate<1>(points);
      case 2:
        return this->Accumulate<2>(points);
      case 3:
        return this->Accumulate<3>(points);
      case 4:
        return this->Accumulate<4>(points);
      default:
        return this->Accumulate<0>(points);
    }
  }
  // This level keeps the upper half while the next one works on the lower one.
  this->Levels[level + 1] = this->Levels[level];
  Halve(this->Levels[level + 1], this->Levels[level], this->Degrees, this->Splits[level]);
  this->Recurse(level + 1);
  this->Levels[level + 1] = this->Levels[level];
  this->Recurse(level + 1);
}

}
