// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSFit
 * @brief Splines through, or close to, the points and values of a data set.
 *
 * Makes a spline model of sampled data, for the exact filters, for compression and for smoothing.
 *
 * Input: vtkImageData or vtkRectilinearGrid, whose geometry is taken over exactly, as one box of
 * degree 1; vtkStructuredGrid, whose points are fitted as its point arrays are; any other
 * vtkPointSet, as scattered data; or a composite of these, one patch for each leaf. Control
 * lattices are refused.
 *
 * The parameters of samples are the indices of an image, the coordinates of a rectilinear grid, and
 * see SampleParameters for a structured one. A direction with one point is not there.
 *
 * Output 0: vtkPartitionedDataSetCollection, the control lattices, see NURBSConversion.h. Fits that
 * have the knots of the geometry share its lattice, others are datasets of their own. Faces that
 * coincide, of a closed grid or of neighbouring blocks, are interfaces.
 *
 * Output 1: vtkTable, one row for every fit (empty on processes other than the first). The same
 * columns are field data of output 0.
 * - `Attribute` (string; `Points` for a geometry), `PatchId`, `Components`, `Samples`,
 *   `ControlPoints` (integers): what was fitted, with how many control points
 * - `RMSError`, `MaximumError`: distances at the samples (Euclidean over the components) in units
 *   of the data; `RelativeRMSError`, `RelativeError`: the same over the range of the data (the norm
 *   of the ranges of the components); `WorstPoint`: the point with the maximum
 * - `JacobianLower`, `JacobianUpper`: of a fitted volume, certified bounds of the least det J, with
 *   respect to its parameters; `InvalidElements`, `UndecidedElements`: the numbers of elements
 *   (knot spans) where det J certainly changes its sign, and where that was not decided (see
 *   vtkNURBSValidity). NaN and -1 for others.
 *
 * Missing samples, those that are not finite, are refused by default: the message names array and
 * point. Left out, they are filled from their neighbours for interpolation and target errors, and
 * have no influence on least squares to ControlPoints and on scattered data.
 *
 * In a parallel run every process fits the whole data, and gives its part of the result. Data that
 * only one process reads are sent to the others; data that are divided whatever is asked for (as
 * the PLOT3D reader does) are an error.
 *
 * Cost: gridded methods are linear in the number of samples. While an array is fitted there is one
 * copy of it in doubles (two with target errors); the output has the control points in doubles and,
 * where they have a lattice of their own, its points, as a rule in floats.
 *
 * References: C. de Boor, A Practical Guide to Splines; P. Eilers & B. Marx, Flexible smoothing
 * with B-splines and penalties, 1996; S. Lee, G. Wolberg & S. Shin, Scattered data interpolation
 * with multilevel B-splines, 1997.
 *
 * @code
 * vtkNew<vtkNURBSFit> fit;
 * fit->SetInputConnection(image->GetOutputPort());
 * fit->SetMethodToLeastSquares();
 * fit->SetControlPoints(20, 20, 20);
 * contour->SetInputConnection(fit->GetOutputPort());
 * @endcode
 *
 * @sa vtkNURBSAddAttribute, vtkNURBSContour
 */
#ifndef vtkNURBSFit_h
#define vtkNURBSFit_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"
#include "vtkSmartPointer.h" // for the input

#include <memory> // for the report
#include <set>    // for the names of arrays
#include <string> // for the names of arrays

class FitReport;

