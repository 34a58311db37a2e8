// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSAppend.h"

#include "Append.h"

#include "vtkInformation.h"
#include "vtkObjectFactory.h"

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSAppend);

void vtkNURBSAppend::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "InterfaceTolerance: " << this->InterfaceTolerance << "\n";
}

int vtkNURBSAppend::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return this->Superclass::FillInputPortInformation(port, info);
}

double vtkNURBSAppend::FoundInterfaceTolerance() const
{
  return this->InterfaceTolerance;
}

hyperpatch::MultiPatch vtkNURBSAppend::MakeModel(const Inputs& inputs)
{
  return hyperpatch::Append(inputs[0]);
}

VTK_ABI_NAMESPACE_END
