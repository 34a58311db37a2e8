// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianSign.h"

#include "Bernstein.h"
#include "BezierExtractor.h"
#include "Cone.h"
#include "Evaluator.h"
#include "Operators.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <limits>

using namespace hyperpatch;

namespace
{

ParameterBox WholeBox(const Spline& s)
{
  ParameterBox box{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    box.Low[d] = s.Knots()[d].First();
    box.High[d] = s.Knots()[d].Last();
  }
  return box;
}

ParameterBox SpanBox(const Spline& s, int i, int j, int k)
{
  const std::array<int, 3> at{ i, j, k };
  ParameterBox box{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const std::vector<double> breaks = s.Knots()[d].Breaks();
    box.Low[d] = breaks[static_cast<std::size_t>(at[d])];
    box.High[d] = breaks[static_cast<std::size_t>(at[d]) + 1];
  }
  return box;
}

/// Control points on a lattice of spacing 1, moved by noise; weights from 1 - spread to 1 + spread.
Spline NoisyLattice(std::mt19937& random, int degree, int size, double noise, double spread)
{
  std::uniform_real_distribution<double> move(-1.0, 1.0);
  const Eigen::Index n = static_cast<Eigen::Index>(size) * size * size;
  Eigen::MatrixXd points(3, n);
  Eigen::VectorXd weights(spread > 0.0 ? n : 0);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    const Eigen::Array3d lattice(static_cast<double>(i % size),
      static_cast<double>(i / size % size), static_cast<double>(i / size / size));
    points.col(i) = lattice + noise * Eigen::Array3d(move(random), move(random), move(random));
    if (spread > 0.0)
    {
      weights[i] = 1.0 + spread * move(random);
    }
  }
  const KnotVector knots = KnotVector::Uniform(degree, size);
  return Spline({ knots, knots, knots }, points, weights);
}

Spline Mapped(const Spline& s, const Eigen::Matrix3d& A)
{
  return Spline(s.Knots(), A * s.Coefficients(), s.Weights());
}

/// Least and greatest det J on a grid of the box.
std::array<double, 2> SampledRange(const Spline& s, const ParameterBox& box, int n)
{
  std::array<std::vector<double>, 3> parameters;
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (int i = 0; i <= n; ++i)
    {
      const double t = static_cast<double>(i) / n;
      // Closed boxes: the derivative at the end is that from inside.
      const double inside = i == n ? std::nextafter(box.High[d], box.Low[d]) : box.High[d];
      parameters[d].push_back(i == n ? inside : (1 - t) * box.Low[d] + t * box.High[d]);
    }
  }
  const auto count = static_cast<std::size_t>((n + 1) * (n + 1) * (n + 1));
  std::vector<double> values(3 * count);
  std::vector<double> derivatives(9 * count);
  Evaluator(s).EvaluateGrid(parameters, values.data(), derivatives.data());
  std::array<double, 2> range{ INFINITY, -INFINITY };
  for (std::size_t i = 0; i < count; ++i)
  {
    const double J = Eigen::Map<const Eigen::Matrix3d>(derivatives.data() + 9 * i).determinant();
    range = { std::min(range[0], J), std::max(range[1], J) };
  }
  return range;
}

}

TEST(JacobianSign, NoAnswerIsContradictedBySamples)
{
  std::mt19937 random(1);
  int decided = 0;
  for (int run = 0; run < 3000; ++run)
  {
    const double noise = 0.1 + 0.1 * (run % 5);
    const Spline s = NoisyLattice(random, 1 + run % 3, 5, noise, run % 2 ? 0.4 : 0.0);
    const ParameterBox box = run % 4 == 0 ? WholeBox(s) : SpanBox(s, run % 2, 0, 1);
    const int sign = JacobianSign(s, box);
    decided += sign != 0;
    if (sign != 0)
    {
      const auto range = SampledRange(s, box, 6);
      ASSERT_GT(sign > 0 ? range[0] : -range[1], 0.0) << "run " << run;
    }
  }
  EXPECT_GT(decided, 700);
  EXPECT_LT(decided, 2800);
}

