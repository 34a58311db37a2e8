// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkSMNURBSRepresentationProxy
 * @brief Colours NURBS Solid by the range of the values drawn, not by that of the coefficients.
 *
 * ParaView takes the range of a colour map from a representation's input. The input of NURBS Solid
 * is a control lattice, whose coefficients reach beyond the values of the attribute on the solid.
 * This proxy gives the range of the surface that is drawn, and updates the view for it if need be.
 */
#ifndef vtkSMNURBSRepresentationProxy_h
#define vtkSMNURBSRepresentationProxy_h

#include "vtkNURBSRepresentationModule.h" // for the export macro
#include "vtkSMPVRepresentationProxy.h"

class VTKNURBSREPRESENTATION_EXPORT vtkSMNURBSRepresentationProxy
  : public vtkSMPVRepresentationProxy
{
public:
  static vtkSMNURBSRepresentationProxy* New();
  vtkTypeMacro(vtkSMNURBSRepresentationProxy, vtkSMPVRepresentationProxy)

  vtkPVArrayInformation* GetArrayInformationForColorArray(
    bool checkRepresentedData = true) override;

protected:
  vtkSMNURBSRepresentationProxy() = default;
  ~vtkSMNURBSRepresentationProxy() override = default;

private:
  vtkSMNURBSRepresentationProxy(const vtkSMNURBSRepresentationProxy&) = delete;
  void operator=(const vtkSMNURBSRepresentationProxy&) = delete;

  bool UpdatingView = false;
};

#endif
