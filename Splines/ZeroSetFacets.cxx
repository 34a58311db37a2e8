// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hyperpatch
{

namespace
{

/// Where linear interpolation in a triangle is about furthest from a surface whose curvature makes
/// it a Delaunay triangle: the centre of its circle, or the middle of an edge that is in the way.
Eigen::Vector2d WorstPlace(const FacetTriangulation& triangulation, int triangle)
{
  const auto& corners = triangulation.Triangles()[static_cast<std::size_t>(triangle)];
  std::array<Eigen::Vector2d, 3> x;
  for (std::size_t k = 0; k < 3; ++k)
  {
    x[k] = triangulation.Points()[static_cast<std::size_t>(corners[k])];
  }
  std::array<double, 3> square{};
  std::size_t longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
  {
    square[k] = (x[(k + 2) % 3] - x[(k + 1) % 3]).squaredNorm();
    longest = square[k] > square[longest] ? k : longest;
  }
  const std::size_t i = (longest + 1) % 3;
  const std::size_t j = (longest + 2) % 3;
  if (square[longest] >= 0.9 * (square[i] + square[j]))
  {
    return triangulation.IsBoundary(triangle, static_cast<int>(longest))
      ? Eigen::Vector2d((x[0] + x[1] + x[2]) / 3.0)
      : Eigen::Vector2d(0.5 * (x[i] + x[j]));
  }
  std::array<double, 3> weight{};
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k)
  {
    weight[k] = square[k] * (square[(k + 1) % 3] + square[(k + 2) % 3] - square[k]);
    sum += weight[k];
  }
  return (weight[0] * x[0] + weight[1] * x[1] + weight[2] * x[2]) / sum;
}

}

bool ZeroSet::Worker::Fill()
{
  this->Pieces.resize(this->Leaves.size());
  if (this->Axes.size() < 3)
  {
    return true;
  }
  constexpr Index Grain = 8;
  return this->Parallel(static_cast<Index>(this->Leaves.size()), Grain,
    [this](Index begin, Index end)
    {
      Scratch scratch;
      for (Index i = begin; i < end; ++i)
      {
        const auto leaf = static_cast<std::size_t>(i);
        this->FillLeaf(leaf, scratch, this->Pieces[leaf]);
      }
    });
}

void ZeroSet::Worker::FillLeaf(std::size_t number, Scratch& scratch, Facets& facets) const
{
  const Leaf& leaf = this->Leaves[number];
  const bool followed = this->FindLoops(number, scratch);
  if (leaf.Flat != 0)
  {
    this->FindFlatLoops(leaf, scratch.Loops);
  }
  for (std::size_t i = 0; i < scratch.Loops.size() && this->AreLinesTurned; ++i)
  {
    std::reverse(scratch.Loops[i].begin(), scratch.Loops[i].end());
  }
  const std::uint64_t signature = this->SignatureOf(scratch.Loops);
  if (signature != facets.Signature)
  {
    facets = Facets();
    facets.Signature = signature;
    facets.Inner.Resize(*this, 0);
    Index begin = 0;
    for (const std::vector<Index>& loop : scratch.Loops)
    {
      Facets piece;
      this->FillLoop(leaf, loop, scratch, piece);
      this->Add(piece, begin, facets);
      begin += static_cast<Index>(loop.size());
    }
  }
  facets.Loops.clear();
  for (const std::vector<Index>& loop : scratch.Loops)
  {
    facets.Loops.insert(facets.Loops.end(), loop.begin(), loop.end());
  }
  facets.IsWithinTolerance = facets.IsWithinTolerance && followed;
}

void ZeroSet::Worker::FillLoop(
  const Leaf& leaf, const std::vector<Index>& loop, Scratch& scratch, Facets& facets) const
{
  facets.Inner.Resize(*this, 0);
  if (loop.size() < 3 || (leaf.Height >= 0 && this->FillSheet(leaf, loop, scratch, facets)))
  {
    return;
  }
  // No simple polygon seen along the height: nearly upright, or vertices joined across a corner.
  std::vector<FacetTriangulation::Triangle> triangles;
  this->FillPolygon(loop, triangles);
  if (leaf.Height >= 0)
  {
    std::vector<std::pair<int, double>> missing;
    scratch.Measuring.Known.clear();
    this->MeasureFacets(
      triangles, static_cast<int>(loop.size()), loop, {}, true, scratch, facets, missing);
    facets.Failed = missing.empty() ? 0 : 1;
    facets.IsWithinTolerance = missing.empty();
  }
  for (const auto& triangle : triangles)
  {
    facets.Cells.push_back({ triangle[0], triangle[1], triangle[2] });
  }
}

