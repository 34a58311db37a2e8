// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSContour.h"

#include "Aggregate.h"
#include "ArrayNames.h"
#include "Error.h"
#include "FieldChoice.h"
#include "NURBSMeshOutput.h"

#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <utility>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSContour);

vtkNURBSContour::vtkNURBSContour()
  : vtkNURBSLevelSetAlgorithm({})
{
}

vtkNURBSContour::~vtkNURBSContour() = default;

void vtkNURBSContour::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ContourOf: " << this->ContourOf << "\n";
  os << indent << "Component: " << this->Component << "\n";
}

void vtkNURBSContour::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  vtkInformation* array = this->GetInputArrayInformation(0);
  const char* chosen = array ? array->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  const FieldChoice choice{ this->ContourOf, chosen ? chosen : "", this->Component };
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  choice.Check(tolerances.Components);
  const std::vector<double>& values = this->CheckedLevels("an isovalue");
  std::vector<Task> tasks;
  for (const PreparedPatch& patch : this->Prepare(model))
  {
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      if (auto field = choice.At(*patch.Body, values[i]))
      {
        tasks.push_back({ patch, std::move(field), static_cast<int>(i),
          choice.ConstantAttribute(patch.Patch->Body) });
      }
    }
  }
  NURBSMeshOutput mesh(tolerances.Components, { hyperpatch::names::ContourIndex });
  this->Draw(tasks, tolerances, mesh, output->GetFieldData());
  mesh.Fill(vtkPolyData::SafeDownCast(output), this->KernelParallelFor());
}

VTK_ABI_NAMESPACE_END
