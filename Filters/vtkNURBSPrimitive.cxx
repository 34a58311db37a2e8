// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSPrimitive.h"

#include "Primitives.h"

#include "vtkObjectFactory.h"

namespace
{

Eigen::Vector3d Vector(const double numbers[3])
{
  return { numbers[0], numbers[1], numbers[2] };
}

hyperpatch::MultiPatch Moved(hyperpatch::MultiPatch model, const Eigen::Vector3d& by)
{
  for (hyperpatch::Patch& patch : model.Patches)
  {
    const hyperpatch::Spline& g = patch.Body.Geometry();
    patch.Body = hyperpatch::Aggregate(
      hyperpatch::Spline(g.Knots(), g.Coefficients().colwise() + by, g.Weights()));
  }
  return model;
}

}

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSPrimitive);

vtkNURBSPrimitive::vtkNURBSPrimitive()
{
  this->SetNumberOfInputPorts(0);
}

void vtkNURBSPrimitive::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const char* shapes[] = { "Box", "Cylinder", "Tube", "Cone", "Sphere", "Spherical Shell", "Torus",
    "Wedge", "Helix" };
  os << indent << "Shape: " << shapes[this->Shape] << "\n";
  os << indent << "Parametrisation: " << (this->Parametrisation == POLES ? "Poles" : "Patches")
     << "\n";
  os << indent << "Lengths: " << this->Lengths[0] << " " << this->Lengths[1] << " "
     << this->Lengths[2] << "\n";
  os << indent << "Radius: " << this->Radius << "\n";
  os << indent << "InnerRadius: " << this->InnerRadius << "\n";
  os << indent << "TopRadius: " << this->TopRadius << "\n";
  os << indent << "Height: " << this->Height << "\n";
  os << indent << "MajorRadius: " << this->MajorRadius << "\n";
  os << indent << "Pitch: " << this->Pitch << "\n";
  os << indent << "Turns: " << this->Turns << "\n";
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "Center: " << this->Center[0] << " " << this->Center[1] << " " << this->Center[2]
     << "\n";
}

hyperpatch::MultiPatch vtkNURBSPrimitive::MakeModel(const Inputs&)
{
  const auto parametrisation = this->Parametrisation == POLES
    ? hyperpatch::Parametrisation::Poles
    : hyperpatch::Parametrisation::Patches;
  const auto make = [&]
  {
    switch (this->Shape)
    {
      case CYLINDER:
        return hyperpatch::MakeCylinder(this->Radius, this->Height, parametrisation);
      case TUBE:
        return hyperpatch::MakeTube(this->InnerRadius, this->Radius, this->Height);
      case CONE:
        return hyperpatch::MakeCone(this->Radius, this->TopRadius, this->Height, parametrisation);
      case SPHERE:
        return hyperpatch::MakeSphere(this->Radius, parametrisation);
      case SPHERICAL_SHELL:
        return hyperpatch::MakeSphericalShell(this->InnerRadius, this->Radius, parametrisation);
      case TORUS:
        return hyperpatch::MakeTorus(this->MajorRadius, this->Radius, parametrisation);
      case WEDGE:
        return hyperpatch::MakeWedge(Vector(this->Lengths), parametrisation);
      case HELIX:
        return hyperpatch::MakeHelix(this->MajorRadius, this->Radius, this->Pitch, this->Turns,
          this->Tolerance * (this->MajorRadius + this->Radius), parametrisation);
      default:
        return hyperpatch::MakeBox(Vector(this->Lengths));
    }
  };
  return Moved(make(), Vector(this->Center));
}

VTK_ABI_NAMESPACE_END