bool ZeroSet::Worker::FillSheet(
  const Leaf& leaf, const std::vector<Index>& loop, Scratch& scratch, Facets& facets) const
{
  Eigen::Vector3d low = this->Shared.Parameters.col(loop[0]);
  Eigen::Vector3d high = low;
  for (const Index i : loop)
  {
    low = low.cwiseMin(this->Shared.Parameters.col(i));
    high = high.cwiseMax(this->Shared.Parameters.col(i));
  }
  Eigen::Vector3d width = high - low;
  Range heights{ 0.0, 0.0 }; // of points of the sheet
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    const double a = this->Line(d, leaf.At.Low[D]);
    const double b = this->Line(d, leaf.At.Low[D] + leaf.At.Size);
    const double box = std::abs(b - a);
    width[d] = std::max(width[d], 1e-3 * box);
    if (d == leaf.Height)
    {
      // Outside a curve, but inside its chords, the sheet is beyond the ends of the box.
      heights.Low = std::max(std::min({ a, b, low[d] }) - box, this->Low[d]);
      heights.High = std::min(std::max({ a, b, high[d] }) + box, this->High[d]);
    }
  }
  // Few corners may do as they are.
  constexpr std::size_t Few = 12;
  if (loop.size() <= Few)
  {
    Shape flat;
    flat.Axis = leaf.Height;
    flat.A = (leaf.Height + 1) % 3;
    flat.B = (leaf.Height + 2) % 3;
    flat.Centre = 0.5 * (low + high);
    flat.Slope.setZero();
    flat.Bend.setZero();
    flat.Metric.setZero();
    flat.Heights = heights;
    Facets piece;
    const double error =
      this->FillSheet(flat, leaf.Rises ? 1.0 : -1.0, 1.0, JustOnce, width, loop, scratch, piece);
    if (error >= 0.0 && error <= Accepted)
    {
      facets = std::move(piece);
      return true;
    }
  }
  std::optional<Shape> shape = this->Probe(0.5 * (low + high), width, leaf.Height);
  if (!shape)
  {
    return false;
  }
  shape->Heights = heights;
  // Counter-clockwise around the normal is counter-clockwise in (a, b) where f grows with height.
  const double turn = leaf.Rises ? 1.0 : -1.0;
  // Denser where the metric turns out to be too coarse for some place.
  constexpr int Tries = 3;
  double density = 1.0;
  for (int tried = 0; tried < Tries; ++tried)
  {
    Facets piece;
    const Effort effort = tried + 1 < Tries ? UntilMostMiss : Full;
    const double error =
      this->FillSheet(*shape, turn, density, effort, width, loop, scratch, piece);
    if (error < 0.0)
    {
      return false;
    }
    if (!piece.Cells.empty())
    {
      piece.IsWithinTolerance = error <= 1.0;
      facets = std::move(piece);
      break;
    }
    density *= 1.1 * error;
  }
  return true;
}

