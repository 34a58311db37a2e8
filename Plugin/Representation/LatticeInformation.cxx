// SPDX-License-Identifier: BSD-3-Clause
#include "LatticeInformation.h"

#include "vtkDataObject.h"
#include "vtkPVDataInformation.h"
#include "vtkType.h"

bool IsLattice(vtkPVDataInformation* information)
{
  return information && information->HasDataSetType(VTK_STRUCTURED_GRID) &&
    information->GetArrayInformation("SplineLayout", vtkDataObject::FIELD);
}
