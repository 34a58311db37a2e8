// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace hyperpatch
{

namespace
{

/// The symmetric matrix with the eigenvalues' magnitudes, in coordinates that `frame` makes
/// orthonormal (frame' Q frame is rotated).
Eigen::Matrix2d Magnitude(const Eigen::Matrix2d& Q, const Eigen::Matrix2d& frame)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(frame.transpose() * Q * frame);
  const Eigen::Matrix2d inverse = frame.inverse();
  return inverse.transpose() *
    (eigen.eigenvectors() * eigen.eigenvalues().cwiseAbs().asDiagonal() *
      eigen.eigenvectors().transpose()) *
    inverse;
}

/// A metric in which no vector is shorter than in either of two.
Eigen::Matrix2d Larger(const Eigen::Matrix2d& M, const Eigen::Matrix2d& N)
{
  const double trace = M.trace() + N.trace();
  if (!(trace > 0.0))
  {
    return M;
  }
  // Both are diagonal in the eigenvectors of N relative to M.
  const Eigen::Matrix2d regular = M + 1e-9 * trace * Eigen::Matrix2d::Identity();
  const Eigen::LLT<Eigen::Matrix2d> llt(regular);
  const Eigen::Matrix2d L = llt.matrixL();
  const Eigen::Matrix2d inverse = L.inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(inverse * N * inverse.transpose());
  return L * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(1.0).asDiagonal() *
    eigen.eigenvectors().transpose() * L.transpose();
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

/// Where linear interpolation in a triangle is about furthest from a surface whose curvature makes
/// it a Delaunay triangle: the centre of its circle, or the middle of an edge that is in the way.
Eigen::Vector2d WorstPlace(const FacetTriangulation& triangulation, int triangle)
{
  const auto& corners = triangulation.Triangles()[static_cast<std::size_t>(triangle)];
  std::array<Eigen::Vector2d, 3> x;
  for (std::size_t k = 0; k < 3; ++k)
  {
    x[k] = triangulation.Points()[static_cast<std::size_t>(corners[k])];
  }
  std::array<double, 3> square{};
  std::size_t longest = 0;
  for (std::size_t k = 0; k < 3; ++k)
  {
    square[k] = (x[(k + 2) % 3] - x[(k + 1) % 3]).squaredNorm();
    longest = square[k] > square[longest] ? k : longest;
  }
  const std::size_t i = (longest + 1) % 3;
  const std::size_t j = (longest + 2) % 3;
  if (square[longest] >= 0.9 * (square[i] + square[j]))
  {
    return triangulation.IsBoundary(triangle, static_cast<int>(longest))
      ? Eigen::Vector2d((x[0] + x[1] + x[2]) / 3.0)
      : Eigen::Vector2d(0.5 * (x[i] + x[j]));
  }
  std::array<double, 3> weight{};
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k)
  {
    weight[k] = square[k] * (square[(k + 1) % 3] + square[(k + 2) % 3] - square[k]);
    sum += weight[k];
  }
  return (weight[0] * x[0] + weight[1] * x[1] + weight[2] * x[2]) / sum;
}

}

/// What one thread needs again and again.
struct ZeroSet::Worker::Scratch
{
  FacetTriangulation Triangulation;
  std::vector<Eigen::Vector2d> Polygon;
  std::vector<Eigen::Vector2d> Candidates;
  Eigen::Matrix3Xd Parameters;
  std::vector<int> Axes;
  std::vector<char> Projected;
  struct Step
  {
    const Curve* Along;
    bool Forward;
    bool Used;
  };
  std::vector<Step> Steps;
  std::vector<Step*> Path;
  std::vector<double> Errors; ///< of triangles
  std::vector<Error> Measured;
  Middles Centres;
  std::vector<std::vector<Index>> Loops;
};

