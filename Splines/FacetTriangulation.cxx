// SPDX-License-Identifier: BSD-3-Clause
#include "FacetTriangulation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace hyperpatch
{

namespace
{

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
  return a[0] * b[1] - a[1] * b[0];
}

/// Positive where d is inside the circle through a, b, c (counter-clockwise), by more than
/// round-off.
bool IsInCircle(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
  const Eigen::Vector2d& d)
{
  const Eigen::Vector2d p = a - d;
  const Eigen::Vector2d q = b - d;
  const Eigen::Vector2d r = c - d;
  const double pp = p.squaredNorm();
  const double qq = q.squaredNorm();
  const double rr = r.squaredNorm();
  const double determinant = pp * Cross(q, r) + qq * Cross(r, p) + rr * Cross(p, q);
  const double largest = std::max({ pp, qq, rr });
  return determinant > 1e-10 * largest * largest;
}

int Next(int corner)
{
  return corner == 2 ? 0 : corner + 1;
}

}

double FacetTriangulation::Area(int a, int b, int c) const
{
  const Eigen::Vector2d& origin = this->X[static_cast<std::size_t>(a)];
  return Cross(
    this->X[static_cast<std::size_t>(b)] - origin, this->X[static_cast<std::size_t>(c)] - origin);
}

bool FacetTriangulation::Start(const std::vector<Eigen::Vector2d>& polygon)
{
  this->X = polygon;
  this->T.clear();
  this->N.clear();
  this->Stack.clear();
  this->Last = 0;
  const int n = static_cast<int>(polygon.size());
  if (n < 3)
  {
    return false;
  }
  this->Ring.resize(static_cast<std::size_t>(n));
  std::iota(this->Ring.begin(), this->Ring.end(), 0);
  this->Behind.assign(static_cast<std::size_t>(n), -1);
  const auto ring = [this](int i) { return this->Ring[static_cast<std::size_t>(i)]; };
  const auto behind = [this](int i) -> int& { return this->Behind[static_cast<std::size_t>(i)]; };
  const auto connect = [this](int triangle, int corner, int edge)
  {
    const auto t = static_cast<std::size_t>(triangle);
    this->N[t][static_cast<std::size_t>(corner)] = edge < 0 ? -1 : edge / 3;
    if (edge >= 0)
    {
      this->N[static_cast<std::size_t>(edge / 3)][static_cast<std::size_t>(edge % 3)] = triangle;
      this->Stack.push_back({ triangle, corner });
    }
  };
  int start = 0;
  for (int size = n; size > 3; --size)
  {
    int ear = -1;
    for (int tried = 0; tried < size && ear < 0; ++tried)
    {
      const int i = (start + tried) % size;
      const int a = ring((i + size - 1) % size);
      const int b = ring(i);
      const int c = ring((i + 1) % size);
      ear = this->Area(a, b, c) > 0.0 ? i : -1;
      for (int j = 0; j < size && ear >= 0; ++j)
      {
        const int p = ring(j);
        if (p != a && p != b && p != c && this->Area(a, b, p) >= 0.0 &&
          this->Area(b, c, p) >= 0.0 && this->Area(c, a, p) >= 0.0)
        {
          ear = -1;
        }
      }
    }
    if (ear < 0)
    {
      return false;
    }
    const int before = (ear + size - 1) % size;
    const int triangle = static_cast<int>(this->T.size());
    this->T.push_back({ ring(before), ring(ear), ring((ear + 1) % size) });
    this->N.push_back({ -1, -1, -1 });
    connect(triangle, 2, behind(before));
    connect(triangle, 0, behind(ear));
    behind(before) = 3 * triangle + 1;
    this->Ring.erase(this->Ring.begin() + ear);
    this->Behind.erase(this->Behind.begin() + ear);
    // Not at the same place again: ears all around make better triangles than a fan.
    start = ear + 1;
  }
  if (this->Area(ring(0), ring(1), ring(2)) <= 0.0)
  {
    return false;
  }
  const int triangle = static_cast<int>(this->T.size());
  this->T.push_back({ ring(0), ring(1), ring(2) });
  this->N.push_back({ -1, -1, -1 });
  connect(triangle, 2, behind(0));
  connect(triangle, 0, behind(1));
  connect(triangle, 1, behind(2));
  this->Legalise();
  return true;
}

void FacetTriangulation::Link(int triangle, int corner, int neighbor, int old)
{
  this->N[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(corner)] = neighbor;
  if (neighbor >= 0)
  {
    auto& back = this->N[static_cast<std::size_t>(neighbor)];
    *std::find(back.begin(), back.end(), old) = triangle;
  }
}

void FacetTriangulation::Flip(int triangle, int corner)
{
  const auto t = static_cast<std::size_t>(triangle);
  const int other = this->N[t][static_cast<std::size_t>(corner)];
  const auto o = static_cast<std::size_t>(other);
  const int opposite = static_cast<int>(
    std::find(this->N[o].begin(), this->N[o].end(), triangle) - this->N[o].begin());
  const int i1 = Next(corner);
  const int i2 = Next(i1);
  const int j1 = Next(opposite);
  const int j2 = Next(j1);
  const auto at = [](const std::array<int, 3>& list, int i)
  { return list[static_cast<std::size_t>(i)]; };
  // The quadrilateral a b d c with diagonal b c becomes one with diagonal a d.
  const int a = at(this->T[t], corner);
  const int b = at(this->T[t], i1);
  const int c = at(this->T[t], i2);
  const int d = at(this->T[o], opposite);
  const int ac = at(this->N[t], i1);
  const int ab = at(this->N[t], i2);
  // In the other triangle j1 is c and j2 is b.
  const int bd = at(this->N[o], j1);
  const int cd = at(this->N[o], j2);
  this->T[t] = { a, b, d };
  this->T[o] = { a, d, c };
  this->N[t] = { -1, other, -1 };
  this->N[o] = { -1, -1, triangle };
  this->Link(triangle, 0, bd, other);
  this->Link(triangle, 2, ab, triangle);
  this->Link(other, 0, cd, other);
  this->Link(other, 1, ac, triangle);
  this->Stack.push_back({ triangle, 0 });
  this->Stack.push_back({ triangle, 2 });
  this->Stack.push_back({ other, 0 });
  this->Stack.push_back({ other, 1 });
}

