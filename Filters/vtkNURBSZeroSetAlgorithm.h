// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSZeroSetAlgorithm
 * @brief Base class of slice, isosurface and Jacobian boundary: f = 0 drawn on the exact splines.
 *
 * A subclass says which fields f it wants on which patches; this class refines until the tolerances
 * are met on all patches and ranks, lets the surface close across interfaces between patches and
 * cuts between pieces, and fills the output.
 *
 * Output: vtkPolyData: triangles in volumes, line segments in surfaces, vertices on curves, with
 * the arrays of vtkNURBSMeshAlgorithm. Normals point to growing f and do not flip where a volume is
 * folded; triangles turn counter-clockwise around them. Field data, one number each:
 * - `CertifiedCells`: parameter boxes that hold a piece of the surface, proven to be one sheet
 * - `UndecidedCells`: parameter boxes where a zero can neither be excluded nor be proven to be a
 *   simple sheet; no wider than the tolerance unless the limit of refinement came first
 * - `LargestResidual`: of |f| at the points, relative to the largest |f| near the surface; what is
 *   within the rounding error of f counts as 0
 * - `LargestError`: measured distance between mesh and exact zero set, inside every cell
 * - `ToleranceReached`: 0 where the limit of refinement came first (a warning says so too)
 * - `OpenEdgesOnBoundary`: edges of one triangle only, on sides beyond which there is no model
 * - `OpenEdgesOnInterfaces`: the same on interfaces on which the field or the geometry of both
 *   sides differ by more than 1e-6 of its range or of the extent of the model, or that contradict
 *   other interfaces, and on cuts whose other side is not there
 * - `OpenEdgesInside`: the same anywhere else. These are cracks; there are none where nothing is
 *   undecided.
 * - `UndecidedBoxes`: which these cells are: PatchId, then the least and the greatest parameter in
 *   each direction; no more than 100,000 of a surface in a patch
 * In a parallel run all processes have the numbers of the whole, and the boxes of their own part.
 *
 * Points on interfaces and creases occur once per side, with the same bits in their coordinates and
 * the ParametricCoordinates, normal and attributes of their side; MergePoints joins them.
 */
#ifndef vtkNURBSZeroSetAlgorithm_h
#define vtkNURBSZeroSetAlgorithm_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSMeshAlgorithm.h"

#include <memory> // for fields
#include <vector> // for fields

class NURBSMeshOutput;
class vtkFieldData;

namespace hyperpatch
{
struct Interface;
class PreparedAggregate;
class ScalarField;
struct ZeroSetMesh;
}

class VTKNURBSFILTERS_EXPORT vtkNURBSZeroSetAlgorithm : public vtkNURBSMeshAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkNURBSZeroSetAlgorithm, vtkNURBSMeshAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Whether points of one surface that have the same coordinates become one: those of the sides of
   * interfaces and creases. It has the ParametricCoordinates and attributes of the first side and
   * the mean of the normals; triangles that lose a corner by that are left out. Points of different
   * processes are not joined. Default: off.
   */
  vtkSetMacro(MergePoints, bool);
  vtkGetMacro(MergePoints, bool);
  vtkBooleanMacro(MergePoints, bool);
  ///@}

protected:
  vtkNURBSZeroSetAlgorithm();
  ~vtkNURBSZeroSetAlgorithm() override;

  /**
   * A patch with what zero sets of it share; kept until the model changes, so that another plane or
   * value costs only its surface.
   */
  struct PreparedPatch
  {
    std::shared_ptr<const hyperpatch::Patch> Patch;
    std::shared_ptr<const hyperpatch::PreparedAggregate> Body;
    int Handedness = 1;
  };
  const std::vector<PreparedPatch>& Prepare(const hyperpatch::MultiPatch& model);

  /**
   * One field on one patch (or on the block of it between C0 knot planes).
   */
  struct Task
  {
    PreparedPatch On;
    std::shared_ptr<const hyperpatch::ScalarField> Field;
    /// Label of the cells. Tasks of the same value are one surface; where a patch has several of
    /// them, the first of all patches are one, the second, and so on.
    int Value = 0;
    /// Index of an attribute that is constant where the field is 0: its tolerance does not apply.
    int Constant = -1;
  };

  /**
   * Draws the zero sets of all tasks into the output, whose one label is Task::Value, and adds the
   * numbers above to the field data. All ranks must call it.
   */
  void Draw(const std::vector<Task>& tasks, const AbsoluteTolerances& tolerances,
    NURBSMeshOutput& output, vtkFieldData* fieldData);

  /**
   * Called with the surfaces of all tasks, in their order, before they become output; leaves them
   * as they are.
   */
  virtual void Change(
    const std::vector<Task>& tasks, std::vector<hyperpatch::ZeroSetMesh>& surfaces);

  void ModelChanged() override;

  const hyperpatch::PreparedAggregate* PreparedBody(
    const hyperpatch::MultiPatch& model, std::size_t patch) override;

private:
  vtkNURBSZeroSetAlgorithm(const vtkNURBSZeroSetAlgorithm&) = delete;
  void operator=(const vtkNURBSZeroSetAlgorithm&) = delete;

  std::vector<PreparedPatch> Prepared;
  std::vector<hyperpatch::Interface> Interfaces; ///< of the model
  bool MergePoints = false;
};

#endif
