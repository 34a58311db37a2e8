// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_RealFiles_h
#define hyperpatch_testing_RealFiles_h

#include "Evaluator.h"
#include "Formats.h"

#include <Eigen/LU>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace models
{

/// Files of other projects in a folder of the shared data, sorted; empty where it is absent.
inline std::vector<std::string> RealFiles(const std::string& folder)
{
  std::vector<std::string> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(
         std::filesystem::path(HYPERPATCH_SHARED_DATA) / folder, none))
  {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

inline std::string RealFile(const std::string& name)
{
  return std::string(HYPERPATCH_SHARED_DATA) + "/" + name;
}

/// Largest distance of the two sides of an interface, at a grid of points of both patches.
inline double Gap(const hyperpatch::MultiPatch& model, const hyperpatch::Interface& interface)
{
  using namespace hyperpatch;
  const auto& n = interface.Values;
  const auto find = [&model](int id) -> const Spline&
  {
    return std::find_if(
      model.Patches.begin(), model.Patches.end(), [id](const Patch& p) { return p.Id == id; })
      ->Body.Geometry();
  };
  const Spline& one = find(n[0]);
  const Spline& two = find(n[2]);
  double gap = 0.0;
  constexpr int steps = 5;
  for (int j = 0; j <= steps; ++j)
  {
    for (int i = 0; i <= steps; ++i)
    {
      double u[3] = {};
      double v[3] = {};
      const double fractions[2] = { static_cast<double>(i) / steps,
        static_cast<double>(j) / steps };
      int used = 0;
      for (int d = 0; d < 3; ++d)
      {
        const bool normal = d == (n[1] - 1) / 2;
        const double f = normal ? (n[1] - 1) % 2 : fractions[used++];
        const int e = n[static_cast<std::size_t>(4 + d)];
        const double g = normal ? (n[3] - 1) % 2 : n[static_cast<std::size_t>(7 + d)] ? f : 1.0 - f;
        u[d] = one.Knots(d).First() * (1 - f) + one.Knots(d).Last() * f;
        v[e] = two.Knots(e).First() * (1 - g) + two.Knots(e).Last() * g;
      }
      gap = std::max(gap, (one.Evaluate(u[0], u[1], u[2]) - two.Evaluate(v[0], v[1], v[2])).norm());
    }
  }
  return gap;
}

/// The determinant of the Jacobian at an inner grid of points.
inline std::vector<double> Determinants(const hyperpatch::Spline& volume)
{
  const hyperpatch::Evaluator evaluator(volume);
  std::vector<double> determinants;
  for (int n = 0; n < 27; ++n)
  {
    double u[3];
    for (int d = 0, rest = n; d < 3; ++d, rest /= 3)
    {
      const hyperpatch::KnotVector& k = volume.Knots(d);
      u[d] = k.First() + (k.Last() - k.First()) * (0.1 + 0.4 * (rest % 3));
    }
    double value[3];
    Eigen::Matrix3d jacobian;
    evaluator.EvaluateWithDerivatives(1, u, value, jacobian.data());
    determinants.push_back(jacobian.determinant());
  }
  return determinants;
}

/// Diagonal of the control points' bounds.
inline double Diagonal(const hyperpatch::MultiPatch& model)
{
  Eigen::VectorXd low = model.Patches.front().Body.Geometry().Coefficients().col(0);
  Eigen::VectorXd high = low;
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    const auto points = patch.Body.Geometry().Coefficients();
    low = low.cwiseMin(points.rowwise().minCoeff());
    high = high.cwiseMax(points.rowwise().maxCoeff());
  }
  return (high - low).norm();
}

}

#endif
