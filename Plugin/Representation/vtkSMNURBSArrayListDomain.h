// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSMNURBSArrayListDomain
 * @brief The arrays that a representation can colour by, without the weights of control lattices.
 *
 * Takes the place of the stock domain of the colour array. Weights belong to the form of a lattice;
 * the solid has none. Arrays of the same name on other data stay.
 */
#ifndef vtkSMNURBSArrayListDomain_h
#define vtkSMNURBSArrayListDomain_h

#include "vtkNURBSRepresentationModule.h" // for the export macro
#include "vtkSMRepresentedArrayListDomain.h"

class VTKNURBSREPRESENTATION_EXPORT vtkSMNURBSArrayListDomain
  : public vtkSMRepresentedArrayListDomain
{
public:
  static vtkSMNURBSArrayListDomain* New();
  vtkTypeMacro(vtkSMNURBSArrayListDomain, vtkSMRepresentedArrayListDomain)

protected:
  vtkSMNURBSArrayListDomain() = default;
  ~vtkSMNURBSArrayListDomain() override = default;

  bool IsFilteredArray(
    vtkPVDataInformation* information, int association, const char* name) override;

private:
  vtkSMNURBSArrayListDomain(const vtkSMNURBSArrayListDomain&) = delete;
  void operator=(const vtkSMNURBSArrayListDomain&) = delete;
};

#endif
