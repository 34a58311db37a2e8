// SPDX-License-Identifier: BSD-3-Clause
#include "CollapsedSidesWorker.h"

#include "Operators.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hyperpatch
{

namespace
{

/// A side or an edge, as the sides that it lies in, and a direction along which it is collapsed.
struct Collapse
{
  unsigned Sides;
  int Direction;
};

unsigned EndsOf(int direction)
{
  return 3u << (2 * direction);
}

/// Both are sides of a cell that does not reach from one end of the domain to the other.
bool MayMeet(unsigned a, unsigned b)
{
  for (int d = 0; d < 3; ++d)
  {
    const unsigned both = (a | b) & EndsOf(d);
    if (both == EndsOf(d))
    {
      return false;
    }
  }
  return true;
}

bool IsConstantAlong(const Spline& part, int direction, double distance)
{
  const auto sizes = part.Sizes();
  Eigen::Index stride = 1;
  for (int d = 0; d < direction; ++d)
  {
    stride *= sizes[static_cast<std::size_t>(d)];
  }
  const auto size = static_cast<Eigen::Index>(sizes[static_cast<std::size_t>(direction)]);
  const auto points = part.Coefficients();
  const auto first = [&](Eigen::Index i) { return i - i / stride % size * stride; };
  bool isPoint = true;
  bool isConstant = true;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    isPoint = isPoint && (points.col(i) - points.col(0)).norm() <= distance;
    isConstant = isConstant && (points.col(i) - points.col(first(i))).norm() <= distance;
  }
  // Weights move points along the rest, unless they have the same ratios all along.
  constexpr double Same = 1e-9;
  for (Eigen::Index i = 0; i < points.cols() && part.IsRational() && isConstant && !isPoint; ++i)
  {
    const auto& w = part.Weights();
    const double own = w[i] * w[0];
    const double other = w[first(i)] * w[i - first(i)];
    isConstant = std::abs(own - other) <= Same * std::abs(own);
  }
  return isConstant;
}

}

CollapsedSides::CollapsedSides(const Spline& geometry, double distance)
{
  std::vector<Collapse> all;
  for (int d = 0; d < 3; ++d)
  {
    this->Low[d] = geometry.Knots(d).First();
    this->High[d] = geometry.Knots(d).Last();
  }
  const auto isThere = [&geometry](int d) { return geometry.Knots(d).Degree() > 0; };
  const auto isKnown = [&all](unsigned sides, int d)
  {
    return std::any_of(all.begin(), all.end(),
      [&](const Collapse& c) { return c.Direction == d && (c.Sides & sides) == c.Sides; });
  };
  const auto add = [&](const Spline& part, unsigned sides)
  {
    for (int d = 0; d < 3; ++d)
    {
      // Two parts that meet and are collapsed across each other are one point in the shape of an L:
      // no product, and left alone.
      const bool isCrossed = std::any_of(all.begin(), all.end(),
        [&](const Collapse& c)
        {
          return (c.Sides & EndsOf(d)) != 0 && (sides & EndsOf(c.Direction)) != 0 &&
            MayMeet(c.Sides, sides);
        });
      if (isThere(d) && !(sides & EndsOf(d)) && !isKnown(sides, d) && !isCrossed &&
        IsConstantAlong(part, d, distance))
      {
        all.push_back({ sides, d });
      }
    }
  };
  std::vector<Spline> faces;
  for (int side = 0; side < NumberOfSides; ++side)
  {
    faces.push_back(isThere(side / 2) ? ExtractFace(geometry, side) : geometry);
    if (isThere(side / 2))
    {
      add(faces.back(), 1u << side);
    }
  }
  for (int a = 0; a < NumberOfSides; ++a)
  {
    for (int b = a / 2 * 2 + 2; b < NumberOfSides; ++b)
    {
      if (isThere(a / 2) && isThere(b / 2))
      {
        add(ExtractFace(faces[static_cast<std::size_t>(a)], b), 1u << a | 1u << b);
      }
    }
  }
  for (unsigned sides = 0; sides < this->Table.size(); ++sides)
  {
    for (const Collapse& c : all)
    {
      this->Table[sides] |=
        static_cast<unsigned char>((sides & c.Sides) == c.Sides ? 1u << c.Direction : 0u);
    }
  }
}

unsigned CollapsedSides::SidesOf(const Eigen::Vector3d& u) const
{
  unsigned sides = 0;
  for (int d = 0; d < 3; ++d)
  {
    sides |= u[d] == this->Low[d] ? 1u << (2 * d) : 0;
    sides |= u[d] == this->High[d] ? 2u << (2 * d) : 0;
  }
  const unsigned free = this->Free(sides);
  for (int d = 0; free >> d != 0; ++d)
  {
    sides |= free >> d & 1 ? EndsOf(d) : 0;
  }
  return sides;
}

bool CollapsedSides::NeedsMiddle(int direction) const
{
  unsigned low = 0;
  unsigned high = 0;
  for (unsigned sides = 0; sides < this->Table.size(); ++sides)
  {
    // What these sides add to the others.
    const unsigned others = sides & ~EndsOf(direction);
    const unsigned added = this->Table[sides] & ~this->Table[others];
    const unsigned end = sides >> (2 * direction) & 3;
    low |= end == 1 ? added : 0;
    high |= end == 2 ? added : 0;
  }
  return (low & high) != 0;
}

}
