// SPDX-License-Identifier: BSD-3-Clause
#include "FacetTriangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

using namespace hyperpatch;

namespace
{

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
  return a[0] * b[1] - a[1] * b[0];
}

double AreaOf(const std::vector<Eigen::Vector2d>& polygon)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    sum += 0.5 * Cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  }
  return sum;
}

}

TEST(FacetTriangulation, CoversThePolygonAndIsDelaunayInside)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int seed = 0; seed < 50; ++seed)
  {
    const int corners = 3 + seed % 17;
    std::vector<Eigen::Vector2d> polygon;
    for (int i = 0; i < corners; ++i)
    {
      const double angle = 2.0 * std::acos(-1.0) * i / corners;
      const double radius = 0.3 + 0.7 * unit(random);
      polygon.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    FacetTriangulation t;
    ASSERT_TRUE(t.Start(polygon));
    int inserted = 0;
    for (int i = 0; i < 60; ++i)
    {
      inserted += t.Insert({ 2.0 * unit(random) - 1.0, 2.0 * unit(random) - 1.0 }) >= 0 ? 1 : 0;
    }
    EXPECT_EQ(static_cast<int>(t.Triangles().size()), corners - 2 + 2 * inserted);
    double area = 0.0;
    const auto x = [&t](int i) { return t.Points()[static_cast<std::size_t>(i)]; };
    std::map<std::pair<int, int>, int> opposite; // directed edge -> corner
    for (std::size_t k = 0; k < t.Triangles().size(); ++k)
    {
      const auto& c = t.Triangles()[k];
      const double own = 0.5 * Cross(x(c[1]) - x(c[0]), x(c[2]) - x(c[0]));
      EXPECT_GT(own, 0.0);
      area += own;
      for (std::size_t i = 0; i < 3; ++i)
      {
        EXPECT_TRUE(opposite.insert({ { c[(i + 1) % 3], c[(i + 2) % 3] }, c[i] }).second);
      }
    }
    EXPECT_NEAR(area, AreaOf(polygon), 1e-13);
    for (const auto& [edge, corner] : opposite)
    {
      const auto other = opposite.find({ edge.second, edge.first });
      if (other == opposite.end())
      {
        EXPECT_EQ((edge.first + 1) % corners, edge.second);
        continue;
      }
      // The angles opposite to an inner edge sum to at most pi, unless flipping it is impossible.
      const Eigen::Vector2d a = x(edge.first);
      const Eigen::Vector2d b = x(edge.second);
      const Eigen::Vector2d p = x(corner);
      const Eigen::Vector2d q = x(other->second);
      const auto angle = [&](const Eigen::Vector2d& at)
      { return std::atan2(std::abs(Cross(a - at, b - at)), (a - at).dot(b - at)); };
      const bool convex = Cross(a - p, q - p) > 1e-12 && Cross(q - p, b - p) > 1e-12;
      if (convex)
      {
        EXPECT_LE(angle(p) + angle(q), std::acos(-1.0) + 1e-6);
      }
    }
  }
}

TEST(FacetTriangulation, PointsOnEdgesAreInserted)
{
  FacetTriangulation t;
  ASSERT_TRUE(t.Start({ { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } }));
  EXPECT_GE(t.Insert({ 0.5, 0.5 }), 0); // on the diagonal, whichever it is
  EXPECT_EQ(t.Triangles().size(), 4u);
  EXPECT_EQ(t.Insert({ 0.5, 0.5 }), -1);
  EXPECT_EQ(t.Insert({ 0.5, 0.0 }), -1); // an edge of the polygon is not divided
  EXPECT_EQ(t.Insert({ 2.0, 0.5 }), -1);
}

TEST(FacetTriangulation, WhatIsNoSimplePolygonIsRefused)
{
  FacetTriangulation t;
  EXPECT_FALSE(t.Start({ { 0, 0 }, { 1, 0 } }));
  EXPECT_FALSE(t.Start({ { 0, 0 }, { 1, 1 }, { 1, 0 }, { 0, 1 } }));
  EXPECT_FALSE(t.Start({ { 0, 0 }, { 0, 1 }, { 1, 0 } })); // clockwise
}
