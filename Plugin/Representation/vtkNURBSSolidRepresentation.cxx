// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSSolidRepresentation.h"

#include "vtkNURBSGeometryFilter.h"
#include "vtkNURBSTessellate.h"

#include "vtkActor.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkCompositeDataDisplayAttributes.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkCompositePolyDataMapper2.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkPVLODActor.h"
#include "vtkPVRenderView.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"

#include <string>

namespace
{

/// The knot lines travel to the rendering processes as a piece of their own.
constexpr int KnotLinePort = 1;

/// Whether what is drawn is a solid: it has lost the ids by which selections find the input.
bool IsSolid(vtkDataObject* drawn)
{
  auto composite = vtkCompositeDataSet::SafeDownCast(drawn);
  if (!composite)
  {
    return false;
  }
  vtkSmartPointer<vtkCompositeDataIterator> it;
  it.TakeReference(composite->NewIterator());
  for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem())
  {
    auto mesh = vtkPolyData::SafeDownCast(it->GetCurrentDataObject());
    if (mesh && mesh->GetNumberOfCells() > 0)
    {
      return !mesh->GetCellData()->HasArray("vtkOriginalCellIds");
    }
  }
  return false;
}

}

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

  this->KnotLineMapper->ScalarVisibilityOff();
  // Lines lie in the triangles, and seen at a slant they sink between them: this is what it takes
  // to draw them whole, 0.15 percent of the depth of the view.
  this->KnotLineMapper->SetRelativeCoincidentTopologyLineOffsetParameters(-4.0, -100.0);
  this->KnotLines->SetMapper(this->KnotLineMapper);
  this->KnotLines->GetProperty()->LightingOff();
  this->KnotLines->PickableOff();
  this->KnotLines->VisibilityOff();
}

vtkNURBSSolidRepresentation::~vtkNURBSSolidRepresentation() = default;

void vtkNURBSSolidRepresentation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "GeometryFilter:\n";
  this->GeometryFilter->PrintSelf(os, indent.GetNextIndent());
}

vtkNURBSGeometryFilter* vtkNURBSSolidRepresentation::GetFilter()
{
  return static_cast<vtkNURBSGeometryFilter*>(this->GeometryFilter);
}

void vtkNURBSSolidRepresentation::SetTolerance(double tolerance)
{
  this->GetFilter()->GetTessellation()->SetTolerance(tolerance);
  this->MarkModified();
}

double vtkNURBSSolidRepresentation::GetTolerance()
{
  return this->GetFilter()->GetTessellation()->GetTolerance();
}

void vtkNURBSSolidRepresentation::SetAttributeTolerance(double tolerance)
{
  this->GetFilter()->GetTessellation()->SetAttributeTolerance(tolerance);
  this->MarkModified();
}

double vtkNURBSSolidRepresentation::GetAttributeTolerance()
{
  return this->GetFilter()->GetTessellation()->GetAttributeTolerance();
}

void vtkNURBSSolidRepresentation::SetNormalArray(const char* name)
{
  const std::string chosen = name ? name : "";
  this->Superclass::SetNormalArray(chosen.empty() || chosen == "None" ? "Normals" : name);
}

void vtkNURBSSolidRepresentation::SetRepresentation(const char* type)
{
  this->Superclass::SetRepresentation(type);
  const bool lines = this->Representation == SURFACE_WITH_EDGES;
  vtkNURBSTessellate* tessellation = this->GetFilter()->GetTessellation();
  if (tessellation->GetKnotLines() != lines)
  {
    tessellation->SetKnotLines(lines);
    this->MarkModified();
  }
}

void vtkNURBSSolidRepresentation::SetVisibility(bool visible)
{
  this->Superclass::SetVisibility(visible);
  if (!visible)
  {
    this->KnotLines->VisibilityOff();
  }
}

void vtkNURBSSolidRepresentation::SetPickable(int pickable)
{
  this->Pickable = pickable != 0;
}

int vtkNURBSSolidRepresentation::ProcessViewRequest(
  vtkInformationRequestKey* request, vtkInformation* inInfo, vtkInformation* outInfo)
{
  if (!this->Superclass::ProcessViewRequest(request, inInfo, outInfo))
  {
    return 0;
  }
  if (request == vtkPVView::REQUEST_UPDATE())
  {
    vtkPVView::SetPiece(inInfo, this, this->GetFilter()->GetKnotLines(), 0, KnotLinePort);
  }
  else if (request == vtkPVView::REQUEST_RENDER())
  {
    this->KnotLineMapper->SetInputDataObject(
      vtkPVView::GetDeliveredPiece(inInfo, this, KnotLinePort));
    this->UpdateKnotLines();
  }
  return 1;
}

bool vtkNURBSSolidRepresentation::AddToView(vtkView* view)
{
  if (auto render = vtkPVRenderView::SafeDownCast(view))
  {
    render->GetRenderer()->AddActor(this->KnotLines);
  }
  return this->Superclass::AddToView(view);
}

bool vtkNURBSSolidRepresentation::RemoveFromView(vtkView* view)
{
  if (auto render = vtkPVRenderView::SafeDownCast(view))
  {
    render->GetRenderer()->RemoveActor(this->KnotLines);
  }
  return this->Superclass::RemoveFromView(view);
}

void vtkNURBSSolidRepresentation::UpdateColoringParameters()
{
  this->Superclass::UpdateColoringParameters();
  const bool solid = IsSolid(this->Mapper->GetInputDataObject(0, 0));
  this->Actor->SetPickable(this->Pickable && !solid);
  if (solid)
  {
    this->Property->EdgeVisibilityOff();
  }
}

void vtkNURBSSolidRepresentation::UpdateKnotLines()
{
  // The user may have hidden the block of the solid.
  vtkDataObject* drawn = this->Mapper->GetInputDataObject(0, 0);
  auto attributes =
    static_cast<vtkCompositePolyDataMapper2*>(this->Mapper)->GetCompositeDataDisplayAttributes();
  double bounds[6];
  const bool visible = this->Representation == SURFACE_WITH_EDGES && IsSolid(drawn) &&
    vtkGeometryRepresentation::GetBounds(drawn, bounds, attributes);
  this->KnotLines->SetVisibility(visible);
  if (visible)
  {
    vtkProperty* property = this->KnotLines->GetProperty();
    property->SetColor(this->Property->GetEdgeColor());
    property->SetLineWidth(this->Property->GetLineWidth());
    property->SetRenderLinesAsTubes(this->Property->GetRenderLinesAsTubes());
    property->SetOpacity(this->Property->GetOpacity());
    vtkNew<vtkMatrix4x4> placed;
    this->Actor->GetMatrix(placed);
    this->KnotLines->SetUserMatrix(placed);
  }
}
