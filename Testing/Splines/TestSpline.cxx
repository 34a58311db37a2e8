// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <limits>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();
constexpr double Infinity = std::numeric_limits<double>::infinity();

std::array<KnotVector, 3> LinearCube()
{
  return { KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) };
}

}

TEST(Spline, QuarterTubeIsRound)
{
  const Spline tube = models::QuarterTube();
  for (int i = 0; i <= 20; ++i)
  {
    const double u = 0.05 * i;
    const Eigen::VectorXd p = tube.Evaluate(u, 1.0 - u, 0.3);
    EXPECT_NEAR(std::hypot(p[0], p[1]), 1.0 + u, 8 * Epsilon);
    EXPECT_NEAR(p[2], 0.3, 2 * Epsilon);
  }
}

TEST(Spline, HomogeneousFormRoundTrips)
{
  std::mt19937 random(1);
  const Spline spline = models::RandomSpline(random,
    { KnotVector::Uniform(2, 4), KnotVector::Uniform(1, 3), KnotVector::Uniform(3, 4) }, 3, true);
  const Eigen::MatrixXd h = spline.Homogeneous();
  EXPECT_EQ(h.rows(), 4);
  const Spline back = Spline::FromHomogeneous(spline.Knots(), h);
  EXPECT_EQ(back.Weights(), spline.Weights());
  EXPECT_LE((back.Coefficients() - spline.Coefficients()).lpNorm<Eigen::Infinity>(), Epsilon);
}

TEST(Spline, ConstantWeightsChangeNothing)
{
  std::mt19937 random(2);
  const std::array<KnotVector, 3> knots{ KnotVector::Uniform(2, 4), KnotVector::Uniform(1, 3),
    KnotVector::Uniform(3, 4) };
  const Spline polynomial = models::RandomSpline(random, knots, 2, false);
  const Spline rational(knots, polynomial.Coefficients(),
    Eigen::VectorXd::Constant(polynomial.NumberOfControlPoints(), 3.0));
  const Eigen::VectorXd difference =
    rational.Evaluate(0.2, 0.7, 0.9) - polynomial.Evaluate(0.2, 0.7, 0.9);
  EXPECT_LE(difference.lpNorm<Eigen::Infinity>(), 50 * Epsilon);
}

TEST(Spline, ParametersOutsideAreMovedToTheBorder)
{
  const Spline tube = models::QuarterTube();
  EXPECT_EQ(tube.Evaluate(-1.0, 2.0, 0.5), tube.Evaluate(0.0, 1.0, 0.5));
}

TEST(Spline, DimensionCountsTheDirectionsThatAreThere)
{
  EXPECT_EQ(models::QuarterTube().Dimension(), 3);
  EXPECT_EQ(Spline({ KnotVector::Uniform(1, 2) }, Eigen::MatrixXd::Zero(3, 2)).Dimension(), 1);
}

TEST(Spline, SharesBasisOnlyWithTheSameKnotsAndWeights)
{
  const Spline tube = models::QuarterTube();
  const Spline field(tube.Knots(), Eigen::MatrixXd::Ones(1, 12), tube.Weights());
  EXPECT_TRUE(SharesBasis(tube, field));
  EXPECT_FALSE(SharesBasis(tube, Spline(tube.Knots(), Eigen::MatrixXd::Ones(1, 12))));
  EXPECT_NE(tube, field);
  EXPECT_EQ(tube, models::QuarterTube());
}

TEST(Spline, CopiesShareTheirNumbers)
{
  const Spline tube = models::QuarterTube();
  const Spline copy = tube;
  EXPECT_EQ(copy.Coefficients().data(), tube.Coefficients().data());
  EXPECT_EQ(copy.Weights().data(), tube.Weights().data());
  EXPECT_TRUE(copy == tube);
  // What is taken of one that goes at once is a copy.
  const auto points = models::QuarterTube().Coefficients();
  EXPECT_EQ(points, tube.Coefficients());
}

TEST(Spline, NumbersThatAreNotItsOwnAreNotCopied)
{
  const Spline tube = models::QuarterTube();
  auto points = std::make_shared<Eigen::MatrixXd>(tube.Coefficients());
  auto weights = std::make_shared<Eigen::VectorXd>(tube.Weights());
  const double* const place = points->data();
  const Spline shared(tube.Knots(), { { points, place }, points->rows(), points->cols() },
    { { weights, weights->data() }, 1, weights->size() });
  points.reset();
  weights.reset();
  EXPECT_EQ(shared.Coefficients().data(), place);
  EXPECT_TRUE(shared == tube);
}

TEST(Spline, RefusesWhatDoesNotFit)
{
  const Eigen::MatrixXd points = Eigen::MatrixXd::Zero(3, 8);
  EXPECT_NO_THROW(Spline(LinearCube(), points));
  EXPECT_THROW(Spline(LinearCube(), Eigen::MatrixXd::Zero(3, 7)), Error);
  EXPECT_THROW(Spline(LinearCube(), Eigen::MatrixXd::Zero(0, 8)), Error);
  EXPECT_THROW(Spline(LinearCube(), points, Eigen::VectorXd::Ones(7)), Error);
  for (double bad : { 0.0, -1.0, Infinity, std::nan("") })
  {
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(8);
    weights[3] = bad;
    EXPECT_THROW(Spline(LinearCube(), points, weights), Error);
  }
  for (double bad : { Infinity, std::nan("") })
  {
    Eigen::MatrixXd broken = points;
    broken(1, 5) = bad;
    try
    {
      const Spline spline(LinearCube(), broken);
      FAIL() << "a control point that is not finite was accepted";
    }
    catch (const Error& error)
    {
      EXPECT_NE(std::string(error.what()).find("control point 5"), std::string::npos);
    }
  }
}
