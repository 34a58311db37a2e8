// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Interfaces.h"
#include "RealFiles.h"

#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <set>

using namespace hyperpatch;

namespace
{

/// The same interface with the lower (patch, side) first, so that both ways of writing it agree.
std::array<int, 10> Canonical(const Interface& interface)
{
  const auto& n = interface.Values;
  if (std::pair(n[0], n[1]) <= std::pair(n[2], n[3]))
  {
    return n;
  }
  std::array<int, 10> m{ n[2], n[3], n[0], n[1] };
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto e = static_cast<std::size_t>(n[4 + d]);
    m[4 + e] = static_cast<int>(d);
    m[7 + e] = n[7 + d];
  }
  return m;
}

std::set<std::array<int, 10>> Canonical(const std::vector<Interface>& interfaces)
{
  std::set<std::array<int, 10>> result;
  for (const Interface& interface : interfaces)
  {
    result.insert(Canonical(interface));
  }
  return result;
}

Spline Brick(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  Eigen::MatrixXd points(3, 8);
  for (int i = 0; i < 8; ++i)
  {
    points.col(i) << (i & 1 ? high : low)[0], (i & 2 ? high : low)[1], (i & 4 ? high : low)[2];
  }
  return Spline(
    { KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) }, points);
}

/// The same map with its directions permuted and reversed.
Spline Turned(const Spline& spline, std::array<std::size_t, 3> direction, int reversed)
{
  std::array<KnotVector, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& k = spline.Knots()[direction[d]];
    std::vector<double> values = k.Knots();
    if (reversed >> d & 1)
    {
      std::reverse(values.begin(), values.end());
      std::transform(values.begin(), values.end(), values.begin(),
        [&](double t) { return k.First() + k.Last() - t; });
    }
    knots[d] = KnotVector(k.Degree(), values);
  }
  const auto sizes = spline.Sizes();
  Eigen::MatrixXd points(spline.Components(), spline.NumberOfControlPoints());
  Eigen::VectorXd weights(spline.Weights().size());
  Eigen::Index to = 0;
  for (int k = 0; k < knots[2].Size(); ++k)
  {
    for (int j = 0; j < knots[1].Size(); ++j)
    {
      for (int i = 0; i < knots[0].Size(); ++i, ++to)
      {
        const std::array<int, 3> index{ i, j, k };
        std::array<int, 3> from{};
        for (std::size_t d = 0; d < 3; ++d)
        {
          from[direction[d]] = reversed >> d & 1 ? knots[d].Size() - 1 - index[d] : index[d];
        }
        const Eigen::Index column =
          from[0] + static_cast<Eigen::Index>(sizes[0]) * (from[1] + sizes[1] * from[2]);
        points.col(to) = spline.Coefficients().col(column);
        if (spline.IsRational())
        {
          weights[to] = spline.Weights()[column];
        }
      }
    }
  }
  return Spline(knots, points, weights);
}

constexpr std::array<std::array<std::size_t, 3>, 6> Permutations{ { { 0, 1, 2 }, { 0, 2, 1 },
  { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } } };

Spline RandomVolume(double shift)
{
  // The same degrees and sizes: knots, points and weights tell the orientations apart.
  std::mt19937 random;
  std::uniform_real_distribution<double> noise(-0.05, 0.05);
  const std::array<KnotVector, 3> knots{ KnotVector(2, { 0, 0, 0, 0.3, 1, 1, 1 }),
    KnotVector(2, { 0, 0, 0, 0.4, 1, 1, 1 }), KnotVector(2, { 1, 1, 1, 1.2, 2, 2, 2 }) };
  Eigen::MatrixXd points(3, 64);
  Eigen::VectorXd weights(64);
  for (int i = 0; i < 64; ++i)
  {
    points.col(i) << shift + i % 4 / 3.0, i / 4 % 4 / 3.0, i / 16 / 3.0;
    // The same in all points of a line along x: the first face fits the last one of a neighbour.
    random.seed(static_cast<unsigned>(i / 4));
    points(1, i) += noise(random);
    points(2, i) += noise(random);
    weights[i] = 1.0 + noise(random);
  }
  return Spline(knots, points, weights);
}

}