std::optional<ZeroSet::Worker::Shape> ZeroSet::Worker::Probe(
  const Eigen::Vector3d& start, const Eigen::Vector3d& width, int axis) const
{
  // Onto the surface, along the direction of height.
  Shape shape;
  shape.Axis = axis;
  Eigen::Vector3d x = start;
  double value = 0.0;
  Eigen::Vector3d g;
  for (int step = 0; step < 4; ++step)
  {
    this->Field.EvaluateWithGradient(1, x.data(), &value, g.data());
    const double slope = g[shape.Axis];
    if (slope == 0.0 || !std::isfinite(value))
    {
      return std::nullopt;
    }
    const double move = value / slope;
    x[shape.Axis] =
      std::min(std::max(x[shape.Axis] - move, this->Low[shape.Axis]), this->High[shape.Axis]);
    if (std::abs(move) < 1e-3 * width[shape.Axis])
    {
      break;
    }
    if (std::abs(x[shape.Axis] - start[shape.Axis]) > 4.0 * width[shape.Axis])
    {
      return std::nullopt;
    }
  }
  const int w = shape.Axis;
  shape.A = (w + 1) % 3;
  shape.B = (w + 2) % 3;
  // Around it: the surface's points at both sides in a, in b, and in a + b.
  constexpr int Count = 7;
  constexpr std::array<std::array<int, 2>, Count> Steps{ { { 0, 0 }, { 1, 0 }, { -1, 0 }, { 0, 1 },
    { 0, -1 }, { 1, 1 }, { -1, -1 } } };
  const double ha = 0.25 * width[shape.A];
  const double hb = 0.25 * width[shape.B];
  Eigen::Matrix<double, 3, Count> at;
  Eigen::Vector2d slope(-g[shape.A] / g[w], -g[shape.B] / g[w]);
  for (int i = 0; i < Count; ++i)
  {
    const auto& s = Steps[static_cast<std::size_t>(i)];
    at.col(i) = x;
    at(shape.A, i) += s[0] * ha;
    at(shape.B, i) += s[1] * hb;
    at(w, i) += s[0] * ha * slope[0] + s[1] * hb * slope[1];
  }
  std::array<double, Count> values{};
  Eigen::Matrix<double, 3, Count> gradients;
  const auto clamp = [&]
  {
    for (int i = 0; i < Count; ++i)
    {
      at.col(i) = at.col(i).cwiseMax(this->Low).cwiseMin(this->High);
    }
  };
  for (int step = 0; step < 2; ++step)
  {
    clamp();
    this->Field.EvaluateWithGradient(Count, at.data(), values.data(), gradients.data());
    for (int i = 0; i < Count; ++i)
    {
      const double move = values[static_cast<std::size_t>(i)] / gradients(w, i);
      at(w, i) -= std::isfinite(move) && std::abs(move) < width[w] ? move : 0.0;
    }
  }
  clamp();
  const int m = this->Geometry.Components();
  Eigen::MatrixXd points(m, Count);
  Eigen::MatrixXd derivatives(3 * m, Count);
  this->Geometry.EvaluateWithDerivatives(Count, at.data(), points.data(), derivatives.data());
  Eigen::Matrix<double, 3, Count> X = Eigen::Matrix<double, 3, Count>::Zero();
  X.topRows(m) = points;
  Eigen::Matrix<double, 3, Count> n;
  for (int i = 0; i < Count; ++i)
  {
    n.col(i) = this->Normal(derivatives.col(i).data(), gradients.col(i));
  }
  const auto second = [&](const auto& row)
  {
    Eigen::Matrix2d H;
    const double aa = row(1) - 2.0 * row(0) + row(2);
    const double bb = row(3) - 2.0 * row(0) + row(4);
    const double both = row(5) - 2.0 * row(0) + row(6);
    const double ab = 0.5 * (both - aa - bb);
    H << aa / (ha * ha), ab / (ha * hb), ab / (ha * hb), bb / (hb * hb);
    return H;
  };
  shape.Centre = at.col(0);
  shape.Slope = { (at(w, 1) - at(w, 2)) / (2.0 * ha), (at(w, 3) - at(w, 4)) / (2.0 * hb) };
  shape.Bend = second([&](int i) { return at(w, i); });

  // The second fundamental form: how the normal turns. And the first, to take magnitudes in.
  const Eigen::Vector3d Xa = (X.col(1) - X.col(2)) / (2.0 * ha);
  const Eigen::Vector3d Xb = (X.col(3) - X.col(4)) / (2.0 * hb);
  const Eigen::Vector3d na = (n.col(1) - n.col(2)) / (2.0 * ha);
  const Eigen::Vector3d nb = (n.col(3) - n.col(4)) / (2.0 * hb);
  Eigen::Matrix2d form;
  const double mixed = 0.5 * (na.dot(Xb) + nb.dot(Xa));
  form << na.dot(Xa), mixed, mixed, nb.dot(Xb);
  Eigen::Matrix2d first;
  first << Xa.dot(Xa), Xa.dot(Xb), Xa.dot(Xb), Xb.dot(Xb);
  const double trace = first.trace();
  if (!(trace > 0.0) || !form.allFinite())
  {
    return std::nullopt;
  }
  const Eigen::LLT<Eigen::Matrix2d> llt(first + 1e-9 * trace * Eigen::Matrix2d::Identity());
  const Eigen::Matrix2d frame = Eigen::Matrix2d(llt.matrixU()).inverse();
  // An equilateral triangle with edges L on curvature k is off by k L^2 / 6.
  shape.Metric = Magnitude(form, frame) / (6.0 * Target * this->Options.Tolerance);
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    const double tolerance = this->Options.AttributeTolerances[a];
    if (tolerance <= 0.0)
    {
      continue;
    }
    const int components = this->Attributes[a]->Components();
    Eigen::MatrixXd field(components, Count);
    this->Attributes[a]->Evaluate(Count, at.data(), field.data());
    for (int c = 0; c < components; ++c)
    {
      const Eigen::Matrix2d H = second([&](int i) { return field(c, i); });
      if (H.allFinite())
      {
        shape.Metric = Larger(shape.Metric, Magnitude(H, frame) / (6.0 * Target * tolerance));
      }
    }
  }
  return shape.Metric.allFinite() ? std::optional<Shape>(shape) : std::nullopt;
}

