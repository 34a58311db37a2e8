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
  if (style == "NURBS Solid" && this->GetUsingScalarColoring())
  {
    // Before the first rendering there is nothing drawn yet to take the range of.
    vtkSMViewProxy* view = vtkSMViewProxy::FindView(this);
    if (view && view->GetNeedsUpdate())
    {
      view->Update();
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
