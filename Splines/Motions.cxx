// SPDX-License-Identifier: BSD-3-Clause
#include "Motions.h"

#include "Error.h"
#include "Evaluator.h"
#include "Interpolation.h"
#include "Operators.h"
#include "Reparametrise.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

using Map = Eigen::Matrix<double, 3, 4>;

constexpr double Pi = 3.14159265358979323846;

/// Cosine and sine of an angle in degrees; those of multiples of 90 have no rounding.
std::array<double, 2> CosSin(double degrees)
{
  const double quarters = std::round(degrees / 90.0);
  const double rest = (degrees - 90.0 * quarters) * Pi / 180.0;
  const double c = std::cos(rest);
  const double s = std::sin(rest);
  const double turn = quarters - 4.0 * std::floor(quarters / 4.0);
  return turn == 0.0 ? std::array<double, 2>{ c, s }
    : turn == 1.0    ? std::array<double, 2>{ -s, c }
    : turn == 2.0    ? std::array<double, 2>{ -c, -s }
                     : std::array<double, 2>{ s, -c };
}

/// What an axis makes of space: along it, and across it in two ways.
struct AxisFrame
{
  AxisFrame(const Eigen::Vector3d& point, const Eigen::Vector3d& axis)
    : Point(point)
    , Unit(axis.normalized())
    , Along(this->Unit * this->Unit.transpose())
    , Across(Eigen::Matrix3d::Identity() - this->Along)
  {
    if (!point.allFinite() || !axis.allFinite() || !(axis.norm() > 0.0))
    {
      throw Error("the axis of rotation needs a direction that is not zero");
    }
    this->Turned << 0.0, -this->Unit[2], this->Unit[1], this->Unit[2], 0.0, -this->Unit[0],
      -this->Unit[1], this->Unit[0], 0.0;
  }

  /// The map x -> point + along + c across + s turned.
  [[nodiscard]] Map operator()(double c, double s) const
  {
    Map map;
    map.leftCols<3>() = this->Along + c * this->Across + s * this->Turned;
    map.col(3) = this->Point - map.leftCols<3>() * this->Point;
    return map;
  }

  Eigen::Vector3d Point;
  Eigen::Vector3d Unit;
  Eigen::Matrix3d Along;
  Eigen::Matrix3d Across;
  Eigen::Matrix3d Turned;
};

Eigen::Map<const Eigen::Matrix<double, 12, 1>> Column(const Map& map)
{
  return Eigen::Map<const Eigen::Matrix<double, 12, 1>>(map.data());
}

/// The path as a clamped curve in u on [0, 1].
Spline CheckedPath(const Spline& path)
{
  if (path.Dimension() != 1 || path.Components() != 3)
  {
    throw Error("the path has " + std::to_string(path.Dimension()) + " directions and " +
      std::to_string(path.Components()) + " coordinates: it must be a curve in space");
  }
  int along = 0;
  while (path.Knots(along).Degree() == 0)
  {
    ++along;
  }
  return ScaleDomain(Clamp(SwapDirections(path, 0, along)), 0);
}

/// Unit tangents of a path; at a crease those of its left side where `left`.
Eigen::Vector3d Tangent(const Spline& path, const Evaluator& evaluator, double t)
{
  const double parameters[3] = { t, 0.0, 0.0 };
  Eigen::Vector3d point;
  double derivatives[9];
  evaluator.EvaluateWithDerivatives(1, parameters, point.data(), derivatives);
  const Eigen::Vector3d tangent(derivatives[0], derivatives[1], derivatives[2]);
  const double size =
    (path.Coefficients().rowwise().maxCoeff() - path.Coefficients().rowwise().minCoeff()).norm();
  if (!(tangent.norm() > 1e-9 * size))
  {
    throw Error("the path comes to rest at " + std::to_string(t) +
      " of its length in parameters: no frame follows it there; move the control points apart");
  }
  return tangent.normalized();
}

void CheckCorners(const Spline& path, const Evaluator& evaluator)
{
  for (const double crease : path.Knots(0).Creases())
  {
    const Spline before = RestrictToBox(path, { 0.0, path.Knots(1).First(), path.Knots(2).First() },
      { crease, path.Knots(1).Last(), path.Knots(2).Last() });
    const Eigen::Vector3d left = Tangent(before, Evaluator(before), crease);
    const Eigen::Vector3d right = Tangent(path, evaluator, crease);
    if ((left - right).norm() > 1e-6)
    {
      throw Error("the path has a corner at " + std::to_string(crease) +
        " of its parameters, where no frame follows it: raise the degree of the path, or sweep its "
        "parts one by one");
    }
  }
}

