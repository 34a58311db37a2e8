// SPDX-License-Identifier: BSD-3-Clause
#include "Operators.h"

#include "Bernstein.h"
#include "BezierExtractor.h"
#include "Error.h"
#include "Measures.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

/// One row of a linear map between the control points of one direction.
struct Row
{
  int First = 0; ///< the first input control point
  int Count = 1;
  double Weights[MaxDegree + 1] = { 1.0 };
};

std::size_t Index(int i)
{
  return static_cast<std::size_t>(i);
}

void CheckDirection(int direction)
{
  if (direction < 0 || direction > 2)
  {
    throw Error("direction " + std::to_string(direction) + " is not 0, 1 or 2");
  }
}

std::array<KnotVector, 3> With(const Spline& spline, int direction, KnotVector knots)
{
  std::array<KnotVector, 3> all = spline.Knots();
  all[Index(direction)] = std::move(knots);
  return all;
}

/// Applies a linear map to the homogeneous control points along one direction; row j gives control
/// point j of `knots`. Rows of one weight 1 copy.
Spline MapDirection(
  const Spline& spline, int direction, KnotVector knots, const std::vector<Row>& rows)
{
  const std::array<int, 3> sizes = spline.Sizes();
  Eigen::Index stride = 1;
  for (int d = 0; d < direction; ++d)
  {
    stride *= sizes[Index(d)];
  }
  const Eigen::Index oldSlab = stride * sizes[Index(direction)];
  const Eigen::Index slabs = spline.NumberOfControlPoints() / oldSlab;
  const auto points = spline.Coefficients();
  const auto weights = spline.Weights();
  Eigen::MatrixXd newPoints(points.rows(), slabs * stride * static_cast<Eigen::Index>(rows.size()));
  Eigen::VectorXd newWeights(spline.IsRational() ? newPoints.cols() : 0);
  Eigen::Index to = 0;
  for (Eigen::Index slab = 0; slab < slabs; ++slab)
  {
    for (const Row& row : rows)
    {
      Eigen::Index from = slab * oldSlab + row.First * stride;
      auto target = newPoints.middleCols(to, stride);
      if (row.Count == 1 && row.Weights[0] == 1.0)
      {
        target = points.middleCols(from, stride);
        if (spline.IsRational())
        {
          newWeights.segment(to, stride) = weights.segment(from, stride);
        }
        to += stride;
        continue;
      }
      target.setZero();
      if (spline.IsRational())
      {
        newWeights.segment(to, stride).setZero();
      }
      for (int i = 0; i < row.Count; ++i, from += stride)
      {
        if (!spline.IsRational())
        {
          target += row.Weights[i] * points.middleCols(from, stride);
          continue;
        }
        for (Eigen::Index e = 0; e < stride; ++e)
        {
          const double weight = row.Weights[i] * weights[from + e];
          target.col(e) += weight * points.col(from + e);
          newWeights[to + e] += weight;
        }
      }
      if (spline.IsRational())
      {
        target.array().rowwise() /= newWeights.segment(to, stride).transpose().array();
      }
      to += stride;
    }
  }
  return Spline(With(spline, direction, std::move(knots)), newPoints, newWeights);
}

/// Blossom weights of sorted arguments, taken in the order of their distance from the span: then
/// all intermediate combinations are convex as well where the arguments come from a refinement of
/// the knots, on both sides of the span and outside the domain.
void StableBlossomWeights(const KnotVector& knots, int span, const double* sorted, double* weights)
{
  const int p = knots.Degree();
  double arguments[MaxDegree];
  const double* right = std::upper_bound(sorted, sorted + p, knots[span]);
  const double* left = right;
  for (int i = 0; i < p; ++i)
  {
    const bool goLeft =
      left != sorted && (right == sorted + p || knots[span] - left[-1] < *right - knots[span + 1]);
    arguments[i] = goLeft ? *--left : *right++;
  }
  knots.BlossomWeights(span, arguments, weights);
}

