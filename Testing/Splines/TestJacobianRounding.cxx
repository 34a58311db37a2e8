// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianRounding.h"

#include "Evaluator.h"
#include "JacobianField.h"
#include "Models.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <limits>

using namespace hyperpatch;

namespace
{

/// The Jacobian matrix of a spline in extended precision, by its definition (A2.2, A4.4).
Eigen::Matrix<long double, 3, 3> Exact(const Spline& spline, const double* parameters)
{
  using Real = long double;
  std::array<std::vector<Real>, 3> values;
  std::array<std::vector<Real>, 3> derivatives;
  std::array<int, 3> first{};
  for (int d = 0; d < 3; ++d)
  {
    const auto i = static_cast<std::size_t>(d);
    const KnotVector& knots = spline.Knots(d);
    const int p = knots.Degree();
    const Real u = parameters[d];
    const int span = knots.FindSpan(parameters[d]);
    first[i] = span - p;
    // Triangle of Cox and de Boor.
    const auto basis = [&](int degree)
    {
      std::vector<Real> n(static_cast<std::size_t>(degree) + 1, Real(1));
      for (int q = 1; q <= degree; ++q)
      {
        Real saved = 0;
        for (int r = 0; r < q; ++r)
        {
          const Real right = knots[span + r + 1];
          const Real left = knots[span + 1 - q + r];
          const Real term = n[static_cast<std::size_t>(r)] / (right - left);
          n[static_cast<std::size_t>(r)] = saved + (right - u) * term;
          saved = (u - left) * term;
        }
        n[static_cast<std::size_t>(q)] = saved;
      }
      return n;
    };
    values[i] = basis(p);
    const std::vector<Real> lower = basis(p - 1);
    derivatives[i].assign(static_cast<std::size_t>(p) + 1, Real(0));
    for (int j = 0; j < p; ++j)
    {
      const int k = span - p + 1 + j;
      const Real slope = p * lower[static_cast<std::size_t>(j)] /
        (static_cast<Real>(knots[k + p]) - static_cast<Real>(knots[k]));
      derivatives[i][static_cast<std::size_t>(j)] -= slope;
      derivatives[i][static_cast<std::size_t>(j) + 1] += slope;
    }
  }
  Eigen::Matrix<Real, 4, 4> sums = Eigen::Matrix<Real, 4, 4>::Zero(); // value, d/du, d/dv, d/dw
  const auto sizes = spline.Sizes();
  for (std::size_t k = 0; k < values[2].size(); ++k)
  {
    for (std::size_t j = 0; j < values[1].size(); ++j)
    {
      for (std::size_t i = 0; i < values[0].size(); ++i)
      {
        const Eigen::Index column = first[0] + static_cast<Eigen::Index>(i) +
          sizes[0] *
            (first[1] + static_cast<Eigen::Index>(j) +
              static_cast<Eigen::Index>(sizes[1]) * (first[2] + static_cast<Eigen::Index>(k)));
        Eigen::Matrix<Real, 4, 1> point;
        const Real weight = spline.IsRational() ? spline.Weights()[column] : 1.0;
        point << weight * spline.Coefficients().col(column).cast<Real>(), weight;
        sums.col(0) += values[0][i] * values[1][j] * values[2][k] * point;
        sums.col(1) += derivatives[0][i] * values[1][j] * values[2][k] * point;
        sums.col(2) += values[0][i] * derivatives[1][j] * values[2][k] * point;
        sums.col(3) += values[0][i] * values[1][j] * derivatives[2][k] * point;
      }
    }
  }
  Eigen::Matrix<Real, 3, 3> J;
  for (int d = 0; d < 3; ++d)
  {
    J.col(d) =
      (sums.col(d + 1).head(3) - sums(3, d + 1) / sums(3, 0) * sums.col(0).head(3)) / sums(3, 0);
  }
  return J;
}

}

TEST(JacobianRounding, BoundsTheErrorOfTheDeterminant)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int n = 0; n < 60; ++n)
  {
    std::array<KnotVector, 3> knots;
    for (KnotVector& k : knots)
    {
      const int degree = 1 + static_cast<int>(random() % 4);
      k = models::RandomKnots(random, degree, degree + 3, random() % 2 == 0);
    }
    Spline spline = models::RandomSpline(random, knots, 3, n % 2 == 0);
    // Far from the origin, and flat in one direction: derivatives cancel.
    Eigen::MatrixXd points = spline.Coefficients();
    if (n % 3 > 0)
    {
      points.row(1) *= 1e-7;
    }
    if (n % 3 > 1)
    {
      points.array() += 1000.0;
    }
    spline = Spline(knots, points, spline.Weights());
    const Evaluator evaluator(spline);
    const JacobianRounding rounding(spline);
    for (int i = 0; i < 50; ++i)
    {
      double u[3];
      for (int d = 0; d < 3; ++d)
      {
        u[d] = knots[static_cast<std::size_t>(d)].First() +
          (knots[static_cast<std::size_t>(d)].Last() - knots[static_cast<std::size_t>(d)].First()) *
            unit(random);
      }
      double value[3];
      Eigen::Matrix3d J;
      evaluator.EvaluateWithDerivatives(1, u, value, J.data());
      const double error = std::abs(static_cast<double>(
        Exact(spline, u).determinant() - static_cast<long double>(J.determinant())));
      ASSERT_LE(error, rounding.Bound(J, u)) << n;
      ASSERT_LE(rounding.Bound(J, u), rounding.LargestBound(J) * (1 + 1e-15)) << n;
    }
  }
}

TEST(JacobianRounding, WhereControlPointsAreEqualTheDeterminantIsZero)
{
  // P_u is zero at the knot u = 6/7 of the face v = 1, where two control points are equal, on a
  // curve that is not straight.
  std::vector<double> u{ 0, 0, 0 };
  for (int i = 1; i < 7; ++i)
  {
    u.push_back(0.142857142857 * i);
  }
  u.insert(u.end(), { 1, 1, 1 });
  const std::array<KnotVector, 3> knots{ KnotVector(2, u), KnotVector::Uniform(1, 2),
    KnotVector::Uniform(1, 2) };
  Eigen::MatrixXd points(3, 36);
  for (int n = 0; n < 36; ++n)
  {
    const int i = n % 9;
    const double radius = n / 9 % 2 == 0 ? 0.37 : 0.83;
    const double angle = 0.7 * (i == 7 && n / 9 % 2 == 1 ? 6 : i);
    points.col(n) << radius * std::cos(angle), radius * std::sin(angle), n / 18 * 1.3;
  }
  const Spline spline(knots, points);
  const JacobianField field(spline);
  for (int i = 0; i <= 100; ++i)
  {
    const double at[3] = { u[8], 1.0, 0.01 * i };
    double value = 1.0;
    field.Evaluate(1, at, &value);
    EXPECT_EQ(value, 0.0);
    // Not far away it is not.
    const double beside[3] = { u[8] - 1e-6, 1.0, 0.01 * i };
    field.Evaluate(1, beside, &value);
    EXPECT_NE(value, 0.0);
  }
}