bool ZeroSet::Worker::FindLoops(std::size_t leaf, Scratch& scratch) const
{
  bool failed = false;
  std::vector<std::vector<Index>>& loops = scratch.Loops;
  loops.clear();
  std::vector<Scratch::Step>& steps = scratch.Steps;
  using Step = Scratch::Step;
  steps.clear();
  for (Index f = this->FirstFace[leaf]; f < this->FirstFace[leaf + 1]; ++f)
  {
    const Index face = this->FacesOfLeaf[static_cast<std::size_t>(f)];
    const bool high = face % 2 != 0;
    const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face / 2)];
    for (Index c = first; c < first + count; ++c)
    {
      const Index kept = this->CurveOf[static_cast<std::size_t>(c)];
      if (kept >= 0)
      {
        const Curve* curve = &this->Curves[static_cast<std::size_t>(kept)];
        failed = failed || curve->HasFailed;
        const bool same = curve->From == this->Curves[static_cast<std::size_t>(c)].From;
        steps.push_back({ curve, high == same, false });
      }
    }
  }
  // There and back again is nothing.
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    for (std::size_t j = i + 1; j < steps.size() && !steps[i].Used; ++j)
    {
      if (!steps[j].Used && steps[i].Along == steps[j].Along &&
        steps[i].Forward != steps[j].Forward)
      {
        steps[i].Used = steps[j].Used = true;
      }
    }
  }
  const auto from = [](const Step& s) { return s.Forward ? s.Along->From : s.Along->To; };
  const auto to = [](const Step& s) { return s.Forward ? s.Along->To : s.Along->From; };
  // From step to step; where a point is met again, what lies between is a loop of its own.
  std::vector<Step*>& path = scratch.Path;
  path.clear();
  for (Step& start : steps)
  {
    Step* at = start.Used ? nullptr : &start;
    while (at)
    {
      at->Used = true;
      path.push_back(at);
      const Index end = to(*at);
      const auto again =
        std::find_if(path.rbegin(), path.rend(), [&](const Step* s) { return from(*s) == end; });
      if (again != path.rend())
      {
        std::vector<Index> loop;
        for (auto step = again.base() - 1; step != path.end(); ++step)
        {
          const Curve& curve = *(*step)->Along;
          loop.push_back(from(**step));
          for (Index i = 0; i < curve.Count; ++i)
          {
            loop.push_back(curve.First + ((*step)->Forward ? i : curve.Count - 1 - i));
          }
        }
        loops.push_back(std::move(loop));
        path.erase(again.base() - 1, path.end());
      }
      at = nullptr;
      if (!path.empty())
      {
        const auto next = std::find_if(
          steps.begin(), steps.end(), [&](const Step& s) { return !s.Used && from(s) == end; });
        at = next == steps.end() ? nullptr : &*next;
      }
    }
    path.clear();
  }
  return !failed;
}

void ZeroSet::Worker::FindFlatLoops(const Leaf& leaf, std::vector<std::vector<Index>>& loops) const
{
  for (int d = 0; d < 3; ++d)
  {
    for (const bool high : { false, true })
    {
      if (!this->IsDrawn(leaf, d, high))
      {
        continue;
      }
      Node low = leaf.At.Low;
      low[static_cast<std::size_t>(d)] += high ? leaf.At.Size : 0;
      const Index face = this->FaceKeys.Find({ low[0], low[1], low[2], 3 + d });
      const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face)];
      std::vector<Index> loop;
      for (Index c = first; c < first + count; ++c)
      {
        const Curve& own = this->Curves[static_cast<std::size_t>(c)];
        const Curve& curve =
          this->Curves[static_cast<std::size_t>(this->CurveOf[static_cast<std::size_t>(c)])];
        loop.push_back(own.From);
        for (Index i = 0; i < curve.Count; ++i)
        {
          loop.push_back(curve.First + (curve.From == own.From ? i : curve.Count - 1 - i));
        }
      }
      // f is positive inside: the face is seen from there.
      if (high)
      {
        std::reverse(loop.begin(), loop.end());
      }
      loops.push_back(std::move(loop));
    }
  }
}

