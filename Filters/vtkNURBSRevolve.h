// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSRevolve
 * @brief Surfaces of curves, and volumes of surfaces, by turning them about an axis.
 *
 * Input: see vtkNURBSAlgorithm; curves and surfaces. Output: vtkPartitionedDataSetCollection, the
 * control lattice, see NURBSConversion.h: every curve gives a surface, every surface a volume. The
 * new direction is the last one, rational quadratic over [0, 1] in arcs of at most 90 degrees,
 * which are exact circles. After a full turn the two ends are an interface. Attributes are carried,
 * constant around the axis (Martin and Cohen, 2001, section 3): those in the basis of the geometry
 * stay in it, others keep theirs.
 *
 * Where the input touches the axis the result degenerates, which the filters of this module know.
 * An input that crosses the axis is an error, which names the place; so are volumes and an angle of
 * zero.
 *
 * @sa vtkNURBSExtrude, vtkNURBSSweep
 */
#ifndef vtkNURBSRevolve_h
#define vtkNURBSRevolve_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSRevolve : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSRevolve* New();
  vtkTypeMacro(vtkNURBSRevolve, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * A point of the axis. Default 0, 0, 0.
   */
  vtkSetVector3Macro(AxisPoint, double);
  vtkGetVector3Macro(AxisPoint, double);
  ///@}

  ///@{
  /**
   * The direction of the axis, of any length. Default 0, 1, 0.
   */
  vtkSetVector3Macro(AxisDirection, double);
  vtkGetVector3Macro(AxisDirection, double);
  ///@}

  ///@{
  /**
   * The angle in degrees, counter-clockwise seen against the axis; from -360 to 360 and not 0.
   * Default 360.
   */
  vtkSetMacro(Angle, double);
  vtkGetMacro(Angle, double);
  ///@}

protected:
  vtkNURBSRevolve() = default;
  ~vtkNURBSRevolve() override = default;

  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSRevolve(const vtkNURBSRevolve&) = delete;
  void operator=(const vtkNURBSRevolve&) = delete;

  double AxisPoint[3] = { 0.0, 0.0, 0.0 };
  double AxisDirection[3] = { 0.0, 1.0, 0.0 };
  double Angle = 360.0;
};

#endif