/// The row of blossom weights; a copy where the arguments are consecutive knots.
Row BlossomRow(const KnotVector& knots, int span, const double* sorted)
{
  const int p = knots.Degree();
  Row row;
  for (int i = span - p; i <= span; ++i)
  {
    if (std::equal(sorted, sorted + p, knots.Knots().data() + i + 1))
    {
      row.First = i;
      return row;
    }
  }
  row.First = span - p;
  row.Count = p + 1;
  StableBlossomWeights(knots, span, sorted, row.Weights);
  return row;
}

/// The span of `knots` for blossoms of control point j of `refined`, which has the same domain:
/// where the middle of its support is.
int SpanForControlPoint(const KnotVector& knots, const KnotVector& refined, int j)
{
  const std::vector<int>& spans = refined.Spans();
  const int middle = j + refined.Degree() / 2;
  auto s = std::lower_bound(spans.begin(), spans.end(), middle);
  if (s == spans.end() || (s != spans.begin() && middle - s[-1] < *s - middle))
  {
    --s;
  }
  return knots.FindSpan(refined[*s]);
}

/// Control points first .. last of each direction, with the knots that go with them.
Spline Slice(const Spline& spline, const std::array<int, 3>& first, const std::array<int, 3>& last,
  std::array<KnotVector, 3> knots)
{
  const std::array<int, 3> sizes = spline.Sizes();
  const Eigen::Index run = last[0] - first[0] + 1;
  const Eigen::Index count = run * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
  Eigen::MatrixXd points(spline.Components(), count);
  Eigen::VectorXd weights(spline.IsRational() ? count : 0);
  Eigen::Index to = 0;
  for (int k = first[2]; k <= last[2]; ++k)
  {
    for (int j = first[1]; j <= last[1]; ++j, to += run)
    {
      const Eigen::Index from = first[0] + sizes[0] * (j + static_cast<Eigen::Index>(sizes[1]) * k);
      points.middleCols(to, run) = spline.Coefficients().middleCols(from, run);
      if (spline.IsRational())
      {
        weights.segment(to, run) = spline.Weights().segment(from, run);
      }
    }
  }
  return Spline(std::move(knots), std::move(points), std::move(weights));
}

/// Number of the non-empty span [a, b) with a <= value < b, or a < value <= b if `closedAbove`.
int SpanNumber(const KnotVector& knots, double value, bool closedAbove)
{
  const std::vector<double> breaks = knots.Breaks();
  const auto next = closedAbove ? std::lower_bound(breaks.begin(), breaks.end(), value)
                                : std::upper_bound(breaks.begin(), breaks.end(), value);
  return static_cast<int>(next - breaks.begin()) - 1;
}

/// Cuts one direction to an interval and clamps it.
Spline RestrictDirection(const Spline& spline, int direction, double low, double high)
{
  const int p = spline.Knots(direction).Degree();
  std::vector<double> inserted;
  for (double end : { low, high })
  {
    inserted.insert(
      inserted.end(), Index(std::max(0, p - spline.Knots(direction).Multiplicity(end))), end);
  }
  const Spline refined = InsertKnots(spline, direction, inserted);
  const KnotVector& knots = refined.Knots(direction);
  const int first = knots.Spans()[Index(SpanNumber(knots, low, false))] - p;
  const int last = knots.Spans()[Index(SpanNumber(knots, high, true))];
  std::vector<double> cut(knots.Knots().begin() + first, knots.Knots().begin() + last + p + 2);
  // The outermost knots have no influence on the map.
  cut.front() = low;
  cut.back() = high;
  std::array<int, 3> firsts{ 0, 0, 0 };
  std::array<int, 3> lasts = refined.Sizes();
  for (int& l : lasts)
  {
    --l;
  }
  firsts[Index(direction)] = first;
  lasts[Index(direction)] = last;
  return Slice(refined, firsts, lasts,
    With(refined, direction, KnotVector(p, std::move(cut), Smoothness::Discontinuous)));
}

Spline Zero(const Spline& spline)
{
  return Spline(
    spline.Knots(), Eigen::MatrixXd::Zero(spline.Components(), spline.NumberOfControlPoints()));
}

