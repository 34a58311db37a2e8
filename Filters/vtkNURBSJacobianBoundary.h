// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSJacobianBoundary
 * @brief A superset of the boundary of a spline solid: its faces, and where it folds.
 *
 * Where a volume folds over itself its boundary is not made of its six parametric faces alone: the
 * map turns back on the sheet where the Jacobian determinant vanishes (Joy & Duchaineau, theorem
 * 4.1; FIGURE 1 of that paper is a half cylinder swept along its diameter). The theorem asks for a
 * C1 map: at a C0 knot plane det J may also jump from one sign to the other. This filter draws
 * faces, sheets, and the parts of C0 knot planes where that happens, each piece labelled and
 * numbered.
 *
 * Input: see vtkNURBSAlgorithm; volumes only, other patches are left out with a warning.
 *
 * Output: see vtkNURBSZeroSetAlgorithm, and
 * - `Piece` (cell data, 1): what a cell is of, see enum Pieces
 * - `PieceId` (cell data, 1): cells of a patch with the same `Piece` that are connected have the
 *   same number, from 0; the same on any number of ranks
 * - `JacobianDeterminant` (point data, 1): det J with respect to the patch's own parameters; at C0
 *   knots of a face the limit from above, on knot planes 0
 *
 * A sheet in a face, as where a face is collapsed, is left out: the face is there.
 *
 * Normals of faces are outward; those of sheets and knot planes point to growing det J. Triangles
 * turn counter-clockwise around them.
 *
 * Method CERTIFIED: faces keep to the tolerance by bounds; sheets and knot planes are watertight
 * each, end on the faces and on each other to the tolerance, and every vertex is on its piece to
 * round-off. Between C0 knot planes det J is smooth, so sheets are drawn block by block. Field data
 * of vtkNURBSZeroSetAlgorithm; UndecidedCells and LargestError take in the knot planes.
 *
 * Method JOY_DUCHAINEAU, the algorithm of the paper for comparison: cells of the domain in which
 * det J may vanish, halved until all intervals are narrow or the cells too many (JacobianTree); the
 * sheet from their tetrahedra (JacobianTetrahedra). It lies near det J = 0, not on it, to no stated
 * tolerance; `JacobianDeterminant` shows how near. Faces and knot planes are as above. The
 * parameters hold for every block between C0 knot planes. Patches must not be split over ranks.
 * Field data:
 * - `Cells`, `Tetrahedra`, `RepairedCells`, `OpenEdges`: sums over all blocks
 * - `IntervalWidth`, `CellsInQueue`: before every split and at the end, block after block (FIGURE
 *   12 of the paper)
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

  /// Values of the cell array `Piece`. 8 and 9 are kept for sheets known to be outer or inner.
  enum Pieces
  {
    U_FIRST = 0, ///< domain faces
    U_LAST,
    V_FIRST,
    V_LAST,
    W_FIRST,
    W_LAST,
    KNOT_PLANE, ///< part of a C0 knot plane across which det J jumps from one sign to the other
    SHEET,      ///< det J = 0
    CELLS = 10  ///< edges of the cells of JOY_DUCHAINEAU, as lines
  };

  enum Methods
  {
    CERTIFIED = 0,
    JOY_DUCHAINEAU
  };
  ///@{
  /**
   * How sheets are drawn. Default CERTIFIED.
   */
  vtkSetClampMacro(Method, int, CERTIFIED, JOY_DUCHAINEAU);
  vtkGetMacro(Method, int);
  ///@}

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
   * Whether to draw the parts of C0 knot planes across which det J changes its sign. Default on.
   */
  vtkSetMacro(KnotPlanes, bool);
  vtkGetMacro(KnotPlanes, bool);
  vtkBooleanMacro(KnotPlanes, bool);
  ///@}

  ///@{
  /**
   * Whether to draw the sheets det J = 0. Default on.
   */
  vtkSetMacro(Sheet, bool);
  vtkGetMacro(Sheet, bool);
  vtkBooleanMacro(Sheet, bool);
  ///@}

  enum Bounds
  {
    CONES = 0,          ///< of the directions of the derivatives, as in the paper
    CONES_THREE_ORDERS, ///< the best of the three orders of the triple product
    BERNSTEIN           ///< Bernstein coefficients of det J
  };
  ///@{
  /**
   * JOY_DUCHAINEAU: what bounds det J on a cell. Default CONES.
   */
  vtkSetClampMacro(IntervalsFrom, int, CONES, BERNSTEIN);
  vtkGetMacro(IntervalsFrom, int);
  ///@}

  ///@{
  /**
   * JOY_DUCHAINEAU: cells are not split whose interval is narrower. For cones intervals lie in -1
   * to 1, those of Bernstein coefficients are fractions of the greatest |det J| that the first cell
   * allows. Default 0.02.
   */
  vtkSetClampMacro(MinimumWidth, double, 0.0, 2.0);
  vtkGetMacro(MinimumWidth, double);
  ///@}

  ///@{
  /**
   * JOY_DUCHAINEAU: no more splits when so many cells are in the queue. Default 900.
   */
  vtkSetClampMacro(MaximumCells, int, 1, 10000000);
  vtkGetMacro(MaximumCells, int);
  ///@}

  enum Repairs
  {
    NONE = 0,   ///< the surface may have cracks where cells of different size meet
    AS_PRINTED, ///< faces of smaller cells take over the triangles of larger ones
    CONFORMING  ///< no cracks
  };
  ///@{
  /**
   * JOY_DUCHAINEAU: what is done where cells abut on smaller ones. Default CONFORMING.
   */
  vtkSetClampMacro(CrackRepair, int, NONE, CONFORMING);
  vtkGetMacro(CrackRepair, int);
  ///@}

  ///@{
  /**
   * JOY_DUCHAINEAU: whether to draw the cells too. Default off.
   */
  vtkSetMacro(ShowCells, bool);
  vtkGetMacro(ShowCells, bool);
  vtkBooleanMacro(ShowCells, bool);
  ///@}

protected:
  vtkNURBSJacobianBoundary() = default;
  ~vtkNURBSJacobianBoundary() override = default;

  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;

private:
  vtkNURBSJacobianBoundary(const vtkNURBSJacobianBoundary&) = delete;
  void operator=(const vtkNURBSJacobianBoundary&) = delete;

  std::vector<PreparedPatch> SmoothBlocks(const hyperpatch::MultiPatch& model);
  void DrawFaces(const hyperpatch::MultiPatch& model, const AbsoluteTolerances& tolerances,
    NURBSMeshOutput& mesh);
  void DrawKnotPlanes(const hyperpatch::MultiPatch& model, const AbsoluteTolerances& tolerances,
    NURBSMeshOutput& mesh, vtkFieldData* fieldData);
  void DrawTetrahedra(
    const std::vector<PreparedPatch>& blocks, NURBSMeshOutput& mesh, vtkFieldData* fieldData);

  int Method = CERTIFIED;
  bool Faces = true;
  bool KnotPlanes = true;
  bool Sheet = true;
  int IntervalsFrom = CONES;
  double MinimumWidth = 0.02;
  int MaximumCells = 900;
  int CrackRepair = CONFORMING;
  bool ShowCells = false;
};

#endif
