// SPDX-License-Identifier: BSD-3-Clause
#include "ScatteredFit.h"

#include "Error.h"
#include "Evaluator.h"
#include "Operators.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

using Eigen::Index;
using Eigen::MatrixXd;

void Check(const Eigen::Matrix3Xd& parameters, const MatrixXd& values,
  const std::array<double, 3>& low, const std::array<double, 3>& high,
  const ScatteredFitOptions& options)
{
  if (parameters.cols() != values.cols() || values.cols() < 1 || values.rows() < 1)
  {
    throw Error(std::to_string(values.cols()) + " values at " + std::to_string(parameters.cols()) +
      " points cannot be fitted: each point needs one");
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (!(low[d] <= high[d]) || !std::isfinite(low[d]) || !std::isfinite(high[d]))
    {
      throw Error("the box to fit scattered data in is empty or not finite");
    }
    if (options.Degrees[d] < 1)
    {
      throw Error(
        "degree " + std::to_string(options.Degrees[d]) + " cannot be fitted: take 1 or more");
    }
    if (!(options.Tolerance > 0.0) && options.ControlPoints[d] < options.Degrees[d] + 1)
    {
      throw Error(std::to_string(options.ControlPoints[d]) +
        " control points are too few for degree " + std::to_string(options.Degrees[d]) +
        ": at least " + std::to_string(options.Degrees[d] + 1) + " are needed");
    }
  }
  for (Index i = 0; i < parameters.cols(); ++i)
  {
    for (int d = 0; d < 3; ++d)
    {
      const double x = parameters(d, i);
      if (!(x >= low[static_cast<std::size_t>(d)] && x <= high[static_cast<std::size_t>(d)]))
      {
        throw Error("point " + std::to_string(i) + " is outside the box to fit, or not finite");
      }
    }
    if (!values.col(i).allFinite())
    {
      throw Error("sample " + std::to_string(i) + " is not a finite number");
    }
  }
}

/// The best linear polynomial, as a spline over the given knots. Directions that the points do not
/// span get slope 0.
Spline LinearTrend(const std::array<KnotVector, 3>& knots, const Eigen::Matrix3Xd& parameters,
  const MatrixXd& values)
{
  // Centred and scaled: the normal equations of an ill-scaled box would have no digits left.
  Eigen::Vector3d centre;
  Eigen::Vector3d scale;
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& k = knots[static_cast<std::size_t>(d)];
    centre[d] = 0.5 * (k.First() + k.Last());
    scale[d] = k.Degree() > 0 ? 2.0 / (k.Last() - k.First()) : 0.0;
  }
  const auto basis = [&centre, &scale](const Eigen::Vector3d& x)
  {
    Eigen::Vector4d row;
    row << 1.0, scale.cwiseProduct(x - centre);
    return row;
  };
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Matrix4Xd right = Eigen::Matrix4Xd::Zero(4, values.rows());
  for (Index i = 0; i < parameters.cols(); ++i)
  {
    const Eigen::Vector4d row = basis(parameters.col(i));
    normal += row * row.transpose();
    right += row * values.col(i).transpose();
  }
  const Eigen::Matrix4Xd slopes = normal.completeOrthogonalDecomposition().solve(right);
  MatrixXd coefficients(
    values.rows(), static_cast<Index>(knots[0].Size()) * knots[1].Size() * knots[2].Size());
  Index c = 0;
  for (int k = 0; k < knots[2].Size(); ++k)
  {
    for (int j = 0; j < knots[1].Size(); ++j)
    {
      for (int i = 0; i < knots[0].Size(); ++i, ++c)
      {
        const Eigen::Vector3d x{ knots[0].Greville(i), knots[1].Greville(j), knots[2].Greville(k) };
        coefficients.col(c) = slopes.transpose() * basis(x);
      }
    }
  }
  return Spline(knots, std::move(coefficients));
}

