// SPDX-License-Identifier: BSD-3-Clause
#include "FieldChoice.h"

#include "Error.h"
#include "JacobianField.h"
#include "ParameterField.h"
#include "QuadricField.h"

#include <algorithm>

void FieldChoice::Check(const std::map<std::string, int>& components) const
{
  if (this->Kind == JacobianDeterminant)
  {
    return;
  }
  std::string what = this->Kind == Coordinates ? "coordinates" : "parametric coordinates";
  int number = 3;
  if (this->Kind == Attribute)
  {
    const auto found = components.find(this->Name);
    if (found == components.end())
    {
      std::string there;
      for (const auto& entry : components)
      {
        there += (there.empty() ? "" : ", ") + entry.first;
      }
      throw hyperpatch::Error("there is no attribute \"" + this->Name + "\"" +
        (there.empty() ? ": the model has none" : "; there are: " + there));
    }
    what = "attribute \"" + this->Name + "\"";
    number = found->second;
  }
  const int least = this->Kind == ParametricCoordinates ? 0 : -1;
  if (this->Component < least || this->Component >= number)
  {
    throw hyperpatch::Error("there is no component " + std::to_string(this->Component) + " of " +
      what + ": the components are 0 to " + std::to_string(number - 1) +
      (least < 0 ? ", and -1 is the magnitude" : ""));
  }
}

std::shared_ptr<const hyperpatch::ScalarField> FieldChoice::At(
  const hyperpatch::PreparedAggregate& body, double value) const
{
  const auto ofSpline = [&](const std::shared_ptr<const hyperpatch::PreparedSpline>& prepared,
                          bool isPhysical) -> std::shared_ptr<const hyperpatch::ScalarField>
  {
    const hyperpatch::Spline& spline = prepared->Spline();
    return this->Component >= spline.Components()
      ? nullptr
      : std::make_shared<hyperpatch::QuadricField>(prepared,
          this->Component < 0 ? hyperpatch::MagnitudeEquals(spline, value)
                              : hyperpatch::ComponentEquals(spline, this->Component, value),
          isPhysical);
  };
  const hyperpatch::Spline& geometry = body.Body().Geometry();
  switch (this->Kind)
  {
    case Coordinates:
      return ofSpline(body.Geometry(), true);
    case ParametricCoordinates:
      return geometry.Knots(this->Component).Degree() == 0
        ? nullptr
        : std::make_shared<hyperpatch::ParameterField>(geometry, this->Component, value);
    case JacobianDeterminant:
      return geometry.Dimension() == 3 && geometry.Components() == 3
        ? std::make_shared<hyperpatch::JacobianField>(body.Geometry(), value)
        : nullptr;
    default:
      break;
  }
  for (const auto& attribute : body.Attributes())
  {
    if (&attribute->Spline() == body.Body().FindAttribute(this->Name))
    {
      return ofSpline(attribute, false);
    }
  }
  return nullptr;
}

int FieldChoice::ConstantAttribute(const hyperpatch::Aggregate& body) const
{
  const auto& attributes = body.Attributes();
  const auto found = std::find_if(attributes.begin(), attributes.end(),
    [this](const hyperpatch::Attribute& a)
    { return a.Name == this->Name && a.Field.Components() == 1; });
  return this->Kind == Attribute && found != attributes.end()
    ? static_cast<int>(found - attributes.begin())
    : -1;
}