double ZeroSet::Worker::FillSheet(const Shape& shape, double turn, double density, Effort effort,
  const Eigen::Vector3d& width, const std::vector<Index>& loop, Scratch& scratch,
  Facets& facets) const
{
  facets.Inner.Resize(*this, 0);
  const int w = shape.Axis;
  // In the metric, with a floor: no edge longer than a few widths of the loop.
  Eigen::Matrix2d metric = density * shape.Metric;
  metric(0, 0) += 0.01 / (width[shape.A] * width[shape.A]);
  metric(1, 1) += 0.01 / (width[shape.B] * width[shape.B]);
  const Eigen::Matrix2d U = Eigen::LLT<Eigen::Matrix2d>(metric).matrixU();
  const Eigen::Matrix2d inverse = U.inverse();
  const auto flat = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d
  {
    const Eigen::Vector2d d(p[shape.A] - shape.Centre[shape.A], p[shape.B] - shape.Centre[shape.B]);
    const Eigen::Vector2d y = U * d;
    return { turn * y[0], y[1] };
  };
  scratch.Polygon.clear();
  Eigen::Vector2d least(INFINITY, INFINITY);
  Eigen::Vector2d most = -least;
  for (const Index i : loop)
  {
    scratch.Polygon.push_back(flat(this->Shared.Parameters.col(i)));
    least = least.cwiseMin(scratch.Polygon.back());
    most = most.cwiseMax(scratch.Polygon.back());
  }
  FacetTriangulation& triangulation = scratch.Triangulation;
  if (!triangulation.Start(scratch.Polygon))
  {
    return -1.0;
  }

  // Inner points on a lattice of equilateral triangles, not too near to the boundary.
  constexpr double Spacing = 1.0;
  constexpr double Clearance = 0.6;
  const double rowHeight = Spacing * std::sqrt(0.75);
  scratch.Candidates.clear();
  const Eigen::Vector2d middle = 0.5 * (least + most);
  // A metric that asks for more is wrong: it was taken where the sheet stands nearly upright.
  constexpr double MostCandidates = 4000.0;
  if (!((most[0] - least[0]) * (most[1] - least[1]) <= MostCandidates * rowHeight * Spacing))
  {
    return -1.0;
  }
  const int rows = static_cast<int>(0.5 * (most[1] - least[1]) / rowHeight);
  for (int r = -rows; r <= rows; ++r)
  {
    const double y = middle[1] + r * rowHeight;
    const double shift = r % 2 != 0 ? 0.5 * Spacing : 0.0;
    const int columns = static_cast<int>(0.5 * (most[0] - least[0]) / Spacing) + 1;
    for (int c = -columns; c <= columns; ++c)
    {
      const Eigen::Vector2d p(middle[0] + shift + c * Spacing, y);
      bool inside = false;
      bool clear = true;
      for (std::size_t i = 0, j = scratch.Polygon.size() - 1; i < scratch.Polygon.size() && clear;
           j = i++)
      {
        const Eigen::Vector2d& a = scratch.Polygon[j];
        const Eigen::Vector2d& b = scratch.Polygon[i];
        if ((a[1] > p[1]) != (b[1] > p[1]) &&
          p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0])
        {
          inside = !inside;
        }
        const Eigen::Vector2d ab = b - a;
        const double square = ab.squaredNorm();
        const double t =
          square > 0.0 ? std::min(1.0, std::max(0.0, (p - a).dot(ab) / square)) : 0.0;
        clear = (a + t * ab - p).squaredNorm() > Clearance * Clearance;
      }
      if (inside && clear)
      {
        scratch.Candidates.push_back(p);
      }
    }
  }

  const auto boundary = static_cast<int>(loop.size());
  std::vector<Index> innerOf; // of points of the triangulation behind the polygon's
  const auto insert = [&]
  {
    const auto count = static_cast<Index>(scratch.Candidates.size());
    if (count == 0)
    {
      return;
    }
    scratch.Parameters.resize(3, count);
    for (Index i = 0; i < count; ++i)
    {
      const Eigen::Vector2d& y = scratch.Candidates[static_cast<std::size_t>(i)];
      const Eigen::Vector2d d = inverse * Eigen::Vector2d(turn * y[0], y[1]);
      scratch.Parameters(shape.A, i) = shape.Centre[shape.A] + d[0];
      scratch.Parameters(shape.B, i) = shape.Centre[shape.B] + d[1];
      scratch.Parameters(w, i) = shape.Centre[w] + shape.Slope.dot(d) + 0.5 * d.dot(shape.Bend * d);
    }
    scratch.Axes.assign(static_cast<std::size_t>(count), w);
    this->Project(scratch.Parameters, scratch.Axes, shape.Heights, scratch.Projected);
    const Index before = facets.Inner.Count();
    Index at = before;
    facets.Inner.Resize(*this, before + count);
    for (Index i = 0; i < count; ++i)
    {
      if (scratch.Projected[static_cast<std::size_t>(i)] != 0 &&
        triangulation.Insert(scratch.Candidates[static_cast<std::size_t>(i)]) >= 0)
      {
        innerOf.push_back(at);
        facets.Inner.Parameters.col(at++) = scratch.Parameters.col(i);
      }
    }
    facets.Inner.Resize(*this, at);
    this->Evaluate(facets.Inner, before, at);
  };
  insert();

  // Triangles that miss it get a point where they are worst; if they are most, the metric is wrong.
  constexpr int Rounds = 8;
  double worst = 0.0;
  std::vector<std::pair<int, double>> missing;
  scratch.Measuring.Known.clear();
  for (int round = 0; round < Rounds; ++round)
  {
    missing.clear();
    worst = this->MeasureFacets(triangulation.Triangles(), boundary, loop, innerOf,
      round + 1 == Rounds, scratch, facets, missing);
    const std::size_t all = triangulation.Triangles().size();
    if (missing.empty() || round + 1 == Rounds)
    {
      break;
    }
    if (effort == JustOnce || (effort == UntilMostMiss && all > 16 && 2 * missing.size() > all))
    {
      double sum = 0.0;
      for (const auto& miss : missing)
      {
        sum += miss.second;
      }
      return std::min(4.0, sum / static_cast<double>(missing.size()));
    }
    scratch.Candidates.clear();
    for (const auto& miss : missing)
    {
      scratch.Candidates.push_back(WorstPlace(triangulation, miss.first));
    }
    insert();
  }
  for (const auto& triangle : triangulation.Triangles())
  {
    std::array<Index, 3> cell{};
    for (std::size_t k = 0; k < 3; ++k)
    {
      const int corner = triangle[k];
      cell[k] =
        corner < boundary ? corner : -1 - innerOf[static_cast<std::size_t>(corner - boundary)];
    }
    facets.Cells.push_back(cell);
  }
  return worst;
}

