// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSCurveThroughPoints
 * @brief B-spline curves that interpolate polylines and their point data.
 *
 * Turns lines of any origin (a drawn polyline, a contour, a column of measurements) into curves for
 * the modelling filters. Every line of the input becomes a patch. It has as many control points as
 * the line has points, knots at the points (not-a-knot ends; averaged knots for even degrees) and
 * passes through all of them; all numeric point arrays are interpolated along with them. A closed
 * line, whose last point is the first one, gives a curve that is closed but not smooth there.
 *
 * Input: vtkPolyData with lines or polylines. Output: vtkPartitionedDataSetCollection, the control
 * lattice, see NURBSConversion.h; attributes have the names of the point arrays, and share the
 * basis of the geometry.
 *
 * Bad input is an error: consecutive points that coincide, unless Spacing is UNIFORM, and numbers
 * that are not finite, which the message names by line, array and point.
 *
 * References: The NURBS Book, sections 9.2.1 and 9.2.2.
 *
 * @sa vtkNURBSCurve, vtkNURBSLoft
 */
#ifndef vtkNURBSCurveThroughPoints_h
#define vtkNURBSCurveThroughPoints_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSCurveThroughPoints : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSCurveThroughPoints* New();
  vtkTypeMacro(vtkNURBSCurveThroughPoints, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The degree, at least 1; of short lines it is the number of points less 1. Default 3.
   */
  vtkSetMacro(Degree, int);
  vtkGetMacro(Degree, int);
  ///@}

  enum Spacings
  {
    CHORD_LENGTH = 0,
    CENTRIPETAL = 1,
    UNIFORM = 2
  };

  ///@{
  /**
   * How far apart the parameters of consecutive points are: by their distance (the default), by its
   * square root, or all equally.
   */
  vtkSetClampMacro(Spacing, int, CHORD_LENGTH, UNIFORM);
  vtkGetMacro(Spacing, int);
  ///@}

protected:
  vtkNURBSCurveThroughPoints() = default;
  ~vtkNURBSCurveThroughPoints() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  hyperpatch::MultiPatch ConvertInput(int port, vtkDataObject* input) override;
  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSCurveThroughPoints(const vtkNURBSCurveThroughPoints&) = delete;
  void operator=(const vtkNURBSCurveThroughPoints&) = delete;

  int Degree = 3;
  int Spacing = CHORD_LENGTH;
};

#endif
