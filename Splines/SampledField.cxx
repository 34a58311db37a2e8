// SPDX-License-Identifier: BSD-3-Clause
#include "SampledField.h"

#include "Error.h"
#include "ScalarFieldWorker.h"

#include <Eigen/Core>
#include <algorithm>
#include <utility>

namespace hyperpatch
{

using field::BreaksOf;
using field::Chunk;
using field::KnotsNoSmootherThan;

SampledField::SampledField(std::shared_ptr<const PreparedSpline> geometry, Function function)
  : S(std::move(geometry))
  , G(std::move(function))
{
  if (this->S->Spline().Components() != 3)
  {
    throw hyperpatch::Error("a function on physical space needs a geometry with three coordinates");
  }
}

SampledField::SampledField(const Spline& geometry, Function function)
  : SampledField(std::make_shared<const PreparedSpline>(geometry), std::move(function))
{
}

void SampledField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().Evaluate(n, parameters + 3 * first, points.data());
    this->G(n, points.data(), values + first, nullptr);
  }
}

void SampledField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  std::vector<double> derivatives(3 * points.size());
  std::vector<double> physical(points.size());
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().EvaluateWithDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data());
    this->G(n, points.data(), values + first, physical.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      const Eigen::Map<const Eigen::Matrix3d> J(derivatives.data() + 9 * i);
      const Eigen::Map<const Eigen::Vector3d> g(physical.data() + 3 * i);
      Eigen::Map<Eigen::Vector3d>(gradients + 3 * (first + i)) = J.transpose() * g;
    }
  }
}

std::array<std::vector<double>, 3> SampledField::Breaks() const
{
  return BreaksOf(this->S->Spline());
}

std::array<std::vector<double>, 3> SampledField::Creases() const
{
  return KnotsNoSmootherThan(this->S->Spline(), 0);
}

std::optional<Bernstein> SampledField::OnBox(const ParameterBox& /*box*/) const
{
  return std::nullopt;
}

}
