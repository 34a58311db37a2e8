// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSAddAttribute
 * @brief A new attribute of a spline model: a formula, samples of another data set, or a lattice.
 *
 * The attribute gets a basis of its own over the parameter domain of the geometry, or the one of
 * the geometry, and takes the place of an attribute that has its name. Formulas and samples are
 * interpolated at the Greville points of the basis (Martin & Cohen 2001, section 3.4): as many
 * points as there are control points, mapped through the geometry.
 *
 * Input 0: see vtkNURBSAlgorithm. Input 1 (optional): the data to sample, or the lattice.
 *
 * Output 0: vtkPartitionedDataSetCollection, the model with the attribute, see NURBSConversion.h.
 * Weights are not used by the new attribute: with the knots of a rational geometry it is polynomial
 * and a dataset of its own.
 *
 * Output 1: vtkTable, one row per patch with the columns of vtkNURBSFit (empty on processes other
 * than the first; no rows for lattices). Errors are measured between the Greville points, at the
 * middles of their boxes, where they are about the largest.
 *
 * References: Martin & Cohen, Representation and extraction of volumetric attributes using
 * trivariate splines, 2001.
 *
 * @sa vtkNURBSFit
 */
#ifndef vtkNURBSAddAttribute_h
#define vtkNURBSAddAttribute_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"
#include "vtkSmartPointer.h" // for the second input

#include <string> // for names and the expression

class VTKNURBSFILTERS_EXPORT vtkNURBSAddAttribute : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSAddAttribute* New();
  vtkTypeMacro(vtkNURBSAddAttribute, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The name of the attribute. Default `Attribute`.
   */
  vtkSetMacro(AttributeName, std::string);
  vtkGetMacro(AttributeName, std::string);
  ///@}

  enum AttributeFromType
  {
    EXPRESSION = 0,
    DATA_SET = 1, ///< the second input, sampled as vtkProbeFilter does
    LATTICE = 2   ///< the second input, an array of which holds the coefficients
  };

  ///@{
  /**
   * What gives the values. Default EXPRESSION.
   */
  vtkSetClampMacro(AttributeFrom, int, EXPRESSION, LATTICE);
  vtkGetMacro(AttributeFrom, int);
  ///@}

  ///@{
  /**
   * A formula in the syntax of vtkExprTkFunctionParser, a number or a vector of three. Variables
   * are the position x, y, z, also as the vector coords, and the parameters u, v, w. Default `x`.
   */
  vtkSetMacro(Expression, std::string);
  vtkGetMacro(Expression, std::string);
  ///@}

  ///@{
  /**
   * The point array of the second input. Default: empty, its only numeric one.
   */
  vtkSetMacro(PointArray, std::string);
  vtkGetMacro(PointArray, std::string);
  ///@}

  enum BasisType
  {
    GEOMETRY = 0,
    UNIFORM = 1
  };

  ///@{
  /**
   * Degrees and knots: those of the geometry (clamped, if they are not), or Degree and equal spans.
   * A lattice that is a spline model itself keeps its own. Default GEOMETRY.
   */
  vtkSetClampMacro(Basis, int, GEOMETRY, UNIFORM);
  vtkGetMacro(Basis, int);
  ///@}

  ///@{
  /**
   * Degree per direction of a UNIFORM basis, 1 to 31. Default 3.
   */
  vtkSetVector3Macro(Degree, int);
  vtkGetVector3Macro(Degree, int);
  ///@}

  ///@{
  /**
   * Control points per direction of a UNIFORM basis; a lattice has its own. Default 16.
   */
  vtkSetVector3Macro(ControlPoints, int);
  vtkGetVector3Macro(ControlPoints, int);
  ///@}

  enum MissingSamplesType
  {
    REFUSE = 0,
    LEAVE_OUT = 1
  };

  ///@{
  /**
   * What becomes of Greville points outside the second input, and of values that are not finite: an
   * error, or they are filled from their neighbours. Default REFUSE.
   */
  vtkSetClampMacro(MissingSamples, int, REFUSE, LEAVE_OUT);
  vtkGetMacro(MissingSamples, int);
  ///@}

protected:
  vtkNURBSAddAttribute();
  ~vtkNURBSAddAttribute() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  hyperpatch::MultiPatch ConvertInput(int port, vtkDataObject* input) override;
  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSAddAttribute(const vtkNURBSAddAttribute&) = delete;
  void operator=(const vtkNURBSAddAttribute&) = delete;

  class Maker;

  std::string AttributeName = "Attribute";
  int AttributeFrom = EXPRESSION;
  std::string Expression = "x";
  std::string PointArray;
  int Basis = GEOMETRY;
  int Degree[3] = { 3, 3, 3 };
  int ControlPoints[3] = { 16, 16, 16 };
  int MissingSamples = REFUSE;
  /// The second input, from HasWork() to MakeModel().
  vtkSmartPointer<vtkDataObject> Source;
};

#endif
