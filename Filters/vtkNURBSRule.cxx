// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSRule.h"

#include "Error.h"
#include "Modelling.h"

#include "vtkInformation.h"
#include "vtkObjectFactory.h"

#include <cstddef>
#include <string>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSRule);

void vtkNURBSRule::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

int vtkNURBSRule::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_IS_REPEATABLE(), 1);
  return this->Superclass::FillInputPortInformation(port, info);
}

hyperpatch::MultiPatch vtkNURBSRule::MakeModel(const Inputs& inputs)
{
  const std::size_t sections =
    inputs[0].size() == 1 ? inputs[0][0].Patches.size() : inputs[0].size();
  if (sections != 2)
  {
    throw hyperpatch::Error("there are " + std::to_string(sections) +
      " sections: NURBS Rule takes two inputs, or one of two patches; NURBS Loft takes more");
  }
  return hyperpatch::LoftModels(inputs[0], 1);
}

VTK_ABI_NAMESPACE_END
