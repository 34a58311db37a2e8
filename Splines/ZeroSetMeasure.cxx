// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

namespace
{

/// How far a surface leaves a triangle inside it, to second order: half of sum l_i l_j q_ij in
/// barycentric coordinates, where q_ij is what the normal turns by along edge ij, times its length.
double MiddleHeight(const std::array<double, 3>& q)
{
  const double sum = q[0] + q[1] + q[2];
  const double product = q[0] * q[1] * q[2];
  const double divisor =
    2.0 * (q[0] * q[1] + q[1] * q[2] + q[2] * q[0]) - (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  bool isAcute = divisor > 0.0;
  for (const double side : q)
  {
    isAcute = isAcute && side * sum > 0.0 && 2.0 * std::abs(side) < std::abs(sum);
  }
  // In the centre of the circle, if it is inside; otherwise an edge is worse than the middle.
  return std::max(std::abs(sum) / 18.0, isAcute ? std::abs(0.5 * product / divisor) : 0.0);
}

}

void ZeroSet::Worker::Middles::SetZero(const Worker& worker, Index count)
{
  this->Parameters.setZero(3, count);
  this->Points.setZero(3, count);
  this->Attributes.clear();
  for (const Evaluator* attribute : worker.Attributes)
  {
    this->Attributes.push_back(Eigen::MatrixXd::Zero(attribute->Components(), count));
  }
}

void ZeroSet::Worker::Middles::Add(Index to, double weight, const Samples& samples, Index from)
{
  this->Parameters.col(to) += weight * samples.Parameters.col(from);
  this->Points.col(to) += weight * samples.Points.col(from);
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    this->Attributes[a].col(to) += weight * samples.Attributes[a].col(from);
  }
}

void ZeroSet::Worker::Measure(const Middles& middles, std::vector<Error>& errors) const
{
  const auto& [parameters, points, attributes, axes, chords] = middles;
  // From the middle of the parameters one step onto f = 0, then the distance across the surface.
  const Index count = parameters.cols();
  const auto n = static_cast<std::size_t>(count);
  const int m = this->Geometry.Components();
  errors.resize(n);
  std::vector<double> values(n);
  Eigen::Matrix3Xd g(3, count);
  this->Field.EvaluateWithGradient(n, parameters.data(), values.data(), g.data());
  Eigen::Matrix3Xd at = parameters;
  Eigen::MatrixXd X(m, count);
  Eigen::MatrixXd D(3 * m, count);
  for (Index i = 0; i < count; ++i)
  {
    Eigen::Index axis = 0;
    if (axes.empty())
    {
      g.col(i).cwiseProduct(this->Scale).cwiseAbs().maxCoeff(&axis);
    }
    else
    {
      axis = axes[static_cast<std::size_t>(i)];
    }
    const double move = values[static_cast<std::size_t>(i)] / g(axis, i);
    if (std::isfinite(move))
    {
      at(axis, i) = std::min(std::max(at(axis, i) - move, this->Low[axis]), this->High[axis]);
    }
  }
  this->Geometry.EvaluateWithDerivatives(n, at.data(), X.data(), D.data());
  std::vector<Eigen::Vector3d> tangential(n);
  for (Index i = 0; i < count; ++i)
  {
    Eigen::Vector3d off = points.col(i);
    off.head(m) -= X.col(i);
    const Eigen::Vector3d normal = this->Normal(D.col(i).data(), g.col(i));
    const double across = off.dot(normal);
    const bool hasNormal = this->Axes.size() == 3 && normal.squaredNorm() > 0.5;
    double distance = hasNormal ? std::abs(across) : off.norm();
    const bool isCurve = chords.cols() > 0 && !chords.col(i).isZero(0.0);
    if (isCurve)
    {
      distance = (off - off.dot(chords.col(i)) * chords.col(i)).norm();
    }
    errors[static_cast<std::size_t>(i)] = { distance, 0.0 };
    tangential[static_cast<std::size_t>(i)] =
      hasNormal ? Eigen::Vector3d(off - across * normal) : off;
  }
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    const double tolerance = this->Options.AttributeTolerances[a];
    if (tolerance <= 0.0)
    {
      continue;
    }
    const int components = this->Attributes[a]->Components();
    Eigen::MatrixXd exact(components, count);
    Eigen::MatrixXd slope(3 * components, count);
    this->Attributes[a]->EvaluateWithDerivatives(n, at.data(), exact.data(), slope.data());
    for (Index i = 0; i < count; ++i)
    {
      // The exact value is that of the point of the surface below the middle of the cell.
      Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
      for (int d = 0; d < 3; ++d)
      {
        J.col(d).head(m) = D.block(m * d, i, m, 1);
      }
      Eigen::Vector3d du = Eigen::Vector3d::Zero();
      const double det = J.determinant();
      const double size = J.colwise().norm().prod();
      if (this->Axes.size() == 3 && std::abs(det) > 1e-3 * size)
      {
        du = J.inverse() * tangential[static_cast<std::size_t>(i)];
      }
      for (int c = 0; c < components; ++c)
      {
        double value = exact(c, i);
        for (int d = 0; d < 3; ++d)
        {
          value += slope(components * d + c, i) * du[d];
        }
        double& error = errors[static_cast<std::size_t>(i)].Attribute;
        error = std::max(error, std::abs(attributes[a](c, i) - value) / tolerance);
      }
    }
  }
}

