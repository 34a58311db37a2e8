// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSSweep.h"

#include "Error.h"
#include "Modelling.h"
#include "Motions.h"

#include "vtkObjectFactory.h"

#include <string>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSSweep);

vtkNURBSSweep::vtkNURBSSweep()
{
  this->SetNumberOfInputPorts(2);
}

void vtkNURBSSweep::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Orientation: " << (this->Orientation == FIXED ? "Fixed" : "Follow Path") << "\n";
  os << indent << "Twist: " << this->Twist << "\n";
  os << indent << "Sections: " << this->Sections << "\n";
}

hyperpatch::MultiPatch vtkNURBSSweep::MakeModel(const Inputs& inputs)
{
  const hyperpatch::MultiPatch& path = inputs[1][0];
  if (path.Patches.size() != 1)
  {
    throw hyperpatch::Error("the path has " + std::to_string(path.Patches.size()) +
      " patches: give one curve, as NURBS Curve does");
  }
  const hyperpatch::Spline& curve = path.Patches[0].Body.Geometry();
  const hyperpatch::Spline motion = this->Orientation == FIXED
    ? hyperpatch::Translation(curve)
    : hyperpatch::FollowPath(curve, this->Twist, this->Sections);
  return hyperpatch::ForEachSection(inputs[0][0],
    [&motion](const hyperpatch::Aggregate& section) { return hyperpatch::Sweep(section, motion); });
}

VTK_ABI_NAMESPACE_END
