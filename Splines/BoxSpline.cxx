// SPDX-License-Identifier: BSD-3-Clause
#include "BoxSpline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyperpatch
{

namespace
{

constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };

/// The first and last knot span that meet the open interval.
std::array<int, 2> SpansOf(const KnotVector& knots, double low, double high)
{
  const int first = knots.FindSpan(low);
  int last = std::max(first, knots.FindSpan(high));
  while (last > first && knots[last] >= high)
  {
    --last;
  }
  return { first, last };
}

/// `size` sums of `Count` numbers times the weights: numbers that are `layer` apart, the next sum's
/// `step` further on, into places `toStep` apart.
template <int Count>
void Combine(std::ptrdiff_t size, const double* from, std::ptrdiff_t step, std::ptrdiff_t layer,
  const double* weights, double* to, std::ptrdiff_t toStep)
{
  for (std::ptrdiff_t s = 0; s < size; ++s)
  {
    double sum = weights[0] * from[s * step];
    for (int i = 1; i < Count; ++i)
    {
      sum += weights[i] * from[s * step + i * layer];
    }
    to[s * toStep] = sum;
  }
}

void Combine(int count, std::ptrdiff_t size, const double* from, std::ptrdiff_t step,
  std::ptrdiff_t layer, const double* weights, double* to, std::ptrdiff_t toStep)
{
  switch (count)
  {
    case 2:
      return Combine<2>(size, from, step, layer, weights, to, toStep);
    case 3:
      return Combine<3>(size, from, step, layer, weights, to, toStep);
    case 4:
      return Combine<4>(size, from, step, layer, weights, to, toStep);
    case 5:
      return Combine<5>(size, from, step, layer, weights, to, toStep);
    default:
      for (std::ptrdiff_t s = 0; s < size; ++s)
      {
        to[s * toStep] = weights[0] * from[s * step];
        for (int i = 1; i < count; ++i)
        {
          to[s * toStep] += weights[i] * from[s * step + i * layer];
        }
      }
  }
}

}

void BoxSpline::FindWindow(const Spline& spline, const ParameterBox& box)
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    const auto [first, last] = SpansOf(knots, box.Low[d], box.High[d]);
    this->WindowFirst[d] = first - knots.Degree();
    this->WindowSize[d] = last - first + knots.Degree() + 1;
  }
}

void BoxSpline::InsertEnds(const Spline& spline, const ParameterBox& box)
{
  this->Widen(0.0, {});
  this->P = spline.Degrees();
  this->N = this->WindowSize;
  const Range window = RangeOf(this->C.data(), Product(this->N));
  const double largest = std::max(std::abs(window.Low), std::abs(window.High));
  int operations = 6;
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    operations += 6 * this->P[D];
    if (this->P[D] > 0)
    {
      this->InsertEnds(spline.Knots(d), d, box.Low[D], box.High[D]);
    }
  }
  // Rows of knot insertion are convex combinations; their weights are sums of positive terms with
  // five roundings per degree (Higham 2002, section 3.1).
  this->Noise = operations * std::numeric_limits<double>::epsilon() * largest;
  this->All = RangeOf(this->C.data(), Product(this->N));
}

void BoxSpline::InsertEnds(const KnotVector& knots, int direction, double low, double high)
{
  const auto d = static_cast<std::size_t>(direction);
  const int p = knots.Degree();
  const int first = this->WindowFirst[d] + p; // span of the lower end
  std::vector<double>& local = this->K[d];
  local.assign(static_cast<std::size_t>(p) + 1, low);
  int next = first + 1;
  while (knots[next] <= low)
  {
    ++next;
  }
  const int firstInside = next;
  for (; knots[next] < high; ++next)
  {
    local.push_back(knots[next]);
  }
  const int inside = next - firstInside;
  local.insert(local.end(), static_cast<std::size_t>(p) + 1, high);
  const int n = inside + p + 1;

  const std::ptrdiff_t stride = d == 0 ? 1
    : d == 1                           ? this->N[0]
                                       : static_cast<std::ptrdiff_t>(this->N[0]) * this->N[1];
  const std::ptrdiff_t blocks = Product(this->N) / (stride * this->N[d]);
  Reserve(stride * n * blocks, this->Next);
  // Rows at both ends are sums; all knots of those between are the spline's own.
  struct EndRow
  {
    int To, From;
    std::array<double, MaxDegree + 1> Weights;
  };
  std::array<EndRow, 2 * MaxDegree + 1> ends;
  std::size_t numberOfEnds = 0;
  for (int j = 0; j < n; ++j)
  {
    if (j >= p && j <= inside)
    {
      j = inside;
      continue;
    }
    const double begin = local[static_cast<std::size_t>(j)];
    int span = j <= p ? first : firstInside + (j - p) - 1;
    while (knots[span + 1] <= begin)
    {
      ++span;
    }
    EndRow& row = ends[numberOfEnds++];
    row.To = j;
    row.From = span - p - this->WindowFirst[d];
    knots.BlossomWeights(span, &local[static_cast<std::size_t>(j) + 1], row.Weights.data());
  }
  const int copied = std::max(0, inside - p + 1);
  const int copiedFrom = firstInside - 1 - this->WindowFirst[d];
  const std::ptrdiff_t oldBlock = stride * this->N[d];
  const std::ptrdiff_t newBlock = stride * n;
  for (std::ptrdiff_t b = 0; b < blocks; ++b)
  {
    std::copy_n(this->C.data() + oldBlock * b + stride * copiedFrom, stride * copied,
      this->Next.data() + newBlock * b + stride * p);
  }
  for (std::size_t e = 0; e < numberOfEnds; ++e)
  {
    const EndRow& row = ends[e];
    const double* from = this->C.data() + stride * row.From;
    double* to = this->Next.data() + stride * row.To;
    if (d == 0)
    {
      Combine(p + 1, blocks, from, oldBlock, 1, row.Weights.data(), to, newBlock);
      continue;
    }
    for (std::ptrdiff_t b = 0; b < blocks; ++b)
    {
      Combine(
        p + 1, stride, from + oldBlock * b, 1, stride, row.Weights.data(), to + newBlock * b, 1);
    }
  }
  this->C.swap(this->Next);
  this->N[d] = n;
  for (double& k : local)
  {
    k = (k - low) / (high - low);
  }
}