void ZeroSet::Worker::FillPolygon(
  const std::vector<Index>& loop, std::vector<FacetTriangulation::Triangle>& triangles) const
{
  // The triangulation of least area (Klincsek 1980); a fan where that would take long.
  constexpr std::size_t Most = 160;
  const std::size_t n = loop.size();
  if (n > Most)
  {
    for (std::size_t i = 2; i < n; ++i)
    {
      triangles.push_back({ 0, static_cast<int>(i) - 1, static_cast<int>(i) });
    }
    return;
  }
  Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(static_cast<Index>(n), static_cast<Index>(n));
  Eigen::MatrixXi apex = Eigen::MatrixXi::Zero(static_cast<Index>(n), static_cast<Index>(n));
  const auto point = [&](Index i) -> Eigen::Vector3d
  { return this->Shared.Points.col(loop[static_cast<std::size_t>(i)]); };
  const auto end = static_cast<Index>(n);
  for (Index length = 2; length < end; ++length)
  {
    for (Index i = 0; i + length < end; ++i)
    {
      const Index j = i + length;
      cost(i, j) = INFINITY;
      for (Index k = i + 1; k < j; ++k)
      {
        const double area = (point(k) - point(i)).cross(point(j) - point(i)).norm();
        const double sum = cost(i, k) + cost(k, j) + area;
        if (sum < cost(i, j))
        {
          cost(i, j) = sum;
          apex(i, j) = static_cast<int>(k);
        }
      }
    }
  }
  std::vector<std::array<Index, 2>> open{ { 0, end - 1 } };
  while (!open.empty())
  {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i > 1)
    {
      const Index k = apex(i, j);
      triangles.push_back({ static_cast<int>(i), static_cast<int>(k), static_cast<int>(j) });
      open.push_back({ i, k });
      open.push_back({ k, j });
    }
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

bool ZeroSet::Worker::FillSheet(
  const Leaf& leaf, const std::vector<Index>& loop, Scratch& scratch, Facets& facets) const
{
  Eigen::Vector3d low = this->Shared.Parameters.col(loop[0]);
  Eigen::Vector3d high = low;
  for (const Index i : loop)
  {
    low = low.cwiseMin(this->Shared.Parameters.col(i));
    high = high.cwiseMax(this->Shared.Parameters.col(i));
  }
  Eigen::Vector3d width = high - low;
  double reach = 0.0;
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    const double box =
      std::abs(this->Line(d, leaf.At.Low[D] + leaf.At.Size) - this->Line(d, leaf.At.Low[D]));
    width[d] = std::max(width[d], 1e-3 * box);
    reach = d == leaf.Height ? 2.0 * std::max(width[d], box) : reach;
  }
  // Few corners may do as they are.
  constexpr std::size_t Few = 12;
  if (loop.size() <= Few)
  {
    Shape flat;
    flat.Axis = leaf.Height;
    flat.A = (leaf.Height + 1) % 3;
    flat.B = (leaf.Height + 2) % 3;
    flat.Centre = 0.5 * (low + high);
    flat.Slope.setZero();
    flat.Bend.setZero();
    flat.Metric.setZero();
    flat.Reach = reach;
    Facets piece;
    const double error =
      this->FillSheet(flat, leaf.Rises ? 1.0 : -1.0, 1.0, JustOnce, width, loop, scratch, piece);
    if (error >= 0.0 && error <= Accepted)
    {
      facets = std::move(piece);
      return true;
    }
  }
  std::optional<Shape> shape = this->Probe(0.5 * (low + high), width, leaf.Height);
  if (!shape)
  {
    return false;
  }
  shape->Reach = reach;
  // Counter-clockwise around the normal is counter-clockwise in (a, b) where f grows with height.
  const double turn = leaf.Rises ? 1.0 : -1.0;
  // Denser where the metric turns out to be too coarse for some place.
  constexpr int Tries = 3;
  double density = 1.0;
  for (int tried = 0; tried < Tries; ++tried)
  {
    Facets piece;
    const Effort effort = tried + 1 < Tries ? UntilMostMiss : Full;
    const double error =
      this->FillSheet(*shape, turn, density, effort, width, loop, scratch, piece);
    if (error < 0.0)
    {
      return false;
    }
    if (!piece.Cells.empty())
    {
      piece.IsWithinTolerance = error <= 1.0;
      facets = std::move(piece);
      break;
    }
    density *= 1.1 * error;
  }
  return true;
}

