// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSContour
 * @brief Isosurfaces of an attribute, a coordinate, a parameter or det J of exact spline volumes.
 *
 * What vtkContourFilter does with cells, done with the splines themselves: every point lies on the
 * isosurface of the exact attribute (to round-off) in the exact geometry, whatever their bases.
 * Isosurfaces of a parametric coordinate are iso-parametric surfaces, those of the Jacobian
 * determinant show where the parametrisation is dense.
 *
 * Input: see vtkNURBSAlgorithm. An attribute is chosen with
 * SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name). Patches without
 * it are left out; if no patch has it, that is an error which names those there are. Patches that
 * do not extend in the chosen parametric direction, or have no Jacobian determinant, are left out.
 *
 * Output: see vtkNURBSZeroSetAlgorithm; cell data `ContourIndex` is the index of the value. The
 * Attribute Tolerance of a scalar attribute that is contoured does not apply: it is constant.
 *
 * @sa vtkNURBSSlice, vtkNURBSTessellate
 */
#ifndef vtkNURBSContour_h
#define vtkNURBSContour_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSLevelSetAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSContour : public vtkNURBSLevelSetAlgorithm
{
public:
  static vtkNURBSContour* New();
  vtkTypeMacro(vtkNURBSContour, vtkNURBSLevelSetAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum ContourOfTypes
  {
    ATTRIBUTE = 0,
    COORDINATES = 1,
    PARAMETRIC_COORDINATES = 2,
    JACOBIAN_DETERMINANT = 3
  };

  ///@{
  /**
   * What is contoured: an attribute (the default), a coordinate, a parametric coordinate (in the
   * patch's own knots), or the determinant of the derivatives of the coordinates by the parameters.
   */
  vtkSetClampMacro(ContourOf, int, ATTRIBUTE, JACOBIAN_DETERMINANT);
  vtkGetMacro(ContourOf, int);
  ///@}

  ///@{
  /**
   * The component of the attribute or coordinates, from 0; -1 is the magnitude, which parametric
   * coordinates do not have. Default 0.
   */
  vtkSetMacro(Component, int);
  vtkGetMacro(Component, int);
  ///@}

  ///@{
  /**
   * The isovalues. At first there is none.
   */
  void SetNumberOfContours(int number) { this->SetNumberOfLevels(number); }
  int GetNumberOfContours() { return this->GetNumberOfLevels(); }
  void SetValue(int i, double value) { this->SetLevel(i, value); }
  double GetValue(int i) { return this->GetLevel(i); }
  ///@}

protected:
  vtkNURBSContour();
  ~vtkNURBSContour() override;

  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;

private:
  vtkNURBSContour(const vtkNURBSContour&) = delete;
  void operator=(const vtkNURBSContour&) = delete;

  int ContourOf = ATTRIBUTE;
  int Component = 0;
};

#endif
