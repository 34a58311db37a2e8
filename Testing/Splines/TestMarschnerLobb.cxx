// SPDX-License-Identifier: BSD-3-Clause
// The test signal of Marschner & Lobb (An evaluation of reconstruction filters for volume
// rendering, Visualization 1994), sampled and interpolated.
#include "Evaluator.h"
#include "Interpolation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

using namespace hyperpatch;

namespace
{

const double Pi = std::acos(-1.0);

double MarschnerLobb(double x, double y, double z)
{
  const double alpha = 0.25;
  const double wave = std::cos(2.0 * Pi * 6.0 * std::cos(0.5 * Pi * std::hypot(x, y)));
  return (1.0 - std::sin(0.5 * Pi * z) + alpha * (1.0 + wave)) / (2.0 * (1.0 + alpha));
}

std::vector<double> Line(int count)
{
  std::vector<double> line;
  for (int i = 0; i < count; ++i)
  {
    line.push_back(-1.0 + 2.0 * i / (count - 1));
  }
  return line;
}

struct Errors
{
  double Overall = 0.0;
  double Inner = 0.0; ///< in |x|, |y| < 0.8
};

/// The errors between samples, at a fifth of their distance.
Errors InterpolationErrors(int count, int degree)
{
  const std::vector<double> sites = Line(count);
  const KnotVector knots = InterpolationKnots(degree, sites);
  Eigen::MatrixXd samples(1, count * count * count);
  Eigen::Index i = 0;
  for (const double z : sites)
  {
    for (const double y : sites)
    {
      for (const double x : sites)
      {
        samples(0, i++) = MarschnerLobb(x, y, z);
      }
    }
  }
  const Spline spline =
    Interpolate({ knots, knots, knots }, { sites, sites, sites }, std::move(samples));

  const std::vector<double> fine = Line(5 * (count - 1) + 1);
  // Along z the signal is half a sine, of no concern.
  const std::vector<double> heights = Line(24);
  const Evaluator evaluator(spline);
  std::vector<double> values(fine.size() * fine.size());
  Errors errors;
  for (const double z : heights)
  {
    evaluator.EvaluateGrid({ fine, fine, { z } }, values.data());
    std::size_t v = 0;
    for (const double y : fine)
    {
      for (const double x : fine)
      {
        const double error = std::abs(values[v++] - MarschnerLobb(x, y, z));
        errors.Overall = std::max(errors.Overall, error);
        if (std::max(std::abs(x), std::abs(y)) < 0.8)
        {
          errors.Inner = std::max(errors.Inner, error);
        }
      }
    }
  }
  std::cout << count << "^3, degree " << degree << ": largest error " << errors.Overall
            << ", in |x|, |y| < 0.8 " << errors.Inner << "\n";
  return errors;
}

}

TEST(MarschnerLobb, CubicsResolveItAt81Samples)
{
  const Errors cubic = InterpolationErrors(81, 3);
  EXPECT_LE(cubic.Overall, 0.013);
  EXPECT_LE(cubic.Inner, 0.002);
  const Errors linear = InterpolationErrors(81, 1);
  EXPECT_GT(linear.Overall, 0.02);
  EXPECT_GT(linear.Inner, 0.02);
}

TEST(MarschnerLobb, NoDegreeResolvesItAt41Samples)
{
  // The signal reaches 94 % of the Nyquist frequency there: an aliased case.
  for (const int degree : { 1, 3, 9 })
  {
    EXPECT_GT(InterpolationErrors(41, degree).Inner, 0.03);
  }
}
