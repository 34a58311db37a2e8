// SPDX-License-Identifier: BSD-3-Clause
#include "DoublePointWorker.h"

#include "KnotVector.h"
#include "RoundingWorker.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

using rounding::U;

namespace
{

/// A double point this close to the border of an element, in its unit cube, is none: patches that
/// touch may overlap by rounding.
constexpr double Margin = 1e-7;

/// The greatest length of (mixed) second differences of the rows of the points, times degrees: a
/// bound of a second derivative of the homogeneous form; of a first one with e = -1.
double DerivativeBound(const BezierPiece& element, const Eigen::MatrixXd& points, int d, int e)
{
  const auto difference = [](const Eigen::MatrixXd& of, std::array<int, 3>& degrees,
                            int direction) -> Eigen::MatrixXd
  {
    const auto i = static_cast<std::size_t>(direction);
    const int p = degrees[i];
    const Eigen::Index stride = (direction > 0 ? degrees[0] + 1 : 1) *
      static_cast<Eigen::Index>(direction > 1 ? degrees[1] + 1 : 1);
    const Eigen::Index slabs = of.cols() / (stride * (p + 1));
    --degrees[i];
    if (p == 0)
    {
      return Eigen::MatrixXd::Zero(of.rows(), 1);
    }
    Eigen::MatrixXd result(of.rows(), slabs * stride * p);
    for (Eigen::Index s = 0; s < slabs; ++s)
    {
      result.middleCols(s * stride * p, stride * p) = p *
        (of.middleCols(s * stride * (p + 1) + stride, stride * p) -
          of.middleCols(s * stride * (p + 1), stride * p));
    }
    return result;
  };
  std::array<int, 3> degrees = element.Degrees();
  Eigen::MatrixXd result = difference(points, degrees, d);
  if (e >= 0 && degrees[static_cast<std::size_t>(e)] < 1)
  {
    return 0.0;
  }
  if (e >= 0)
  {
    result = difference(result, degrees, e);
  }
  return result.colwise().norm().maxCoeff();
}

/// A Lipschitz constant of the Jacobian of an element (in the Frobenius norm).
double JacobianLipschitz(const BezierPiece& element, const Eigen::Vector3d& origin)
{
  double square = 0.0;
  if (!element.IsRational())
  {
    for (int d = 0; d < 3; ++d)
    {
      for (int e = 0; e < 3; ++e)
      {
        square += std::pow(DerivativeBound(element, element.Points(), d, e), 2);
      }
    }
    return std::sqrt(square);
  }
  // With X about the origin: P_d = (X_d - P W_d) / W and
  // P_de = (X_de - W_d P_e - W_e P_d - W_de P) / W.
  const Eigen::MatrixXd w = element.Points().row(3);
  const Eigen::MatrixXd x = element.Points().topRows<3>() - origin * w;
  const double least = w.minCoeff() - element.Error();
  const double size = (element.Projected().colwise() - origin).colwise().norm().maxCoeff();
  double first[3];
  double weight[3];
  for (int d = 0; d < 3; ++d)
  {
    weight[d] = DerivativeBound(element, w, d, -1);
    first[d] = (DerivativeBound(element, x, d, -1) + size * weight[d]) / least;
  }
  for (int d = 0; d < 3; ++d)
  {
    for (int e = 0; e < 3; ++e)
    {
      square += std::pow((DerivativeBound(element, x, d, e) + weight[d] * first[e] +
                           weight[e] * first[d] + DerivativeBound(element, w, d, e) * size) /
          least,
        2);
    }
  }
  return std::sqrt(square);
}

bool IsInside(const Eigen::Vector3d& parameters, double margin)
{
  return parameters.minCoeff() > margin && parameters.maxCoeff() < 1.0 - margin;
}

}

