// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_Models_h
#define hyperpatch_testing_Models_h

#include "Aggregate.h"

#include <cmath>
#include <random>

/// Analytic and random splines that the tests share.
namespace models
{

using namespace hyperpatch;

/// Knots k_0 .. k_{n+p} with random spacing; clamped or not, with some interior knots repeated.
inline KnotVector RandomKnots(std::mt19937& random, int degree, int size, bool clamped)
{
  std::uniform_real_distribution<double> step(0.2, 1.0);
  std::vector<double> knots(static_cast<std::size_t>(size + degree + 1));
  double knot = 0.0;
  int run = 1;
  for (int i = 0; i < static_cast<int>(knots.size()); ++i)
  {
    const bool end = clamped && (i <= degree || i > size);
    const bool begins = clamped && i == size;
    if (i > 0 && !end && (begins || run >= degree || random() % 4 != 0))
    {
      knot += step(random);
      run = 1;
    }
    else
    {
      ++run;
    }
    knots[static_cast<std::size_t>(i)] = knot;
  }
  return KnotVector(degree, knots);
}

/// Random control points in a unit cube per component, weights in [0.5, 2].
inline Spline RandomSpline(
  std::mt19937& random, std::array<KnotVector, 3> knots, int components, bool rational)
{
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  std::uniform_real_distribution<double> weight(0.5, 2.0);
  const Eigen::Index n =
    static_cast<Eigen::Index>(knots[0].Size()) * knots[1].Size() * knots[2].Size();
  Eigen::MatrixXd points(components, n);
  for (Eigen::Index i = 0; i < points.size(); ++i)
  {
    points.data()[i] = coordinate(random);
  }
  Eigen::VectorXd weights(rational ? n : 0);
  for (Eigen::Index i = 0; i < weights.size(); ++i)
  {
    weights[i] = weight(random);
  }
  return Spline(std::move(knots), points, weights);
}

/// Quarter of a tube: radius 1 + u, angle pi/2 in v (exact), height w; rational, degrees 1, 2, 1.
inline Spline QuarterTube()
{
  Eigen::MatrixXd points(3, 12);
  Eigen::VectorXd weights(12);
  const double arc[3][3] = { { 1, 0, 1 }, { 1, 1, std::sqrt(0.5) }, { 0, 1, 1 } };
  for (int k = 0, n = 0; k < 2; ++k)
  {
    for (int j = 0; j < 3; ++j)
    {
      for (int i = 0; i < 2; ++i, ++n)
      {
        points.col(n) << (1 + i) * arc[j][0], (1 + i) * arc[j][1], k;
        weights[n] = arc[j][2];
      }
    }
  }
  return Spline({ KnotVector::Uniform(1, 2), KnotVector::Uniform(2, 3), KnotVector::Uniform(1, 2) },
    points, weights);
}

/// Joy & Duchaineau's Figure 1, a half cylinder swept by 3 along x, as an exact rational cubic:
/// u the semicircle from (1, 0) over (0, 1) to (-1, 0), v the height z, w the sweep. det J = 0 on
/// u = 1/2, whose image is the rectangle y = 1, 0 <= x <= 3, 0 <= z <= 1.
inline Spline SweptHalfCylinder()
{
  Eigen::MatrixXd points(3, 16);
  Eigen::VectorXd weights(16);
  const double arc[4][3] = { { 1, 0, 1 }, { 1, 2, 1.0 / 3 }, { -1, 2, 1.0 / 3 }, { -1, 0, 1 } };
  for (int k = 0, n = 0; k < 2; ++k)
  {
    for (int j = 0; j < 2; ++j)
    {
      for (int i = 0; i < 4; ++i, ++n)
      {
        points.col(n) << arc[i][0] + 3.0 * k, arc[i][1], j;
        weights[n] = arc[i][2];
      }
    }
  }
  return Spline({ KnotVector::Uniform(3, 4), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) },
    points, weights);
}

}

#endif
