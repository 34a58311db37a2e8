// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSExtrude
 * @brief Surfaces of curves, and volumes of surfaces, by moving them along a vector.
 *
 * Input: see vtkNURBSAlgorithm; curves and surfaces. Output: vtkPartitionedDataSetCollection, the
 * control lattice, see NURBSConversion.h: every curve gives a surface, every surface a volume. The
 * new direction is the last one, of degree 1 over [0, 1]; its first side is the input. The result
 * is exact. Attributes are carried, constant along the new direction (Martin and Cohen, 2001,
 * section 3): those in the basis of the geometry stay in it, others keep theirs.
 *
 * Bad input, that is volumes or a zero vector, is an error.
 *
 * @sa vtkNURBSSweep, vtkNURBSRevolve, vtkNURBSRule
 */
#ifndef vtkNURBSExtrude_h
#define vtkNURBSExtrude_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSExtrude : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSExtrude* New();
  vtkTypeMacro(vtkNURBSExtrude, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The way from the input to the opposite side. Default 0, 0, 1.
   */
  vtkSetVector3Macro(Vector, double);
  vtkGetVector3Macro(Vector, double);
  ///@}

protected:
  vtkNURBSExtrude() = default;
  ~vtkNURBSExtrude() override = default;

  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSExtrude(const vtkNURBSExtrude&) = delete;
  void operator=(const vtkNURBSExtrude&) = delete;

  double Vector[3] = { 0.0, 0.0, 1.0 };
};

#endif
