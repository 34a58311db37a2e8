// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMNURBSRepresentationProxy.h"

#include "vtkObjectFactory.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMViewProxy.h"

#include <string>

vtkStandardNewMacro(vtkSMNURBSRepresentationProxy);

vtkPVArrayInformation* vtkSMNURBSRepresentationProxy::GetArrayInformationForColorArray(
  bool checkRepresentedData)
{
  const std::string style = vtkSMPropertyHelper(this, "Representation").GetAsString();
  if (style.rfind("NURBS Solid", 0) == 0 && this->GetUsingScalarColoring())
  {
    // What is drawn may be out of date, or nothing yet. An update of the view asks for ranges
    // again.
    vtkSMViewProxy* view = vtkSMViewProxy::FindView(this);
    if (view && view->GetNeedsUpdate() && !this->UpdatingView)
    {
      this->UpdatingView = true;
      view->Update();
      this->UpdatingView = false;
    }
    const vtkSMPropertyHelper color(this, "ColorArrayName");
    vtkPVArrayInformation* drawn = this->GetRepresentedDataInformation()->GetArrayInformation(
      color.GetInputArrayNameToProcess(), color.GetInputArrayAssociation());
    if (drawn)
    {
      return drawn;
    }
  }
  return this->Superclass::GetArrayInformationForColorArray(checkRepresentedData);
}
