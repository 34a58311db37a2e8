// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Evaluator.h"
#include "Models.h"
#include "RealFiles.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

std::string Write(const Spline& s)
{
  std::ostringstream out;
  out.precision(17);
  const char* kinds[] = { "CURVE", "SURFACE", "TRIVAR" };
  out << '[' << kinds[s.Dimension() - 1] << " BSPLINE";
  for (int d = 0; d < s.Dimension(); ++d)
  {
    out << ' ' << s.Knots(d).Size();
  }
  for (int d = 0; d < s.Dimension(); ++d)
  {
    out << ' ' << s.Knots(d).Degree() + 1;
  }
  out << (s.IsRational() ? " P" : " E") << s.Components();
  for (int d = 0; d < s.Dimension(); ++d)
  {
    out << "\n[KV";
    for (const double knot : s.Knots(d).Knots())
    {
      out << ' ' << knot;
    }
    out << ']';
  }
  for (Eigen::Index i = 0; i < s.NumberOfControlPoints(); ++i)
  {
    const double weight = s.IsRational() ? s.Weights()[i] : 1.0;
    const char* before = "";
    out << "\n[";
    if (s.IsRational())
    {
      out << weight;
      before = " ";
    }
    for (int c = 0; c < s.Components(); ++c, before = " ")
    {
      out << before << weight * s.Coefficients()(c, i);
    }
    out << ']';
  }
  out << "]\n";
  return out.str();
}

}

TEST(IritItd, WhatIsWrittenIsRead)
{
  std::mt19937 random(5);
  for (int n = 0; n < 40; ++n)
  {
    std::array<KnotVector, 3> knots;
    const int dimension = 1 + n % 3;
    for (int d = 0; d < dimension; ++d)
    {
      const int degree = 1 + static_cast<int>(random() % 4);
      knots[static_cast<std::size_t>(d)] = models::RandomKnots(
        random, degree, degree + 2 + static_cast<int>(random() % 3), random() % 2 == 0);
    }
    const Spline spline = models::RandomSpline(random, knots, 3, n % 2 == 0);
    const FileContents file =
      ParseIritItd("# made\n[OBJECT [COLOR 4] [A [B \"x ] # y\"]] NAME\n" + Write(spline) + "]\n");
    ASSERT_EQ(file.Model.Patches.size(), 1u);
    const Spline& read = file.Model.Patches[0].Body.Geometry();
    EXPECT_EQ(read.Knots(), spline.Knots());
    EXPECT_EQ(read.Weights(), spline.Weights());
    // A product and a quotient by the weight: two roundings of numbers below 1.
    EXPECT_LE((read.Coefficients() - spline.Coefficients()).cwiseAbs().maxCoeff(), 2 * Epsilon);
    EXPECT_TRUE(file.Warnings.empty());
  }
}

TEST(IritItd, BezierObjectsHaveNoKnots)
{
  const FileContents file =
    ParseIritItd("[TRIVAR BEZIER 3 2 2 E3 [0 0 0][1 0 1][2 0 0][0 1 0]"
                 "[1 1 1][2 1 0][0 0 3][1 0 4][2 0 3][0 1 3][1 1 4][2 1 3]]");
  const Spline& s = file.Model.Patches.at(0).Body.Geometry();
  EXPECT_EQ(s.Degrees(), (std::array<int, 3>{ 2, 1, 1 }));
  EXPECT_LE((s.Evaluate(0.5, 0.25, 0.5) - Eigen::Vector3d(1.0, 0.25, 2.0)).norm(), 4 * Epsilon);
}