/// Each distinct knot once more, for degree + 1; as many knots outside the domain as are needed.
KnotVector Elevated(const KnotVector& knots)
{
  std::vector<double> all;
  for (auto i = knots.Knots().begin(); i != knots.Knots().end();)
  {
    const auto next = std::upper_bound(i, knots.Knots().end(), *i);
    all.insert(all.end(), static_cast<std::size_t>(next - i) + 1, *i);
    i = next;
  }
  const int degree = knots.Degree() + 1;
  const auto begin = std::upper_bound(all.begin(), all.end(), knots.First()) - (degree + 1);
  const auto end = std::lower_bound(all.begin(), all.end(), knots.Last()) + (degree + 1);
  return KnotVector(degree, std::vector<double>(begin, end), Smoothness::Discontinuous);
}

}

Spline InsertKnots(const Spline& spline, int direction, const std::vector<double>& knots)
{
  CheckDirection(direction);
  const KnotVector& old = spline.Knots(direction);
  const int p = old.Degree();
  for (std::size_t i = 0; i < knots.size(); ++i)
  {
    if (!(old.First() <= knots[i] && knots[i] <= old.Last()))
    {
      throw Error("knot " + std::to_string(knots[i]) + " cannot be inserted outside the domain [" +
        std::to_string(old.First()) + ", " + std::to_string(old.Last()) + "]");
    }
    if (i > 0 && knots[i] < knots[i - 1])
    {
      throw Error("knots to insert must ascend: sort them");
    }
    const bool interior = old.First() < knots[i] && knots[i] < old.Last();
    const auto same = std::equal_range(knots.begin(), knots.end(), knots[i]);
    const int multiplicity =
      old.Multiplicity(knots[i]) + static_cast<int>(same.second - same.first);
    const int allowed = interior ? std::max(p, 1) : p + 1;
    if (multiplicity > allowed)
    {
      throw Error("knot " + std::to_string(knots[i]) + " would get multiplicity " +
        std::to_string(multiplicity) + "; at degree " + std::to_string(p) + " it may have " +
        std::to_string(allowed));
    }
  }
  if (knots.empty())
  {
    return spline;
  }
  std::vector<double> merged;
  std::merge(
    old.Knots().begin(), old.Knots().end(), knots.begin(), knots.end(), std::back_inserter(merged));
  // A knot inserted at an end of the domain takes the place of the outermost one.
  merged.erase(
    merged.begin(), merged.begin() + std::count(knots.begin(), knots.end(), old.First()));
  merged.resize(
    merged.size() - static_cast<std::size_t>(std::count(knots.begin(), knots.end(), old.Last())));
  KnotVector refined(p, std::move(merged), Smoothness::Discontinuous);
  std::vector<Row> rows;
  rows.reserve(Index(refined.Size()));
  const int added = refined.Size() - old.Size();
  for (int j = 0; j < refined.Size(); ++j)
  {
    // Control points whose support is outside the domain have no influence and stay as they are.
    if (refined[j + p + 1] <= old.First())
    {
      rows.push_back({ j });
    }
    else if (refined[j] >= old.Last())
    {
      rows.push_back({ j - added });
    }
    else
    {
      rows.push_back(
        BlossomRow(old, SpanForControlPoint(old, refined, j), refined.Knots().data() + j + 1));
    }
  }
  return MapDirection(spline, direction, std::move(refined), rows);
}

