// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSLoft.h"

#include "Modelling.h"

#include "vtkInformation.h"
#include "vtkObjectFactory.h"

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSLoft);

void vtkNURBSLoft::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Degree: " << this->Degree << "\n";
}

int vtkNURBSLoft::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return this->Superclass::FillInputPortInformation(port, info);
}

hyperpatch::MultiPatch vtkNURBSLoft::MakeModel(const Inputs& inputs)
{
  return hyperpatch::LoftModels(inputs[0], this->Degree);
}

VTK_ABI_NAMESPACE_END
