// SPDX-License-Identifier: BSD-3-Clause
#include "Reparametrise.h"

#include "Error.h"
#include "Operators.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

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

/// The control points in another order: number i of the result is number source(indices of i).
template <typename SourceOf>
Spline Reorder(const Spline& spline, std::array<KnotVector, 3> knots, SourceOf&& source)
{
  const std::array<int, 3> sizes{ knots[0].Size(), knots[1].Size(), knots[2].Size() };
  const std::array<int, 3> old = spline.Sizes();
  Eigen::MatrixXd points(spline.Components(), spline.NumberOfControlPoints());
  Eigen::VectorXd weights(spline.Weights().size());
  Eigen::Index to = 0;
  for (int k = 0; k < sizes[2]; ++k)
  {
    for (int j = 0; j < sizes[1]; ++j)
    {
      for (int i = 0; i < sizes[0]; ++i, ++to)
      {
        const std::array<int, 3> s = source(std::array<int, 3>{ i, j, k });
        const Eigen::Index from = s[0] + old[0] * (s[1] + static_cast<Eigen::Index>(old[1]) * s[2]);
        points.col(to) = spline.Coefficients().col(from);
        if (spline.IsRational())
        {
          weights[to] = spline.Weights()[from];
        }
      }
    }
  }
  return Spline(std::move(knots), std::move(points), std::move(weights));
}

void CheckWhole(const MultiPatch& model)
{
  for (const Patch& patch : model.Patches)
  {
    if (patch.WholeSpans != std::array<int, 3>{ 0, 0, 0 })
    {
      throw Error("patch " + std::to_string(patch.Id) +
        " is here in part only: change its parameters before it is split");
    }
  }
}

/// Breaks of all knot vectors, those closer than 1e-12 of the domain as one.
std::vector<double> CommonBreaks(const std::vector<Spline>& splines, int direction)
{
  std::vector<double> all;
  for (const Spline& spline : splines)
  {
    const std::vector<double> breaks = spline.Knots(direction).Breaks();
    all.insert(all.end(), breaks.begin(), breaks.end());
  }
  std::sort(all.begin(), all.end());
  const double tolerance = 1e-12 * (all.back() - all.front());
  std::vector<double> common{ all.front() };
  for (const double knot : all)
  {
    if (knot - common.back() > tolerance)
    {
      common.push_back(knot);
    }
  }
  common.back() = all.back();
  return common;
}

/// The spline with its knots moved to the nearest ones of a list, which are within rounding.
Spline SnapKnots(const Spline& spline, int direction, const std::vector<double>& breaks)
{
  std::array<KnotVector, 3> knots = spline.Knots();
  std::vector<double> snapped = spline.Knots(direction).Knots();
  for (double& knot : snapped)
  {
    const auto next = std::lower_bound(breaks.begin(), breaks.end(), knot);
    knot = next == breaks.begin()                                      ? *next
      : next == breaks.end() || knot - *std::prev(next) < *next - knot ? *std::prev(next)
                                                                       : *next;
  }
  knots[Index(direction)] =
    KnotVector(spline.Knots(direction).Degree(), std::move(snapped), Smoothness::Discontinuous);
  return Spline(std::move(knots), spline.Coefficients(), spline.Weights());
}

}

Spline ScaleDomain(const Spline& spline, int direction, double first, double last)
{
  CheckDirection(direction);
  if (!(first < last) || !std::isfinite(last - first))
  {
    throw Error("[" + std::to_string(first) + ", " + std::to_string(last) +
      "] is no domain: the first parameter must be less than the last");
  }
  const KnotVector& old = spline.Knots(direction);
  std::vector<double> scaled = old.Knots();
  for (double& knot : scaled)
  {
    const double t = (knot - old.First()) / (old.Last() - old.First());
    knot = t == 1.0 ? last : first + t * (last - first);
  }
  std::array<KnotVector, 3> knots = spline.Knots();
  knots[Index(direction)] = KnotVector(old.Degree(), std::move(scaled), Smoothness::Discontinuous);
  return Spline(std::move(knots), spline.Coefficients(), spline.Weights());
}

Spline ReverseDirection(const Spline& spline, int direction)
{
  CheckDirection(direction);
  const KnotVector& old = spline.Knots(direction);
  std::vector<double> reversed(old.Knots().rbegin(), old.Knots().rend());
  for (double& knot : reversed)
  {
    // The ends of the domain stay what they are, to the bit.
    knot = knot == old.First() ? old.Last()
      : knot == old.Last()     ? old.First()
                               : old.First() + (old.Last() - knot);
  }
  std::array<KnotVector, 3> knots = spline.Knots();
  knots[Index(direction)] =
    KnotVector(old.Degree(), std::move(reversed), Smoothness::Discontinuous);
  const int last = old.Size() - 1;
  return Reorder(spline, std::move(knots),
    [direction, last](std::array<int, 3> index)
    {
      index[Index(direction)] = last - index[Index(direction)];
      return index;
    });
}

