// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSZeroSetAlgorithm
 * @brief Base class of slice, isosurface and Jacobian boundary: f = 0 drawn on the exact splines.
 *
 * A subclass says which fields f it wants on which patches; this class refines until the tolerances
 * are met on all patches and ranks (the same cells on both sides of every cut between pieces), and
 * fills the output.
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
class PreparedAggregate;
class ScalarField;
class ZeroSet;
}

class VTKNURBSFILTERS_EXPORT vtkNURBSZeroSetAlgorithm : public vtkNURBSMeshAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkNURBSZeroSetAlgorithm, vtkNURBSMeshAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

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
    int Value = 0; ///< label of the cells; parts of a patch with the same value share a grid
  };

  /**
   * Draws the zero sets of all tasks into the output, whose one label is Task::Value, and adds the
   * numbers above to the field data. All ranks must call it.
   */
  void Draw(const std::vector<Task>& tasks, const AbsoluteTolerances& tolerances,
    NURBSMeshOutput& output, vtkFieldData* fieldData);

  void ModelChanged() override;

private:
  vtkNURBSZeroSetAlgorithm(const vtkNURBSZeroSetAlgorithm&) = delete;
  void operator=(const vtkNURBSZeroSetAlgorithm&) = delete;

  /// Neighboring parts divide their common faces alike, so that no crack is between them.
  using ZeroSets = std::vector<std::unique_ptr<hyperpatch::ZeroSet>>;
  void AgreeOnRoots(const std::vector<Task>& tasks, const ZeroSets& zeroSets);
  void ExchangeNodes(const std::vector<Task>& tasks, const ZeroSets& zeroSets);

  std::vector<PreparedPatch> Prepared;
};

#endif
