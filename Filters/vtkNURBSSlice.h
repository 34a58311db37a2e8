// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSSlice
 * @brief Cuts exact spline volumes with a plane or another implicit function.
 *
 * What vtkCutter does with cells, done with the splines themselves: every point of the output lies
 * on the plane (to 1e-12 of the model's size) and on the spline, and carries the exact values of
 * all attributes there.
 *
 * Input: see vtkNURBSAlgorithm. Output: see vtkNURBSZeroSetAlgorithm; cell data `SliceIndex` is the
 * index of the offset value.
 *
 * Planes, spheres, cylinders and quadrics (also transformed by an affine transform) are exact
 * polynomials, with certified exclusion. A vtkBox is six planes, each trimmed where it leaves the
 * box: along the edges of the box two of them share their points. Any other function, and a box at
 * a positive offset, which is round at its edges, is sampled in every cell, and all cells count as
 * undecided.
 *
 * @code{.cpp}
 * vtkNew<vtkBSplineReader> reader;
 * reader->SetFileName("solid.xml");
 * vtkNew<vtkPlane> plane;
 * vtkNew<vtkNURBSSlice> slice;
 * slice->SetInputConnection(reader->GetOutputPort());
 * slice->SetSliceFunction(plane);
 * slice->Update();
 * @endcode
 *
 * @sa vtkNURBSContour, vtkNURBSTessellate
 */
#ifndef vtkNURBSSlice_h
#define vtkNURBSSlice_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSLevelSetAlgorithm.h"
#include "vtkSmartPointer.h" // for the function

class vtkImplicitFunction;

class VTKNURBSFILTERS_EXPORT vtkNURBSSlice : public vtkNURBSLevelSetAlgorithm
{
public:
  static vtkNURBSSlice* New();
  vtkTypeMacro(vtkNURBSSlice, vtkNURBSLevelSetAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Also that of the function.
  vtkMTimeType GetMTime() override;

  ///@{
  /**
   * The function whose level sets are drawn. There is none at first, which is an error.
   */
  void SetSliceFunction(vtkImplicitFunction* function);
  vtkImplicitFunction* GetSliceFunction();
  ///@}

  ///@{
  /**
   * Values of the function to draw; for a plane with a unit normal, distances from it. At first
   * one, 0.
   */
  void SetNumberOfOffsetValues(int number) { this->SetNumberOfLevels(number); }
  int GetNumberOfOffsetValues() { return this->GetNumberOfLevels(); }
  void SetOffsetValue(int i, double value) { this->SetLevel(i, value); }
  double GetOffsetValue(int i) { return this->GetLevel(i); }
  ///@}

protected:
  vtkNURBSSlice();
  ~vtkNURBSSlice() override;

  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;
  void Change(
    const std::vector<Task>& tasks, std::vector<hyperpatch::ZeroSetMesh>& surfaces) override;

private:
  vtkNURBSSlice(const vtkNURBSSlice&) = delete;
  void operator=(const vtkNURBSSlice&) = delete;

  vtkSmartPointer<vtkImplicitFunction> SliceFunction;
};

#endif
