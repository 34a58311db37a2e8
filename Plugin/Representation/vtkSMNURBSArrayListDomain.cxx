// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSMNURBSArrayListDomain.h"

#include "LatticeInformation.h"

#include "vtkObjectFactory.h"

#include <string>

vtkStandardNewMacro(vtkSMNURBSArrayListDomain);

bool vtkSMNURBSArrayListDomain::IsFilteredArray(
  vtkPVDataInformation* information, int association, const char* name)
{
  return (name && std::string(name) == WeightName && IsLattice(information)) ||
    this->Superclass::IsFilteredArray(information, association, name);
}