/// Axes of rotation-minimising frames at ascending parameters of a path: tangent and two normals.
std::vector<Eigen::Matrix3d> MinimisingFrames(const Spline& path, const std::vector<double>& sites)
{
  // The error of double reflection falls with the fourth power of the step.
  constexpr int Steps = 32;
  const Evaluator evaluator(path);
  CheckCorners(path, evaluator);
  Eigen::Vector3d point = path.Evaluate(sites[0]);
  Eigen::Vector3d tangent = Tangent(path, evaluator, sites[0]);
  Eigen::Vector3d normal = tangent.unitOrthogonal();
  std::vector<Eigen::Matrix3d> frames;
  const auto store = [&]
  {
    frames.emplace_back();
    frames.back() << tangent, normal, tangent.cross(normal);
  };
  store();
  for (std::size_t i = 1; i < sites.size(); ++i)
  {
    for (int step = 1; step <= Steps; ++step)
    {
      const double t =
        step == Steps ? sites[i] : sites[i - 1] + (sites[i] - sites[i - 1]) * step / Steps;
      const Eigen::Vector3d nextPoint = path.Evaluate(t);
      const Eigen::Vector3d nextTangent = Tangent(path, evaluator, t);
      const auto reflect = [](const Eigen::Vector3d& x, const Eigen::Vector3d& mirror)
      { return Eigen::Vector3d(x - 2.0 / mirror.squaredNorm() * mirror.dot(x) * mirror); };
      const Eigen::Vector3d chord = nextPoint - point;
      const Eigen::Vector3d mirrored = reflect(tangent, chord);
      normal = reflect(reflect(normal, chord), nextTangent - mirrored);
      // Rounding must not add up.
      normal = (normal - normal.dot(nextTangent) * nextTangent).normalized();
      point = nextPoint;
      tangent = nextTangent;
    }
    store();
  }
  return frames;
}

}

Spline Translation(const Eigen::Vector3d& vector)
{
  if (!vector.allFinite() || !(vector.norm() > 0.0))
  {
    throw Error("a translation needs a vector that is finite and not zero");
  }
  Eigen::MatrixXd maps(12, 2);
  Map map = Map::Identity();
  maps.col(0) = Column(map);
  map.col(3) = vector;
  maps.col(1) = Column(map);
  return Spline({ KnotVector::Uniform(1, 2), {}, {} }, maps);
}

Spline Translation(const Spline& path)
{
  const Spline curve = CheckedPath(path);
  const auto points = curve.Coefficients();
  Eigen::MatrixXd maps(12, points.cols());
  Map map = Map::Identity();
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    map.col(3) = points.col(i) - points.col(0);
    maps.col(i) = Column(map);
  }
  return Spline(curve.Knots(), maps, curve.Weights());
}

Spline Rotation(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle)
{
  const AxisFrame frame(point, axis);
  if (!(std::abs(angle) > 0.0 && std::abs(angle) <= 360.0))
  {
    throw Error("an angle of " + std::to_string(angle) +
      " degrees cannot be revolved by: it must be within -360 and 360 and not 0");
  }
  const int arcs = static_cast<int>(std::ceil(std::abs(angle) / 90.0));
  std::vector<double> knots{ 0.0 };
  Eigen::MatrixXd maps(12, 2 * arcs + 1);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(2 * arcs + 1);
  const double half = CosSin(0.5 * angle / arcs)[0];
  for (int i = 0; i <= 2 * arcs; ++i)
  {
    // The middle control point of an arc is where the tangents at its ends meet.
    const double outward = i % 2 == 1 ? 1.0 / half : 1.0;
    const auto [c, s] = CosSin(angle * i / (2 * arcs));
    maps.col(i) = Column(frame(outward * c, outward * s));
    weights[i] = i % 2 == 1 ? half : 1.0;
    if (i % 2 == 0)
    {
      knots.insert(knots.end(), 2, static_cast<double>(i) / (2 * arcs));
    }
  }
  knots.push_back(1.0);
  return Spline({ KnotVector(2, std::move(knots)), {}, {} }, maps, weights);
}