class VTKNURBSFILTERS_EXPORT vtkNURBSFit : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSFit* New();
  vtkTypeMacro(vtkNURBSFit, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum MethodType
  {
    INTERPOLATE = 0,            ///< one control point per sample, through every sample
    LEAST_SQUARES = 1,          ///< fewer control points than samples, or some smoothing
    DATA_AS_CONTROL_POINTS = 2, ///< the samples become the control points (smooths, approximates)
    SCATTERED_DATA = 3          ///< multilevel B-spline approximation, whatever the arrangement
  };

  ///@{
  /**
   * How the spline is found. Point sets that are no grids are always fitted as scattered data.
   * Default INTERPOLATE.
   */
  vtkSetClampMacro(Method, int, INTERPOLATE, SCATTERED_DATA);
  vtkGetMacro(Method, int);
  void SetMethodToInterpolate() { this->SetMethod(INTERPOLATE); }
  void SetMethodToLeastSquares() { this->SetMethod(LEAST_SQUARES); }
  void SetMethodToDataAsControlPoints() { this->SetMethod(DATA_AS_CONTROL_POINTS); }
  void SetMethodToScatteredData() { this->SetMethod(SCATTERED_DATA); }
  ///@}

  ///@{
  /**
   * The point arrays to fit, by name. None: all numeric ones. A name that no data set has is an
   * error.
   */
  void AddPointArray(const char* name);
  void ClearPointArrays();
  ///@}

  ///@{
  /**
   * Degree per direction, 1 to 31. A grid must have at least degree + 1 points. Default 3.
   */
  vtkSetVector3Macro(Degree, int);
  vtkGetVector3Macro(Degree, int);
  ///@}

  enum FitToType
  {
    CONTROL_POINTS = 0,
    TARGET_ERROR = 1
  };

  ///@{
  /**
   * Whether least squares and scattered fits get a number of control points, or as many as a target
   * error asks for, each array by itself. Default CONTROL_POINTS.
   */
  vtkSetClampMacro(FitTo, int, CONTROL_POINTS, TARGET_ERROR);
  vtkGetMacro(FitTo, int);
  ///@}

  ///@{
  /**
   * Control points per direction; grids with fewer samples than that are interpolated. Scattered
   * data get at least so many: the number of knot spans is the next power of two. Default 16.
   */
  vtkSetVector3Macro(ControlPoints, int);
  vtkGetVector3Macro(ControlPoints, int);
  ///@}

  ///@{
  /**
   * The error at the samples, see ErrorMeasure, as a fraction of the range of the array (of points:
   * their bounds' diagonal). Knots are inserted until it is met, for grids in the worst case at all
   * samples. Scattered fits end at four times as many control points as points; a warning says so.
   * Default 0.01.
   */
  vtkSetMacro(TargetError, double);
  vtkGetMacro(TargetError, double);
  ///@}

  enum ErrorMeasureType
  {
    MAXIMUM = 0,
    ROOT_MEAN_SQUARE = 1
  };

  ///@{
  /**
   * What TargetError is a bound of: the largest error at any sample, or the root of the mean of the
   * squared errors. Default MAXIMUM.
   */
  vtkSetClampMacro(ErrorMeasure, int, MAXIMUM, ROOT_MEAN_SQUARE);
  vtkGetMacro(ErrorMeasure, int);
  ///@}

  ///@{
  /**
   * The weight of the squared second differences of the control points against the squared errors
   * in least squares with ControlPoints, per direction (P-splines). 0, the default, is none; 1 is
   * noticeable; straight lines are never changed.
   */
  vtkSetMacro(Smoothing, double);
  vtkGetMacro(Smoothing, double);
  ///@}

  enum SampleParametersType
  {
    CHORD_LENGTH = 0,
    UNIFORM = 1
  };

  ///@{
  /**
   * The parameters of the points of a structured grid: mean lengths of chords along each direction,
   * or indices. Default CHORD_LENGTH.
   */
  vtkSetClampMacro(SampleParameters, int, CHORD_LENGTH, UNIFORM);
  vtkGetMacro(SampleParameters, int);
  ///@}

  enum MissingSamplesType
  {
    REFUSE = 0,
    LEAVE_OUT = 1
  };

  ///@{
  /**
   * What becomes of samples that are not finite; see above. Points must be finite in any case.
   * Default REFUSE.
   */
  vtkSetClampMacro(MissingSamples, int, REFUSE, LEAVE_OUT);
  vtkGetMacro(MissingSamples, int);
  ///@}

protected:
  vtkNURBSFit();
  ~vtkNURBSFit() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  bool HasWork(vtkDataObject* input) override;
  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;
  void ExecuteInput(vtkDataObject* input, vtkDataObject* output) override;

private:
  vtkNURBSFit(const vtkNURBSFit&) = delete;
  void operator=(const vtkNURBSFit&) = delete;

  class Fitter;

  int Method = INTERPOLATE;
  std::set<std::string> PointArrays;
  int Degree[3] = { 3, 3, 3 };
  int FitTo = CONTROL_POINTS;
  int ControlPoints[3] = { 16, 16, 16 };
  double TargetError = 0.01;
  int ErrorMeasure = MAXIMUM;
  double Smoothing = 0.0;
  int SampleParameters = CHORD_LENGTH;
  int MissingSamples = REFUSE;
  /// From HasWork() to MakeModel().
  vtkSmartPointer<vtkDataObject> Whole;
  std::unique_ptr<FitReport> Report;
};

#endif