void ZeroSet::Worker::FillPolygon(
  const std::vector<Index>& loop, std::vector<FacetTriangulation::Triangle>& triangles) const
{
  // The triangulation of least area (Klincsek 1980); a fan where that would take long.
  constexpr std::size_t Most = 160;
  const std::size_t n = loop.size();
  if (n > Most)
  {
    for (std::size_t i = 2; i < n; ++i)
    {
      triangles.push_back({ 0, static_cast<int>(i) - 1, static_cast<int>(i) });
    }
    return;
  }
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(static_cast<Index>(n), static_cast<Index>(n));
  Eigen::MatrixXi apex = Eigen::MatrixXi::Zero(static_cast<Index>(n), static_cast<Index>(n));
  const auto point = [&](Index i) -> Eigen::Vector3d
  { return this->Shared.Points.col(loop[static_cast<std::size_t>(i)]); };
  const auto end = static_cast<Index>(n);
  for (Index length = 2; length < end; ++length)
  {
    for (Index i = 0; i + length < end; ++i)
    {
      const Index j = i + length;
      cost(i, j) = INFINITY;
      for (Index k = i + 1; k < j; ++k)
      {
        const double area = (point(k) - point(i)).cross(point(j) - point(i)).norm();
        const double sum = cost(i, k) + cost(k, j) + area;
        if (sum < cost(i, j))
        {
          cost(i, j) = sum;
          apex(i, j) = static_cast<int>(k);
        }
      }
    }
  }
  std::vector<std::array<Index, 2>> open{ { 0, end - 1 } };
  while (!open.empty())
  {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i > 1)
    {
      const Index k = apex(i, j);
      triangles.push_back({ static_cast<int>(i), static_cast<int>(k), static_cast<int>(j) });
      open.push_back({ i, k });
      open.push_back({ k, j });
    }
  }
}

void ZeroSet::Worker::Add(const Facets& piece, Index begin, Facets& facets) const
{
  const Index inner = facets.Inner.Count();
  facets.Inner.Resize(*this, inner + piece.Inner.Count());
  this->Copy(piece.Inner, 0, facets.Inner, inner, piece.Inner.Count());
  for (const auto& cell : piece.Cells)
  {
    auto& added = facets.Cells.emplace_back(cell);
    for (Index& corner : added)
    {
      corner += corner < 0 ? -inner : begin;
    }
  }
  facets.Error = std::max(facets.Error, piece.Error);
  facets.AttributeError = std::max(facets.AttributeError, piece.AttributeError);
  facets.Failed += piece.Failed;
  facets.IsWithinTolerance = facets.IsWithinTolerance && piece.IsWithinTolerance;
}

std::uint64_t ZeroSet::Worker::SignatureOf(const std::vector<std::vector<Index>>& loops) const
{
  std::uint64_t signature = loops.size() + 1;
  const auto add = [&signature](double x)
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof(bits));
    signature = (signature ^ bits) * 0x9E3779B97F4A7C15u;
    signature ^= signature >> 29;
  };
  for (const std::vector<Index>& loop : loops)
  {
    add(static_cast<double>(loop.size()));
    for (const Index i : loop)
    {
      for (int d = 0; d < 3; ++d)
      {
        add(this->Shared.Parameters(d, i));
        add(this->Shared.Points(d, i));
      }
    }
  }
  return signature;
}

}