double ZeroSet::Worker::MeasureFacets(const std::vector<FacetTriangulation::Triangle>& triangles,
  int boundary, const std::vector<Index>& loop, const std::vector<Index>& innerOf, Scratch& scratch,
  Facets& facets, std::vector<std::pair<int, double>>& missing) const
{
  const auto count = static_cast<Index>(triangles.size());
  // Barycentric coordinates of the samples: distances are known well from the normals, attributes
  // only where they are evaluated.
  static constexpr std::array<std::array<double, 3>, 4> Places{ { { 1.0 / 3, 1.0 / 3, 1.0 / 3 },
    { 0.5, 0.5, 0.0 }, { 0.0, 0.5, 0.5 }, { 0.5, 0.0, 0.5 } } };
  const bool hasAttributes = this->HasAttributes();
  const Index places = hasAttributes ? 4 : 1;
  std::vector<double>& errors = scratch.Errors;
  errors.assign(static_cast<std::size_t>(count), 0.0);
  const auto corner = [&](Index t, int k) -> std::pair<const Samples*, Index>
  {
    const int c = triangles[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)];
    return c >= boundary
      ? std::make_pair(&facets.Inner, innerOf[static_cast<std::size_t>(c - boundary)])
      : std::make_pair(&this->Shared, loop[static_cast<std::size_t>(c)]);
  };
  double distance = 0.0;
  for (Index t = 0; t < count; ++t)
  {
    Eigen::Matrix3d X;
    Eigen::Matrix3d n;
    for (int k = 0; k < 3; ++k)
    {
      const auto [s, i] = corner(t, k);
      X.col(k) = s->Points.col(i);
      n.col(k) = s->Normals.col(i);
    }
    // The cubic through the corners with these normals, on the edges and in the middle.
    double most = 0.0;
    std::array<double, 3> q{};
    for (int k = 0; k < 3; ++k)
    {
      const int l = (k + 1) % 3;
      const Eigen::Vector3d chord = X.col(l) - X.col(k);
      const double from = -n.col(k).dot(chord);
      const double to = n.col(l).dot(chord);
      most = std::max(most, HermiteHeight(from, to));
      q[static_cast<std::size_t>(k)] = from + to;
    }
    most = std::max(most, MiddleHeight(q));
    errors[static_cast<std::size_t>(t)] = most / this->Options.Tolerance;
    distance = std::max(distance, most);
  }
  double attribute = 0.0;
  // Normals at the corners alone can be those of a plane under a dome.
  Middles& middles = scratch.Centres;
  middles.SetZero(*this, places * count);
  for (Index t = 0; t < count; ++t)
  {
    for (int k = 0; k < 3; ++k)
    {
      const auto [s, i] = corner(t, k);
      for (Index p = 0; p < places; ++p)
      {
        middles.Add(
          places * t + p, Places[static_cast<std::size_t>(p)][static_cast<std::size_t>(k)], *s, i);
      }
    }
  }
  std::vector<Error>& measured = scratch.Measured;
  this->Measure(middles, measured);
  for (std::size_t i = 0; i < measured.size(); ++i)
  {
    const Error& e = measured[i];
    double& error = errors[i / static_cast<std::size_t>(places)];
    error = std::max({ error, e.Distance / this->Options.Tolerance, e.Attribute });
    distance = std::max(distance, e.Distance);
    attribute = std::max(attribute, e.Attribute);
  }
  double worst = 0.0;
  for (Index t = 0; t < count; ++t)
  {
    const double error = errors[static_cast<std::size_t>(t)];
    worst = std::max(worst, error);
    if (error > Accepted)
    {
      missing.emplace_back(static_cast<int>(t), error);
    }
  }
  facets.Error = distance;
  facets.AttributeError = attribute;
  return worst;
}

