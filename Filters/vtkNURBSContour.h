// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSContour
 * @brief Isosurfaces of an attribute of exact spline volumes.
 *
 * What vtkContourFilter does with cells, done with the splines themselves: every point lies on the
 * isosurface of the exact attribute (to round-off) in the exact geometry, whatever their bases.
 *
 * Input: see vtkNURBSAlgorithm. The attribute is chosen with
 * SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name). Patches without
 * it are left out; if no patch has it, that is an error which names those there are.
 *
 * Output: see vtkNURBSZeroSetAlgorithm; cell data `ContourIndex` is the index of the value.
 *
 * @sa vtkNURBSSlice, vtkNURBSTessellate
 */
#ifndef vtkNURBSContour_h
#define vtkNURBSContour_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSZeroSetAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSContour : public vtkNURBSZeroSetAlgorithm
{
public:
  static vtkNURBSContour* New();
  vtkTypeMacro(vtkNURBSContour, vtkNURBSZeroSetAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The component of the attribute, from 0; -1 is the magnitude. Default 0.
   */
  vtkSetMacro(Component, int);
  vtkGetMacro(Component, int);
  ///@}

  ///@{
  /**
   * The isovalues. At first there is none.
   */
  void SetNumberOfContours(int number);
  int GetNumberOfContours() { return static_cast<int>(this->Values.size()); }
  void SetValue(int i, double value);
  double GetValue(int i);
  ///@}

protected:
  vtkNURBSContour();
  ~vtkNURBSContour() override;

  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;

private:
  vtkNURBSContour(const vtkNURBSContour&) = delete;
  void operator=(const vtkNURBSContour&) = delete;

  int Component = 0;
  std::vector<double> Values;
};

#endif