TEST(Interfaces, RealFilesGiveWhatTheyState)
{
  const std::vector<std::string> names{ "gismo/fichera.xml", "gismo/linear_elasticity_example.xml",
    "splinepy/gismo_indent_nolabels_ascii_3d.xml", "mfem/beam-hex-nurbs.mesh",
    "mfem/ijk-hex-nurbs.mesh", "mfem/pipe-nurbs.mesh", "mfem/two-cubes-nurbs.mesh" };
  if (models::RealFiles("gismo").empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  for (const std::string& name : names)
  {
    const FileContents file = ReadSplineFile(models::RealFile(name));
    ASSERT_FALSE(file.Model.Interfaces.empty()) << name;
    EXPECT_EQ(Canonical(FindInterfaces(file.Model, 1e-6)), Canonical(file.Model.Interfaces))
      << name;
  }
}

TEST(Interfaces, SidesThatAreFoundCoincideInRealFilesWithoutTopology)
{
  if (models::RealFiles("gotools").empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  const std::vector<std::pair<std::string, std::size_t>> files{ { "gismo/terrificPart02_vol.xml",
                                                                  23 },
    { "gotools/vols.g2", 5 }, { "gotools/nut.g2", 64 }, { "gismo/bent_pipe.xml", 1 } };
  for (const auto& [name, least] : files)
  {
    const FileContents file = ReadSplineFile(models::RealFile(name));
    const std::vector<Interface> found = FindInterfaces(file.Model, 1e-6);
    EXPECT_GE(found.size(), least) << name;
    for (const Interface& interface : found)
    {
      // Control points within t and weights within 1e-6 relative move a point by a few t.
      EXPECT_LE(models::Gap(file.Model, interface), 1e-5 * models::Diagonal(file.Model)) << name;
    }
  }
}

TEST(Interfaces, EightCubesTouchTwelveTimesInEveryOrientation)
{
  const std::vector<std::string> files = models::RealFiles("splipy");
  if (files.empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  std::set<std::array<int, 6>> orientations;
  for (const std::string& name : files)
  {
    const FileContents file = ReadSplineFile(name);
    const std::vector<Interface> found = FindInterfaces(file.Model, 1e-9);
    EXPECT_EQ(found.size(), 12u) << name;
    for (const Interface& i : found)
    {
      EXPECT_LE(models::Gap(file.Model, i), 1e-14) << name;
      orientations.insert(
        { i.Values[4], i.Values[5], i.Values[6], i.Values[7], i.Values[8], i.Values[9] });
    }
  }
  EXPECT_GE(orientations.size(), 8u);
}

TEST(Interfaces, AllTurnsOfASharedFaceAreFound)
{
  const Spline left = RandomVolume(0.0);
  const Spline right = RandomVolume(1.0);
  for (const auto& permutation : Permutations)
  {
    for (int reversed = 0; reversed < 8; ++reversed)
    {
      MultiPatch model;
      model.Patches.push_back({ 7, Aggregate(left) });
      model.Patches.push_back({ 3, Aggregate(Turned(right, permutation, reversed)) });
      const std::vector<Interface> found = FindInterfaces(model, 1e-9);
      ASSERT_EQ(found.size(), 1u);
      EXPECT_EQ(found[0].Values[0], 7);
      EXPECT_EQ(found[0].Values[1], 2);
      EXPECT_EQ(found[0].Values[2], 3);
      EXPECT_LE(models::Gap(model, found[0]), 1e-14);
      // The direction across continues where a last side meets a first one.
      EXPECT_EQ(found[0].Values[7], found[0].Values[3] % 2);
    }
  }
}

TEST(Interfaces, PointsWeightsAndKnotsMustAllFit)
{
  const Spline left = RandomVolume(0.0);
  const Spline right = RandomVolume(1.0);
  const auto count = [&left](const Spline& other, double tolerance)
  {
    MultiPatch model;
    model.Patches.push_back({ 0, Aggregate(left) });
    model.Patches.push_back({ 1, Aggregate(other) });
    return FindInterfaces(model, tolerance).size();
  };
  ASSERT_EQ(count(right, 1e-9), 1u);
  const Eigen::Index onFace = 4 * (1 + 4 * 1); // i = 0, j = 1, k = 1
  Eigen::MatrixXd points = right.Coefficients();
  points(1, onFace) += 1e-4;
  EXPECT_EQ(count(Spline(right.Knots(), points, right.Weights()), 1e-6), 0u);
  EXPECT_EQ(count(Spline(right.Knots(), points, right.Weights()), 1e-3), 1u);
  Eigen::VectorXd weights = right.Weights();
  weights[onFace] *= 1.001;
  EXPECT_EQ(count(Spline(right.Knots(), right.Coefficients(), weights), 1e-6), 0u);
  auto knots = right.Knots();
  knots[1] = KnotVector(2, { 0, 0, 0, 0.5, 1, 1, 1 });
  EXPECT_EQ(count(Spline(knots, right.Coefficients(), right.Weights()), 1e-6), 0u);
}

TEST(Interfaces, CollapsedAndCutSidesTakeNoPart)
{
  Eigen::MatrixXd points = Brick({ 0, 0, 0 }, { 1, 1, 1 }).Coefficients();
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(Brick({ 0, 0, 0 }, { 1, 1, 1 })) });
  model.Patches.push_back({ 1, Aggregate(Brick({ 1, 0, 0 }, { 2, 1, 1 })) });
  EXPECT_EQ(FindInterfaces(model, 1e-9).size(), 1u);
  model.Patches[0].IsDomainFace[1] = false;
  EXPECT_TRUE(FindInterfaces(model, 1e-9).empty());

  // Two wedges that meet in an edge, into which a face of each collapses.
  points.col(1) = points.col(3);
  points.col(5) = points.col(7);
  const Spline wedge(model.Patches[0].Body.Geometry().Knots(), points);
  Eigen::MatrixXd opposite = 2.0 * points.col(3).replicate(1, 8) - points;
  opposite.row(2) = points.row(2);
  model.Patches.clear();
  model.Patches.push_back({ 0, Aggregate(wedge) });
  model.Patches.push_back({ 1, Aggregate(Spline(wedge.Knots(), opposite)) });
  EXPECT_TRUE(FindInterfaces(model, 1e-9).empty());
  EXPECT_FALSE(MatchSides(model.Patches[0], 1, model.Patches[1], 1, 1e-9).has_value());
}

TEST(Interfaces, SurfacesMeetInEdgesAndCurvesInPoints)
{
  const Spline brick = Brick({ 0, 0, 0 }, { 1, 1, 1 });
  MultiPatch model;
  for (int i = 0; i < 2; ++i)
  {
    Eigen::MatrixXd points = brick.Coefficients().leftCols(4);
    points.row(0).array() += i;
    model.Patches.push_back({ i,
      Aggregate(
        Spline({ KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2), KnotVector() }, points)) });
  }
  std::vector<Interface> found = FindInterfaces(model, 1e-9);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].Values, (std::array<int, 10>{ 0, 2, 1, 1, 0, 1, 2, 1, 1, 1 }));

  model.Patches.clear();
  for (int i = 0; i < 2; ++i)
  {
    Eigen::MatrixXd points = brick.Coefficients().leftCols(2);
    points.row(0).array() += i;
    model.Patches.push_back(
      { i, Aggregate(Spline({ KnotVector::Uniform(1, 2), KnotVector(), KnotVector() }, points)) });
  }
  found = FindInterfaces(model, 1e-9);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].Values, (std::array<int, 10>{ 0, 2, 1, 1, 0, 1, 2, 1, 1, 1 }));
}

