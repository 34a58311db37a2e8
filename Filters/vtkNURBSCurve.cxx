// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSCurve.h"

#include "Error.h"
#include "Reparametrise.h"

#include "vtkObjectFactory.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace
{

using hyperpatch::Error;
using hyperpatch::KnotVector;
using hyperpatch::Spline;

KnotVector EqualKnots(const char* what, int degree, std::size_t count)
{
  if (count < 2)
  {
    throw Error(
      std::string(what) + " needs at least 2 coefficients, there are " + std::to_string(count));
  }
  if (degree < 1)
  {
    throw Error(std::string(what) + " has degree 1 at least, not " + std::to_string(degree));
  }
  const auto size = static_cast<int>(count);
  return KnotVector::Uniform(std::min(degree, size - 1), size);
}

}

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSCurve);

vtkNURBSCurve::vtkNURBSCurve()
{
  this->SetNumberOfInputPorts(0);
}

void vtkNURBSCurve::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto print = [&os, indent](const char* name, const std::vector<double>& numbers)
  {
    os << indent << name << ":";
    for (const double number : numbers)
    {
      os << " " << number;
    }
    os << "\n";
  };
  os << indent << "Points:";
  for (const std::array<double, 3>& point : this->Points)
  {
    os << " (" << point[0] << ", " << point[1] << ", " << point[2] << ")";
  }
  os << "\n" << indent << "Degree: " << this->Degree << "\n";
  print("Weights", this->Weights);
  print("Knots", this->Knots);
  os << indent << "AttributeName: " << this->AttributeName << "\n";
  print("AttributeValues", this->AttributeValues);
  os << indent << "AttributeDegree: " << this->AttributeDegree << "\n";
}

void vtkNURBSCurve::SetNumberOfPoints(int number)
{
  if (number >= 0 && number != this->GetNumberOfPoints())
  {
    this->Points.resize(static_cast<std::size_t>(number));
    this->Modified();
  }
}

void vtkNURBSCurve::SetPoint(int index, double x, double y, double z)
{
  const std::array<double, 3> point{ x, y, z };
  if (index >= 0 && index < this->GetNumberOfPoints() &&
    this->Points[static_cast<std::size_t>(index)] != point)
  {
    this->Points[static_cast<std::size_t>(index)] = point;
    this->Modified();
  }
}

void vtkNURBSCurve::Resize(std::vector<double>& numbers, int number)
{
  if (number >= 0 && static_cast<std::size_t>(number) != numbers.size())
  {
    numbers.resize(static_cast<std::size_t>(number));
    this->Modified();
  }
}

void vtkNURBSCurve::SetNumber(std::vector<double>& numbers, int index, double value)
{
  if (index >= 0 && static_cast<std::size_t>(index) < numbers.size() &&
    numbers[static_cast<std::size_t>(index)] != value)
  {
    numbers[static_cast<std::size_t>(index)] = value;
    this->Modified();
  }
}

hyperpatch::MultiPatch vtkNURBSCurve::MakeModel(const Inputs&)
{
  const std::size_t count = this->Points.size();
  const KnotVector equal = EqualKnots("a curve", this->Degree, count);
  if (!this->Knots.empty() && this->Knots.size() != count + this->Degree + 1)
  {
    throw Error("there are " + std::to_string(this->Knots.size()) +
      " knots: " + std::to_string(count) + " points of degree " + std::to_string(this->Degree) +
      " need " + std::to_string(count + this->Degree + 1) + ", or none");
  }
  const KnotVector knots = this->Knots.empty() ? equal : KnotVector(this->Degree, this->Knots);
  Eigen::MatrixXd points(3, static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i)
  {
    points.col(static_cast<Eigen::Index>(i)) =
      Eigen::Map<const Eigen::Vector3d>(this->Points[i].data());
  }
  const Eigen::VectorXd weights = Eigen::Map<const Eigen::VectorXd>(
    this->Weights.data(), static_cast<Eigen::Index>(this->Weights.size()));
  Spline curve({ knots, {}, {} }, std::move(points), weights);

  std::vector<hyperpatch::Attribute> attributes;
  if (!this->AttributeName.empty())
  {
    const KnotVector own =
      EqualKnots("an attribute", this->AttributeDegree, this->AttributeValues.size());
    const Eigen::RowVectorXd values = Eigen::Map<const Eigen::RowVectorXd>(
      this->AttributeValues.data(), static_cast<Eigen::Index>(this->AttributeValues.size()));
    attributes.push_back({ this->AttributeName,
      hyperpatch::ScaleDomain(Spline({ own, {}, {} }, values), 0, knots.First(), knots.Last()) });
  }
  hyperpatch::MultiPatch model;
  model.Patches.push_back({ 0, hyperpatch::Aggregate(std::move(curve), std::move(attributes)) });
  return model;
}

VTK_ABI_NAMESPACE_END
