// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSContour.h"

#include "Aggregate.h"
#include "Error.h"
#include "NURBSMeshOutput.h"
#include "QuadricField.h"

#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSContour);

vtkNURBSContour::vtkNURBSContour() = default;
vtkNURBSContour::~vtkNURBSContour() = default;

void vtkNURBSContour::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Component: " << this->Component << "\n";
  os << indent << "Values:";
  for (const double value : this->Values)
  {
    os << " " << value;
  }
  os << "\n";
}

void vtkNURBSContour::SetNumberOfContours(int number)
{
  const auto size = static_cast<std::size_t>(std::max(number, 0));
  if (this->Values.size() != size)
  {
    this->Values.resize(size, 0.0);
    this->Modified();
  }
}

void vtkNURBSContour::SetValue(int i, double value)
{
  if (i < 0)
  {
    vtkErrorMacro("there is no contour " << i);
    return;
  }
  if (i >= this->GetNumberOfContours())
  {
    this->SetNumberOfContours(i + 1);
  }
  double& at = this->Values[static_cast<std::size_t>(i)];
  if (at != value)
  {
    at = value;
    this->Modified();
  }
}

double vtkNURBSContour::GetValue(int i)
{
  return i >= 0 && i < this->GetNumberOfContours() ? this->Values[static_cast<std::size_t>(i)]
                                                   : 0.0;
}

void vtkNURBSContour::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  vtkInformation* array = this->GetInputArrayInformation(0);
  const char* chosen = array ? array->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  const std::string name = chosen ? chosen : "";
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  const auto found = tolerances.Components.find(name);
  if (found == tolerances.Components.end())
  {
    std::string there;
    for (const auto& entry : tolerances.Components)
    {
      there += (there.empty() ? "" : ", ") + entry.first;
    }
    throw hyperpatch::Error("there is no attribute \"" + name + "\" to contour by" +
      (there.empty() ? ": the model has none" : "; there are: " + there));
  }
  if (this->Component < -1 || this->Component >= found->second)
  {
    throw hyperpatch::Error("component " + std::to_string(this->Component) + " of attribute \"" +
      name + "\" cannot be contoured: it has " + std::to_string(found->second) +
      " (0.. or -1 for the magnitude)");
  }

  for (const double value : this->Values)
  {
    if (!std::isfinite(value))
    {
      throw hyperpatch::Error("an isovalue is not a finite number");
    }
  }
  std::vector<Task> tasks;
  for (const PreparedPatch& patch : this->Prepare(model))
  {
    for (const auto& attribute : patch.Body->Attributes())
    {
      const hyperpatch::Spline& spline = attribute->Spline();
      if (&spline != patch.Patch->Body.FindAttribute(name) || spline.Components() != found->second)
      {
        continue;
      }
      for (std::size_t i = 0; i < this->Values.size(); ++i)
      {
        const double value = this->Values[i];
        auto field = std::make_shared<hyperpatch::QuadricField>(attribute,
          this->Component < 0 ? hyperpatch::MagnitudeEquals(spline, value)
                              : hyperpatch::ComponentEquals(spline, this->Component, value),
          false);
        tasks.push_back({ patch, std::move(field), static_cast<int>(i) });
      }
    }
  }
  NURBSMeshOutput mesh(tolerances.Components, { "ContourIndex" });
  this->Draw(tasks, tolerances, mesh, output->GetFieldData());
  mesh.Fill(vtkPolyData::SafeDownCast(output));
}

VTK_ABI_NAMESPACE_END
