// SPDX-License-Identifier: BSD-3-Clause
#include "BoxSpline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyperpatch
{

namespace
{

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

}

double BoxSpline::WindowVolume(const Spline& spline, const ParameterBox& box)
{
  double volume = 1.0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    const auto [first, last] = SpansOf(knots, box.Low[d], box.High[d]);
    volume *= last - first + knots.Degree() + 1;
  }
  return volume;
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
  double largest = 0.0;
  for (const double c : this->C)
  {
    largest = std::max(largest, std::abs(c));
  }
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
  const std::ptrdiff_t blocks = static_cast<std::ptrdiff_t>(this->C.size()) / (stride * this->N[d]);
  this->Next.assign(static_cast<std::size_t>(stride * n * blocks), 0.0);
  std::array<double, MaxDegree + 1> weights{};
  for (int j = 0; j < n; ++j)
  {
    int column = 0;
    int count = 1;
    weights[0] = 1.0;
    if (j >= p && j <= inside)
    {
      // All its knots are the spline's own.
      column = firstInside + (j - p) - 1 - this->WindowFirst[d];
    }
    else
    {
      const double begin = local[static_cast<std::size_t>(j)];
      int span = j <= p ? first : firstInside + (j - p) - 1;
      while (knots[span + 1] <= begin)
      {
        ++span;
      }
      knots.BlossomWeights(span, &local[static_cast<std::size_t>(j) + 1], weights.data());
      column = span - p - this->WindowFirst[d];
      count = p + 1;
    }
    for (std::ptrdiff_t b = 0; b < blocks; ++b)
    {
      double* to = &this->Next[static_cast<std::size_t>(stride * (j + n * b))];
      for (int i = 0; i < count; ++i)
      {
        const double weight = weights[static_cast<std::size_t>(i)];
        const double* from =
          &this->C[static_cast<std::size_t>(stride * (column + i + this->N[d] * b))];
        for (std::ptrdiff_t s = 0; s < stride; ++s)
        {
          to[s] += weight * from[s];
        }
      }
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

Range BoxSpline::Hull(const Layers& layers) const
{
  double low = INFINITY;
  double high = -INFINITY;
  for (int k = layers.First[2]; k <= layers.Last[2]; ++k)
  {
    for (int j = layers.First[1]; j <= layers.Last[1]; ++j)
    {
      const double* row =
        this->C.data() + this->N[0] * (j + static_cast<std::ptrdiff_t>(this->N[1]) * k);
      for (int i = layers.First[0]; i <= layers.Last[0]; ++i)
      {
        low = std::min(low, row[i]);
        high = std::max(high, row[i]);
      }
    }
  }
  return { low, high };
}

Range BoxSpline::Values(const std::array<Part, 3>& part) const
{
  const Range hull = this->Hull(this->LayersOf(part));
  const double width = this->Noise + this->Slack;
  return { hull.Low - width, hull.High + width };
}

bool BoxSpline::Vanishes(const std::array<Part, 3>& part) const
{
  const Range hull = this->Hull(this->LayersOf(part));
  return this->Slack == 0.0 && hull.Low >= -this->Noise && hull.High <= this->Noise;
}

bool BoxSpline::IsLostInNoise() const
{
  const Range hull = this->Hull(this->LayersOf({ Part::Whole, Part::Whole, Part::Whole }));
  return this->Slack == 0.0 && !hull.Contains(0.0) && this->Noise >= 0.5 * (hull.High - hull.Low);
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
  double low = INFINITY;
  double high = -INFINITY;
  double steepest = 0.0;
  // Layer after layer of the direction, so that the factor stays out of the inner loop.
  for (int at = layers.First[d]; at < layers.Last[d]; ++at)
  {
    const auto A = static_cast<std::size_t>(at);
    const double factor = p / (this->K[d][A + static_cast<std::size_t>(p) + 1] - this->K[d][A + 1]);
    steepest = std::max(steepest, factor);
    Layers layer = layers;
    layer.First[d] = layer.Last[d] = at;
    double least = INFINITY;
    double most = -INFINITY;
    for (int k = layer.First[2]; k <= layer.Last[2]; ++k)
    {
      for (int j = layer.First[1]; j <= layer.Last[1]; ++j)
      {
        const double* row =
          this->C.data() + this->N[0] * (j + static_cast<std::ptrdiff_t>(this->N[1]) * k);
        for (int i = layer.First[0]; i <= layer.Last[0]; ++i)
        {
          const double difference = row[i + stride] - row[i];
          least = std::min(least, difference);
          most = std::max(most, difference);
        }
      }
    }
    low = std::min(low, factor * least);
    high = std::max(high, factor * most);
  }
  const double noise = 2.0 * this->Noise * steepest + this->DerivativeSlack[d];
  return { low - noise, high + noise };
}

}
