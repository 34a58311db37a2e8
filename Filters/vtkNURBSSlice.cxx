// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSSlice.h"

#include "Aggregate.h"
#include "ArrayNames.h"
#include "FunctionFields.h"
#include "NURBSMeshOutput.h"
#include "TrimmedSurfaces.h"

#include "vtkImplicitFunction.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSSlice);

vtkNURBSSlice::vtkNURBSSlice()
  : vtkNURBSLevelSetAlgorithm({ 0.0 })
{
}

vtkNURBSSlice::~vtkNURBSSlice() = default;

void vtkNURBSSlice::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SliceFunction: " << this->SliceFunction.Get() << "\n";
}

vtkMTimeType vtkNURBSSlice::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->SliceFunction ? std::max(own, this->SliceFunction->GetMTime()) : own;
}

void vtkNURBSSlice::SetSliceFunction(vtkImplicitFunction* function)
{
  if (this->SliceFunction != function)
  {
    this->SliceFunction = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkNURBSSlice::GetSliceFunction()
{
  return this->SliceFunction;
}

void vtkNURBSSlice::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  const std::vector<double>& offsets = this->CheckedLevels("an offset value");
  const FunctionFields function(this->SliceFunction, model);
  std::vector<Task> tasks;
  for (const PreparedPatch& patch : this->Prepare(model))
  {
    for (std::size_t i = 0; i < offsets.size(); ++i)
    {
      for (auto& field : function.At(*patch.Body, offsets[i]))
      {
        tasks.push_back({ patch, std::move(field), static_cast<int>(i) });
      }
    }
  }
  NURBSMeshOutput mesh(tolerances.Components, { hyperpatch::names::SliceIndex });
  this->Draw(tasks, tolerances, mesh, output->GetFieldData());
  mesh.Fill(vtkPolyData::SafeDownCast(output), this->KernelParallelFor());
}

void vtkNURBSSlice::Change(
  const std::vector<Task>& tasks, std::vector<hyperpatch::ZeroSetMesh>& surfaces)
{
  // The tasks of one patch and value are the sides of a box.
  for (std::size_t first = 0; first < tasks.size();)
  {
    std::size_t end = first;
    std::vector<std::shared_ptr<const hyperpatch::ScalarField>> fields;
    std::vector<hyperpatch::ZeroSetMesh> sides;
    for (; end < tasks.size() && tasks[end].Value == tasks[first].Value &&
         tasks[end].On.Patch == tasks[first].On.Patch;
         ++end)
    {
      fields.push_back(tasks[end].Field);
      sides.push_back(std::move(surfaces[end]));
    }
    if (fields.size() > 1)
    {
      (void)hyperpatch::TrimToEachOther(
        tasks[first].On.Body, fields, sides, this->KernelParallelFor(), [] { return false; });
    }
    std::move(sides.begin(), sides.end(), surfaces.begin() + static_cast<std::ptrdiff_t>(first));
    first = end;
  }
}

VTK_ABI_NAMESPACE_END
