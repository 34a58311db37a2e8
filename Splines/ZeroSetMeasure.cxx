// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hyperpatch
{

namespace
{

/// Slope of a curve at the end of its chord, times its length, by the normal there: such that the
/// cubic with these slopes is as high as an arc of a circle.
double Rise(const Eigen::Vector3d& normal, const Eigen::Vector3d& chord)
{
  const double along = normal.dot(chord);
  const double square = chord.squaredNorm();
  return square > 0.0 ? 2.0 * along / (1.0 + std::sqrt(std::max(0.0, 1.0 - along * along / square)))
                      : 0.0;
}

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
  this->Attributes.resize(worker.Attributes.size());
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    const bool isWanted = worker.Options.AttributeTolerances[a] > 0.0;
    this->Attributes[a].setZero(isWanted ? worker.Attributes[a]->Components() : 0, count);
  }
}

void ZeroSet::Worker::Middles::Add(Index to, double weight, const Samples& samples, Index from)
{
  this->Parameters.col(to) += weight * samples.Parameters.col(from);
  this->Points.col(to) += weight * samples.Points.col(from);
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    if (this->Attributes[a].rows() > 0)
    {
      this->Attributes[a].col(to) += weight * samples.Attributes[a].col(from);
    }
  }
}

void ZeroSet::Worker::Measure(Middles& middles, std::vector<Error>& errors) const
{
  const auto& [parameters, points, attributes, axes, chords] = middles;
  // Of what lies along the surface, less makes no difference.
  const double least = std::pow(0.3 * this->Options.Tolerance, 2);
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
    const Eigen::Vector3d along = hasNormal ? Eigen::Vector3d(off - across * normal) : off;
    if (hasNormal && along.squaredNorm() > least)
    {
      // The point below it on the surface, which may end before.
      const Eigen::Matrix3d J = this->Jacobian(D.col(i).data());
      const Eigen::Vector3d foot = at.col(i) + J.inverse() * along;
      const Eigen::Vector3d inside = foot.cwiseMax(this->Low).cwiseMin(this->High);
      if (foot.allFinite())
      {
        middles.Parameters.col(i) = inside;
        distance = std::hypot(distance, (J * (foot - inside)).norm());
      }
    }
    const bool isCurve = chords.cols() > 0 && !chords.col(i).isZero(0.0);
    if (isCurve)
    {
      distance = (off - off.dot(chords.col(i)) * chords.col(i)).norm();
    }
    errors[static_cast<std::size_t>(i)] = { distance, 0.0, along.norm() };
    tangential[static_cast<std::size_t>(i)] = along;
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
      const Eigen::Matrix3d J = this->Jacobian(D.col(i).data());
      Eigen::Vector3d du = Eigen::Vector3d::Zero();
      const double det = J.determinant();
      const double size = J.colwise().norm().prod();
      if (this->Axes.size() == 3 && std::abs(det) > 1e-3 * size)
      {
        const Eigen::Vector3d foot =
          at.col(i) + J.inverse() * tangential[static_cast<std::size_t>(i)];
        du = foot.cwiseMax(this->Low).cwiseMin(this->High) - at.col(i);
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
  int boundary, const std::vector<Index>& loop, const std::vector<Index>& innerOf, bool isFinal,
  Scratch& scratch, Facets& facets, std::vector<std::pair<int, double>>& missing) const
{
  const double tolerance = this->Options.Tolerance;
  const double turn = this->Options.Handedness < 0 ? -1.0 : 1.0;
  // Barycentric coordinates of the samples. In the middle always: normals at the corners alone can
  // be those of a plane under a dome. On the edges too for attributes, of which nothing else is
  // known. There, and further inside, where what the normals say is doubtful. At more places of the
  // edges where attributes nearly miss their tolerances.
  static constexpr std::array<std::array<double, 3>, 13> Places{ { { 1.0 / 3, 1.0 / 3, 1.0 / 3 },
    { 0.5, 0.5, 0.0 }, { 0.0, 0.5, 0.5 }, { 0.5, 0.0, 0.5 }, { 0.6, 0.2, 0.2 }, { 0.2, 0.6, 0.2 },
    { 0.2, 0.2, 0.6 }, { 0.75, 0.25, 0.0 }, { 0.25, 0.75, 0.0 }, { 0.0, 0.75, 0.25 },
    { 0.0, 0.25, 0.75 }, { 0.25, 0.0, 0.75 }, { 0.75, 0.0, 0.25 } } };
  constexpr std::size_t Ordinary = 7;
  const std::size_t fewest = this->HasAttributes() ? 4 : 1;
  constexpr double Tilted = 0.93; // cosines of normals against the triangle's
  constexpr double MuchTilted = 0.7;
  constexpr double Unequal = 3.0;  // slopes at both ends of an edge, in heights
  constexpr double Doubtful = 0.7; // shares of the tolerance
  constexpr double Close = 0.87;
  constexpr double Noticed = 0.3;
  constexpr double LargeShare = 0.5;
  // Measured so much of an edge aside, a height is wrong by a hundredth of that of the triangle.
  constexpr double FarAside = 0.05;

  const auto corner = [&](std::size_t t, std::size_t k) -> std::pair<const Samples*, Index>
  {
    const int c = triangles[t][k];
    return c >= boundary
      ? std::make_pair(&facets.Inner, innerOf[static_cast<std::size_t>(c - boundary)])
      : std::make_pair(&this->Shared, loop[static_cast<std::size_t>(c)]);
  };
  using Facet = Scratch::Facet;
  std::vector<Facet>& known = scratch.Measuring.Known;
  std::vector<std::size_t>& all = scratch.Measuring.All;
  std::vector<std::size_t>& doubtful = scratch.Measuring.Doubtful;
  std::vector<std::size_t>& aside = scratch.Measuring.Aside;
  std::vector<std::size_t>& coloured = scratch.Measuring.Coloured;
  std::vector<Error>& measured = scratch.Measuring.Measured;
  Middles& middles = scratch.Measuring.Centres;
  bool isMissed = false;
  known.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
  {
    Facet& facet = known[t];
    if (facet.Corners == triangles[t])
    {
      isMissed = isMissed || facet.Share > Accepted;
      continue;
    }
    Eigen::Matrix3d X;
    Eigen::Matrix3d n;
    for (std::size_t k = 0; k < 3; ++k)
    {
      const auto [s, i] = corner(t, k);
      X.col(static_cast<Index>(k)) = s->Points.col(i);
      n.col(static_cast<Index>(k)) = s->Normals.col(i);
    }
    // The cubic through the corners with these normals, on the edges and in the middle.
    double most = 0.0;
    double unequal = 0.0;
    double longest = 0.0;
    std::array<double, 3> q{};
    for (int k = 0; k < 3; ++k)
    {
      const int l = (k + 1) % 3;
      const Eigen::Vector3d chord = X.col(l) - X.col(k);
      const double from = Rise(-n.col(k), chord);
      const double to = Rise(n.col(l), chord);
      most = std::max(most, HermiteHeight(from, to));
      unequal = std::max(unequal, std::abs(from - to));
      longest = std::max(longest, chord.squaredNorm());
      q[static_cast<std::size_t>(k)] = from + to;
    }
    most = std::max(most, MiddleHeight(q));
    facet = { triangles[t], { most, 0.0, 0.0 }, most / tolerance, longest, most,
      std::abs(q[0] + q[1] + q[2]) / 18.0, false, false };
    const Eigen::Vector3d across = turn * (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0));
    const double area = across.norm();
    const Eigen::RowVector3d facing = across.transpose() * n;
    if (facing.maxCoeff() < 0.0)
    {
      // Turned over, but for what is too thin to be seen.
      facet.Share = std::max(facet.Share, area / (std::sqrt(longest) * tolerance));
    }
    const bool isTilted = facing.minCoeff() < Tilted * area || unequal > Unequal * most;
    facet.IsDoubtful = facet.Share <= Accepted &&
      (facing.minCoeff() < MuchTilted * area || facet.Share > (isTilted ? Doubtful : Close));
    isMissed = isMissed || facet.Share > Accepted;
  }
  const auto measure =
    [&](const std::vector<std::size_t>& which, std::size_t first, std::size_t last, int steps)
  {
    if (which.empty())
    {
      return;
    }
    const std::size_t places = last - first;
    middles.SetZero(*this, static_cast<Index>(places * which.size()));
    Index at = 0;
    for (const std::size_t t : which)
    {
      for (std::size_t p = first; p < last; ++p, ++at)
      {
        for (std::size_t k = 0; k < 3; ++k)
        {
          const auto [s, i] = corner(t, k);
          middles.Add(at, Places[p][k], *s, i);
        }
      }
    }
    for (int step = 0; step < steps; ++step)
    {
      this->Measure(middles, measured);
    }
    for (std::size_t i = 0; i < places * which.size(); ++i)
    {
      const Error& e = measured[i];
      Facet& facet = known[which[i / places]];
      facet.Worst.Distance = std::max(facet.Worst.Distance, e.Distance);
      facet.Worst.Attribute = std::max(facet.Worst.Attribute, e.Attribute);
      facet.Worst.Aside = std::max(facet.Worst.Aside, e.Aside);
      facet.Share = std::max({ facet.Share, e.Distance / tolerance, e.Attribute });
    }
  };
  // Triangles beside those that are going to be divided may become others.
  if (!isMissed || isFinal)
  {
    all.clear();
    doubtful.clear();
    aside.clear();
    coloured.clear();
    for (std::size_t t = 0; t < known.size(); ++t)
    {
      if (!known[t].IsMeasured)
      {
        known[t].IsMeasured = true;
        all.push_back(t);
        if (known[t].IsDoubtful)
        {
          doubtful.push_back(t);
        }
      }
    }
    measure(all, 0, fewest, 1);
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      // What is higher in the middle than normals say may be so on the edges.
      Facet& facet = known[all[i]];
      const double middle = measured[fewest * i].Distance;
      if (!facet.IsDoubtful && facet.Share <= Accepted && middle > Noticed * tolerance &&
        facet.Most * middle > Close * tolerance * facet.Middle)
      {
        facet.IsDoubtful = true;
        doubtful.push_back(all[i]);
      }
    }
    measure(doubtful, fewest, Ordinary, 1);
    std::copy_if(doubtful.begin(), doubtful.end(), std::back_inserter(aside),
      [&known](std::size_t t)
      { return known[t].Worst.Aside > FarAside * std::sqrt(known[t].Longest); });
    measure(aside, 0, Ordinary, 2);
    std::copy_if(all.begin(), all.end(), std::back_inserter(coloured),
      [&known](std::size_t t)
      { return known[t].Share <= Accepted && known[t].Worst.Attribute > LargeShare; });
    measure(coloured, 0, Places.size(), 2);
  }

  double worst = 0.0;
  facets.Error = facets.AttributeError = 0.0;
  for (std::size_t t = 0; t < known.size(); ++t)
  {
    const Facet& facet = known[t];
    facets.Error = std::max(facets.Error, facet.Worst.Distance);
    facets.AttributeError = std::max(facets.AttributeError, facet.Worst.Attribute);
    worst = std::max(worst, facet.Share);
    if (facet.Share > Accepted)
    {
      missing.emplace_back(static_cast<int>(t), facet.Share);
    }
  }
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
