// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSSweep
 * @brief Surfaces of curves, and volumes of surfaces, by moving them along a path.
 *
 * Input 0: see vtkNURBSAlgorithm; curves and surfaces. Input 1: the path, one curve. Output:
 * vtkPartitionedDataSetCollection, the control lattice, see NURBSConversion.h: every curve gives a
 * surface, every surface a volume. The new direction is the last one, over [0, 1]; its first side
 * is the input where it is: the path is carried over to it, not the input to the path. Where the
 * section turns, it turns about the point where the path begins.
 *
 * - FIXED: parallel to itself, exactly (Joy and Duchaineau's Figure 10, for a straight path).
 * - FOLLOW_PATH: with the tangent of the path and no turn about it (a rotation-minimising frame;
 *   Figure 13), and with Twist turning about it (Figure 11: a straight path and 35 degrees). The
 *   solid passes through at least Sections exact sections and interpolates between them in the
 *   basis of the path, raised to degree 3; the error falls with their fourth power.
 *
 * Attributes are carried, constant along the path (Martin and Cohen, 2001, section 3).
 *
 * A solid whose path bends tighter than the section is wide folds: vtkNURBSJacobianBoundary shows
 * where. Bad input is an error: volumes, a path that is no single curve, and to follow a path that
 * has a corner or comes to rest.
 *
 * References: K. Joy and M. Duchaineau, Boundary determination for trivariate solids, 1999; W.
 * Wang, B. Juettler, D. Zheng and Y. Liu, Computation of rotation minimizing frames, 2008.
 *
 * @sa vtkNURBSExtrude, vtkNURBSRevolve, vtkNURBSCurve
 */
#ifndef vtkNURBSSweep_h
#define vtkNURBSSweep_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSSweep : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSSweep* New();
  vtkTypeMacro(vtkNURBSSweep, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The path: input port 1.
   */
  void SetPathConnection(vtkAlgorithmOutput* path) { this->SetInputConnection(1, path); }

  enum Orientations
  {
    FIXED = 0,
    FOLLOW_PATH = 1
  };

  ///@{
  /**
   * Whether the section stays parallel to itself or turns with the path (the default).
   */
  vtkSetClampMacro(Orientation, int, FIXED, FOLLOW_PATH);
  vtkGetMacro(Orientation, int);
  ///@}

  ///@{
  /**
   * The angle in degrees by which the section turns about the path from its begin to its end,
   * evenly in the parameter, if it follows it. Default 0.
   */
  vtkSetMacro(Twist, double);
  vtkGetMacro(Twist, double);
  ///@}

  ///@{
  /**
   * The least number of exact sections, at least 2, if the section follows the path. Default 16.
   */
  vtkSetMacro(Sections, int);
  vtkGetMacro(Sections, int);
  ///@}

protected:
  vtkNURBSSweep();
  ~vtkNURBSSweep() override = default;

  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSSweep(const vtkNURBSSweep&) = delete;
  void operator=(const vtkNURBSSweep&) = delete;

  int Orientation = FOLLOW_PATH;
  double Twist = 0.0;
  int Sections = 16;
};

#endif
