// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianCrease.h"

#include "Error.h"
#include "JacobianCreaseWorker.h"
#include "JacobianSign.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace hyperpatch
{

namespace
{

/// The sign that all coefficients certainly have, or 0.
int SignOf(const Bernstein& f)
{
  return f.Min() > f.RoundingBound() ? 1 : f.Max() < -f.RoundingBound() ? -1 : 0;
}

/// Zero to rounding: then the plane is part of a sheet det J = 0, and there is no jump over 0.
bool IsZero(const Bernstein& f)
{
  return std::max(-f.Min(), f.Max()) <= f.RoundingBound();
}

/// The polynomial on the face at the begin or the end of a direction.
Bernstein OnFace(const Bernstein& f, std::size_t direction, bool atEnd)
{
  std::array<int, 3> degrees = f.Degrees();
  Eigen::Index step = 1;
  for (std::size_t d = 0; d < direction; ++d)
  {
    step *= degrees[d] + 1;
  }
  const Eigen::Index count = degrees[direction] + 1;
  degrees[direction] = 0;
  Eigen::VectorXd face(f.Coefficients().size() / count);
  for (Eigen::Index i = 0; i < face.size(); ++i)
  {
    face[i] = f.Coefficients()[i % step + step * ((atEnd ? count - 1 : 0) + count * (i / step))];
  }
  return Bernstein(degrees, face, f.RoundingBound());
}

/// True if g is f times a positive number, to rounding: the map turns nowhere at the plane, only
/// its speed may jump, and both vanish together.
bool IsProportional(const Bernstein& f, const Bernstein& g)
{
  Eigen::Index largest = 0;
  f.Coefficients().cwiseAbs().maxCoeff(&largest);
  const double ratio = g.Coefficients()[largest] / f.Coefficients()[largest];
  return ratio > 0.0 &&
    (g.Coefficients() - ratio * f.Coefficients()).cwiseAbs().maxCoeff() <=
    2.0 * (g.RoundingBound() + ratio * f.RoundingBound());
}

/// Zeros of both determinants on an edge are one if they are nearer than this part of it.
constexpr double Coincidence = 1e-11;

}

JacobianCrease JacobianCreaseExtraction::Make()
{
  const std::size_t nb = this->Below.Knots()[this->B].Spans().size();
  const std::size_t nc = this->Below.Knots()[this->C].Spans().size();
  this->Breaks = { this->Below.Knots()[this->B].Breaks(), this->Below.Knots()[this->C].Breaks() };
  this->AddElements({ 0, 0 }, { nb, nc });
  this->Fill();
  this->Measure();
  return std::move(this->Result);
}

double JacobianCreaseExtraction::Line(int axis, std::size_t element, int line) const
{
  const std::vector<double>& breaks = this->Breaks[static_cast<std::size_t>(axis)];
  const double t = static_cast<double>(line) / this->N;
  return line == this->N ? breaks[element + 1]
                         : breaks[element] + t * (breaks[element + 1] - breaks[element]);
}

void JacobianCreaseExtraction::AddElements(
  const std::array<std::size_t, 2>& begin, const std::array<std::size_t, 2>& end)
{
  const double at = this->Below.Knots()[this->D].Last();
  ParameterBox low{};
  ParameterBox high{};
  low.Low[this->D] = this->Below.Knots()[this->D].Breaks().rbegin()[1];
  low.High[this->D] = high.Low[this->D] = at;
  high.High[this->D] = this->Above.Knots()[this->D].Breaks()[1];
  for (std::size_t a = 0; a < 2; ++a)
  {
    const std::size_t d = a == 0 ? this->B : this->C;
    low.Low[d] = high.Low[d] = this->Breaks[a][begin[a]];
    low.High[d] = high.High[d] = this->Breaks[a][end[a]];
  }
  const int sign = JacobianSign(this->Below, low);
  if (sign != 0 && sign == JacobianSign(this->Above, high))
  {
    return;
  }
  const std::size_t wide = end[0] - begin[0] >= end[1] - begin[1] ? 0 : 1;
  if (end[wide] - begin[wide] > 1)
  {
    std::array<std::size_t, 2> middle = end;
    middle[wide] = (begin[wide] + end[wide]) / 2;
    this->AddElements(begin, middle);
    std::array<std::size_t, 2> second = begin;
    second[wide] = middle[wide];
    this->AddElements(second, end);
    return;
  }
  this->Element = begin;
  const std::array<Bernstein, 2> f{ OnFace(*this->Sides[0].OnBox(low), this->D, true),
    OnFace(*this->Sides[1].OnBox(high), this->D, false) };
  if (!IsZero(f[0]) && !IsZero(f[1]) && !IsProportional(f[0], f[1]))
  {
    this->Search({ 0, 0, this->N }, f);
  }
}

void JacobianCreaseExtraction::Search(const Block& block, const std::array<Bernstein, 2>& f)
{
  const int below = SignOf(f[0]);
  const int above = SignOf(f[1]);
  if (below != 0 && above != 0)
  {
    for (int c = block.C; below != above && c < block.C + block.Size; ++c)
    {
      for (int b = block.B; b < block.B + block.Size; ++b)
      {
        this->AddCell(b, c, true);
      }
    }
    return;
  }
  if (block.Size == 1)
  {
    this->AddCell(block.B, block.C, false);
    return;
  }
  const auto direction = [](std::size_t d) { return static_cast<int>(d); };
  const std::array<std::array<Bernstein, 2>, 2> byB{ f[0].Split(direction(this->B)),
    f[1].Split(direction(this->B)) };
  const int half = block.Size / 2;
  for (std::size_t b = 0; b < 2; ++b)
  {
    const std::array<std::array<Bernstein, 2>, 2> byC{ byB[0][b].Split(direction(this->C)),
      byB[1][b].Split(direction(this->C)) };
    for (std::size_t c = 0; c < 2; ++c)
    {
      this->Search(
        { block.B + (b ? half : 0), block.C + (c ? half : 0), half }, { byC[0][c], byC[1][c] });
    }
  }
}

JacobianCreaseExtraction::Index JacobianCreaseExtraction::AddVertex(
  const Parameter& at, std::array<bool, 2> isRoot)
{
  const auto [found, isNew] = this->VertexAt.emplace(at, static_cast<Index>(this->V.size()));
  if (isNew)
  {
    Vertex vertex{ at, {}, isRoot };
    for (std::size_t side = 0; side < 2; ++side)
    {
      vertex.Values[side] = this->Value(side, at);
      vertex.IsRoot[side] = isRoot[side] || vertex.Values[side] == 0.0;
    }
    this->V.push_back(vertex);
  }
  return found->second;
}

double JacobianCreaseExtraction::Value(std::size_t side, const Parameter& at) const
{
  double value = 0.0;
  this->Sides[side].Evaluate(1, at.data(), &value);
  return value;
}

void JacobianCreaseExtraction::AddCell(int b, int c, bool isDecided)
{
  std::array<Index, 4> corners{};
  for (int i = 0; i < 4; ++i)
  {
    Parameter at{};
    at[this->D] = this->Below.Knots()[this->D].Last();
    at[this->B] = this->Line(0, this->Element[0], b + (i == 1 || i == 2 ? 1 : 0));
    at[this->C] = this->Line(1, this->Element[1], c + (i > 1 ? 1 : 0));
    corners[static_cast<std::size_t>(i)] = this->AddVertex(at, {});
  }
  std::size_t pieces = 0;
  for (const bool isPositiveBelow : { true, false })
  {
    for (const Triangle& half : { Triangle{ corners[0], corners[1], corners[2] },
           Triangle{ corners[0], corners[2], corners[3] } })
    {
      std::vector<Index> polygon(half.begin(), half.end());
      polygon = this->Clip(polygon, 0, isPositiveBelow);
      polygon = this->Clip(polygon, 1, !isPositiveBelow);
      for (std::size_t i = 1; i + 1 < polygon.size(); ++i, ++pieces)
      {
        this->Pieces[isPositiveBelow ? 0 : 1].push_back(
          { { polygon[0], polygon[i], polygon[i + 1] }, this->Element });
      }
    }
  }
  if (isDecided || pieces > 0)
  {
    return;
  }
  ++this->Result.UndecidedCells;
  // Where both change their signs together no finer grid tells more.
  if (this->ChangesSign(corners, 0) && this->ChangesSign(corners, 1))
  {
    return;
  }
  const Eigen::Vector3d diagonal = this->Position(corners[2]) - this->Position(corners[0]);
  this->Result.HasWideUndecidedCells =
    this->Result.HasWideUndecidedCells || diagonal.norm() > this->FeatureSize;
}

bool JacobianCreaseExtraction::ChangesSign(
  const std::array<Index, 4>& corners, std::size_t side) const
{
  bool positive = false;
  bool negative = false;
  for (const Index corner : corners)
  {
    const double value = this->V[static_cast<std::size_t>(corner)].Values[side];
    positive = positive || value > 0.0;
    negative = negative || value < 0.0;
  }
  return positive && negative;
}

Eigen::Vector3d JacobianCreaseExtraction::Position(Index vertex) const
{
  Eigen::Vector3d point;
  this->Geometry.Evaluate(1, this->V[static_cast<std::size_t>(vertex)].At.data(), point.data());
  return point;
}

std::vector<JacobianCreaseExtraction::Index> JacobianCreaseExtraction::Clip(
  const std::vector<Index>& polygon, std::size_t side, bool positive)
{
  std::vector<Index> inside;
  const auto isIn = [&](Index vertex)
  {
    const double value = this->V[static_cast<std::size_t>(vertex)].Values[side];
    return !this->V[static_cast<std::size_t>(vertex)].IsRoot[side] &&
      (positive ? value > 0.0 : value < 0.0);
  };
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Index from = polygon[i];
    const Index to = polygon[(i + 1) % polygon.size()];
    if (isIn(from))
    {
      inside.push_back(from);
    }
    else if (this->V[static_cast<std::size_t>(from)].IsRoot[side])
    {
      // On the border; it stays if the polygon goes on inside.
      const Index before = polygon[(i + polygon.size() - 1) % polygon.size()];
      if (isIn(before) || isIn(to))
      {
        inside.push_back(from);
      }
    }
    const auto isRoot = [&](Index v) { return this->V[static_cast<std::size_t>(v)].IsRoot[side]; };
    if (isIn(from) != isIn(to) && !isRoot(from) && !isRoot(to))
    {
      inside.push_back(this->Root(from, to, side));
    }
  }
  return inside.size() > 2 ? inside : std::vector<Index>();
}

