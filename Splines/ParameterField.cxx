// SPDX-License-Identifier: BSD-3-Clause
#include "ParameterField.h"

#include "Error.h"

#include <algorithm>
#include <string>

namespace hyperpatch
{

ParameterField::ParameterField(const Spline& geometry, int direction, double value)
  : Direction(static_cast<std::size_t>(direction))
  , Value(value)
{
  if (direction < 0 || direction > 2 || geometry.Knots(direction).Degree() == 0)
  {
    throw hyperpatch::Error("the geometry has no parametric direction " +
      std::to_string(direction) + " in which it extends");
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->Ends[d] = { geometry.Knots()[d].First(), geometry.Knots()[d].Last() };
  }
}

void ParameterField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  for (std::size_t i = 0; i < count; ++i)
  {
    values[i] = parameters[3 * i + this->Direction] - this->Value;
  }
}

void ParameterField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  this->Evaluate(count, parameters, values);
  std::fill_n(gradients, 3 * count, 0.0);
  for (std::size_t i = 0; i < count; ++i)
  {
    gradients[3 * i + this->Direction] = 1.0;
  }
}

std::array<std::vector<double>, 3> ParameterField::Breaks() const
{
  return this->Ends;
}

std::array<std::vector<double>, 3> ParameterField::Creases() const
{
  return {};
}

std::optional<Bernstein> ParameterField::OnBox(const ParameterBox& box) const
{
  std::array<int, 3> degrees{};
  degrees[this->Direction] = 1;
  const Eigen::Vector2d ends(
    box.Low[this->Direction] - this->Value, box.High[this->Direction] - this->Value);
  return Bernstein(degrees, ends);
}

bool ParameterField::Excludes(const ParameterBox& box) const
{
  return this->Value < box.Low[this->Direction] || this->Value > box.High[this->Direction];
}

}
