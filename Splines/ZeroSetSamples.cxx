// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

void ZeroSet::Worker::Samples::Resize(const Worker& worker, Index count)
{
  this->Parameters.conservativeResize(3, count);
  this->Points.conservativeResize(3, count);
  this->Normals.conservativeResize(3, count);
  this->Residuals.conservativeResize(count);
  this->Attributes.resize(worker.Attributes.size());
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    this->Attributes[a].conservativeResize(worker.Attributes[a]->Components(), count);
  }
}

void ZeroSet::Worker::Copy(
  const Samples& from, Index first, Samples& to, Index at, Index count) const
{
  to.Parameters.middleCols(at, count) = from.Parameters.middleCols(first, count);
  to.Points.middleCols(at, count) = from.Points.middleCols(first, count);
  to.Normals.middleCols(at, count) = from.Normals.middleCols(first, count);
  to.Residuals.segment(at, count) = from.Residuals.segment(first, count);
  for (std::size_t a = 0; a < from.Attributes.size(); ++a)
  {
    to.Attributes[a].middleCols(at, count) = from.Attributes[a].middleCols(first, count);
  }
}

void ZeroSet::Worker::Evaluate(Samples& samples, Index begin, Index end) const
{
  const int m = this->Geometry.Components();
  Eigen::MatrixXd points(m, std::min(end - begin, Batch));
  Eigen::MatrixXd derivatives(3 * m, points.cols());
  std::vector<double> values(static_cast<std::size_t>(points.cols()));
  Eigen::Matrix3Xd gradients(3, points.cols());
  for (Index first = begin; first < end; first += Batch)
  {
    const Index count = std::min(Batch, end - first);
    const auto n = static_cast<std::size_t>(count);
    const double* parameters = samples.Parameters.col(first).data();
    this->Geometry.EvaluateWithDerivatives(n, parameters, points.data(), derivatives.data());
    samples.Points.middleCols(first, count).setZero();
    samples.Points.block(0, first, m, count) = points.leftCols(count);
    this->Field.EvaluateWithGradient(n, parameters, values.data(), gradients.data());
    this->Field.Snap(n, samples.Points.col(first).data());
    for (std::size_t a = 0; a < this->Attributes.size(); ++a)
    {
      this->Attributes[a]->Evaluate(n, parameters, samples.Attributes[a].col(first).data());
    }
    for (Index i = 0; i < count; ++i)
    {
      samples.Normals.col(first + i) = this->Normal(derivatives.col(i).data(), gradients.col(i));
      samples.Residuals[first + i] = std::abs(values[static_cast<std::size_t>(i)]);
    }
  }
}

Eigen::Matrix3d ZeroSet::Worker::Jacobian(const double* derivatives) const
{
  const int m = this->Geometry.Components();
  if (m == 3)
  {
    return Eigen::Map<const Eigen::Matrix3d>(derivatives);
  }
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
  for (int d = 0; d < 3; ++d)
  {
    J.col(d).head(m) = Eigen::Map<const Eigen::VectorXd>(derivatives + m * d, m);
  }
  return J;
}

Eigen::Vector3d ZeroSet::Worker::Normal(
  const double* derivatives, const Eigen::Vector3d& gradient) const
{
  const Eigen::Matrix3d J = this->Jacobian(derivatives);
  // cof(J) grad f: the physical gradient times det J, so it does not flip across folds.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  if (this->Axes.size() == 3)
  {
    normal = this->Options.Handedness *
      (gradient[0] * J.col(1).cross(J.col(2)) + gradient[1] * J.col(2).cross(J.col(0)) +
        gradient[2] * J.col(0).cross(J.col(1)));
  }
  else if (this->Axes.size() == 2)
  {
    normal = J.col(this->Axes[0]).cross(J.col(this->Axes[1]));
  }
  const double norm = normal.norm();
  return norm > 0.0 ? Eigen::Vector3d(normal / norm) : normal;
}

}
