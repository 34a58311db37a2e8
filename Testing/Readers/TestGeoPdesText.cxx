// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Models.h"
#include "RealFiles.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// As GeoPDEs writes it: points multiplied by their weights, a row per coordinate.
std::string WritePatch(const Spline& s)
{
  std::ostringstream out;
  out.precision(17);
  for (int d = 0; d < s.Dimension(); ++d)
  {
    out << s.Knots(d).Degree() << ' ';
  }
  out << '\n';
  for (int d = 0; d < s.Dimension(); ++d)
  {
    out << s.Knots(d).Size() << ' ';
  }
  for (int d = 0; d < s.Dimension(); ++d)
  {
    out << '\n';
    for (const double knot : s.Knots(d).Knots())
    {
      out << knot << ' ';
    }
  }
  for (int row = 0; row <= s.Components(); ++row)
  {
    out << '\n';
    for (Eigen::Index i = 0; i < s.NumberOfControlPoints(); ++i)
    {
      const double weight = s.IsRational() ? s.Weights()[i] : 1.0;
      out << weight * (row < s.Components() ? s.Coefficients()(row, i) : 1.0) << ' ';
    }
  }
  out << '\n';
  return out.str();
}

}

TEST(GeoPdesText, WhatIsWrittenIsReadInEveryVersion)
{
  std::mt19937 random(7);
  for (int n = 0; n < 30; ++n)
  {
    std::array<KnotVector, 3> knots;
    const int dimension = 1 + n % 3;
    for (int d = 0; d < dimension; ++d)
    {
      knots[static_cast<std::size_t>(d)] =
        models::RandomKnots(random, 1 + static_cast<int>(random() % 4), 6, random() % 2 == 0);
    }
    const Spline spline = models::RandomSpline(random, knots, dimension, n % 2 == 0);
    const std::string d = std::to_string(dimension);
    const std::string patch = WritePatch(spline);
    for (const std::string& text :
      { "# nurbs mesh v.2.1\n#\n  " + d + " " + d + " 1 0 0 \nPATCH 1 \n" + patch,
        "# nurbs mesh v.2.1\n" + d + " " + d + " 1\n# a comment\n" + patch,
        "# nurbs mesh v.0.7\n" + d + " 1 0 0\nPATCH 1\n" + patch,
        "# nurbs mesh v.0.6\n" + d + "\n" + patch })
    {
      const FileContents file = ParseGeoPdesText(text);
      ASSERT_EQ(file.Model.Patches.size(), 1u) << text;
      const Spline& read = file.Model.Patches[0].Body.Geometry();
      EXPECT_EQ(read.Knots(), spline.Knots());
      EXPECT_EQ(read.Weights(), spline.Weights());
      // A product and a quotient by the weight: two roundings of numbers below 1.
      EXPECT_LE((read.Coefficients() - spline.Coefficients()).cwiseAbs().maxCoeff(), 2 * Epsilon);
    }
  }
}

TEST(GeoPdesText, InterfacesAndBoundariesAreKept)
{
  const FileContents file = ReadSplineFile(std::string(HYPERPATCH_DATA) + "/two_blocks.txt");
  ASSERT_EQ(file.Model.Interfaces.size(), 1u);
  EXPECT_EQ(file.Model.Interfaces[0].Values, (std::array<int, 10>{ 0, 2, 1, 4, 1, 0, 2, 0, 1, 1 }));
  EXPECT_EQ(models::Gap(file.Model, file.Model.Interfaces[0]), 0.0);
  ASSERT_EQ(file.Model.Boundaries.size(), 2u);
  EXPECT_EQ(file.Model.Boundaries[0].Name, "BOUNDARY left");
  EXPECT_EQ(file.Model.Boundaries[1].Sides, (std::vector<std::array<int, 2>>{ { 1, 2 } }));
  EXPECT_TRUE(file.Warnings.empty());

  // Without lines that name them, and in two dimensions, where the flag is not there.
  const std::string square = "1 1\n2 2\n0 0 1 1\n0 0 1 1\n";
  const FileContents plate = ParseGeoPdesText("# nurbs mesh v.2.1\n2 2 2 1 0\n" + square +
    "0 1 0 1\n0 0 1 1\n1 1 1 1\n" + square + "2 1 2 1\n1 1 0 0\n1 1 1 1\n1 2\n2 2\n-1\n1\n2 1\n");
  ASSERT_EQ(plate.Model.Interfaces.size(), 1u);
  EXPECT_LE(models::Gap(plate.Model, plate.Model.Interfaces[0]), Epsilon);
  ASSERT_EQ(plate.Model.Boundaries.size(), 1u);
  EXPECT_EQ(plate.Model.Boundaries[0].Name, "BOUNDARY 1");
}

TEST(GeoPdesText, InterfacesOfRealFilesCoincide)
{
  const std::vector<std::string> files = models::RealFiles("geopdes");
  if (files.empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  std::size_t interfaces = 0;
  for (const std::string& name : files)
  {
    const MultiPatch model = ReadSplineFile(name).Model;
    for (const Interface& interface : model.Interfaces)
    {
      // The files have 15 digits behind the point.
      EXPECT_LE(models::Gap(model, interface), 4e-15 * models::Diagonal(model)) << name;
      ++interfaces;
    }
  }
  EXPECT_EQ(interfaces, 6u);
}

TEST(GeoPdesText, TheRingIsRound)
{
  const std::string name = models::RealFile("geopdes/geo_thick_ring.txt");
  if (!std::filesystem::exists(name))
  {
    GTEST_SKIP() << "no shared data";
  }
  const MultiPatch model = ReadSplineFile(name).Model;
  const Spline& s = model.Patches.at(0).Body.Geometry();
  for (const double t : { 0.0, 0.2, 0.5, 1.0 })
  {
    const double inner = s.Evaluate(0.0, t, 0.5).head(2).norm();
    const double outer = s.Evaluate(1.0, t, 0.5).head(2).norm();
    EXPECT_NEAR(inner, 1.0, 1e-14);
    EXPECT_NEAR(outer, 2.0, 1e-14);
  }
}
