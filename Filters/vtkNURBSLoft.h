// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSLoft
 * @brief Surfaces through curves, and volumes through surfaces.
 *
 * Input: any number of connections, see vtkNURBSAlgorithm; curves or surfaces. The i-th patches of
 * all inputs are the sections of one result, in the order of the connections; the patches of a
 * single input are the sections of one. Output: vtkPartitionedDataSetCollection, the control
 * lattice, see NURBSConversion.h. The new direction is the last one, over [0, 1].
 *
 * The sections may have other degrees, knots, weights and domains: they are elevated and refined to
 * one basis first, which does not change them. The result passes through all of them, at parameters
 * that follow their distances; rational sections are interpolated in homogeneous coordinates.
 * Attributes are interpolated in the same way (Martin and Cohen, 2001, section 3), each in the
 * common basis of its sections.
 *
 * Bad input is an error: fewer than two sections, curves with surfaces, volumes, sections that
 * coincide, attributes that not all sections have.
 *
 * References: The NURBS Book, section 10.3 (skinning).
 *
 * @sa vtkNURBSRule, vtkNURBSSweep
 */
#ifndef vtkNURBSLoft_h
#define vtkNURBSLoft_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSLoft : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSLoft* New();
  vtkTypeMacro(vtkNURBSLoft, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The degree across the sections, at least 1; with few sections it is their number less 1.
   * Default 3.
   */
  vtkSetMacro(Degree, int);
  vtkGetMacro(Degree, int);
  ///@}

protected:
  vtkNURBSLoft() = default;
  ~vtkNURBSLoft() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSLoft(const vtkNURBSLoft&) = delete;
  void operator=(const vtkNURBSLoft&) = delete;

  int Degree = 3;
};

#endif