/// The B-spline approximation of one level: control points are means of what each datum, alone,
/// would ask of them (eqs. 3 to 5).
MatrixXd ApproximateLevel(const std::array<KnotVector, 3>& knots,
  const Eigen::Matrix3Xd& parameters, const MatrixXd& residuals)
{
  const int size[2] = { knots[0].Size(), knots[1].Size() };
  const Index count = static_cast<Index>(size[0]) * size[1] * knots[2].Size();
  MatrixXd sums = MatrixXd::Zero(residuals.rows(), count);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(count);
  double basis[3][MaxDegree + 1];
  int first[3];
  for (Index n = 0; n < parameters.cols(); ++n)
  {
    double squares = 1.0;
    for (int d = 0; d < 3; ++d)
    {
      const KnotVector& k = knots[static_cast<std::size_t>(d)];
      const int span = k.FindSpan(parameters(d, n));
      first[d] = span - k.Degree();
      k.BasisFunctions(span, parameters(d, n), basis[d]);
      double sum = 0.0;
      for (int a = 0; a <= k.Degree(); ++a)
      {
        sum += basis[d][a] * basis[d][a];
      }
      squares *= sum;
    }
    const auto value = residuals.col(n);
    for (int c = 0; c <= knots[2].Degree(); ++c)
    {
      for (int b = 0; b <= knots[1].Degree(); ++b)
      {
        const Index row =
          first[0] + size[0] * (first[1] + b + static_cast<Index>(size[1]) * (first[2] + c));
        for (int a = 0; a <= knots[0].Degree(); ++a)
        {
          const double w = basis[0][a] * basis[1][b] * basis[2][c];
          weights[row + a] += w * w;
          sums.col(row + a) += w * w * w / squares * value;
        }
      }
    }
  }
  for (Index i = 0; i < count; ++i)
  {
    // No datum near: the coarser levels decide.
    sums.col(i) *= weights[i] > 0.0 ? 1.0 / weights[i] : 0.0;
  }
  return sums;
}

/// values - spline(parameters)
MatrixXd Residuals(const Spline& spline, const Eigen::Matrix3Xd& parameters, const MatrixXd& values,
  const ParallelFor& parallelFor)
{
  const Evaluator evaluator(spline);
  MatrixXd result(values.rows(), values.cols());
  parallelFor(values.cols(), 4096,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      evaluator.Evaluate(static_cast<std::size_t>(end - begin), parameters.data() + 3 * begin,
        result.data() + result.rows() * begin);
    });
  return values - result;
}

int NextPowerOfTwo(int n)
{
  int power = 1;
  while (power < n)
  {
    power *= 2;
  }
  return power;
}

}

Spline FitScattered(const Eigen::Matrix3Xd& parameters, const MatrixXd& values,
  std::array<double, 3> low, std::array<double, 3> high, const ScatteredFitOptions& options,
  const ParallelFor& parallelFor)
{
  Check(parameters, values, low, high, options);
  // Squares of the values occur: in a unit of about their size, a power of two, none overflows.
  const double size = values.cwiseAbs().maxCoeff();
  const double unit = size > 0.0 ? std::exp2(std::clamp(std::ilogb(size), -1000, 1000)) : 1.0;
  const MatrixXd scaled = values / unit;
  const double tolerance = options.Tolerance / unit;
  Eigen::Matrix3Xd sites = parameters;
  std::array<KnotVector, 3> knots;
  std::array<int, 3> spans{ 1, 1, 1 };
  std::array<int, 3> goal{ 1, 1, 1 };
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (low[d] < high[d])
    {
      knots[d] = KnotVector::Uniform(options.Degrees[d], options.Degrees[d] + 1, low[d], high[d]);
      goal[d] = NextPowerOfTwo(options.ControlPoints[d] - options.Degrees[d]);
    }
    else
    {
      sites.row(static_cast<Index>(d)).setConstant(0.5);
    }
  }
  const bool toTolerance = options.Tolerance > 0.0;
  Spline sum = LinearTrend(knots, sites, scaled);
  for (;;)
  {
    const MatrixXd coefficients =
      ApproximateLevel(sum.Knots(), sites, Residuals(sum, sites, scaled, parallelFor));
    sum = Spline(sum.Knots(), sum.Coefficients() + coefficients);

    // The next level halves the directions with the longest spans: all, where the shape of the
    // final lattice, or that of the box, is reached already.
    std::array<double, 3> lengths{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      const bool there = knots[d].Degree() > 0;
      lengths[d] = !there ? 0.0
        : toTolerance     ? (high[d] - low[d]) / spans[d]
                          : static_cast<double>(goal[d]) / spans[d];
    }
    const double longest = *std::max_element(lengths.begin(), lengths.end());
    std::array<int, 3> pieces{ 1, 1, 1 };
    Index next = 1;
    for (std::size_t d = 0; d < 3; ++d)
    {
      pieces[d] = lengths[d] > 0.7 * longest ? 2 : 1;
      spans[d] *= pieces[d];
      next *= spans[d] + knots[d].Degree();
    }
    const bool done = toTolerance
      ? MeasureError(sum, sites, scaled, parallelFor).Of(options.Measure) <= tolerance ||
        next > 4 * scaled.cols() + 64
      : longest <= 1.0;
    if (done)
    {
      return Spline(sum.Knots(), unit * sum.Coefficients());
    }
    sum = RefineUniformly(sum, pieces);
  }
}

FitError MeasureError(const Spline& spline, const Eigen::Matrix3Xd& parameters,
  const MatrixXd& values, const ParallelFor& parallelFor)
{
  return FitError::Of(
    Residuals(spline, parameters, values, parallelFor).colwise().stableNorm().transpose());
}

}