TEST(IritItd, PeriodicDirectionsClose)
{
  // A periodic quadratic with the corners of a square; the first two points come again at the end.
  const FileContents file = ParseIritItd("[OBJECT RING [SURFACE BSPLINE 2 4 2 3 E2\n"
                                         "[KV 0 0 1 1][KVP 0 1 2 3 4 5 6 7 8]\n"
                                         "[1 1][2 2][-1 1][-2 2][-1 -1][-2 -2][1 -1][2 -2]]]");
  const Spline& s = file.Model.Patches.at(0).Body.Geometry();
  EXPECT_EQ(s.Sizes(), (std::array<int, 3>{ 2, 6, 1 }));
  EXPECT_EQ(s.Knots(1).First(), 2.0);
  EXPECT_EQ(s.Knots(1).Last(), 6.0);
  for (const double u : { 0.0, 0.3, 1.0 })
  {
    EXPECT_LE((s.Evaluate(u, 2.0) - s.Evaluate(u, 6.0)).norm(), 4 * Epsilon);
    // A quarter of the period is a quarter of a turn.
    const Eigen::VectorXd p = s.Evaluate(u, 2.25);
    const Eigen::VectorXd q = s.Evaluate(u, 3.25);
    EXPECT_LE((q - Eigen::Vector2d(-p[1], p[0])).norm(), 8 * Epsilon);
  }
}

TEST(IritItd, ObjectsNestAndOthersAreCounted)
{
  const std::string line = "[CURVE BSPLINE 2 2 E2 [KV 0 0 1 1] [0 0] [1 2]]\n";
  const FileContents file = ParseIritItd("[OBJECT ALL [OBJECT ONE " + line +
    "] [OBJECT TWO [POLYGON 3 [0 0 0] [1 0 0] [0 1 0]]]\n[OBJECT THREE [RGB \"1,2,3\"] " + line +
    "[TRIMSRF " + line + "]]]\nbetween objects\n" + line);
  EXPECT_EQ(file.Model.Patches.size(), 3u);
  EXPECT_EQ(file.Model.Patches[2].Id, 2);
  ASSERT_EQ(file.Warnings.size(), 1u);
  EXPECT_EQ(file.Warnings[0], "Objects that are not read: 1 POLYGON, 1 TRIMSRF.");
}

TEST(IritItd, AScalarVolumeIsAField)
{
  const FileContents file = ParseIritItd("[OBJECT F [TRIVAR BEZIER 2 2 2 E1 [ 1 ][ 2 ][ 3 ][ 4 ]"
                                         "[ 5 ][ 6 ][ 7 ][ 8 ]]]");
  const Spline* field = file.Model.Patches.at(0).Body.FindAttribute("Field");
  ASSERT_NE(field, nullptr);
  EXPECT_EQ(field->Coefficients()(0, 5), 6.0);
  EXPECT_EQ(file.Warnings.size(), 1u);
}

TEST(IritItd, RealFiles)
{
  if (models::RealFiles("irit").empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  // Converted from the XML file, to all its digits.
  const MultiPatch itd = ReadSplineFile(models::RealFile("irit/tensorBSpline.itd")).Model;
  const MultiPatch xml = ReadSplineFile(models::RealFile("gismo/tensorBSpline.xml")).Model;
  EXPECT_EQ(itd.Patches.at(0).Body.Geometry().Coefficients(),
    xml.Patches.at(0).Body.Geometry().Coefficients());
  EXPECT_EQ(itd.Patches.at(0).Body.Geometry().Knots(), xml.Patches.at(0).Body.Geometry().Knots());

  // At the bottom of the muscle is the unit disk about (0, 1).
  const MultiPatch muscle = ReadSplineFile(models::RealFile("irit/skeletal_muscle.itd")).Model;
  const Spline& s = muscle.Patches.at(0).Body.Geometry();
  ASSERT_TRUE(s.IsRational());
  for (const double t : { 0.0, 0.3, 0.5, 0.9, 1.0 })
  {
    // The file has sqrt(1/2) to 9 digits.
    EXPECT_NEAR((s.Evaluate(t, 0.0, 0.0) - Eigen::Vector3d(0, 1, 0)).norm(), 1.0, 1e-9);
    EXPECT_NEAR((s.Evaluate(1.0, t, 0.0) - Eigen::Vector3d(0, 1, 0)).norm(), 1.0, 1e-9);
  }

  const MultiPatch sphere = ReadSplineFile(models::RealFile("irit/sphere8.itd")).Model;
  const Spline* field = sphere.Patches.at(0).Body.FindAttribute("Field");
  ASSERT_NE(field, nullptr);
  EXPECT_EQ(field->NumberOfControlPoints(), 512);
  EXPECT_EQ(field->Evaluate(0.0, 0.0, 5.0)[0], 0.57735);
}
