// SPDX-License-Identifier: BSD-3-Clause
#include "Measures.h"

#include "Evaluator.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyperpatch
{

int Handedness(const Spline& geometry)
{
  if (geometry.Dimension() < 3 || geometry.Components() < 3)
  {
    return 0;
  }
  std::array<std::vector<double>, 3> centres;
  std::array<std::vector<double>, 3> lengths;
  std::size_t count = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const std::vector<double> breaks = geometry.Knots(static_cast<int>(d)).Breaks();
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    {
      centres[d].push_back(0.5 * (breaks[i] + breaks[i + 1]));
      lengths[d].push_back(breaks[i + 1] - breaks[i]);
    }
    count *= centres[d].size();
  }
  std::vector<double> values(3 * count);
  std::vector<double> derivatives(9 * count);
  Evaluator(geometry).EvaluateGrid(centres, values.data(), derivatives.data());
  double sum = 0.0;
  double largest = 0.0; // what the sum could be, as measure of its rounding
  const double* jacobian = derivatives.data();
  for (const double w : lengths[2])
  {
    for (const double v : lengths[1])
    {
      for (const double u : lengths[0])
      {
        const Eigen::Map<const Eigen::Matrix3d> columns(jacobian);
        sum += columns.determinant() * u * v * w;
        largest += columns.colwise().norm().prod() * u * v * w;
        jacobian += 9;
      }
    }
  }
  if (std::abs(sum) <= 1e-13 * largest)
  {
    return 0;
  }
  return sum > 0.0 ? 1 : -1;
}

int Handedness(const Patch& patch)
{
  return patch.WholeHandedness != 0 ? patch.WholeHandedness : Handedness(patch.Body.Geometry());
}

Bounds ControlPointBounds(const MultiPatch& model)
{
  Bounds bounds;
  bounds.Low.fill(std::numeric_limits<double>::infinity());
  bounds.High.fill(-std::numeric_limits<double>::infinity());
  for (const Patch& patch : model.Patches)
  {
    const Eigen::MatrixXd& points = patch.Body.Geometry().Coefficients();
    for (std::size_t d = 0; d < 3; ++d)
    {
      const auto row = static_cast<Eigen::Index>(d);
      const bool there = row < points.rows();
      bounds.Low[d] = std::min(bounds.Low[d], there ? points.row(row).minCoeff() : 0.0);
      bounds.High[d] = std::max(bounds.High[d], there ? points.row(row).maxCoeff() : 0.0);
    }
  }
  return bounds;
}

}
