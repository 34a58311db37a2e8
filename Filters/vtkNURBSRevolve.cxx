// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSRevolve.h"

#include "Modelling.h"

#include "vtkObjectFactory.h"

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSRevolve);

void vtkNURBSRevolve::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "AxisPoint: " << this->AxisPoint[0] << " " << this->AxisPoint[1] << " "
     << this->AxisPoint[2] << "\n";
  os << indent << "AxisDirection: " << this->AxisDirection[0] << " " << this->AxisDirection[1]
     << " " << this->AxisDirection[2] << "\n";
  os << indent << "Angle: " << this->Angle << "\n";
}

hyperpatch::MultiPatch vtkNURBSRevolve::MakeModel(const Inputs& inputs)
{
  const Eigen::Vector3d point(this->AxisPoint);
  const Eigen::Vector3d direction(this->AxisDirection);
  return hyperpatch::ForEachSection(inputs[0][0],
    [&](const hyperpatch::Aggregate& section)
    { return hyperpatch::Revolve(section, point, direction, this->Angle); });
}

VTK_ABI_NAMESPACE_END
