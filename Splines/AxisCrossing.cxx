// SPDX-License-Identifier: BSD-3-Clause
#include "AxisCrossing.h"

#include "Error.h"
#include "Operators.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

double End(const Spline& spline, int direction, bool last)
{
  const KnotVector& knots = spline.Knots(direction);
  return last ? knots.Last() : knots.First();
}

/// Length of a piece in one direction, as a fraction of the whole; 0 if it is not there.
double Length(const Spline& piece, const Spline& whole, int direction)
{
  return piece.Knots(direction).Degree() == 0
    ? 0.0
    : (End(piece, direction, true) - End(piece, direction, false)) /
      (End(whole, direction, true) - End(whole, direction, false));
}

/// The halves of a clamped piece, in its longer direction.
std::array<Spline, 2> Halves(const Spline& piece, const Spline& whole)
{
  const auto split =
    static_cast<std::size_t>(Length(piece, whole, 1) > Length(piece, whole, 0) ? 1 : 0);
  std::array<double, 3> low{};
  std::array<double, 3> high{};
  for (int d = 0; d < 3; ++d)
  {
    low[static_cast<std::size_t>(d)] = End(piece, d, false);
    high[static_cast<std::size_t>(d)] = End(piece, d, true);
  }
  std::array<double, 3> before = high;
  std::array<double, 3> after = low;
  before[split] = after[split] = 0.5 * (low[split] + high[split]);
  return { RestrictToBox(piece, low, before), RestrictToBox(piece, after, high) };
}

/// Parameters where a scalar field is less than -tolerance. None: by the convex hull property it is
/// nowhere less than -2 tolerance.
std::optional<Eigen::Vector2d> FindBelow(const Spline& field, double tolerance)
{
  std::vector<Spline> pieces{ Clamp(field) };
  while (!pieces.empty())
  {
    const Spline piece = std::move(pieces.back());
    pieces.pop_back();
    const auto values = piece.Coefficients();
    if (values.minCoeff() >= -2.0 * tolerance)
    {
      continue;
    }
    const auto [nu, nv, nw] = piece.Sizes();
    for (const bool lastV : { false, true })
    {
      for (const bool lastU : { false, true })
      {
        if (values(0, (lastU ? nu - 1 : 0) + nu * (lastV ? nv - 1 : 0)) < -tolerance)
        {
          return Eigen::Vector2d(End(piece, 0, lastU), End(piece, 1, lastV));
        }
      }
    }
    // Between corners like these the control points come close to the values with the square of
    // the lengths: that ends it, but for weights that differ beyond all measure.
    if (std::max(Length(piece, field, 0), Length(piece, field, 1)) < 1e-12)
    {
      continue;
    }
    for (Spline& half : Halves(piece, field))
    {
      pieces.push_back(std::move(half));
    }
  }
  return std::nullopt;
}

/// Where a curve or surface in a plane through the axis goes from one side to the other.
/// \param distances from the axis, signed
std::optional<Eigen::Vector2d> FindPassage(const Spline& distances, double tolerance)
{
  const Spline negated(distances.Knots(), -distances.Coefficients(), distances.Weights());
  const auto inside = FindBelow(distances, tolerance);
  const auto outside = FindBelow(negated, tolerance);
  if (!inside || !outside)
  {
    return std::nullopt;
  }
  Eigen::Vector2d low = *inside;
  Eigen::Vector2d high = *outside;
  for (int i = 0; i < 60; ++i)
  {
    const Eigen::Vector2d middle = 0.5 * (low + high);
    (distances.Evaluate(middle[0], middle[1])[0] < 0.0 ? low : high) = middle;
  }
  return low;
}