Spline ElevateDegree(const Spline& spline, int direction, int times)
{
  CheckDirection(direction);
  if (times < 0)
  {
    throw Error("a degree cannot be elevated " + std::to_string(times) + " times");
  }
  if (times == 0)
  {
    return spline;
  }
  const KnotVector& old = spline.Knots(direction);
  const int p = old.Degree();
  KnotVector elevated = Elevated(old);
  std::vector<Row> rows;
  rows.reserve(Index(elevated.Size()));
  for (int j = 0; j < elevated.Size(); ++j)
  {
    const int span = SpanForControlPoint(old, elevated, j);
    const double* arguments = elevated.Knots().data() + j + 1;
    if (arguments[0] == arguments[p])
    {
      rows.push_back(BlossomRow(old, span, arguments));
      continue;
    }
    // The blossom of the raised polynomial is the mean of those that leave out one argument.
    Row row;
    row.First = span - p;
    row.Count = p + 1;
    row.Weights[0] = 0.0;
    for (int omitted = 0; omitted <= p; ++omitted)
    {
      double rest[MaxDegree];
      std::copy(arguments, arguments + omitted, rest);
      std::copy(arguments + omitted + 1, arguments + p + 1, rest + omitted);
      double weights[MaxDegree + 1];
      StableBlossomWeights(old, span, rest, weights);
      for (int i = 0; i <= p; ++i)
      {
        row.Weights[i] += weights[i] / (p + 1);
      }
    }
    rows.push_back(row);
  }
  return ElevateDegree(
    MapDirection(spline, direction, std::move(elevated), rows), direction, times - 1);
}

Spline RefineUniformly(const Spline& spline, std::array<int, 3> pieces)
{
  Spline refined = spline;
  for (int d = 0; d < 3; ++d)
  {
    const int n = pieces[Index(d)];
    if (n < 1)
    {
      throw Error("a span cannot be split into " + std::to_string(n) + " pieces");
    }
    std::vector<double> inserted;
    const KnotVector& knots = spline.Knots(d);
    for (int s : knots.Spans())
    {
      for (int i = 1; i < n && knots.Degree() > 0; ++i)
      {
        inserted.push_back(knots[s] + (knots[s + 1] - knots[s]) * i / n);
      }
    }
    refined = InsertKnots(refined, d, inserted);
  }
  return refined;
}

Spline Clamp(const Spline& spline)
{
  Spline clamped = spline;
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots(d);
    clamped = RestrictDirection(clamped, d, knots.First(), knots.Last());
  }
  return clamped;
}

Spline RestrictToSpans(const Spline& spline, std::array<int, 3> begin, std::array<int, 3> end)
{
  std::array<int, 3> first;
  std::array<int, 3> last;
  std::array<KnotVector, 3> cut;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    const int p = knots.Degree();
    const int count = static_cast<int>(knots.Spans().size());
    if (begin[d] < 0 || end[d] > count || begin[d] >= end[d])
    {
      throw Error("knot spans " + std::to_string(begin[d]) + " to " + std::to_string(end[d]) +
        " in direction " + "uvw"[d] + " are not a range within 0 to " + std::to_string(count));
    }
    first[d] = knots.Spans()[Index(begin[d])] - p;
    last[d] = knots.Spans()[Index(end[d] - 1)];
    cut[d] = KnotVector(p,
      std::vector<double>(
        knots.Knots().begin() + first[d], knots.Knots().begin() + last[d] + p + 2),
      Smoothness::Discontinuous);
  }
  return Slice(spline, first, last, std::move(cut));
}

Spline RestrictToBox(const Spline& spline, std::array<double, 3> low, std::array<double, 3> high)
{
  std::array<int, 3> begin;
  std::array<int, 3> end;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    if (!(knots.First() <= low[d] && low[d] < high[d] && high[d] <= knots.Last()))
    {
      throw Error("the interval [" + std::to_string(low[d]) + ", " + std::to_string(high[d]) +
        "] in direction " + "uvw"[d] + " is empty or not inside the domain [" +
        std::to_string(knots.First()) + ", " + std::to_string(knots.Last()) + "]");
    }
    begin[d] = SpanNumber(knots, low[d], false);
    end[d] = SpanNumber(knots, high[d], true) + 1;
  }
  Spline part = RestrictToSpans(spline, begin, end);
  for (int d = 0; d < 3; ++d)
  {
    part = RestrictDirection(part, d, low[Index(d)], high[Index(d)]);
  }
  return part;
}

Spline ExtractFace(const Spline& spline, int side)
{
  if (side < 0 || side >= NumberOfSides)
  {
    throw Error("side " + std::to_string(side) + " is not in 0..5");
  }
  const KnotVector& knots = spline.Knots(side / 2);
  return ExtractIsoparametric(spline, side / 2, side % 2 == 0 ? knots.First() : knots.Last());
}