TEST(Interfaces, FifteenThousandPatchesTakeLinearTime)
{
  MultiPatch model;
  const int nx = 25;
  const int ny = 25;
  const int nz = 24;
  for (int k = 0; k < nz; ++k)
  {
    for (int j = 0; j < ny; ++j)
    {
      for (int i = 0; i < nx; ++i)
      {
        const Eigen::Vector3d low(0.1 * i, 0.1 * j, 0.1 * k);
        const Eigen::Vector3d high(0.1 * (i + 1), 0.1 * (j + 1), 0.1 * (k + 1));
        model.Patches.push_back(
          { static_cast<int>(model.Patches.size()), Aggregate(Brick(low, high)) });
      }
    }
  }
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Interface> found = FindInterfaces(model, 1e-9);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  const int expected = (nx - 1) * ny * nz + nx * (ny - 1) * nz + nx * ny * (nz - 1);
  EXPECT_EQ(found.size(), static_cast<std::size_t>(expected));
  // All pairs of 90,000 sides would take minutes; a generous bound, for sanitizers and debug.
  EXPECT_LT(seconds.count(), 60.0);
  RecordProperty("milliseconds", static_cast<int>(1000 * seconds.count()));

  // The same patch many times: sides are paired once, not with all others.
  for (Patch& patch : model.Patches)
  {
    patch.Body = model.Patches[0].Body;
  }
  EXPECT_EQ(FindInterfaces(model, 1e-9).size(), model.Patches.size() / 2 * 6);
}

TEST(Interfaces, BadArgumentsAreNamed)
{
  MultiPatch model;
  model.Patches.push_back({ 4, Aggregate(Brick({ 0, 0, 0 }, { 1, 1, 1 })) });
  EXPECT_TRUE(FindInterfaces(MultiPatch(), 1e-6).empty());
  EXPECT_THROW((void)FindInterfaces(model, -1.0), Error);
  EXPECT_THROW((void)FindInterfaces(model, std::nan("")), Error);
  try
  {
    (void)MatchSides(model.Patches[0], 0, model.Patches[0], 6, 1e-6);
    FAIL();
  }
  catch (const Error& error)
  {
    EXPECT_STREQ(error.what(), "patch 4 has no side 6");
  }
}
