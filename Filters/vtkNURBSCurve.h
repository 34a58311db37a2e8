// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSCurve
 * @brief A B-spline or NURBS curve from its control points, with an attribute if wanted.
 *
 * The beginning of a pipeline of modelling filters: a profile to extrude or revolve, a path to
 * sweep along. The attribute is a second spline over the same parameter with a degree and
 * coefficients of its own (Martin and Cohen's aggregate curve); it is carried to whatever is made
 * of the curve, and an edit here is seen there.
 *
 * Both have clamped knots over [0, 1], equally spaced unless Knots are given. The curve begins and
 * ends at its first and last control point.
 *
 * Output: vtkPartitionedDataSetCollection, the control lattice, see NURBSConversion.h.
 *
 * Bad input is an error: fewer than two points, a degree of 0, weights that are not positive or not
 * as many as points, knots that do not fit.
 *
 * References: W. Martin and E. Cohen, Representation and extraction of volumetric attributes using
 * trivariate splines, 2001, section 3.
 *
 * @sa vtkNURBSCurveThroughPoints, vtkNURBSExtrude, vtkNURBSRevolve, vtkNURBSSweep
 */
#ifndef vtkNURBSCurve_h
#define vtkNURBSCurve_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

#include <array>  // for points
#include <string> // for the name of the attribute
#include <vector> // for points and numbers

class VTKNURBSFILTERS_EXPORT vtkNURBSCurve : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSCurve* New();
  vtkTypeMacro(vtkNURBSCurve, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The control points. Default: four, in an S from (1, 0, 0) to (1, 2, 0). Indices beyond their
   * number are ignored, here and below.
   */
  void SetNumberOfPoints(int number);
  int GetNumberOfPoints() { return static_cast<int>(this->Points.size()); }
  void SetPoint(int index, double x, double y, double z);
  ///@}

  ///@{
  /**
   * The degree, at least 1; with few points it is their number less 1. Default 3.
   */
  vtkSetMacro(Degree, int);
  vtkGetMacro(Degree, int);
  ///@}

  ///@{
  /**
   * The weights of a rational curve, one per point and positive. Default none: a polynomial curve.
   */
  void SetNumberOfWeights(int number) { this->Resize(this->Weights, number); }
  int GetNumberOfWeights() { return static_cast<int>(this->Weights.size()); }
  void SetWeight(int index, double weight) { this->SetNumber(this->Weights, index, weight); }
  ///@}

  ///@{
  /**
   * The knots, as many as points and degree plus one, not decreasing. Default none: clamped and
   * equally spaced over [0, 1].
   */
  void SetNumberOfKnots(int number) { this->Resize(this->Knots, number); }
  int GetNumberOfKnots() { return static_cast<int>(this->Knots.size()); }
  void SetKnot(int index, double knot) { this->SetNumber(this->Knots, index, knot); }
  ///@}

  ///@{
  /**
   * The name of the attribute. Default empty: no attribute.
   */
  vtkSetStdStringFromCharMacro(AttributeName);
  vtkGetCharFromStdStringMacro(AttributeName);
  ///@}

  ///@{
  /**
   * The coefficients of the attribute, equally spaced along the parameter. Default 0, 1.
   */
  void SetNumberOfAttributeValues(int number) { this->Resize(this->AttributeValues, number); }
  int GetNumberOfAttributeValues() { return static_cast<int>(this->AttributeValues.size()); }
  void SetAttributeValue(int index, double value)
  {
    this->SetNumber(this->AttributeValues, index, value);
  }
  ///@}

  ///@{
  /**
   * The degree of the attribute, at least 1; with few values it is their number less 1. Default 3.
   */
  vtkSetMacro(AttributeDegree, int);
  vtkGetMacro(AttributeDegree, int);
  ///@}

protected:
  vtkNURBSCurve();
  ~vtkNURBSCurve() override = default;

  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSCurve(const vtkNURBSCurve&) = delete;
  void operator=(const vtkNURBSCurve&) = delete;

  void Resize(std::vector<double>& numbers, int number);
  void SetNumber(std::vector<double>& numbers, int index, double value);

  std::vector<std::array<double, 3>> Points = { { 1.0, 0.0, 0.0 }, { 2.0, 0.5, 0.0 },
    { 0.25, 1.0, 0.0 }, { 1.0, 2.0, 0.0 } };
  int Degree = 3;
  std::vector<double> Weights;
  std::vector<double> Knots;
  std::string AttributeName;
  std::vector<double> AttributeValues = { 0.0, 1.0 };
  int AttributeDegree = 3;
};

#endif
