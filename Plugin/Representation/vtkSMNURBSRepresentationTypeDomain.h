// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSMNURBSRepresentationTypeDomain
 * @brief The styles of a representation; for control lattices NURBS Solid is the default.
 *
 * Takes the place of the stock domain in the representations that know NURBS Solid, so that what
 * stock filters make of a lattice shows as a solid, too. Whether the input is a lattice is read
 * from its data information: structured grids with the field data of NURBSConversion.h.
 */
#ifndef vtkSMNURBSRepresentationTypeDomain_h
#define vtkSMNURBSRepresentationTypeDomain_h

#include "vtkNURBSRepresentationModule.h" // for the export macro
#include "vtkSMRepresentationTypeDomain.h"

class VTKNURBSREPRESENTATION_EXPORT vtkSMNURBSRepresentationTypeDomain
  : public vtkSMRepresentationTypeDomain
{
public:
  static vtkSMNURBSRepresentationTypeDomain* New();
  vtkTypeMacro(vtkSMNURBSRepresentationTypeDomain, vtkSMRepresentationTypeDomain)

  int SetDefaultValues(vtkSMProperty* property, bool useUnchecked) override;

protected:
  vtkSMNURBSRepresentationTypeDomain() = default;
  ~vtkSMNURBSRepresentationTypeDomain() override = default;

private:
  vtkSMNURBSRepresentationTypeDomain(const vtkSMNURBSRepresentationTypeDomain&) = delete;
  void operator=(const vtkSMNURBSRepresentationTypeDomain&) = delete;
};

#endif