TEST(JacobianSign, NoAnswerAboutWildWeightsIsContradictedBySamples)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> move(-1.0, 1.0);
  int decided = 0;
  for (int run = 0; run < 20000; ++run)
  {
    const int degree = 1 + run % 2;
    const Spline plain = NoisyLattice(random, degree, degree + 1, 0.35, 0.0);
    Eigen::VectorXd weights(plain.NumberOfControlPoints());
    for (Eigen::Index i = 0; i < weights.size(); ++i)
    {
      weights[i] = std::pow(run % 3 == 0 ? 2.0 : 1.3, move(random));
    }
    const Spline s(plain.Knots(), plain.Coefficients(), weights);
    const int sign = JacobianSign(s, WholeBox(s));
    decided += sign != 0;
    if (sign != 0)
    {
      const auto range = SampledRange(s, WholeBox(s), 4);
      ASSERT_GT(sign > 0 ? range[0] : -range[1], 0.0) << "run " << run;
    }
  }
  EXPECT_GT(decided, 200);
}

// x_i + the sum of k_j (x_j - x_j^2) over the others: the frame is that of x, the control vectors
// of direction j have parts k_j or -k_j beside 1. With equal k det J at (1, 1, 1) is 1 - 3 k^2 - 2
// k^3, which is 0 at k = 1/2.
TEST(JacobianSign, IsKnownUpToTheFold)
{
  const auto signOf = [](std::array<double, 3> k)
  {
    const double c[3] = { 0.0, 0.5, 0.0 };
    Eigen::MatrixXd points(3, 27);
    for (int i = 0; i < 27; ++i)
    {
      const std::array<int, 3> at{ i % 3, i / 3 % 3, i / 9 };
      for (int d = 0; d < 3; ++d)
      {
        const auto D = static_cast<std::size_t>(d);
        const std::size_t e = (D + 1) % 3;
        const std::size_t f = (D + 2) % 3;
        points(d, i) = 0.5 * at[D] + k[e] * c[at[e]] + k[f] * c[at[f]];
      }
    }
    const KnotVector knots = KnotVector::Uniform(2, 3);
    const Spline s({ knots, knots, knots }, points);
    return JacobianSign(s, WholeBox(s));
  };
  EXPECT_EQ(signOf({ 0.4999, 0.4999, 0.4999 }), 1);
  EXPECT_EQ(signOf({ -0.4999, -0.4999, -0.4999 }), 1);
  EXPECT_EQ(signOf({ 0.5, 0.5, 0.5 }), 0);
  // 1 - k_0 k_1 - k_1 k_2 - k_2 k_0 - 2 k_0 k_1 k_2: one column may be wide if the others are not.
  EXPECT_EQ(signOf({ 0.6, 0.495, 0.495 }), 0);
  EXPECT_EQ(signOf({ 0.495, 0.6, 0.495 }), 0);
  EXPECT_EQ(signOf({ 0.495, 0.495, 0.6 }), 0);
  EXPECT_EQ(signOf({ 0.6, 0.4, 0.4 }), 1);
  EXPECT_EQ(signOf({ 0.2, 0.2, 1.9 }), 1);
  EXPECT_EQ(signOf({ 0.3, 0.3, 2.0 }), 0);
}

TEST(JacobianSign, IsThatOfTheFrameOfTheMap)
{
  std::mt19937 random(2);
  const Spline s = NoisyLattice(random, 3, 6, 0.12, 0.0);
  ASSERT_EQ(JacobianSign(s, WholeBox(s)), 1);
  // Neither units, nor skew frames, nor mirrors matter: a cone test would see three directions
  // within a few degrees of each other.
  Eigen::Matrix3d skew;
  skew << 1, 1, 1, 0, 0.1, 0.1, 0, 0, 0.01;
  EXPECT_EQ(JacobianSign(Mapped(s, 1e-150 * skew), WholeBox(s)), 1);
  EXPECT_EQ(JacobianSign(Mapped(s, 1e150 * skew), WholeBox(s)), 1);
  EXPECT_EQ(JacobianSign(Mapped(s, Eigen::Vector3d(1, 1, -1e-3).asDiagonal()), WholeBox(s)), -1);
}

TEST(JacobianSign, DecidesWhatConesDecideAndMoreInSkewFrames)
{
  std::mt19937 random(3);
  Eigen::Matrix3d skew;
  skew << 1, 0.8, 0.5, 0, 1, 0.5, 0, 0, 0.7;
  for (const bool isSkew : { false, true })
  {
    int byCones = 0;
    int bySign = 0;
    for (int run = 0; run < 2000; ++run)
    {
      const Spline lattice = NoisyLattice(random, 3, 4, 0.0001 * run, 0.0);
      const Spline s = isSkew ? Mapped(lattice, skew) : lattice;
      std::array<Cone, 3> cones;
      for (int d = 0; d < 3; ++d)
      {
        cones[static_cast<std::size_t>(d)] = DerivativeCone(s.Coefficients(), s.Degrees(), d);
      }
      const int sign = TripleProductSign(cones[0], cones[1], cones[2]);
      const int own = JacobianSign(s, WholeBox(s));
      ASSERT_TRUE(sign == 0 || own == 0 || sign == own);
      byCones += sign != 0;
      bySign += own != 0;
    }
    EXPECT_GT(bySign, (isSkew ? 1.5 : 0.95) * byCones);
    EXPECT_GT(bySign, 1000);
  }
}