Spline ExtractIsoparametric(const Spline& spline, int direction, double value)
{
  CheckDirection(direction);
  const KnotVector& knots = spline.Knots(direction);
  if (!(knots.First() <= value && value <= knots.Last()))
  {
    throw Error("parameter " + std::to_string(value) + " is outside the domain [" +
      std::to_string(knots.First()) + ", " + std::to_string(knots.Last()) + "] of direction " +
      "uvw"[direction]);
  }
  double arguments[MaxDegree];
  std::fill_n(arguments, knots.Degree(), value);
  return MapDirection(
    spline, direction, KnotVector(), { BlossomRow(knots, knots.FindSpan(value), arguments) });
}

Spline Derivative(const Spline& spline, int direction)
{
  CheckDirection(direction);
  if (spline.IsRational())
  {
    throw Error("the derivative of a rational spline has another basis: use RationalDerivative");
  }
  const KnotVector& knots = spline.Knots(direction);
  const int p = knots.Degree();
  if (p == 0)
  {
    return Zero(spline);
  }
  std::vector<double> lower;
  std::vector<Row> rows;
  for (int i = 0; i + 1 < knots.Size(); ++i)
  {
    const double length = knots[i + p + 1] - knots[i + 1];
    // A discontinuous break makes a basis function of no extent; it goes, with one of its knots.
    if (length > 0.0)
    {
      lower.push_back(knots[i + 1]);
      rows.push_back({ i, 2, { -p / length, p / length } });
    }
  }
  lower.insert(lower.end(), knots.Knots().end() - p - 1, knots.Knots().end() - 1);
  return MapDirection(
    spline, direction, KnotVector(p - 1, std::move(lower), Smoothness::Discontinuous), rows);
}

Spline AsPolynomial(const Spline& spline)
{
  return Spline(spline.Knots(), spline.Homogeneous());
}

Spline RationalDerivative(const Spline& spline, int direction)
{
  CheckDirection(direction);
  if (!spline.IsRational())
  {
    return Derivative(spline, direction);
  }
  if (spline.Knots(direction).Degree() == 0)
  {
    return Zero(spline);
  }
  std::array<KnotVector, 3> knots;
  std::array<int, 3> elements;
  std::array<int, 3> pieces; // control points of one element
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& old = spline.Knots()[d];
    const int degree = 2 * old.Degree();
    if (degree > MaxDegree)
    {
      throw Error("the derivative of a rational spline of degree " + std::to_string(old.Degree()) +
        " has degree " + std::to_string(degree) + "; the limit is " + std::to_string(MaxDegree));
    }
    pieces[d] = degree + 1;
    std::vector<double> repeated;
    for (double knot : old.Breaks())
    {
      repeated.insert(repeated.end(), Index(pieces[d]), knot);
    }
    knots[d] = KnotVector(degree, std::move(repeated), Smoothness::Discontinuous);
    elements[d] = static_cast<int>(old.Spans().size());
  }
  const Eigen::Index m = spline.Components();
  const Eigen::Index nu = knots[0].Size();
  const Eigen::Index nv = knots[1].Size();
  Eigen::MatrixXd points(m, nu * nv * knots[2].Size());
  Eigen::VectorXd weights(points.cols());
  const std::array<int, 3> degrees = spline.Degrees();
  const BezierExtractor extractor(spline);
  Eigen::MatrixXd bezier;
  Eigen::MatrixXd quotient(m + 1, static_cast<Eigen::Index>(pieces[0]) * pieces[1] * pieces[2]);
  std::array<int, 3> e;
  for (e[2] = 0; e[2] < elements[2]; ++e[2])
  {
    for (e[1] = 0; e[1] < elements[1]; ++e[1])
    {
      for (e[0] = 0; e[0] < elements[0]; ++e[0])
      {
        extractor.Extract(e, bezier);
        const KnotVector& along = spline.Knots(direction);
        const int span = along.Spans()[Index(e[Index(direction)])];
        const double length = along[span + 1] - along[span];
        const Bernstein w(degrees, bezier.row(m).transpose());
        const Bernstein dw = w.Derivative(direction);
        quotient.row(m) = (w * w).Coefficients().transpose();
        for (Eigen::Index r = 0; r < m; ++r)
        {
          const Bernstein x(degrees, bezier.row(r).transpose());
          const Bernstein numerator = (x.Derivative(direction) * w - x * dw)
                                        .Elevate(direction, 2 * degrees[Index(direction)]);
          quotient.row(r) =
            numerator.Coefficients().transpose().array() / length / quotient.row(m).array();
        }
        Eigen::Index from = 0;
        for (int k = 0; k < pieces[2]; ++k)
        {
          for (int j = 0; j < pieces[1]; ++j, from += pieces[0])
          {
            const Eigen::Index to =
              e[0] * pieces[0] + nu * (e[1] * pieces[1] + j + nv * (e[2] * pieces[2] + k));
            points.middleCols(to, pieces[0]) = quotient.topRows(m).middleCols(from, pieces[0]);
            weights.segment(to, pieces[0]) = quotient.row(m).segment(from, pieces[0]).transpose();
          }
        }
      }
    }
  }
  return Spline(std::move(knots), std::move(points), std::move(weights));
}

