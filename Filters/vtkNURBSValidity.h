// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSValidity
 * @brief Certified verdicts on spline volumes: validity, quality, injectivity, element by element.
 *
 * Whether the map of a volume is a proper one cannot be told by sampling: this filter proves it, by
 * bounds that include rounding, or shows where it fails. What it cannot decide it calls undecided.
 *
 * Input: see vtkNURBSAlgorithm; volumes only, other patches are left out with a warning.
 *
 * Output 0: vtkUnstructuredGrid, one hexahedron per element (non-empty knot span), linear where the
 * volume is trilinear, otherwise with 27 points (VTK_TRIQUADRATIC_HEXAHEDRON). Point data
 * `ParametricCoordinates` (3, in the patch's own knots). Cell data:
 * - `PatchId`, `ElementId`.
 * - `Verdict`: 1 det J keeps one strict sign in the open element, that of the patch; -1 it does
 *   not; 0 undecided.
 * - `WitnessParameters` (3): for verdict -1 a point where det J certainly has the other sign; NaN
 *   elsewhere.
 * - `Handedness`: 1, or -1 where the patch is left-handed. Left-handed patches are valid.
 * - `Degenerate`: where det J is 0 to rounding all over, which the verdict leaves out: bits 0..5
 *   faces u0 u1 v0 v1 w0 w1; 6 + 4 d + a + 2 b edges along direction d at end a of the next and b
 *   of the last of the other directions; 18 + i + 2 j + 4 k corners.
 * - `CertificateDepth`: the most halvings in a row that it took.
 * - with Tolerance > 0, `MinimumJacobianLower`, `MinimumJacobianUpper`, `MaximumJacobianLower`,
 *   `MaximumJacobianUpper`: enclosures of the least and the greatest det J with respect to the
 *   patch's knots (cubic length per cubic parameter), no further apart than Tolerance times the
 *   greatest |det J| of the element.
 * - with ScaledTolerance > 0, `ScaledJacobianLower`, `ScaledJacobianUpper`: enclosure of the least
 *   det J / (|P_u| |P_v| |P_w|), times the handedness: 1 is orthogonal. An element is halved into
 *   4000 boxes at most, 1000 for its scaled Jacobian; Notes tell where bounds stay wider.
 * - with CondeTorres, `CondeTorres`: 1 the element passes the condition of Conde & Torres 2001, 0
 *   it does not. A label for comparison, which neither proves nor refutes validity.
 *
 * Output 1: vtkTable, a row for each patch and a last one, `All` (PatchId -1), with the numbers of
 * Elements, Valid, Invalid, Undecided and Degenerate ones, the bounds above over the patch, how
 * many pass CondeTorres in which CondeTorresForm, and a Note in words.
 *
 * Field data of both: `InvalidElements`, `UndecidedElements`, `TestedElements`, `Notes` (strings).
 * With GlobalInjectivity: `GloballyInjective` (1: no two points of the model have the same image,
 * but for boundary points that share control points, and left out what lies within 1 / 1024 of an
 * element of a face, edge or corner where det J is 0; -1: they do; 0: undecided),
 * `UndecidedInjectivity` (elements and pairs), `TestedPairs`, and for -1 `DoublePoint` (3),
 * `DoublePointPatches` (2 values), `DoublePointParameters` (2 x 3), where one was found.
 *
 * Edits: the results are kept. When control points or weights of the input have changed, only the
 * elements that they reach, and pairs with them, are tested again (`TestedElements`,
 * `TestedPairs`).
 *
 * Cost: signs of det J 1 to 5 microseconds per tricubic element and core, bounds some 20, the
 * condition of Conde & Torres and injectivity some 100 each. Ranks share elements and pairs; for
 * pairs every rank holds all geometries.
 *
 * References: Joy, Duchaineau 1999 (cones); Johnen, Remacle, Geuzaine, JCP 233, 2013 (Bernstein
 * coefficients of det J); Conde, Torres, A Simple Validity Condition for B-Spline Hyperpatches,
 * 2001.
 *
 * @sa vtkNURBSJacobianBoundary
 *
 * @code
 * vtkNew<vtkNURBSValidity> validity;
 * validity->SetInputConnection(reader->GetOutputPort());
 * validity->Update();
 * validity->GetOutputDataObject(1)->Print(std::cout);
 * @endcode
 */
#ifndef vtkNURBSValidity_h
#define vtkNURBSValidity_h

#include "vtkNURBSAlgorithm.h"
#include "vtkNURBSFiltersModule.h" // for the export macro

#include <memory> // for what is kept

class VTKNURBSFILTERS_EXPORT vtkNURBSValidity : public vtkNURBSAlgorithm
{
public:
  static vtkNURBSValidity* New();
  vtkTypeMacro(vtkNURBSValidity, vtkNURBSAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * How far apart the bounds of the least (and of the greatest) det J of an element may be, as a
   * fraction of the greatest |det J| there. 0: signs only, which is much faster. Default 0.01.
   */
  vtkSetClampMacro(Tolerance, double, 0.0, 1.0);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /**
   * How far apart the bounds of the least scaled Jacobian may be. 0: not wanted. Default 0.05.
   */
  vtkSetClampMacro(ScaledTolerance, double, 0.0, 1.0);
  vtkGetMacro(ScaledTolerance, double);
  ///@}

  ///@{
  /**
   * Whether to test that the model is one to one. Default on.
   */
  vtkSetMacro(GlobalInjectivity, bool);
  vtkGetMacro(GlobalInjectivity, bool);
  vtkBooleanMacro(GlobalInjectivity, bool);
  ///@}

  ///@{
  /**
   * How many boxes may be looked at for one element or pair of elements, before injectivity is left
   * undecided there. Default 20000.
   */
  vtkSetClampMacro(MaximumTests, int, 1, VTK_INT_MAX);
  vtkGetMacro(MaximumTests, int);
  ///@}

  ///@{
  /**
   * Control points this close are one and the same, as a fraction of the diagonal of the control
   * points: how interfaces, seams and collapsed sides are found. Patches that overlap by less are
   * not taken to overlap. Default 1e-6.
   */
  vtkSetClampMacro(ContactTolerance, double, 0.0, 1e-2);
  vtkGetMacro(ContactTolerance, double);
  ///@}

  ///@{
  /**
   * Whether to make the test of Conde & Torres. Default on.
   */
  vtkSetMacro(CondeTorres, bool);
  vtkGetMacro(CondeTorres, bool);
  vtkBooleanMacro(CondeTorres, bool);
  ///@}

protected:
  vtkNURBSValidity();
  ~vtkNURBSValidity() override;

  int OutputType() const override;
  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;

private:
  vtkNURBSValidity(const vtkNURBSValidity&) = delete;
  void operator=(const vtkNURBSValidity&) = delete;

  struct Results;
  void TestElements(Results& results);
  void AgreeOnHandedness(Results& results) const;
  void TestModel(Results& results);
  bool IsShared();

  double Tolerance = 0.01;
  double ScaledTolerance = 0.05;
  bool GlobalInjectivity = true;
  int MaximumTests = 20000;
  double ContactTolerance = 1e-6;
  bool CondeTorres = true;
  std::unique_ptr<Results> Known;
};

#endif