void BoxSpline::Assign(const Bernstein& polynomial)
{
  this->Widen(0.0, {});
  this->P = polynomial.Degrees();
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->N[d] = this->P[d] + 1;
    this->K[d].assign(static_cast<std::size_t>(this->N[d]), 0.0);
    this->K[d].insert(this->K[d].end(), static_cast<std::size_t>(this->N[d]), 1.0);
  }
  const Eigen::VectorXd& c = polynomial.Coefficients();
  this->C.assign(c.data(), c.data() + c.size());
  this->All = RangeOf(c.data(), c.size());
  this->Noise = polynomial.RoundingBound();
}

void BoxSpline::Widen(double values, const std::array<double, 3>& derivatives)
{
  this->Slack = values;
  this->DerivativeSlack = derivatives;
}

BoxSpline::Layers BoxSpline::LayersOf(const std::array<Part, 3>& part) const
{
  Layers layers{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    layers.First[d] = part[d] == Part::High ? this->N[d] - 1 : 0;
    layers.Last[d] = part[d] == Part::Low ? 0 : this->N[d] - 1;
  }
  return layers;
}

Range BoxSpline::Hull(const std::array<Part, 3>& part) const
{
  if (part == Everywhere)
  {
    return this->All;
  }
  const Layers layers = this->LayersOf(part);
  const int length = layers.Last[0] - layers.First[0] + 1;
  Range hull{ INFINITY, -INFINITY };
  for (int k = layers.First[2]; k <= layers.Last[2]; ++k)
  {
    for (int j = layers.First[1]; j <= layers.Last[1]; ++j)
    {
      hull = Union(hull, RangeOf(this->Row(j, k) + layers.First[0], length));
    }
  }
  return hull;
}

Range BoxSpline::Values(const std::array<Part, 3>& part) const
{
  const Range hull = this->Hull(part);
  const double width = this->Noise + this->Slack;
  return { hull.Low - width, hull.High + width };
}

bool BoxSpline::Vanishes(const std::array<Part, 3>& part) const
{
  const Range hull = this->Hull(part);
  return this->Slack == 0.0 && hull.Low >= -this->Noise && hull.High <= this->Noise;
}

bool BoxSpline::IsLostInNoise() const
{
  return this->Slack == 0.0 && !this->All.Contains(0.0) &&
    this->Noise >= 0.5 * (this->All.High - this->All.Low);
}

Range BoxSpline::Derivative(int direction, const std::array<Part, 3>& part) const
{
  const auto d = static_cast<std::size_t>(direction);
  const Layers layers = this->LayersOf(part);
  const int p = this->P[d];
  const std::ptrdiff_t stride = d == 0 ? 1
    : d == 1                           ? this->N[0]
                                       : static_cast<std::ptrdiff_t>(this->N[0]) * this->N[1];
  if (p == 0)
  {
    return { -this->DerivativeSlack[d], this->DerivativeSlack[d] };
  }
  Range all{ INFINITY, -INFINITY };
  double steepest = 0.0;
  const auto add = [&](int at, const Range& differences)
  {
    const auto A = static_cast<std::size_t>(at);
    const double factor = p / (this->K[d][A + static_cast<std::size_t>(p) + 1] - this->K[d][A + 1]);
    steepest = std::max(steepest, factor);
    all = Union(all, { factor * differences.Low, factor * differences.High });
  };
  if (d == 0)
  {
    // Rows hold one difference of each layer.
    constexpr int Most = 8;
    for (int begin = layers.First[0]; begin < layers.Last[0]; begin += Most)
    {
      const int count = std::min(Most, layers.Last[0] - begin);
      double least[Most];
      double most[Most];
      std::fill_n(least, Most, INFINITY);
      std::fill_n(most, Most, -INFINITY);
      for (int k = layers.First[2]; k <= layers.Last[2]; ++k)
      {
        for (int j = layers.First[1]; j <= layers.Last[1]; ++j)
        {
          const double* row = this->Row(j, k) + begin;
          for (int i = 0; i < count; ++i)
          {
            least[i] = std::min(least[i], row[i + 1] - row[i]);
            most[i] = std::max(most[i], row[i + 1] - row[i]);
          }
        }
      }
      for (int i = 0; i < count; ++i)
      {
        add(begin + i, { least[i], most[i] });
      }
    }
  }
  else
  {
    const int length = layers.Last[0] - layers.First[0] + 1;
    for (int at = layers.First[d]; at < layers.Last[d]; ++at)
    {
      const std::size_t other = 3 - d;
      Range differences{ INFINITY, -INFINITY };
      for (int o = layers.First[other]; o <= layers.Last[other]; ++o)
      {
        const double* row = (d == 1 ? this->Row(at, o) : this->Row(o, at)) + layers.First[0];
        differences = Union(differences,
          RangeOf(length, [row, stride](std::ptrdiff_t i) { return row[i + stride] - row[i]; }));
      }
      add(at, differences);
    }
  }
  const double noise = 2.0 * this->Noise * steepest + this->DerivativeSlack[d];
  return { all.Low - noise, all.High + noise };
}

}