double ZeroSet::Worker::FillSheet(const Shape& shape, double turn, double density, Effort effort,
  const Eigen::Vector3d& width, const std::vector<Index>& loop, Scratch& scratch,
  Facets& facets) const
{
  facets.Inner.Resize(*this, 0);
  const int w = shape.Axis;
  // In the metric, with a floor: no edge longer than a few widths of the loop.
  Eigen::Matrix2d metric = density * shape.Metric;
  metric(0, 0) += 0.01 / (width[shape.A] * width[shape.A]);
  metric(1, 1) += 0.01 / (width[shape.B] * width[shape.B]);
  const Eigen::Matrix2d U = Eigen::LLT<Eigen::Matrix2d>(metric).matrixU();
  const Eigen::Matrix2d inverse = U.inverse();
  const auto flat = [&](const Eigen::Vector3d& p) -> Eigen::Vector2d
  {
    const Eigen::Vector2d d(p[shape.A] - shape.Centre[shape.A], p[shape.B] - shape.Centre[shape.B]);
    const Eigen::Vector2d y = U * d;
    return { turn * y[0], y[1] };
  };
  scratch.Polygon.clear();
  Eigen::Vector2d least(INFINITY, INFINITY);
  Eigen::Vector2d most = -least;
  for (const Index i : loop)
  {
    scratch.Polygon.push_back(flat(this->Shared.Parameters.col(i)));
    least = least.cwiseMin(scratch.Polygon.back());
    most = most.cwiseMax(scratch.Polygon.back());
  }
  FacetTriangulation& triangulation = scratch.Triangulation;
  if (!triangulation.Start(scratch.Polygon))
  {
    return -1.0;
  }

  // Inner points on a lattice of equilateral triangles, not too near to the boundary.
  constexpr double Spacing = 1.0;
  constexpr double Clearance = 0.6;
  const double rowHeight = Spacing * std::sqrt(0.75);
  scratch.Candidates.clear();
  const Eigen::Vector2d middle = 0.5 * (least + most);
  // A metric that asks for more is wrong: it was taken where the sheet stands nearly upright.
  constexpr double MostCandidates = 4000.0;
  if (!((most[0] - least[0]) * (most[1] - least[1]) <= MostCandidates * rowHeight * Spacing))
  {
    return -1.0;
  }
  const int rows = static_cast<int>(0.5 * (most[1] - least[1]) / rowHeight);
  for (int r = -rows; r <= rows; ++r)
  {
    const double y = middle[1] + r * rowHeight;
    const double shift = r % 2 != 0 ? 0.5 * Spacing : 0.0;
    const int columns = static_cast<int>(0.5 * (most[0] - least[0]) / Spacing) + 1;
    for (int c = -columns; c <= columns; ++c)
    {
      const Eigen::Vector2d p(middle[0] + shift + c * Spacing, y);
      bool inside = false;
      bool clear = true;
      for (std::size_t i = 0, j = scratch.Polygon.size() - 1; i < scratch.Polygon.size() && clear;
           j = i++)
      {
        const Eigen::Vector2d& a = scratch.Polygon[j];
        const Eigen::Vector2d& b = scratch.Polygon[i];
        if ((a[1] > p[1]) != (b[1] > p[1]) &&
          p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0])
        {
          inside = !inside;
        }
        const Eigen::Vector2d ab = b - a;
        const double square = ab.squaredNorm();
        const double t =
          square > 0.0 ? std::min(1.0, std::max(0.0, (p - a).dot(ab) / square)) : 0.0;
        clear = (a + t * ab - p).squaredNorm() > Clearance * Clearance;
      }
      if (inside && clear)
      {
        scratch.Candidates.push_back(p);
      }
    }
  }

  const auto boundary = static_cast<int>(loop.size());
  std::vector<Index> innerOf; // of points of the triangulation behind the polygon's
  const auto insert = [&]
  {
    const auto count = static_cast<Index>(scratch.Candidates.size());
    if (count == 0)
    {
      return;
    }
    scratch.Parameters.resize(3, count);
    for (Index i = 0; i < count; ++i)
    {
      const Eigen::Vector2d& y = scratch.Candidates[static_cast<std::size_t>(i)];
      const Eigen::Vector2d d = inverse * Eigen::Vector2d(turn * y[0], y[1]);
      scratch.Parameters(shape.A, i) = shape.Centre[shape.A] + d[0];
      scratch.Parameters(shape.B, i) = shape.Centre[shape.B] + d[1];
      scratch.Parameters(w, i) = shape.Centre[w] + shape.Slope.dot(d) + 0.5 * d.dot(shape.Bend * d);
    }
    scratch.Axes.assign(static_cast<std::size_t>(count), w);
    this->Project(scratch.Parameters, scratch.Axes, scratch.Projected);
    const Index before = facets.Inner.Count();
    Index at = before;
    facets.Inner.Resize(*this, before + count);
    for (Index i = 0; i < count; ++i)
    {
      if (scratch.Projected[static_cast<std::size_t>(i)] != 0 &&
        std::abs(scratch.Parameters(w, i) - shape.Centre[w]) <= shape.Reach &&
        triangulation.Insert(scratch.Candidates[static_cast<std::size_t>(i)]) >= 0)
      {
        innerOf.push_back(at);
        facets.Inner.Parameters.col(at++) = scratch.Parameters.col(i);
      }
    }
    facets.Inner.Resize(*this, at);
    this->Evaluate(facets.Inner, before, at);
  };
  insert();

  // Triangles that miss it get a point where they are worst; if they are most, the metric is wrong.
  constexpr int Rounds = 8;
  double worst = 0.0;
  std::vector<std::pair<int, double>> missing;
  for (int round = 0; round < Rounds; ++round)
  {
    missing.clear();
    worst = this->MeasureFacets(
      triangulation.Triangles(), boundary, loop, innerOf, scratch, facets, missing);
    const std::size_t all = triangulation.Triangles().size();
    if (missing.empty() || round + 1 == Rounds)
    {
      break;
    }
    if (effort == JustOnce || (effort == UntilMostMiss && all > 16 && 2 * missing.size() > all))
    {
      double sum = 0.0;
      for (const auto& miss : missing)
      {
        sum += miss.second;
      }
      return std::min(4.0, sum / static_cast<double>(missing.size()));
    }
    scratch.Candidates.clear();
    for (const auto& miss : missing)
    {
      scratch.Candidates.push_back(WorstPlace(triangulation, miss.first));
    }
    insert();
  }
  for (const auto& triangle : triangulation.Triangles())
  {
    std::array<Index, 3> cell{};
    for (std::size_t k = 0; k < 3; ++k)
    {
      const int corner = triangle[k];
      cell[k] =
        corner < boundary ? corner : -1 - innerOf[static_cast<std::size_t>(corner - boundary)];
    }
    facets.Cells.push_back(cell);
  }
  return worst;
}