void ZeroSet::Worker::MeasureCurves(Index begin, const std::vector<std::size_t>& which,
  const std::vector<Index>& firsts, const std::vector<Index>& counts, const Samples& samples,
  const std::vector<int>& axisOf, const std::vector<double>& places, std::vector<double>& errors)
{
  Index total = 0;
  for (const std::size_t k : which)
  {
    total += (counts[k] + 1) * static_cast<Index>(places.size());
  }
  Middles middles;
  middles.SetZero(*this, total);
  middles.Axes.resize(static_cast<std::size_t>(total));
  middles.Chords.setZero(3, total);
  Index at = 0;
  for (const std::size_t k : which)
  {
    const Curve& curve = this->Curves[static_cast<std::size_t>(begin) + k];
    const bool outline = curve.IsOnCrease || this->Axes.size() < 3;
    const auto point = [&](Index i) -> std::pair<const Samples*, Index>
    {
      return i < 0       ? std::make_pair(&this->Shared, curve.From)
        : i >= counts[k] ? std::make_pair(&this->Shared, curve.To)
                         : std::make_pair(&samples, firsts[k] + i);
    };
    for (Index i = 0; i <= counts[k]; ++i)
    {
      const auto [from, a] = point(i - 1);
      const auto [to, b] = point(i);
      for (const double t : places)
      {
        middles.Add(at, 1.0 - t, *from, a);
        middles.Add(at, t, *to, b);
        middles.Axes[static_cast<std::size_t>(at)] = axisOf[k];
        if (outline)
        {
          middles.Chords.col(at) = (to->Points.col(b) - from->Points.col(a)).normalized();
        }
        ++at;
      }
    }
  }
  std::vector<Error> measured;
  this->Measure(middles, measured);
  at = 0;
  for (const std::size_t k : which)
  {
    Curve& curve = this->Curves[static_cast<std::size_t>(begin) + k];
    const double inner = curve.IsOnCrease || this->Axes.size() < 3 ? 1.0 : InnerChord;
    curve.Measured = Error();
    for (Index i = 0; i < (counts[k] + 1) * static_cast<Index>(places.size()); ++i, ++at)
    {
      const Error& e = measured[static_cast<std::size_t>(at)];
      curve.Measured.Distance = std::max(curve.Measured.Distance, e.Distance);
      curve.Measured.Attribute = std::max(curve.Measured.Attribute, e.Attribute);
    }
    errors[k] = std::max(inner * curve.Measured.Distance / this->Options.Tolerance,
                  InnerChord * curve.Measured.Attribute) /
      Target;
  }
}

}
