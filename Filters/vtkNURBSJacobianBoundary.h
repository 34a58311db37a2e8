// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSJacobianBoundary
 * @brief A superset of the boundary of a spline solid: its six faces and the sheet det J = 0.
 *
 * Where a volume folds over itself its boundary is not made of its parametric faces alone: the map
 * turns back on the sheet where the Jacobian determinant vanishes (Joy & Duchaineau, theorem 4.1;
 * FIGURE 1 of that paper is a half cylinder swept along its diameter). This filter draws both.
 *
 * Input: see vtkNURBSAlgorithm; volumes only, other patches are left out with a warning. Output:
 * see vtkNURBSZeroSetAlgorithm, and cell data `Piece`: 0..5 the domain face (u = first, u = last, v
 * = first, ... w = last), 7 the sheet. Normals of faces are outward; those of the sheet point to
 * growing det J.
 *
 * Between C0 knot planes det J is smooth, so the sheet is drawn block by block; C0 knot planes
 * across which det J changes sign by a jump are not drawn.
 *
 * The result is a superset of the boundary: pieces that a fold swallows are not removed.
 *
 * References: Joy, Duchaineau, Boundary Determination for Trivariate Solids, Pacific Graphics 1999.
 *
 * @sa vtkNURBSTessellate
 */
#ifndef vtkNURBSJacobianBoundary_h
#define vtkNURBSJacobianBoundary_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSZeroSetAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSJacobianBoundary : public vtkNURBSZeroSetAlgorithm
{
public:
  static vtkNURBSJacobianBoundary* New();
  vtkTypeMacro(vtkNURBSJacobianBoundary, vtkNURBSZeroSetAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Values of the cell array `Piece` beyond the faces 0..5; 6 is kept for C0 knot planes.
  enum Pieces
  {
    SHEET = 7
  };

  ///@{
  /**
   * Whether to draw the domain faces. Default on.
   */
  vtkSetMacro(Faces, bool);
  vtkGetMacro(Faces, bool);
  vtkBooleanMacro(Faces, bool);
  ///@}

  ///@{
  /**
   * Whether to draw the sheet det J = 0. Default on.
   */
  vtkSetMacro(Sheet, bool);
  vtkGetMacro(Sheet, bool);
  vtkBooleanMacro(Sheet, bool);
  ///@}

protected:
  vtkNURBSJacobianBoundary() = default;
  ~vtkNURBSJacobianBoundary() override = default;

  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;

private:
  vtkNURBSJacobianBoundary(const vtkNURBSJacobianBoundary&) = delete;
  void operator=(const vtkNURBSJacobianBoundary&) = delete;

  bool Faces = true;
  bool Sheet = true;
};

#endif
