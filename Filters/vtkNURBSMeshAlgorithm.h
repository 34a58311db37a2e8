// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSMeshAlgorithm
 * @brief Base class of the filters that draw exact splines as meshes to stated tolerances.
 *
 * Holds the two tolerances and fills the output: points and cells of all patches in one data set,
 * with every attribute of the model and the arrays below.
 *
 * Output arrays, all point data unless said:
 * - every attribute under its own name, exact at the points; NaN in patches that do not have it
 * - `Normals` (3): unit
 * - `ParametricCoordinates` (3): in the patch's own knots
 * - `PatchId` (cell data, 1)
 * - `ElementId` (cell data, 1): the knot span of the whole patch that holds the cell, u fastest
 *
 * Points and normals are double.
 */
#ifndef vtkNURBSMeshAlgorithm_h
#define vtkNURBSMeshAlgorithm_h

#include "vtkNURBSAlgorithm.h"
#include "vtkNURBSFiltersModule.h" // for the export macro

#include <array>  // for ranges of values
#include <limits> // for the largest tolerance
#include <map>    // for the tolerance of each attribute
#include <string> // for names of attributes

namespace hyperpatch
{
struct Patch;
class PreparedAggregate;
}

class VTKNURBSFILTERS_EXPORT vtkNURBSMeshAlgorithm : public vtkNURBSAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkNURBSMeshAlgorithm, vtkNURBSAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Largest distance between the mesh and the exact shape, as a fraction of the diagonal of the
   * control points' bounds over all patches and ranks. Default 1e-3, range 1e-12 and up.
   */
  vtkSetClampMacro(Tolerance, double, 1e-12, std::numeric_limits<double>::max());
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /**
   * Largest difference between linear interpolation in a cell and the exact value of each carried
   * attribute, as a fraction of that attribute's range. Default 1e-2; 0 is off. Attributes of
   * degree 0, which jump at knots, ask for nothing.
   */
  vtkSetClampMacro(AttributeTolerance, double, 0.0, std::numeric_limits<double>::max());
  vtkGetMacro(AttributeTolerance, double);
  ///@}

protected:
  vtkNURBSMeshAlgorithm() = default;
  ~vtkNURBSMeshAlgorithm() override = default;

  /**
   * The two tolerances in absolute terms for a model; all ranks must ask.
   */
  struct AbsoluteTolerances
  {
    double Position = 0.0;
    std::map<std::string, double> Attributes; ///< 0 where an attribute does not matter
    /// Components of every attribute of the model, on all ranks.
    std::map<std::string, int> Components;

    /// In the order of the patch's attributes.
    std::vector<double> Of(const hyperpatch::Patch& patch) const;
  };
  AbsoluteTolerances FindTolerances(const hyperpatch::MultiPatch& model);

  /**
   * What the filter keeps of a patch for itself, so that it is not made twice, or nullptr.
   */
  virtual const hyperpatch::PreparedAggregate* PreparedBody(
    const hyperpatch::MultiPatch& model, std::size_t patch);

  void ModelChanged() override;

private:
  vtkNURBSMeshAlgorithm(const vtkNURBSMeshAlgorithm&) = delete;
  void operator=(const vtkNURBSMeshAlgorithm&) = delete;

  void FindRanges(const hyperpatch::MultiPatch& model);

  /// Least and largest sampled value of each attribute of the patches here.
  std::map<std::string, std::array<double, 2>> LocalRanges;

  double Tolerance = 1e-3;
  double AttributeTolerance = 1e-2;
};

#endif
