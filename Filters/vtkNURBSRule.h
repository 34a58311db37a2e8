// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSRule
 * @brief Surfaces between two curves, and volumes between two surfaces, along straight lines.
 *
 * Input: two connections, see vtkNURBSAlgorithm, whose patches correspond in their order; or one
 * with two patches. Output: vtkPartitionedDataSetCollection, the control lattice, see
 * NURBSConversion.h. Points of equal parameters (scaled to one domain) are joined by lines. The new
 * direction is the last one, of degree 1 over [0, 1].
 *
 * Sections of other degrees, knots, weights and domains are elevated and refined to one basis
 * first, which does not change them. Attributes are ruled between the corresponding ones of the
 * two sections (Martin and Cohen, 2001, section 3).
 *
 * Bad input is an error: another number of sections than two, curves with surfaces, volumes,
 * sections that coincide, attributes that only one section has. Where lines cross, the sections run
 * in opposite ways: reverse one with vtkNURBSRefine.
 *
 * @sa vtkNURBSLoft, vtkNURBSExtrude
 */
#ifndef vtkNURBSRule_h
#define vtkNURBSRule_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSRule : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSRule* New();
  vtkTypeMacro(vtkNURBSRule, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkNURBSRule() = default;
  ~vtkNURBSRule() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSRule(const vtkNURBSRule&) = delete;
  void operator=(const vtkNURBSRule&) = delete;
};

#endif
