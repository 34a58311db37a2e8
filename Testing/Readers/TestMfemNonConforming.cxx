// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Integrals.h"
#include "RealFiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <sstream>

using namespace hyperpatch;

TEST(MfemNonConforming, PatchesOfANonConformingMeshFillTheirBlock)
{
  // 4 x 1 x 4, of one patch of 2 x 3 x 2 elements and 12 patches that hang on it.
  const std::string name = models::RealFile("mfem/nc-nurbs3d.mesh");
  if (!std::filesystem::exists(name))
  {
    GTEST_SKIP() << "no shared data";
  }
  const MultiPatch model = ReadSplineFile(name).Model;
  ASSERT_EQ(model.Patches.size(), 13u);
  EXPECT_EQ(model.Patches[0].Body.Geometry().Sizes(), (std::array<int, 3>{ 3, 4, 3 }));
  double volume = 0.0;
  for (const Patch& patch : model.Patches)
  {
    const Spline& s = patch.Body.Geometry();
    for (const double determinant : models::Determinants(s))
    {
      EXPECT_GT(determinant, 0.0) << patch.Id;
    }
    volume += integrals::Volume(s);
  }
  // Nodes of the quadrature are good to 1e-13.
  EXPECT_NEAR(volume, 16.0, 1e-11);
  // Every vertex that hangs is the corner of the small patches and a control point of the large
  // one.
  const Spline& large = model.Patches[0].Body.Geometry();
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      EXPECT_LE(
        (large.Evaluate(0.5 * i, j / 3.0, 0.0) - Eigen::Vector3d(2.0 * i, j / 3.0, 2)).norm(),
        1e-14);
    }
  }
}

namespace
{

/// A block of m x n x 1 spans under m x n patches, every vertex number and direction of the large
/// patch shuffled: control points are their own place.
std::string HangingBlock(std::mt19937& random, int m, int n, std::vector<Eigen::Vector3d>& places)
{
  // Vertices: four corners below, the (m + 1) (n + 1) of the common face, as many above.
  const int layer = (m + 1) * (n + 1);
  std::vector<int> number(static_cast<std::size_t>(4 + 2 * layer));
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  places.assign(number.size(), Eigen::Vector3d::Zero());
  const auto vertex = [&](int i, int j, int k)
  {
    const int at = k == 0 ? (i > 0) + 2 * (j > 0) : 4 + (k - 1) * layer + i + (m + 1) * j;
    const int id = number[static_cast<std::size_t>(at)];
    places[static_cast<std::size_t>(id)] = Eigen::Vector3d(i, j, k);
    return id;
  };
  std::ostringstream out;
  out << "MFEM NURBS NC-patch mesh v1.0 dimension 3 elements " << m * n + 1 << '\n';
  const auto element = [&](int i, int j, int k, int width, int depth)
  {
    // Turned about w and upside down at random.
    std::array<std::array<int, 2>, 4> ring{ { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } } };
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(random() % 4), ring.end());
    const bool flips = random() % 2 == 0;
    if (flips)
    {
      std::reverse(ring.begin(), ring.end());
    }
    out << "0 1 5 0";
    for (int l = 0; l < 2; ++l)
    {
      for (const auto& [a, b] : ring)
      {
        out << ' ' << vertex(i + a * width, j + b * depth, k + (flips ? 1 - l : l));
      }
    }
    out << '\n';
  };
  element(0, 0, 0, m, n);
  for (int j = 0; j < n; ++j)
  {
    for (int i = 0; i < m; ++i)
    {
      element(i, j, 1, 1, 1);
    }
  }
  out << "boundary 0\nvertex_to_knotspan " << layer - 4 << '\n';
  for (int j = 0; j <= n; ++j)
  {
    for (int i = 0; i <= m; ++i)
    {
      if ((i % m != 0) || (j % n != 0))
      {
        out << vertex(i, j, 1) << ' ' << i << ' ' << j << ' ' << vertex(0, 0, 1) << ' '
            << vertex(m, 0, 1) << ' ' << vertex(m, n, 1) << ' ' << vertex(0, n, 1) << '\n';
      }
    }
  }
  out << "coordinates " << number.size() << " 1\n";
  for (std::size_t v = 0; v < number.size(); ++v)
  {
    out << "0 ";
  }
  // Knots 0: along x of the large patch, 1: along y, 2: all others.
  std::vector<std::array<int, 3>> edges;
  for (int k = 0; k < 2; ++k)
  {
    edges.push_back({ 0, vertex(0, 0, k), vertex(m, 0, k) });
    edges.push_back({ 0, vertex(0, n, k), vertex(m, n, k) });
    edges.push_back({ 1, vertex(0, 0, k), vertex(0, n, k) });
    edges.push_back({ 1, vertex(m, 0, k), vertex(m, n, k) });
  }
  for (const int i : { 0, m })
  {
    for (const int j : { 0, n })
    {
      edges.push_back({ 2, vertex(i, j, 0), vertex(i, j, 1) });
    }
  }
  for (int j = 0; j <= n; ++j)
  {
    for (int i = 0; i <= m; ++i)
    {
      edges.push_back({ 2, vertex(i, j, 1), vertex(i, j, 2) });
      for (int k = 1; k <= 2; ++k)
      {
        if (i < m)
        {
          edges.push_back({ 2, vertex(i, j, k), vertex(i + 1, j, k) });
        }
        if (j < n)
        {
          edges.push_back({ 2, vertex(i, j, k), vertex(i, j + 1, k) });
        }
      }
    }
  }
  std::shuffle(edges.begin(), edges.end(), random);
  out << "\nedges " << edges.size() << '\n';
  for (const auto& [knots, a, b] : edges)
  {
    out << knots << ' ' << a << ' ' << b << '\n';
    // Inside the edges below, from the lower vertex to the higher.
    const Eigen::Vector3d from = places[static_cast<std::size_t>(std::min(a, b))];
    const Eigen::Vector3d to = places[static_cast<std::size_t>(std::max(a, b))];
    const int count = knots == 0 ? m : knots == 1 ? n : 1;
    for (int i = 1; i < count && from[2] == 0.0; ++i)
    {
      places.push_back(from + (to - from) * i / count);
    }
  }
  out << "knotvectors 3\n";
  for (const int count : { m, n, 1 })
  {
    out << "1 " << count + 1 << " 0";
    for (int i = 0; i <= count; ++i)
    {
      out << ' ' << i;
    }
    out << ' ' << count << '\n';
  }
  return out.str();
}

}