Spline ToBezier(const Spline& spline)
{
  Spline bezier = Clamp(spline);
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& knots = bezier.Knots(d);
    std::vector<double> inserted;
    for (double knot : knots.Breaks())
    {
      inserted.insert(
        inserted.end(), Index(std::max(0, knots.Degree() - knots.Multiplicity(knot))), knot);
    }
    bezier = InsertKnots(bezier, d, inserted);
  }
  return bezier;
}

Patch RestrictPatch(const Patch& patch, std::array<int, 3> begin, std::array<int, 3> end)
{
  Spline geometry = RestrictToSpans(patch.Body.Geometry(), begin, end);
  std::vector<Attribute> attributes;
  for (const Attribute& attribute : patch.Body.Attributes())
  {
    const std::array<KnotVector, 3>& knots = attribute.Field.Knots();
    std::array<double, 3> low;
    std::array<double, 3> high;
    std::array<int, 3> first;
    std::array<int, 3> last;
    bool aligned = true;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const KnotVector& g = geometry.Knots()[d];
      low[d] = std::max(g.First(), knots[d].First());
      high[d] = std::min(g.Last(), knots[d].Last());
      // The tolerance with which domains of an aggregate agree.
      const double tolerance = 1e-12 * (g.Last() - g.First());
      const std::vector<double> breaks = knots[d].Breaks();
      const auto nearest = [&breaks, tolerance](double value)
      {
        return static_cast<int>(
          std::lower_bound(breaks.begin(), breaks.end(), value - tolerance) - breaks.begin());
      };
      first[d] = nearest(low[d]);
      last[d] = nearest(high[d]);
      aligned = aligned && breaks[Index(first[d])] - low[d] <= tolerance &&
        breaks[Index(last[d])] - high[d] <= tolerance;
    }
    attributes.push_back({ attribute.Name,
      aligned ? RestrictToSpans(attribute.Field, first, last)
              : RestrictToBox(attribute.Field, low, high) });
  }
  Patch part = patch;
  part.Body = Aggregate(std::move(geometry), std::move(attributes));
  part.WholeHandedness = Handedness(patch);
  for (std::size_t d = 0; d < 3; ++d)
  {
    const int count = static_cast<int>(patch.Body.Geometry().Knots()[d].Spans().size());
    part.FirstSpan[d] += begin[d];
    part.WholeSpans[d] = patch.WholeSpans[d] > 0 ? patch.WholeSpans[d] : count;
    part.IsDomainFace[2 * d] = patch.IsDomainFace[2 * d] && begin[d] == 0;
    part.IsDomainFace[2 * d + 1] = patch.IsDomainFace[2 * d + 1] && end[d] == count;
  }
  return part;
}

}