ElementValue EvaluateElement(const BezierPiece& element, const std::array<double, 3>& parameters)
{
  double basis[3][MaxDegree + 1];
  double slope[3][MaxDegree + 1];
  int steps = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const int p = element.Degrees()[d];
    const double t = parameters[d];
    double* b = basis[d];
    b[0] = 1.0;
    std::fill_n(slope[d], p + 1, 0.0);
    for (int r = 1; r <= p; ++r)
    {
      if (r == p)
      {
        for (int i = 0; i < p; ++i)
        {
          slope[d][i] -= p * b[i];
          slope[d][i + 1] += p * b[i];
        }
      }
      double saved = 0.0;
      for (int i = 0; i < r; ++i)
      {
        const double value = b[i];
        b[i] = saved + (1.0 - t) * value;
        saved = t * value;
      }
      b[r] = saved;
    }
    steps += 4 * p + 2;
  }
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(element.Points().rows(), 4);
  Eigen::Index index = 0;
  for (int k = 0; k <= element.Degree(2); ++k)
  {
    for (int j = 0; j <= element.Degree(1); ++j)
    {
      for (int i = 0; i <= element.Degree(0); ++i, ++index)
      {
        const auto point = element.Points().col(index);
        sums.col(0) += basis[0][i] * basis[1][j] * basis[2][k] * point;
        sums.col(1) += slope[0][i] * basis[1][j] * basis[2][k] * point;
        sums.col(2) += basis[0][i] * slope[1][j] * basis[2][k] * point;
        sums.col(3) += basis[0][i] * basis[1][j] * slope[2][k] * point;
      }
    }
  }
  ElementValue result;
  const auto operations = static_cast<double>(steps + element.Points().cols());
  result.Error = element.Error() +
    rounding::Gamma(operations) * element.Points().cwiseAbs().maxCoeff() * rounding::Outward;
  result.X = sums.col(0).head<3>();
  result.J = sums.rightCols<3>().topRows<3>();
  if (element.IsRational())
  {
    const double w = sums(3, 0);
    result.X /= w;
    result.J = (result.J - result.X * sums.row(3).tail<3>()) / w;
    result.Error = (result.Error * (1.0 + result.X.cwiseAbs().maxCoeff()) / (w - result.Error) +
                     2 * U * result.X.cwiseAbs().maxCoeff()) *
      rounding::Outward;
  }
  return result;
}

std::optional<SameImage> FindSameImage(const BezierPiece& a, const std::array<double, 3>& start,
  const BezierPiece& b, std::array<double, 3> guess, bool areOneElement)
{
  const ElementValue target = EvaluateElement(a, start);
  Eigen::Map<Eigen::Vector3d> y(guess.data());
  ElementValue value = EvaluateElement(b, guess);
  for (int iteration = 0; iteration < 20; ++iteration)
  {
    const Eigen::Vector3d step = value.J.partialPivLu().solve(target.X - value.X);
    if (!step.allFinite() || step.norm() > 1e3)
    {
      return std::nullopt;
    }
    // Steps of at most half an element: far away the polynomial says nothing of it.
    y += step * std::min(1.0, 0.5 / step.norm());
    value = EvaluateElement(b, guess);
    if (step.norm() < 1e-14)
    {
      break;
    }
  }
  if (!IsInside(y, Margin))
  {
    return std::nullopt;
  }
  const double least = value.J.jacobiSvd().singularValues()[2];
  const double residual =
    (value.X - target.X).norm() + std::sqrt(3.0) * (value.Error + target.Error);
  const double step = residual / least * 1.01;
  // 1/2 would do in exact arithmetic; the rounding of J is far below the rest.
  const double h = step * JacobianLipschitz(b, target.X) / least * 1.01;
  if (!(h < 0.1) || !IsInside(y, Margin + 2 * step))
  {
    return std::nullopt;
  }
  const Eigen::Map<const Eigen::Vector3d> x(start.data());
  if (areOneElement && !((x - y).norm() > 4 * step + Margin))
  {
    return std::nullopt;
  }
  return SameImage{ start, guess, target.X };
}

std::optional<SameImage> FindSameImageAtFold(const BezierPiece& element,
  const std::array<double, 3>& positive, const std::array<double, 3>& negative)
{
  std::array<double, 3> low = negative;
  std::array<double, 3> high = positive;
  for (int i = 0; i < 60; ++i)
  {
    std::array<double, 3> middle;
    for (std::size_t d = 0; d < 3; ++d)
    {
      middle[d] = 0.5 * (low[d] + high[d]);
    }
    (EvaluateElement(element, middle).J.determinant() < 0.0 ? low : high) = middle;
  }
  // At a fold P(x + s k) and P(x - s k) differ by s^3 only, k the kernel of J at x.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(EvaluateElement(element, low).J, Eigen::ComputeFullV);
  const Eigen::Vector3d kernel = svd.matrixV().col(2);
  for (const double distance : { 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003 })
  {
    for (const double sign : { 1.0, -1.0 })
    {
      std::array<double, 3> start;
      std::array<double, 3> guess;
      bool inside = true;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const double move = sign * distance * kernel[static_cast<Eigen::Index>(d)];
        start[d] = low[d] + move;
        guess[d] = low[d] - move;
        inside = inside && start[d] > Margin && start[d] < 1.0 - Margin;
      }
      if (!inside)
      {
        continue;
      }
      if (auto found = FindSameImage(element, start, element, guess, true))
      {
        return found;
      }
    }
  }
  return std::nullopt;
}

}