TEST(MfemNonConforming, HangingVerticesAreFoundInEveryOrientation)
{
  std::mt19937 random(8);
  for (int round = 0; round < 100; ++round)
  {
    // One row of spans across: no control points inside the faces of the large patch but hanging
    // ones, whose order depends on nothing else.
    const int m = 2 + static_cast<int>(random() % 3);
    const int n = 2 + static_cast<int>(random() % 2);
    std::vector<Eigen::Vector3d> places;
    std::string text = HangingBlock(random, m, n, places);
    // The inside of the face below comes last; where all its points are one, in any order.
    const int inside = (m - 1) * (n - 1);
    std::ostringstream out;
    out << text << "unitweights FiniteElementSpace FiniteElementCollection: NURBS1 VDim: 3 "
        << "Ordering: 1\n";
    for (const Eigen::Vector3d& place : places)
    {
      out << place.transpose() << '\n';
    }
    for (int i = 0; i < inside; ++i)
    {
      out << "0.5 0.5 -1\n";
    }
    FileContents file;
    ASSERT_NO_THROW(file = ParseMfemMesh(out.str())) << out.str();
    ASSERT_EQ(file.Model.Patches.size(), static_cast<std::size_t>(m * n + 1));
    // The face of the large patch that others hang on is plane, with its points in their places.
    const Spline& large = file.Model.Patches[0].Body.Geometry();
    const bool isLast = large.Evaluate(0, 0, 1)[2] > 0.5;
    const KnotVector& ku = large.Knots(0);
    const KnotVector& kv = large.Knots(1);
    const double w = isLast ? 1.0 : 0.0;
    const Eigen::Vector3d origin = large.Evaluate(0, 0, w);
    const Eigen::Vector3d u = (large.Evaluate(ku.Last(), 0, w) - origin) / ku.Last();
    const Eigen::Vector3d v = (large.Evaluate(0, kv.Last(), w) - origin) / kv.Last();
    for (int j = 0; j <= kv.Last(); ++j)
    {
      for (int i = 0; i <= ku.Last(); ++i)
      {
        ASSERT_LE((large.Evaluate(i, j, w) - origin - i * u - j * v).norm(), 1e-14) << out.str();
      }
    }
    for (std::size_t p = 1; p < file.Model.Patches.size(); ++p)
    {
      EXPECT_NEAR(
        std::abs(models::Determinants(file.Model.Patches[p].Body.Geometry())[13]), 1.0, 1e-14);
    }
  }
}

TEST(MfemNonConforming, HangingVerticesThatDoNotFitAreRefused)
{
  // Each time one line of the section is changed; the text ends before the weights, which is
  // another error.
  for (const int change : { 0, 1, 2, 3, 4 })
  {
    std::mt19937 random(9);
    std::vector<Eigen::Vector3d> places;
    const int m = change == 4 ? 3 : 2;
    std::istringstream in(HangingBlock(random, m, 2, places));
    std::ostringstream out;
    for (std::string line; std::getline(in, line);)
    {
      std::istringstream numbers(line);
      std::array<int, 7> n{};
      for (int& number : n)
      {
        numbers >> number;
      }
      const bool isHanging = !numbers.fail() && (numbers >> std::ws).eof();
      const bool isMiddle = isHanging && n[1] == 1 && n[2] == 1;
      const bool isOnEdge = isHanging && n[1] == 1 && n[2] == 0;
      if ((change == 1 || change == 4) && line.find("vertex_to_knotspan") == 0)
      {
        line = change == 1 ? "vertex_to_knotspan 4" : "vertex_to_knotspan 7";
      }
      if ((change == 1 || change == 4) && isMiddle)
      {
        continue; // of one vertex inside the face, none is left: then it has points of its own
      }
      if (change == 2 && isMiddle)
      {
        line = std::to_string(n[5]) + line.substr(line.find(' '));
      }
      if (change == 3 && isOnEdge)
      {
        line.replace(line.find(" 1 0 "), 5, " 0 0 ");
      }
      out << line << '\n';
    }
    std::string message;
    try
    {
      (void)ParseMfemMesh(out.str());
    }
    catch (const Error& error)
    {
      message = error.what();
    }
    const std::array<std::string, 5> expected{ "ends where \"weights\" is expected",
      "ends where \"weights\" is expected", "that place or the vertex is taken",
      "that place or the vertex is taken",
      "has 1 hanging vertices inside where 2 knot spans meet" };
    EXPECT_NE(message.find(expected[static_cast<std::size_t>(change)]), message.npos)
      << change << ": " << message;
  }
}
