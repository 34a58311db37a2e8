// SPDX-License-Identifier: BSD-3-Clause
#include "ScalarField.h"

#include "BezierExtractor.h"
#include "ScalarFieldWorker.h"

#include <algorithm>

namespace hyperpatch
{

namespace field
{

std::array<std::vector<double>, 3> BreaksOf(const Spline& spline)
{
  return { spline.Knots(0).Breaks(), spline.Knots(1).Breaks(), spline.Knots(2).Breaks() };
}

std::array<std::vector<double>, 3> KnotsNoSmootherThan(const Spline& spline, int smoothness)
{
  std::array<std::vector<double>, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& k = spline.Knots()[d];
    const std::vector<double> breaks = k.Breaks();
    for (std::size_t b = 1; b + 1 < breaks.size(); ++b)
    {
      if (k.Multiplicity(breaks[b]) >= k.Degree() - smoothness)
      {
        knots[d].push_back(breaks[b]);
      }
    }
  }
  return knots;
}

std::array<int, 3> SpansAround(const Spline& spline, const ParameterBox& box)
{
  std::array<int, 3> spans{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    spans[d] = spline.Knots()[d].FindSpan(0.5 * (box.Low[d] + box.High[d]));
  }
  return spans;
}

BezierBox OnBezierBox(const Spline& spline, const ParameterBox& box)
{
  const std::array<int, 3> knots = SpansAround(spline, box);
  std::array<int, 3> spans{};
  int operations = 6;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const std::vector<int>& all = spline.Knots()[d].Spans();
    spans[d] = static_cast<int>(std::lower_bound(all.begin(), all.end(), knots[d]) - all.begin());
    operations += 6 * spline.Knots()[d].Degree();
  }
  BezierBox result;
  BezierExtractor(spline).Extract(spans, box.Low, box.High, result.Points);
  // Weights of blossoms inside a span are sums of positive terms of degree factors, five roundings
  // each; they sum to 1 (Higham 2002, section 3.1).
  double largest = 0.0;
  ForControlWindow(spline, knots,
    [&spline, &largest](Eigen::Index i)
    {
      const double weight = spline.IsRational() ? spline.Weights()[i] : 1.0;
      const double magnitude = spline.Coefficients().col(i).cwiseAbs().maxCoeff();
      largest =
        std::max(largest, weight * (spline.IsRational() ? std::max(1.0, magnitude) : magnitude));
    });
  result.Error = UnitRoundoff * operations * largest;
  return result;
}

double Operations(const Spline& spline)
{
  const auto p = spline.Degrees();
  return 4.0 + 2.0 * (p[0] + p[1] + p[2]);
}

}

ScalarField::~ScalarField() = default;

bool ScalarField::Restrict(const ParameterBox& box, BoxSpline& f) const
{
  const std::array<std::vector<double>, 3> breaks = this->Breaks();
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto next = std::upper_bound(breaks[d].begin(), breaks[d].end(), box.Low[d]);
    if (next != breaks[d].end() && *next < box.High[d])
    {
      return false;
    }
  }
  const std::optional<Bernstein> polynomial = this->OnBox(box);
  if (polynomial)
  {
    f.Assign(*polynomial);
  }
  return polynomial.has_value();
}

bool ScalarField::Excludes(const ParameterBox& /*box*/) const
{
  return false;
}

void ScalarField::Snap(std::size_t /*count*/, double* /*points*/) const {}

}