void ZeroSet::Worker::FillLoop(
  const Leaf& leaf, const std::vector<Index>& loop, Scratch& scratch, Facets& facets) const
{
  facets.Inner.Resize(*this, 0);
  if (loop.size() < 3 || (leaf.Height >= 0 && this->FillSheet(leaf, loop, scratch, facets)))
  {
    return;
  }
  // No simple polygon seen along the height: nearly upright, or vertices joined across a corner.
  std::vector<FacetTriangulation::Triangle> triangles;
  this->FillPolygon(loop, triangles);
  if (leaf.Height >= 0)
  {
    std::vector<std::pair<int, double>> missing;
    this->MeasureFacets(
      triangles, static_cast<int>(loop.size()), loop, {}, scratch, facets, missing);
    facets.Failed = missing.empty() ? 0 : 1;
    facets.IsWithinTolerance = missing.empty();
  }
  for (const auto& triangle : triangles)
  {
    facets.Cells.push_back({ triangle[0], triangle[1], triangle[2] });
  }
}

void ZeroSet::Worker::PartSheets(std::vector<CrowdedEdge> edges)
{
  if (edges.empty())
  {
    return;
  }
  // Two sheets may join the same points where a curve between them has a corner, or where they lie
  // flat in the face between their leaves.
  std::map<std::array<Index, 2>, CrowdedEdge*> crowded;
  for (CrowdedEdge& edge : edges)
  {
    crowded[edge.Ends] = &edge;
  }
  const auto find = [&crowded](Index a, Index b)
  {
    const auto found = crowded.find({ std::min(a, b), std::max(a, b) });
    return found != crowded.end() ? found->second : nullptr;
  };

  Scratch scratch;
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    Facets& piece = this->Pieces[leaf];
    if (this->Leaves[leaf].Height < 0)
    {
      continue;
    }
    for (std::size_t c = 0; c < piece.Cells.size(); ++c)
    {
      for (std::size_t k = 0; k < 3; ++k)
      {
        const Index from = piece.Cells[c][k];
        const Index to = piece.Cells[c][(k + 1) % 3];
        if (from < 0 || to < 0)
        {
          continue;
        }
        const Index a = piece.Loops[static_cast<std::size_t>(from)];
        const Index b = piece.Loops[static_cast<std::size_t>(to)];
        CrowdedEdge* const edge = find(a, b);
        if (edge && edge->Sheets > 1 && this->SplitEdge(leaf, c, k, 1.0 / edge->Sheets, scratch))
        {
          --edge->Sheets;
        }
      }
    }
  }

  const auto isCrowded = [&find](Index a, Index b)
  {
    const CrowdedEdge* edge = find(a, b);
    return edge && edge->Sheets > 1;
  };
  // Where that is not possible, triangles back to back, which enclose nothing, go with the edges
  // that only they have.
  std::map<std::array<Index, 3>, std::array<std::size_t, 2>> facing; // leaf and cell
  std::vector<std::array<std::size_t, 2>> dropped;
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    const Facets& piece = this->Pieces[leaf];
    for (std::size_t c = 0; c < piece.Cells.size(); ++c)
    {
      if (*std::min_element(piece.Cells[c].begin(), piece.Cells[c].end()) < 0)
      {
        continue;
      }
      std::array<Index, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k)
      {
        corners[k] = piece.Loops[static_cast<std::size_t>(piece.Cells[c][k])];
      }
      if (!isCrowded(corners[0], corners[1]) && !isCrowded(corners[1], corners[2]) &&
        !isCrowded(corners[2], corners[0]))
      {
        continue;
      }
      // The least first, so that what turns the other way has the others swapped.
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      const auto back = facing.find({ corners[0], corners[2], corners[1] });
      if (back == facing.end())
      {
        facing.insert({ corners, { leaf, c } });
        continue;
      }
      dropped.insert(dropped.end(), { back->second, { leaf, c } });
      facing.erase(back);
      for (std::size_t k = 0; k < 3; ++k)
      {
        CrowdedEdge* const edge = find(corners[k], corners[(k + 1) % 3]);
        if (edge)
        {
          --edge->Sheets;
        }
      }
    }
  }
  std::sort(dropped.rbegin(), dropped.rend());
  for (const auto& [leaf, c] : dropped)
  {
    auto& cells = this->Pieces[leaf].Cells;
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(c));
  }
}

