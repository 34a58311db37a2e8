// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSSolidRepresentation.h"

#include "vtkNURBSGeometryFilter.h"
#include "vtkNURBSTessellate.h"

#include "vtkCommand.h"
#include "vtkObjectFactory.h"

#include <string>

vtkStandardNewMacro(vtkNURBSSolidRepresentation);

vtkNURBSSolidRepresentation::vtkNURBSSolidRepresentation()
{
  this->GeometryFilter->Delete();
  this->GeometryFilter = vtkNURBSGeometryFilter::New();
  // The superclass watches the filter that it made itself.
  this->GeometryFilter->AddObserver(vtkCommand::ProgressEvent,
    static_cast<vtkGeometryRepresentation*>(this),
    &vtkNURBSSolidRepresentation::HandleGeometryRepresentationProgress);
  this->SetupDefaults();
}

void vtkNURBSSolidRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "GeometryFilter:\n";
  this->GeometryFilter->PrintSelf(os, indent.GetNextIndent());
}

vtkNURBSTessellate* vtkNURBSSolidRepresentation::GetTessellation()
{
  return static_cast<vtkNURBSGeometryFilter*>(this->GeometryFilter)->GetTessellation();
}

void vtkNURBSSolidRepresentation::SetTolerance(double tolerance)
{
  this->GetTessellation()->SetTolerance(tolerance);
  this->MarkModified();
}

double vtkNURBSSolidRepresentation::GetTolerance()
{
  return this->GetTessellation()->GetTolerance();
}

void vtkNURBSSolidRepresentation::SetAttributeTolerance(double tolerance)
{
  this->GetTessellation()->SetAttributeTolerance(tolerance);
  this->MarkModified();
}

double vtkNURBSSolidRepresentation::GetAttributeTolerance()
{
  return this->GetTessellation()->GetAttributeTolerance();
}

void vtkNURBSSolidRepresentation::SetNormalArray(const char* name)
{
  const std::string chosen = name ? name : "";
  this->Superclass::SetNormalArray(chosen.empty() || chosen == "None" ? "Normals" : name);
}
