// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSExtrude.h"

#include "Modelling.h"

#include "vtkObjectFactory.h"

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSExtrude);

void vtkNURBSExtrude::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Vector: " << this->Vector[0] << " " << this->Vector[1] << " " << this->Vector[2]
     << "\n";
}

hyperpatch::MultiPatch vtkNURBSExtrude::MakeModel(const Inputs& inputs)
{
  const Eigen::Vector3d vector(this->Vector);
  return hyperpatch::ForEachSection(inputs[0][0],
    [&vector](const hyperpatch::Aggregate& section)
    { return hyperpatch::Extrude(section, vector); });
}

VTK_ABI_NAMESPACE_END