bool ZeroSet::Worker::SplitEdge(
  std::size_t leaf, std::size_t cell, std::size_t side, double place, Scratch& scratch)
{
  Facets& piece = this->Pieces[leaf];
  const Index from = piece.Cells[cell][side];
  const Index to = piece.Cells[cell][(side + 1) % 3];
  // The triangle on the other side, if it is one of this leaf.
  std::size_t other = 0;
  std::size_t otherSide = 3;
  for (std::size_t c = 0; c < piece.Cells.size() && otherSide == 3; ++c)
  {
    for (std::size_t k = 0; k < 3; ++k)
    {
      if (piece.Cells[c][k] == to && piece.Cells[c][(k + 1) % 3] == from)
      {
        other = c;
        otherSide = k;
      }
    }
  }
  if (otherSide == 3)
  {
    return false;
  }
  const Index a = std::min(from, to); // of which neither side makes a difference
  const Index b = std::max(from, to);
  Eigen::Matrix3Xd parameters =
    (1.0 - place) * this->Shared.Parameters.col(piece.Loops[static_cast<std::size_t>(a)]) +
    place * this->Shared.Parameters.col(piece.Loops[static_cast<std::size_t>(b)]);
  this->Project(parameters, { this->Leaves[leaf].Height }, scratch.Projected);
  if (scratch.Projected[0] == 0)
  {
    return false;
  }
  const Index inner = piece.Inner.Count();
  piece.Inner.Resize(*this, inner + 1);
  piece.Inner.Parameters.col(inner) = parameters;
  this->Evaluate(piece.Inner, inner, inner + 1);

  const Index apex = piece.Cells[cell][(side + 2) % 3];
  const Index otherApex = piece.Cells[other][(otherSide + 2) % 3];
  const Index middle = -1 - inner;
  const std::array<std::array<Index, 3>, 4> parts{ { { from, middle, apex }, { middle, to, apex },
    { to, middle, otherApex }, { middle, from, otherApex } } };
  piece.Cells[cell] = parts[0];
  piece.Cells[other] = parts[2];
  piece.Cells.insert(piece.Cells.end(), { parts[1], parts[3] });

  // What the new triangles are off by.
  std::vector<Index> loop;
  std::vector<Index> innerOf;
  std::vector<FacetTriangulation::Triangle> triangles(parts.size());
  for (const bool isInner : { false, true })
  {
    for (std::size_t t = 0; t < parts.size(); ++t)
    {
      for (std::size_t k = 0; k < 3; ++k)
      {
        const Index corner = parts[t][k];
        if ((corner < 0) == isInner)
        {
          triangles[t][k] = static_cast<int>(loop.size() + innerOf.size());
          isInner ? innerOf.push_back(-1 - corner)
                  : loop.push_back(piece.Loops[static_cast<std::size_t>(corner)]);
        }
      }
    }
  }
  const double distance = piece.Error;
  const double attribute = piece.AttributeError;
  std::vector<std::pair<int, double>> missing;
  const double worst = this->MeasureFacets(
    triangles, static_cast<int>(loop.size()), loop, innerOf, scratch, piece, missing);
  piece.Error = std::max(piece.Error, distance);
  piece.AttributeError = std::max(piece.AttributeError, attribute);
  piece.IsWithinTolerance = piece.IsWithinTolerance && worst <= 1.0;
  return true;
}

