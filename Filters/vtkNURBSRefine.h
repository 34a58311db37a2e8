// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSRefine
 * @brief Other control points, knots, degrees or parameters for the same shape.
 *
 * For editing (more control points where they are wanted), for analysis (a basis rich enough for a
 * solution) and to prepare patches for each other. The map and all attributes stay what they are,
 * to round-off; the operations that only reorder do so to the bit.
 *
 * Input: see vtkNURBSAlgorithm. Output: vtkPartitionedDataSetCollection, the control lattice, see
 * NURBSConversion.h. Directions that a patch does not have are left alone, and an operation on a
 * single one is an error then. Interfaces and boundaries follow; of a restricted model only the
 * sides that it keeps. Patches that differ in how their directions run into each other do not fit
 * together any more if only some directions are refined.
 *
 * - REFINE_UNIFORMLY: every knot span is split into Pieces equal ones per direction.
 * - INSERT_KNOTS: the numbers of Knots, into one Direction.
 * - ELEVATE_DEGREES: by Elevations per direction; every break keeps its smoothness.
 * - SPLIT_TO_BEZIER: every knot is repeated until its span is a Bezier element.
 * - RESTRICT_TO_BOX: the part of every patch on ParameterBox, in its own parameters: what Extract
 *   Subset cannot do.
 * - REVERSE_DIRECTION: the other way through Direction. This mirrors the handedness.
 * - SWAP_DIRECTIONS: Direction and OtherDirection exchanged. This mirrors the handedness.
 * - NORMALISE_DOMAINS: all parameters scaled to [0, 1], of geometry and attributes. It takes
 *   attributes whose domain differs from that of the geometry, which all other filters refuse.
 *
 * Bases says whose basis the first four operations change.
 *
 * References: see Operators.h.
 *
 * @sa vtkNURBSExtractPatches, vtkNURBSAppend
 */
#ifndef vtkNURBSRefine_h
#define vtkNURBSRefine_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

#include <vector> // for the knots

class VTKNURBSFILTERS_EXPORT vtkNURBSRefine : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSRefine* New();
  vtkTypeMacro(vtkNURBSRefine, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Operations
  {
    REFINE_UNIFORMLY = 0,
    INSERT_KNOTS = 1,
    ELEVATE_DEGREES = 2,
    SPLIT_TO_BEZIER = 3,
    RESTRICT_TO_BOX = 4,
    REVERSE_DIRECTION = 5,
    SWAP_DIRECTIONS = 6,
    NORMALISE_DOMAINS = 7
  };

  ///@{
  /**
   * What to do. Default REFINE_UNIFORMLY.
   */
  vtkSetClampMacro(Operation, int, REFINE_UNIFORMLY, NORMALISE_DOMAINS);
  vtkGetMacro(Operation, int);
  ///@}

  enum BasesTypes
  {
    ALL_BASES = 0,
    GEOMETRY = 1,
    ATTRIBUTES = 2
  };

  ///@{
  /**
   * Which bases are refined, elevated or split: all, each in its own knots (the default); that of
   * the geometry, with the attributes in it; or those of the attributes that have their own.
   */
  vtkSetClampMacro(Bases, int, ALL_BASES, ATTRIBUTES);
  vtkGetMacro(Bases, int);
  ///@}

  ///@{
  /**
   * Into how many spans each is split, per direction. Default 2, 2, 2.
   */
  vtkSetVector3Macro(Pieces, int);
  vtkGetVector3Macro(Pieces, int);
  ///@}

  ///@{
  /**
   * The knots to insert, in any order, inside the domain. A number that occurs k times is inserted
   * k times. Default 0.5. Indices beyond their number are ignored.
   */
  void SetNumberOfKnots(int number);
  int GetNumberOfKnots() { return static_cast<int>(this->Knots.size()); }
  void SetKnot(int index, double knot);
  ///@}

  ///@{
  /**
   * By how much degrees are raised, per direction. Default 1, 1, 1.
   */
  vtkSetVector3Macro(Elevations, int);
  vtkGetVector3Macro(Elevations, int);
  ///@}

  ///@{
  /**
   * Least and largest u, v and w of the box. Default 0, 1, 0, 1, 0, 1.
   */
  vtkSetVector6Macro(ParameterBox, double);
  vtkGetVector6Macro(ParameterBox, double);
  ///@}

  enum Directions
  {
    U = 0,
    V = 1,
    W = 2
  };

  ///@{
  /**
   * The direction to work on, and the one to swap it with. Defaults U and V.
   */
  vtkSetClampMacro(Direction, int, U, W);
  vtkGetMacro(Direction, int);
  vtkSetClampMacro(OtherDirection, int, U, W);
  vtkGetMacro(OtherDirection, int);
  ///@}

protected:
  vtkNURBSRefine() = default;
  ~vtkNURBSRefine() override = default;

  hyperpatch::MultiPatch ConvertInput(int port, vtkDataObject* input) override;
  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSRefine(const vtkNURBSRefine&) = delete;
  void operator=(const vtkNURBSRefine&) = delete;

  int Operation = REFINE_UNIFORMLY;
  int Bases = ALL_BASES;
  int Pieces[3] = { 2, 2, 2 };
  std::vector<double> Knots = { 0.5 };
  int Elevations[3] = { 1, 1, 1 };
  double ParameterBox[6] = { 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 };
  int Direction = U;
  int OtherDirection = V;
};

#endif