JacobianCreaseExtraction::Index JacobianCreaseExtraction::Root(Index a, Index b, std::size_t side)
{
  if (this->V[static_cast<std::size_t>(b)].At < this->V[static_cast<std::size_t>(a)].At)
  {
    std::swap(a, b);
  }
  const auto [found, isNew] = this->RootOn.emplace(std::make_tuple(a, b, side), Index{ 0 });
  if (!isNew)
  {
    return found->second;
  }
  const Vertex low = this->V[static_cast<std::size_t>(a)];
  const Vertex high = this->V[static_cast<std::size_t>(b)];
  const auto at = [&](double t)
  {
    Parameter p = low.At;
    for (std::size_t d = 0; d < 3; ++d)
    {
      p[d] += t * (high.At[d] - low.At[d]);
    }
    return p;
  };
  // Illinois, a bracketed secant method.
  double t0 = 0.0;
  double t1 = 1.0;
  double f0 = low.Values[side];
  double f1 = high.Values[side];
  double t = f0 == 0.0 ? 0.0 : 1.0;
  for (int i = 0; i < 100 && f0 != 0.0 && f1 != 0.0 && t1 - t0 > 1e-16; ++i)
  {
    t = t0 + (t1 - t0) * f0 / (f0 - f1);
    const double f = this->Value(side, at(t));
    if (f == 0.0)
    {
      break;
    }
    if ((f < 0.0) == (f1 < 0.0))
    {
      t1 = t;
      f1 = f;
      f0 *= 0.5;
    }
    else
    {
      t0 = t;
      f0 = f;
      f1 *= 0.5;
    }
  }
  std::array<bool, 2> isRoot = { low.IsRoot[0] && high.IsRoot[0], low.IsRoot[1] && high.IsRoot[1] };
  isRoot[side] = true;
  // Where the map is smooth but for its speed both vanish together: no slivers of round-off.
  const std::size_t other = 1 - side;
  isRoot[other] = isRoot[other] ||
    std::abs(this->Value(other, at(t))) <=
      Coincidence * std::max(std::abs(low.Values[other]), std::abs(high.Values[other]));
  const Index root = this->AddVertex(at(t), isRoot);
  this->V[static_cast<std::size_t>(root)].IsRoot[side] = true;
  found->second = root;
  return root;
}

JacobianCrease ExtractJacobianCrease(
  const Spline& below, const Spline& above, int direction, int subdivision, double featureSize)
{
  if (direction < 0 || direction > 2)
  {
    throw Error("there is no direction " + std::to_string(direction));
  }
  const auto d = static_cast<std::size_t>(direction);
  bool meet = below.Knots()[d].Last() == above.Knots()[d].First();
  for (const std::size_t other : { (d + 1) % 3, (d + 2) % 3 })
  {
    meet = meet && below.Knots()[other].Breaks() == above.Knots()[other].Breaks();
  }
  if (!meet)
  {
    throw Error(
      "the volumes do not meet in a knot plane of direction " + std::string(1, "uvw"[direction]));
  }
  if (subdivision < 1 || (subdivision & (subdivision - 1)) != 0)
  {
    throw Error("a knot plane is divided by a power of two, not by " + std::to_string(subdivision));
  }
  return JacobianCreaseExtraction(below, above, direction, subdivision, featureSize).Make();
}

}
