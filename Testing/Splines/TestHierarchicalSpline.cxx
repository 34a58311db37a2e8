// SPDX-License-Identifier: BSD-3-Clause
#include "HierarchicalSpline.h"

#include "Error.h"
#include "Models.h"
#include "Operators.h"

#include <gtest/gtest.h>

#include <limits>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

const std::vector<HierarchicalBox> Boxes{ { 0, { 0, 0, 0 }, { 3, 2, 2 } },
  { 1, { 0, 0, 0 }, { 6, 4, 2 } }, { 1, { 4, 2, 0 }, { 6, 4, 4 } },
  { 2, { 0, 0, 0 }, { 9, 6, 4 } } };

std::array<KnotVector, 3> Base(int p)
{
  return { KnotVector::Uniform(p, p + 3), KnotVector::Uniform(p, p + 2),
    KnotVector::Uniform(p, p + 2, 1.0, 3.0) };
}

/// Basis function `which` of `count` functions.
Spline Function(int p, Eigen::Index which, Eigen::Index count, bool truncated)
{
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(1, count);
  coefficients(0, which) = 1.0;
  return FlattenHierarchicalSpline(Base(p), Boxes, coefficients, truncated);
}

/// The number of active functions, from the message about too many coefficients.
Eigen::Index ActiveFunctions(int p)
{
  try
  {
    (void)FlattenHierarchicalSpline(Base(p), Boxes, Eigen::MatrixXd::Zero(1, 100000), true);
  }
  catch (const Error& error)
  {
    const std::string text = error.what();
    const std::string before = "control points for ";
    return std::stol(text.substr(text.find(before) + before.size()));
  }
  return 0;
}

}

TEST(HierarchicalSpline, TruncatedFunctionsSumToOneAndArePositive)
{
  for (const int p : { 1, 2, 3 })
  {
    const Eigen::Index n = ActiveFunctions(p);
    ASSERT_GT(n,
      Spline(Base(p), Eigen::MatrixXd::Zero(1, (p + 3) * (p + 2) * (p + 2)))
        .NumberOfControlPoints());
    const Spline one = FlattenHierarchicalSpline(Base(p), Boxes, Eigen::MatrixXd::Ones(1, n), true);
    EXPECT_LE((one.Coefficients().array() - 1.0).abs().maxCoeff(), 64 * Epsilon);
    for (Eigen::Index i = 0; i < n; i += 7)
    {
      EXPECT_GE(Function(p, i, n, true).Coefficients().minCoeff(), 0.0);
    }
  }
}

TEST(HierarchicalSpline, WithoutTruncationFunctionsAreThoseOfTheirLevel)
{
  // A function of level 0 that is active is the B-spline itself, one of level 2 too.
  const int p = 2;
  const Eigen::Index n = ActiveFunctions(p);
  const Spline last = Function(p, n - 1, n, false);
  EXPECT_EQ((last.Coefficients().array() != 0.0).count(), 1);
  const Spline first = Function(p, 0, n, false);
  bool found = false;
  for (Eigen::Index i = 0; i < 5 * 4 * 4 && !found; ++i)
  {
    Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(1, 5 * 4 * 4);
    coefficients(0, i) = 1.0;
    const Spline coarse = RefineUniformly(Spline(Base(p), coefficients), { 4, 4, 4 });
    found = (coarse.Coefficients() - first.Coefficients()).cwiseAbs().maxCoeff() <= 16 * Epsilon;
  }
  EXPECT_TRUE(found);
  // Coarse functions overlap fine ones: the sum is not one.
  const Spline sum = FlattenHierarchicalSpline(Base(p), Boxes, Eigen::MatrixXd::Ones(1, n), false);
  EXPECT_GT(sum.Coefficients().maxCoeff(), 1.5);
}

TEST(HierarchicalSpline, WithoutFinerBoxesItIsTheSpline)
{
  std::mt19937 random(1);
  const Spline spline = models::RandomSpline(random, Base(3), 3, false);
  EXPECT_EQ(FlattenHierarchicalSpline(Base(3), {}, spline.Coefficients(), true), spline);
}

TEST(HierarchicalSpline, AFullyRefinedLevelIsTheRefinedSpline)
{
  std::mt19937 random(2);
  const Spline fine = RefineUniformly(models::RandomSpline(random, Base(2), 3, false), { 2, 2, 2 });
  const Spline flat = FlattenHierarchicalSpline(
    Base(2), { { 1, { 0, 0, 0 }, { 6, 4, 4 } } }, fine.Coefficients(), true);
  EXPECT_EQ(flat, fine);
}

TEST(HierarchicalSpline, CurvesAndSurfacesKeepTheirDimension)
{
  // Linear functions on three levels: where the coefficients are a linear function's values at the
  // knots, the spline is that function.
  const std::array<KnotVector, 3> base{ KnotVector::Uniform(1, 3), KnotVector(), KnotVector() };
  Eigen::MatrixXd values(1, 5);
  // Level 0 has 0.5 and 1, level 1 has 0.25, level 2 has 0 and 0.125.
  values << 0.5, 1.0, 0.25, 0.0, 0.125;
  const Spline curve = FlattenHierarchicalSpline(
    base, { { 1, { 0, 0, 0 }, { 2, 1, 1 } }, { 2, { 0, 0, 0 }, { 2, 1, 1 } } }, values, true);
  EXPECT_EQ(curve.Dimension(), 1);
  for (const double u : { 0.0, 0.1, 0.3, 0.6, 1.0 })
  {
    EXPECT_NEAR(curve.Evaluate(u)[0], u, 4 * Epsilon);
  }
}

TEST(HierarchicalSpline, WhatDoesNotFitIsRefused)
{
  const auto messageOf = [](const std::vector<HierarchicalBox>& boxes, Eigen::Index count)
  {
    try
    {
      (void)FlattenHierarchicalSpline(Base(2), boxes, Eigen::MatrixXd::Zero(3, count), true);
    }
    catch (const Error& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(messageOf({}, 79).find("fewer than active functions"), std::string::npos);
  EXPECT_NE(messageOf({}, 81).find("81 control points for 80"), std::string::npos);
  EXPECT_NE(messageOf({ { 1, { 0, 0, 0 }, { 7, 4, 4 } } }, 80).find("the level has 6 elements"),
    std::string::npos);
  EXPECT_NE(messageOf({ { 1, { 2, 0, 0 }, { 2, 4, 4 } } }, 80).find("is empty or outside"),
    std::string::npos);
  EXPECT_NE(
    messageOf({ { -1, { 0, 0, 0 }, { 1, 1, 1 } } }, 80).find("level -1"), std::string::npos);
  EXPECT_NE(
    messageOf({ { 30, { 0, 0, 0 }, { 1, 1, 1 } } }, 80).find("fewer levels"), std::string::npos);
}
