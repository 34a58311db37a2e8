// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMNURBSRepresentationTypeDomain.h"

#include "LatticeInformation.h"

#include "vtkObjectFactory.h"
#include "vtkSMPropertyHelper.h"

vtkStandardNewMacro(vtkSMNURBSRepresentationTypeDomain);

int vtkSMNURBSRepresentationTypeDomain::SetDefaultValues(vtkSMProperty* property, bool useUnchecked)
{
  unsigned int index = 0;
  if (!IsLattice(this->GetInputInformation()) || !this->IsInDomain("NURBS Solid", index))
  {
    return this->Superclass::SetDefaultValues(property, useUnchecked);
  }
  vtkSMPropertyHelper helper(property);
  helper.SetUseUnchecked(useUnchecked);
  helper.Set("NURBS Solid");
  return 1;
}
