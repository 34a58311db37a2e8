// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

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

}

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

}