/// A zero inside the domain of a surface in the plane, with a Jacobian that is not zero.
/// \param field two components
std::optional<Eigen::Vector2d> FindSimpleZero(const Spline& field)
{
  constexpr double least = 1.0 / 1024.0;
  const double size = field.Coefficients().colwise().norm().maxCoeff();
  Eigen::Vector2d low;
  Eigen::Vector2d lengths;
  for (int d = 0; d < 2; ++d)
  {
    low[d] = End(field, d, false);
    lengths[d] = End(field, d, true) - low[d];
  }
  // Parameters as fractions of the domain.
  const auto value = [&](const Eigen::Vector2d& t)
  {
    const Eigen::Vector2d at = low + lengths.cwiseProduct(t);
    return Eigen::Vector2d(field.Evaluate(at[0], at[1]));
  };
  const auto newton = [&](Eigen::Vector2d t) -> std::optional<Eigen::Vector2d>
  {
    for (int i = 0; i < 20; ++i)
    {
      constexpr double step = 1e-6;
      const Eigen::Vector2d f = value(t);
      Eigen::Matrix2d jacobian;
      for (int d = 0; d < 2; ++d)
      {
        const Eigen::Vector2d along = step * Eigen::Vector2d::Unit(d);
        jacobian.col(d) = (value(t + along) - value(t - along)) / (2.0 * step);
      }
      const bool isSimple =
        std::abs(jacobian.determinant()) > 1e-6 * jacobian.col(0).norm() * jacobian.col(1).norm();
      if (!isSimple || t.minCoeff() < 1e-5 || t.maxCoeff() > 1.0 - 1e-5)
      {
        return std::nullopt;
      }
      if (f.norm() <= 1e-12 * size)
      {
        return low + lengths.cwiseProduct(t);
      }
      t -= jacobian.inverse() * f;
    }
    return std::nullopt;
  };
  std::vector<Spline> pieces{ Clamp(field) };
  while (!pieces.empty())
  {
    const Spline piece = std::move(pieces.back());
    pieces.pop_back();
    Eigen::Matrix<double, 4, 2> normals;
    normals << 1, 0, 0, 1, 1, 1, 1, -1;
    const Eigen::MatrixXd sides = normals * piece.Coefficients();
    if ((sides.rowwise().minCoeff().array() > 0.0 || sides.rowwise().maxCoeff().array() < 0.0)
          .any())
    {
      continue;
    }
    Eigen::Vector2d middle;
    for (int d = 0; d < 2; ++d)
    {
      middle[d] = (0.5 * (End(piece, d, false) + End(piece, d, true)) - low[d]) / lengths[d];
    }
    if (const auto zero = newton(middle))
    {
      return zero;
    }
    if (std::max(Length(piece, field, 0), Length(piece, field, 1)) > least)
    {
      for (Spline& half : Halves(piece, field))
      {
        pieces.push_back(std::move(half));
      }
    }
  }
  return std::nullopt;
}

}

std::optional<Eigen::Vector3d> FindAxisCrossing(
  const Spline& section, const Eigen::Vector3d& point, const Eigen::Vector3d& axis)
{
  const Eigen::Vector3d unit = axis.normalized();
  const Eigen::MatrixXd points = section.Coefficients().colwise() - point;
  const Eigen::MatrixXd across = points - unit * (unit.transpose() * points);
  Eigen::Index farthest = 0;
  const double size = across.colwise().norm().maxCoeff(&farthest);
  if (!(size > 0.0))
  {
    throw Error("the section lies on the axis of revolution: it draws nothing");
  }
  const Eigen::Vector3d outward = across.col(farthest) / size;
  Eigen::Matrix<double, 3, 2> frame;
  frame << outward, unit.cross(outward);
  const Eigen::MatrixXd plane = frame.transpose() * across;
  const double tolerance = 1e-9 * size;
  std::optional<Eigen::Vector2d> at;
  if (plane.row(1).cwiseAbs().maxCoeff() <= tolerance)
  {
    at = FindPassage(Spline(section.Knots(), plane.row(0), section.Weights()), tolerance);
  }
  else if (section.Dimension() == 2)
  {
    at = FindSimpleZero(Spline(section.Knots(), plane, section.Weights()));
  }
  if (!at)
  {
    return std::nullopt;
  }
  const Eigen::Vector3d from = section.Evaluate((*at)[0], (*at)[1]) - point;
  return point + unit.dot(from) * unit;
}

}