void FacetTriangulation::Legalise()
{
  // Round-off must not make two diagonals flip for ever.
  std::size_t left = 64 + 16 * this->T.size() * this->T.size();
  while (!this->Stack.empty())
  {
    const auto [triangle, corner] = this->Stack.back();
    this->Stack.pop_back();
    const auto t = static_cast<std::size_t>(triangle);
    const int other = this->N[t][static_cast<std::size_t>(corner)];
    if (other < 0 || left-- == 0)
    {
      continue;
    }
    const auto o = static_cast<std::size_t>(other);
    const auto opposite = static_cast<std::size_t>(
      std::find(this->N[o].begin(), this->N[o].end(), triangle) - this->N[o].begin());
    const int a = this->T[t][static_cast<std::size_t>(corner)];
    const int b = this->T[t][static_cast<std::size_t>(Next(corner))];
    const int c = this->T[t][static_cast<std::size_t>(Next(Next(corner)))];
    const int d = this->T[o][opposite];
    if (this->Area(a, b, d) > 0.0 && this->Area(a, d, c) > 0.0 &&
      IsInCircle(this->X[static_cast<std::size_t>(a)], this->X[static_cast<std::size_t>(b)],
        this->X[static_cast<std::size_t>(c)], this->X[static_cast<std::size_t>(d)]))
    {
      this->Flip(triangle, corner);
    }
  }
}

int FacetTriangulation::Insert(const Eigen::Vector2d& point)
{
  const auto corner = [this](int triangle, int i) -> const Eigen::Vector2d&
  {
    return this->X[static_cast<std::size_t>(
      this->T[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(i)])];
  };
  // Walk towards the point; if the walk is blocked by the polygon, look everywhere.
  int found = -1;
  int at = std::min(this->Last, static_cast<int>(this->T.size()) - 1);
  for (std::size_t steps = 0; steps <= this->T.size() && found < 0; ++steps)
  {
    int way = -1;
    for (int i = 0; i < 3 && way < 0; ++i)
    {
      const Eigen::Vector2d& a = corner(at, Next(i));
      way = Cross(corner(at, Next(Next(i))) - a, point - a) < 0.0 ? i : -1;
    }
    if (way < 0)
    {
      found = at;
      break;
    }
    const int next = this->N[static_cast<std::size_t>(at)][static_cast<std::size_t>(way)];
    if (next < 0)
    {
      break;
    }
    at = next;
  }
  if (found < 0)
  {
    // The one whose edges it is least behind: round-off may put it behind both sides of one.
    double best = -1e-9;
    for (int t = 0; t < static_cast<int>(this->T.size()) && best < 0.0; ++t)
    {
      const double area = Cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
      double least = INFINITY;
      for (int i = 0; i < 3; ++i)
      {
        const Eigen::Vector2d& a = corner(t, Next(i));
        least = std::min(least, Cross(corner(t, Next(Next(i))) - a, point - a) / area);
      }
      if (least > best)
      {
        best = least;
        found = t;
      }
    }
  }
  if (found < 0)
  {
    return -1;
  }
  const auto f = static_cast<std::size_t>(found);
  const Triangle old = this->T[f];
  const std::array<int, 3> neighbors = this->N[f];
  const double area =
    Cross(corner(found, 1) - corner(found, 0), corner(found, 2) - corner(found, 0));
  std::array<double, 3> share{};
  for (int i = 0; i < 3; ++i)
  {
    const Eigen::Vector2d& a = corner(found, Next(i));
    share[static_cast<std::size_t>(i)] = Cross(corner(found, Next(Next(i))) - a, point - a) / area;
  }
  constexpr double Thin = 1e-9;
  if (!(*std::max_element(share.begin(), share.end()) < 1.0 - Thin))
  {
    return -1;
  }
  for (std::size_t i = 0; i < 3; ++i)
  {
    // On an edge of the polygon it would make a triangle without area.
    if (share[i] < Thin && neighbors[i] < 0)
    {
      return -1;
    }
  }
  const int p = static_cast<int>(this->X.size());
  this->X.push_back(point);
  const int second = static_cast<int>(this->T.size());
  const int third = second + 1;
  this->T[f] = { p, old[1], old[2] };
  this->T.push_back({ p, old[2], old[0] });
  this->T.push_back({ p, old[0], old[1] });
  this->N[f] = { neighbors[0], second, third };
  this->N.push_back({ -1, third, found });
  this->N.push_back({ -1, found, second });
  this->Link(second, 0, neighbors[1], found);
  this->Link(third, 0, neighbors[2], found);
  // A point on an inner edge leaves a triangle without area; flipping that edge mends it.
  const std::array<int, 3> triangles{ found, second, third };
  for (std::size_t i = 0; i < 3; ++i)
  {
    if (share[i] < Thin)
    {
      this->Flip(triangles[i], 0);
      break;
    }
  }
  for (const int t : triangles)
  {
    this->Stack.push_back({ t, 0 });
  }
  this->Legalise();
  this->Last = found;
  return p;
}

}
