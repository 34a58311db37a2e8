// SPDX-License-Identifier: BSD-3-Clause
#include "Validity.h"

#include "BezierExtractor.h"
#include "Error.h"
#include "Measures.h"
#include "RoundingWorker.h"
#include "ScaledJacobian.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hyperpatch
{

using rounding::U;

namespace
{

/// The non-empty knot spans of a volume, u fastest.
class Elements
{
public:
  explicit Elements(const Spline& spline)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      this->Breaks[d] = spline.Knots()[d].Breaks();
      this->Size[d] = static_cast<int>(this->Breaks[d].size()) - 1;
    }
  }

  [[nodiscard]] std::size_t Count() const
  {
    return static_cast<std::size_t>(this->Size[0]) * static_cast<std::size_t>(this->Size[1]) *
      static_cast<std::size_t>(this->Size[2]);
  }

  [[nodiscard]] std::array<int, 3> Spans(std::size_t element) const
  {
    const auto nu = static_cast<std::size_t>(this->Size[0]);
    const auto nv = static_cast<std::size_t>(this->Size[1]);
    return { static_cast<int>(element % nu), static_cast<int>(element / nu % nv),
      static_cast<int>(element / nu / nv) };
  }

  /// From the unit cube to the patch's knots.
  void Rescale(ElementValidity& result, std::size_t element) const
  {
    const std::array<int, 3> spans = this->Spans(element);
    std::array<double, 3> low;
    std::array<double, 3> size;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const auto i = static_cast<std::size_t>(spans[d]);
      low[d] = this->Breaks[d][i];
      size[d] = this->Breaks[d][i + 1] - low[d];
    }
    const double volume = size[0] * size[1] * size[2];
    for (auto* interval : { &result.Minimum, &result.Maximum })
    {
      if (*interval)
      {
        // Lengths and their product round four times, the division once.
        const double a = (*interval)->Low / volume;
        const double b = (*interval)->High / volume;
        *interval = Interval{ a - 8 * U * std::abs(a), b + 8 * U * std::abs(b) };
      }
    }
    for (auto* point : { &result.Positive, &result.Negative })
    {
      for (std::size_t d = 0; *point && d < 3; ++d)
      {
        (**point)[d] = low[d] + (**point)[d] * size[d];
      }
    }
  }

private:
  std::array<std::vector<double>, 3> Breaks;
  std::array<int, 3> Size;
};

/// Tests some elements of a volume, several at a time.
class ElementTester
{
public:
  ElementTester(
    const Spline& spline, const Elements& elements, const ValidityOptions& options, int handedness)
    : Spans(elements)
    , Options(options)
    , Handedness(handedness)
    , Degrees(spline.Degrees())
    , Extractor(spline)
    , Test(spline.Degrees(), spline.IsRational(), options)
  {
  }

  void operator()(const std::size_t* begin, const std::size_t* end, PatchValidity& result)
  {
    this->Points.clear();
    this->Errors.clear();
    for (const std::size_t* e = begin; e < end; ++e)
    {
      const std::array<int, 3> spans = this->Spans.Spans(*e);
      this->Extractor.Extract(spans, this->Element);
      this->Points.insert(
        this->Points.end(), this->Element.data(), this->Element.data() + this->Element.size());
      this->Errors.push_back(this->Extractor.ErrorBound(spans));
    }
    this->Results.resize(this->Errors.size());
    this->Test(this->Errors.size(), this->Points.data(), this->Errors.data(), this->Results.data());
    for (std::size_t i = 0; i < this->Results.size(); ++i)
    {
      ElementValidity& element = this->Results[i];
      this->Spans.Rescale(element, begin[i]);
      if (this->Options.ScaledTolerance > 0.0)
      {
        this->Element = Eigen::Map<const Eigen::MatrixXd>(
          this->Points.data() + i * static_cast<std::size_t>(this->Element.size()),
          this->Element.rows(), this->Element.cols());
        element.Scaled =
          BoundScaledJacobian(this->Element, this->Degrees, this->Options.ScaledTolerance,
            this->Handedness, this->Options.MaxScaledBoxes, this->Errors[i]);
      }
      result.Elements[begin[i]] = element;
    }
  }

private:
  const Elements& Spans;
  ValidityOptions Options;
  int Handedness;
  std::array<int, 3> Degrees;
  BezierExtractor Extractor;
  ValidityTest Test;
  Eigen::MatrixXd Element;
  std::vector<double> Points;
  std::vector<double> Errors;
  std::vector<ElementValidity> Results;
};

}