Spline SwapDirections(const Spline& spline, int direction1, int direction2)
{
  CheckDirection(direction1);
  CheckDirection(direction2);
  std::array<KnotVector, 3> knots = spline.Knots();
  std::swap(knots[Index(direction1)], knots[Index(direction2)]);
  return Reorder(spline, std::move(knots),
    [direction1, direction2](std::array<int, 3> index)
    {
      std::swap(index[Index(direction1)], index[Index(direction2)]);
      return index;
    });
}

Aggregate Apply(const Aggregate& aggregate, const std::function<Spline(const Spline&)>& function)
{
  std::vector<Attribute> attributes;
  for (const Attribute& attribute : aggregate.Attributes())
  {
    attributes.push_back({ attribute.Name, function(attribute.Field) });
  }
  return Aggregate(function(aggregate.Geometry()), std::move(attributes));
}

MultiPatch ReverseDirection(MultiPatch model, int direction)
{
  CheckWhole(model);
  for (Patch& patch : model.Patches)
  {
    patch.Body =
      Apply(patch.Body, [direction](const Spline& s) { return ReverseDirection(s, direction); });
  }
  const auto other = [direction](int side) { return side / 2 == direction ? side ^ 1 : side; };
  for (Interface& item : model.Interfaces)
  {
    std::array<int, 10>& v = item.Values;
    v[1] = other(v[1] - 1) + 1;
    v[3] = other(v[3] - 1) + 1;
    for (int d = 0; d < 3; ++d)
    {
      if ((d == direction) != (v[Index(4 + d)] == direction))
      {
        v[Index(7 + d)] = 1 - v[Index(7 + d)];
      }
    }
  }
  for (Boundary& boundary : model.Boundaries)
  {
    for (std::array<int, 2>& side : boundary.Sides)
    {
      side[1] = other(side[1]);
    }
  }
  return model;
}

MultiPatch SwapDirections(MultiPatch model, int direction1, int direction2)
{
  CheckWhole(model);
  for (Patch& patch : model.Patches)
  {
    patch.Body = Apply(patch.Body,
      [=](const Spline& spline) { return SwapDirections(spline, direction1, direction2); });
  }
  const auto other = [=](int direction) {
    return direction == direction1 ? direction2 : direction == direction2 ? direction1 : direction;
  };
  for (Interface& item : model.Interfaces)
  {
    const std::array<int, 10> old = item.Values;
    for (const std::size_t side : { 1U, 3U })
    {
      item.Values[side] = 2 * other((old[side] - 1) / 2) + (old[side] - 1) % 2 + 1;
    }
    for (int d = 0; d < 3; ++d)
    {
      item.Values[Index(4 + other(d))] = other(old[Index(4 + d)]);
      item.Values[Index(7 + other(d))] = old[Index(7 + d)];
    }
  }
  for (Boundary& boundary : model.Boundaries)
  {
    for (std::array<int, 2>& side : boundary.Sides)
    {
      side[1] = 2 * other(side[1] / 2) + side[1] % 2;
    }
  }
  return model;
}

std::vector<Spline> MakeCompatible(const std::vector<Spline>& splines)
{
  if (splines.empty())
  {
    throw Error("there are no splines to make compatible");
  }
  bool rational = false;
  for (const Spline& spline : splines)
  {
    rational = rational || spline.IsRational();
    if (spline.Components() != splines[0].Components())
    {
      throw Error("one has " + std::to_string(splines[0].Components()) +
        " components where another has " + std::to_string(spline.Components()));
    }
  }
  std::vector<Spline> result;
  for (const Spline& spline : splines)
  {
    Spline clamped = Clamp(spline);
    if (rational && !spline.IsRational())
    {
      clamped = Spline(clamped.Knots(), clamped.Coefficients(),
        Eigen::VectorXd::Ones(clamped.NumberOfControlPoints()));
    }
    result.push_back(std::move(clamped));
  }
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector first = result[0].Knots(d);
    int degree = 0;
    for (Spline& spline : result)
    {
      const KnotVector& own = spline.Knots(d);
      degree = std::max(degree, own.Degree());
      if (own.First() != first.First() || own.Last() != first.Last())
      {
        spline = ScaleDomain(spline, d, first.First(), first.Last());
      }
    }
    const std::vector<double> breaks = CommonBreaks(result, d);
    std::vector<int> multiplicities(breaks.size(), 0);
    for (Spline& spline : result)
    {
      spline = ElevateDegree(SnapKnots(spline, d, breaks), d, degree - spline.Knots(d).Degree());
      for (std::size_t i = 0; i < breaks.size(); ++i)
      {
        multiplicities[i] = std::max(multiplicities[i], spline.Knots(d).Multiplicity(breaks[i]));
      }
    }
    for (Spline& spline : result)
    {
      std::vector<double> missing;
      for (std::size_t i = 0; i < breaks.size(); ++i)
      {
        missing.insert(missing.end(),
          Index(multiplicities[i] - spline.Knots(d).Multiplicity(breaks[i])), breaks[i]);
      }
      spline = InsertKnots(spline, d, missing);
    }
  }
  return result;
}

}