Spline Screw(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle, double rise,
  double radius, double tolerance)
{
  const AxisFrame frame(point, axis);
  if (!(std::abs(angle) > 0.0) || !std::isfinite(angle) || !std::isfinite(rise))
  {
    throw Error("a screw needs an angle that is finite and not zero, and a finite rise");
  }
  if (!(radius > 0.0 && tolerance > 0.0))
  {
    throw Error("a screw is made to a tolerance at a radius: both must be positive");
  }
  const double turn = angle * Pi / 180.0;
  constexpr double MaxSpans = 100000.0;
  const double wanted = std::ceil(std::abs(turn) * std::pow(radius / (384.0 * tolerance), 0.25));
  if (wanted > MaxSpans)
  {
    throw Error("the screw would need " + std::to_string(wanted) +
      " spans: raise the tolerance or take fewer turns");
  }
  const int spans = static_cast<int>(std::max(1.0, wanted));
  // Control points at a third before and after each knot, all knots double.
  std::vector<double> knots(4, 0.0);
  Eigen::MatrixXd maps(12, 2 * spans + 2);
  Eigen::Index to = 0;
  for (int i = 0; i <= spans; ++i)
  {
    const double t = static_cast<double>(i) / spans;
    const auto [c, s] = CosSin(angle * t);
    Map value = frame(c, s);
    value.col(3) += rise * t * frame.Unit;
    Map third;
    third.leftCols<3>() = turn * (c * frame.Turned - s * frame.Across);
    third.col(3) = rise * frame.Unit - third.leftCols<3>() * frame.Point;
    third /= 3.0 * spans;
    maps.col(to++) = Column(i == 0 ? value : Map(value - third));
    maps.col(to++) = Column(i == spans ? value : Map(value + third));
    if (i > 0 && i < spans)
    {
      knots.insert(knots.end(), 2, t);
    }
  }
  knots.insert(knots.end(), 4, 1.0);
  return Spline({ KnotVector(3, std::move(knots)), {}, {} }, maps);
}

Spline FollowPath(const Spline& path, double twist, int sections)
{
  if (!std::isfinite(twist))
  {
    throw Error("the twist must be a finite number of degrees");
  }
  if (sections < 2)
  {
    throw Error("a motion along a path needs 2 sections at least, not " + std::to_string(sections));
  }
  Spline curve = CheckedPath(path);
  curve = ElevateDegree(curve, 0, std::max(0, 3 - curve.Knots(0).Degree()));
  const int missing = sections - curve.Knots(0).Size();
  const int spans = static_cast<int>(curve.Knots(0).Spans().size());
  curve = RefineUniformly(curve, { 1 + (std::max(0, missing) + spans - 1) / spans, 1, 1 });

  const KnotVector& along = curve.Knots(0);
  const std::vector<double> sites = GrevilleAbscissae(along);
  const std::vector<Eigen::Matrix3d> frames = MinimisingFrames(curve, sites);
  const auto count = static_cast<Eigen::Index>(sites.size());
  const Eigen::VectorXd weights =
    curve.IsRational() ? Eigen::VectorXd(curve.Weights()) : Eigen::VectorXd::Ones(count);
  const Spline denominator(curve.Knots(), weights.transpose());
  Eigen::MatrixXd turns(9, count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    const auto site = static_cast<std::size_t>(i);
    const auto [c, s] = CosSin(twist * sites[site]);
    Eigen::Matrix3d roll;
    roll << 1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c;
    const Eigen::Matrix3d turn = frames[site] * roll * frames[0].transpose();
    turns.col(i) = denominator.Evaluate(sites[site])[0] *
      Eigen::Map<const Eigen::Matrix<double, 9, 1>>(turn.data());
  }
  // The basis of the path holds its weights too: what is interpolated are numerators.
  const Spline numerators = Interpolate(curve.Knots(), { sites, {}, {} }, std::move(turns));
  Eigen::MatrixXd maps(12, count);
  const Eigen::Vector3d begin = curve.Coefficients().col(0);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    const Eigen::Matrix<double, 9, 1> entries = numerators.Coefficients().col(i) / weights[i];
    Map map;
    map.leftCols<3>() = Eigen::Map<const Eigen::Matrix3d>(entries.data());
    if (i == 0)
    {
      map.leftCols<3>().setIdentity(); // but for rounding it is
    }
    map.col(3) = curve.Coefficients().col(i) - map.leftCols<3>() * begin;
    maps.col(i) = Column(map);
  }
  return Spline(curve.Knots(), maps, curve.Weights());
}

}
