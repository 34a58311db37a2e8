// SPDX-License-Identifier: BSD-3-Clause
#include "BezierExtractor.h"

#include "Error.h"

#include <algorithm>
#include <limits>
#include <string>

namespace hyperpatch
{

namespace
{

/// Index of the knot span with that number among the non-empty ones.
int SpanIndex(const KnotVector& knots, int number, int direction)
{
  const auto& spans = knots.Spans();
  if (number < 0 || number >= static_cast<int>(spans.size()))
  {
    throw Error("knot span " + std::to_string(number) + " in direction " + "uvw"[direction] +
      " is not one of the " + std::to_string(spans.size()) + " there are");
  }
  return spans[static_cast<std::size_t>(number)];
}

/// In every block of n runs of `length` numbers replaces run j by the sum of weights[j][i] times
/// run i.
template <std::size_t Width>
void Transform(double* values, Eigen::Index count, Eigen::Index length, int n,
  const double (&weights)[Width][Width])
{
  constexpr Eigen::Index Chunk = 8;
  double old[Width][Chunk];
  for (double* block = values; block < values + count; block += length * n)
  {
    for (Eigen::Index begin = 0; begin < length; begin += Chunk)
    {
      const Eigen::Index size = std::min(Chunk, length - begin);
      for (int i = 0; i < n; ++i)
      {
        std::copy_n(block + i * length + begin, size, old[i]);
      }
      for (int j = 0; j < n; ++j)
      {
        double* target = block + j * length + begin;
        std::fill_n(target, size, 0.0);
        for (int i = 0; i < n; ++i)
        {
          const double weight = weights[j][i];
          for (Eigen::Index e = 0; e < size; ++e)
          {
            target[e] += weight * old[i][e];
          }
        }
      }
    }
  }
}

}

void BezierExtractor::Extract(std::array<int, 3> spans, Eigen::MatrixXd& points) const
{
  std::array<double, 3> low;
  std::array<double, 3> high;
  for (int d = 0; d < 3; ++d)
  {
    const auto i = static_cast<std::size_t>(d);
    const KnotVector& knots = this->S->Knots(d);
    const int s = SpanIndex(knots, spans[i], d);
    low[i] = knots[s];
    high[i] = knots[s + 1];
  }
  this->Extract(spans, low, high, points);
}

void BezierExtractor::Extract(std::array<int, 3> spans, std::array<double, 3> low,
  std::array<double, 3> high, Eigen::MatrixXd& points) const
{
  const Spline& spline = *this->S;
  const std::array<int, 3> p = spline.Degrees();
  const std::array<int, 3> sizes = spline.Sizes();
  const Eigen::Index m = spline.Components();
  const Eigen::Index rows = m + (spline.IsRational() ? 1 : 0);
  int index[3];
  for (int d = 0; d < 3; ++d)
  {
    index[d] = SpanIndex(spline.Knots(d), spans[static_cast<std::size_t>(d)], d);
  }
  points.resize(rows, static_cast<Eigen::Index>(p[0] + 1) * (p[1] + 1) * (p[2] + 1));

  Eigen::Index column = 0;
  for (int k = index[2] - p[2]; k <= index[2]; ++k)
  {
    for (int j = index[1] - p[1]; j <= index[1]; ++j)
    {
      Eigen::Index source =
        index[0] - p[0] + sizes[0] * (j + static_cast<Eigen::Index>(sizes[1]) * k);
      for (int i = 0; i <= p[0]; ++i, ++source, ++column)
      {
        points.col(column).head(m) = spline.Coefficients().col(source);
        if (spline.IsRational())
        {
          points.col(column).head(m) *= spline.Weights()[source];
          points(m, column) = spline.Weights()[source];
        }
      }
    }
  }

  double weights[MaxDegree + 1][MaxDegree + 1];
  Eigen::Index length = rows;
  for (int d = 0; d < 3; ++d)
  {
    const auto i = static_cast<std::size_t>(d);
    double arguments[MaxDegree];
    for (int j = 0; j <= p[i]; ++j)
    {
      std::fill_n(arguments, p[i] - j, low[i]);
      std::fill_n(arguments + p[i] - j, j, high[i]);
      spline.Knots(d).BlossomWeights(index[d], arguments, weights[j]);
    }
    if (p[i] > 0)
    {
      Transform(points.data(), points.size(), length, p[i] + 1, weights);
    }
    length *= p[i] + 1;
  }
}

double BezierExtractor::ErrorBound(std::array<int, 3> spans) const
{
  const Spline& spline = *this->S;
  const std::array<int, 3> sizes = spline.Sizes();
  std::array<int, 3> low;
  std::array<int, 3> high;
  int operations = 6;
  for (int d = 0; d < 3; ++d)
  {
    const auto i = static_cast<std::size_t>(d);
    const int p = spline.Knots(d).Degree();
    high[i] = SpanIndex(spline.Knots(d), spans[i], d);
    low[i] = high[i] - p;
    operations += 6 * p;
  }
  // The greatest number among the control points that reach the element.
  double largest = 0.0;
  for (int k = low[2]; k <= high[2]; ++k)
  {
    for (int j = low[1]; j <= high[1]; ++j)
    {
      const Eigen::Index row = sizes[0] * (j + static_cast<Eigen::Index>(sizes[1]) * k);
      for (Eigen::Index i = row + low[0]; i <= row + high[0]; ++i)
      {
        const double m = spline.Coefficients().col(i).lpNorm<Eigen::Infinity>();
        largest =
          std::max(largest, spline.IsRational() ? spline.Weights()[i] * std::max(1.0, m) : m);
      }
    }
  }
  return std::numeric_limits<double>::epsilon() * operations * largest;
}

}