PatchValidity TestValidity(const Spline& geometry, const ValidityOptions& options,
  const ParallelFor& parallelFor, int handedness, const KnownValidity* known)
{
  if (geometry.Components() != 3 || geometry.Dimension() != 3)
  {
    throw Error("the Jacobian determinant needs a volume with three coordinates");
  }
  // Refuses bad options before the work is divided.
  static_cast<void>(ValidityTest(geometry.Degrees(), geometry.IsRational(), options));

  const Elements elements(geometry);
  PatchValidity result;
  result.Handedness = handedness != 0 ? handedness : Handedness(geometry);
  result.ScaledHandedness = result.Handedness;
  std::vector<std::size_t> unknown;
  std::vector<bool> changed(elements.Count(), true);
  // Of scaled Jacobians only the bound that the handedness asks for is narrow.
  if (known && (options.ScaledTolerance == 0.0 || known->Validity->Handedness == result.Handedness))
  {
    changed = ChangedElements(*known->Geometry, geometry);
    result.Elements = known->Validity->Elements;
  }
  result.Elements.resize(elements.Count());
  for (std::size_t e = 0; e < changed.size(); ++e)
  {
    ElementValidity& element = result.Elements[e];
    if (changed[e])
    {
      unknown.push_back(e);
    }
    else if (element.Sign != 0)
    {
      // The sign is the element's own; that of the patch may be another now.
      element.Verdict = 1;
    }
  }
  result.Tested = unknown.size();

  constexpr std::ptrdiff_t Chunk = 64;
  parallelFor(static_cast<std::ptrdiff_t>(unknown.size()), Chunk,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      ElementTester test(geometry, elements, options, result.Handedness);
      for (std::ptrdiff_t first = begin; first < end; first += Chunk)
      {
        test(unknown.data() + first, unknown.data() + std::min(end, first + Chunk), result);
      }
    });

  for (const ElementValidity& element : result.Elements)
  {
    // Only where left-handed and right-handed volumes cancel.
    result.Handedness = result.Handedness != 0 ? result.Handedness : element.Sign;
  }
  for (ElementValidity& element : result.Elements)
  {
    if (element.Verdict == 1 && element.Sign != result.Handedness)
    {
      element.Verdict = -1;
    }
  }
  return result;
}

std::vector<bool> ChangedElements(const Spline& before, const Spline& after)
{
  std::size_t count = 1;
  for (const KnotVector& knots : after.Knots())
  {
    count *= knots.Spans().size();
  }
  if (before.Knots() != after.Knots() || before.Components() != after.Components() ||
    before.IsRational() != after.IsRational())
  {
    return std::vector<bool>(count, true);
  }
  std::vector<bool> changed(count, false);
  const std::array<int, 3> sizes = after.Sizes();
  for (Eigen::Index i = 0; i < after.NumberOfControlPoints(); ++i)
  {
    if (before.Coefficients().col(i) == after.Coefficients().col(i) &&
      (!after.IsRational() || before.Weights()[i] == after.Weights()[i]))
    {
      continue;
    }
    const Eigen::Index index[3] = { i % sizes[0], i / sizes[0] % sizes[1],
      i / sizes[0] / sizes[1] };
    // Control point j reaches the spans of knots j .. j + degree.
    std::array<std::size_t, 3> first;
    std::array<std::size_t, 3> last;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const std::vector<int>& spans = after.Knots()[d].Spans();
      const auto j = static_cast<int>(index[d]);
      const int end = j + after.Degrees()[d];
      first[d] =
        static_cast<std::size_t>(std::lower_bound(spans.begin(), spans.end(), j) - spans.begin());
      last[d] =
        static_cast<std::size_t>(std::upper_bound(spans.begin(), spans.end(), end) - spans.begin());
    }
    const std::size_t nu = after.Knots(0).Spans().size();
    const std::size_t nv = after.Knots(1).Spans().size();
    for (std::size_t w = first[2]; w < last[2]; ++w)
    {
      for (std::size_t v = first[1]; v < last[1]; ++v)
      {
        for (std::size_t u = first[0]; u < last[0]; ++u)
        {
          changed[u + nu * (v + nv * w)] = true;
        }
      }
    }
  }
  return changed;
}

}