TEST(JacobianSign, OfFoldedBoxesIsUnknown)
{
  const Spline s = models::SweptHalfCylinder();
  EXPECT_EQ(JacobianSign(s, WholeBox(s)), 0);
  // Refined, the spans that meet u = 1/2 remain, and none else.
  const Spline fine = RefineUniformly(s, { 16, 1, 1 });
  for (int i = 0; i < 16; ++i)
  {
    EXPECT_EQ(JacobianSign(fine, SpanBox(fine, i, 0, 0)), i < 7 ? 1 : i > 8 ? -1 : 0) << i;
  }
}

TEST(JacobianSign, OfRationalVolumesIsFoundOnLargeBoxes)
{
  const Spline tube = models::QuarterTube();
  const Spline fine = RefineUniformly(tube, { 4, 4, 4 });
  // All of it turns by 90 degrees, which no frame sees as one direction; half of it does not.
  EXPECT_EQ(JacobianSign(fine, WholeBox(fine)), 0);
  EXPECT_EQ(JacobianSign(fine, { { 0, 0.5, 0 }, { 1, 1, 1 } }), 1);
}

TEST(JacobianSign, OfDegenerateVolumesIsUnknownOnlyWhereTheyAreDegenerate)
{
  const Spline s = RefineUniformly(models::QuarterTube(), { 4, 4, 1 });
  Eigen::MatrixXd points = s.Coefficients();
  for (Eigen::Index i = 0; i < points.cols(); i += s.Sizes()[0])
  {
    points.col(i).head(2).setZero(); // the inner face becomes the axis
  }
  const Spline pole(s.Knots(), points, s.Weights());
  EXPECT_EQ(JacobianSign(pole, SpanBox(pole, 0, 0, 0)), 0);
  EXPECT_EQ(JacobianSign(pole, SpanBox(pole, 1, 0, 0)), 1);
}

TEST(JacobianSign, OfBoxesAcrossKnotPlanesHoldsOnBothSides)
{
  // A kink at u = 1/2: flat before it, backwards behind it.
  const KnotVector kinked(1, { 0, 0, 0.5, 1, 1 });
  Eigen::MatrixXd points(3, 12);
  for (int i = 0; i < 12; ++i)
  {
    const int at = i % 3;
    points.col(i) << (at == 1 ? 1.0 : 0.2 * at), i / 3 % 2, i / 6;
  }
  const Spline s({ kinked, KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) }, points);
  EXPECT_EQ(JacobianSign(s, { { 0.0, 0, 0 }, { 0.5, 1, 1 } }), 1);
  EXPECT_EQ(JacobianSign(s, { { 0.5, 0, 0 }, { 1.0, 1, 1 } }), -1);
  EXPECT_EQ(JacobianSign(s, { { 0.4, 0, 0 }, { 0.6, 1, 1 } }), 0);
}

TEST(JacobianSign, OfWhatIsNoVolumeIsUnknown)
{
  Eigen::MatrixXd flat(3, 4);
  flat << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  const Spline surface(
    { KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2), KnotVector() }, flat);
  EXPECT_EQ(JacobianSign(surface, WholeBox(surface)), 0);
  EXPECT_EQ(JacobianSign(Mapped(models::QuarterTube(), Eigen::Matrix3d::Zero()),
              WholeBox(models::QuarterTube())),
    0);
}

TEST(JacobianSign, SurvivesNumbersThatOverflow)
{
  Eigen::MatrixXd points(3, 8);
  for (int i = 0; i < 8; ++i)
  {
    const double huge = std::numeric_limits<double>::max();
    points.col(i) << (i % 2 ? huge : -huge), i / 2 % 2, i / 4;
  }
  const KnotVector k = KnotVector::Uniform(1, 2);
  const Spline s({ k, k, k }, points);
  EXPECT_EQ(JacobianSign(s, WholeBox(s)), 0);
}
