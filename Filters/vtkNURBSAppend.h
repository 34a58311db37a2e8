// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSAppend
 * @brief Several spline models as one.
 *
 * Input: any number of connections, see vtkNURBSAlgorithm. Output: vtkPartitionedDataSetCollection,
 * the control lattice, see NURBSConversion.h. Patches are numbered from 0 in the order of the
 * inputs. Interfaces and boundaries of the inputs come along, boundaries of one name become one;
 * further interfaces, between models too, are found by coincident faces.
 *
 * Attributes are matched by name; a model need not have those of another. The same name with other
 * numbers of components is an error.
 *
 * @sa vtkNURBSExtractPatches
 */
#ifndef vtkNURBSAppend_h
#define vtkNURBSAppend_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSAppend : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSAppend* New();
  vtkTypeMacro(vtkNURBSAppend, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Largest distance between control points of two faces that are one, as a fraction of the
   * diagonal of all control points' bounds, from 0 to less than 1. Default 1e-9.
   */
  vtkSetMacro(InterfaceTolerance, double);
  vtkGetMacro(InterfaceTolerance, double);
  ///@}

protected:
  vtkNURBSAppend() = default;
  ~vtkNURBSAppend() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  double FoundInterfaceTolerance() const override;
  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSAppend(const vtkNURBSAppend&) = delete;
  void operator=(const vtkNURBSAppend&) = delete;

  double InterfaceTolerance = 1e-9;
};

#endif