void ZeroSet::Worker::Add(const Facets& piece, Index begin, Facets& facets) const
{
  const Index inner = facets.Inner.Count();
  facets.Inner.Resize(*this, inner + piece.Inner.Count());
  this->Copy(piece.Inner, 0, facets.Inner, inner, piece.Inner.Count());
  for (const auto& cell : piece.Cells)
  {
    auto& added = facets.Cells.emplace_back(cell);
    for (Index& corner : added)
    {
      corner += corner < 0 ? -inner : begin;
    }
  }
  facets.Error = std::max(facets.Error, piece.Error);
  facets.AttributeError = std::max(facets.AttributeError, piece.AttributeError);
  facets.Failed += piece.Failed;
  facets.IsWithinTolerance = facets.IsWithinTolerance && piece.IsWithinTolerance;
}

std::uint64_t ZeroSet::Worker::SignatureOf(const std::vector<std::vector<Index>>& loops) const
{
  std::uint64_t signature = loops.size() + 1;
  const auto add = [&signature](double x)
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &x, sizeof(bits));
    signature = (signature ^ bits) * 0x9E3779B97F4A7C15u;
    signature ^= signature >> 29;
  };
  for (const std::vector<Index>& loop : loops)
  {
    add(static_cast<double>(loop.size()));
    for (const Index i : loop)
    {
      for (int d = 0; d < 3; ++d)
      {
        add(this->Shared.Parameters(d, i));
        add(this->Shared.Points(d, i));
      }
    }
  }
  return signature;
}

void ZeroSet::Worker::FillLeaf(std::size_t number, Scratch& scratch, Facets& facets) const
{
  const Leaf& leaf = this->Leaves[number];
  const bool followed = this->FindLoops(number, scratch);
  if (leaf.Flat != 0)
  {
    this->FindFlatLoops(leaf, scratch.Loops);
  }
  for (std::size_t i = 0; i < scratch.Loops.size() && this->AreLinesTurned; ++i)
  {
    std::reverse(scratch.Loops[i].begin(), scratch.Loops[i].end());
  }
  const std::uint64_t signature = this->SignatureOf(scratch.Loops);
  if (signature != facets.Signature)
  {
    facets = Facets();
    facets.Signature = signature;
    facets.Inner.Resize(*this, 0);
    Index begin = 0;
    for (const std::vector<Index>& loop : scratch.Loops)
    {
      Facets piece;
      this->FillLoop(leaf, loop, scratch, piece);
      this->Add(piece, begin, facets);
      begin += static_cast<Index>(loop.size());
    }
  }
  facets.Loops.clear();
  for (const std::vector<Index>& loop : scratch.Loops)
  {
    facets.Loops.insert(facets.Loops.end(), loop.begin(), loop.end());
  }
  facets.IsWithinTolerance = facets.IsWithinTolerance && followed;
}

bool ZeroSet::Worker::Fill()
{
  this->Pieces.resize(this->Leaves.size());
  if (this->Axes.size() < 3)
  {
    return true;
  }
  constexpr Index Grain = 8;
  return this->Parallel(static_cast<Index>(this->Leaves.size()), Grain,
    [this](Index begin, Index end)
    {
      Scratch scratch;
      for (Index i = begin; i < end; ++i)
      {
        const auto leaf = static_cast<std::size_t>(i);
        this->FillLeaf(leaf, scratch, this->Pieces[leaf]);
      }
    });
}

}
