// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_Integrals_h
#define hyperpatch_testing_Integrals_h

#include "Evaluator.h"
#include "Spline.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

/// Integrals over splines by Gauss quadrature, 16 points in every direction of every element: of
/// rational integrands such as those of quarter circles the error is below rounding.
namespace integrals
{

/// Nodes and weights on [0, 1] (Golub & Welsch 1969).
inline std::pair<Eigen::VectorXd, Eigen::VectorXd> GaussRule(int n)
{
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(n, n);
  for (int i = 1; i < n; ++i)
  {
    jacobi(i, i - 1) = jacobi(i - 1, i) = i / std::sqrt(4.0 * i * i - 1.0);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi);
  return { 0.5 * (solver.eigenvalues().array() + 1.0),
    solver.eigenvectors().row(0).transpose().array().square() };
}

/// The sum over all quadrature points of weight times f(columns d/du, d/dv, d/dw).
template <typename Density>
double Integrate(const hyperpatch::Spline& spline, Density&& density)
{
  const auto [nodes, weights] = GaussRule(16);
  std::array<std::vector<double>, 3> sites;
  std::array<std::vector<double>, 3> factors;
  std::size_t count = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const std::vector<double> breaks = spline.Knots()[d].Breaks();
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    {
      for (Eigen::Index g = 0; g < nodes.size(); ++g)
      {
        sites[d].push_back(breaks[i] + (breaks[i + 1] - breaks[i]) * nodes[g]);
        factors[d].push_back((breaks[i + 1] - breaks[i]) * weights[g]);
      }
    }
    if (spline.Knots()[d].Degree() == 0)
    {
      sites[d] = { breaks[0] };
      factors[d] = { 1.0 };
    }
    count *= sites[d].size();
  }
  std::vector<double> values(3 * count);
  std::vector<double> derivatives(9 * count);
  hyperpatch::Evaluator(spline).EvaluateGrid(sites, values.data(), derivatives.data());
  double sum = 0.0;
  const double* at = derivatives.data();
  for (const double w : factors[2])
  {
    for (const double v : factors[1])
    {
      for (const double u : factors[0])
      {
        sum += u * v * w * density(Eigen::Matrix3d(Eigen::Map<const Eigen::Matrix3d>(at)));
        at += 9;
      }
    }
  }
  return sum;
}

/// The integral of det J.
inline double Volume(const hyperpatch::Spline& volume)
{
  return Integrate(volume, [](const Eigen::Matrix3d& j) { return j.determinant(); });
}

/// The area of a surface in space, whichever direction it lacks.
inline double Area(const hyperpatch::Spline& surface)
{
  const int missing = surface.Knots(0).Degree() == 0 ? 0 : surface.Knots(1).Degree() == 0 ? 1 : 2;
  return Integrate(surface,
    [missing](const Eigen::Matrix3d& j)
    { return j.col((missing + 1) % 3).cross(j.col((missing + 2) % 3)).norm(); });
}

}

#endif
