// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSModelAlgorithm
 * @brief Base class of the sources and filters that make spline models.
 *
 * Converts all inputs of all ports, and writes the model that a subclass makes of them in
 * MakeModel(). Errors, progress and Cancel: see vtkNURBSAlgorithm.
 *
 * Input: see vtkNURBSAlgorithm. Parts of patches, such as the cells of a Bezier mesh, are taken as
 * patches of their own and numbered anew.
 *
 * Output: vtkPartitionedDataSetCollection, the control lattice, see NURBSConversion.h. Interfaces
 * of the input come along; others are found by coincident faces.
 *
 * In a parallel run every rank makes the whole model, which is small beside what it is looked at
 * with, and keeps its piece. So the result is the same on any number of ranks.
 */
#ifndef vtkNURBSModelAlgorithm_h
#define vtkNURBSModelAlgorithm_h

#include "vtkNURBSAlgorithm.h"
#include "vtkNURBSFiltersModule.h" // for the export macro

#include <vector> // for the inputs

class VTKNURBSFILTERS_EXPORT vtkNURBSModelAlgorithm : public vtkNURBSAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkNURBSModelAlgorithm, vtkNURBSAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkNURBSModelAlgorithm();
  ~vtkNURBSModelAlgorithm() override;

  /**
   * The models of each port, in the order of its connections.
   */
  using Inputs = std::vector<std::vector<hyperpatch::MultiPatch>>;

  /**
   * The model to give. Not called if no model of the first port has patches. Report errors by
   * throwing hyperpatch::Error.
   */
  virtual hyperpatch::MultiPatch MakeModel(const Inputs& inputs) = 0;

  /**
   * The model in an input; here a control lattice.
   */
  virtual hyperpatch::MultiPatch ConvertInput(int port, vtkDataObject* input);

  /**
   * Largest distance between control points of faces that are one, as a fraction of the diagonal;
   * 1e-9 here.
   */
  virtual double FoundInterfaceTolerance() const;

  int OutputType() const override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  bool HasWork(vtkDataObject* input) override;
  void ExecuteInput(vtkDataObject* input, vtkDataObject* output) override;

  /**
   * Whether this piece is the one that gives reports: those are of the whole model.
   */
  bool IsFirstPiece();

private:
  vtkNURBSModelAlgorithm(const vtkNURBSModelAlgorithm&) = delete;
  void operator=(const vtkNURBSModelAlgorithm&) = delete;

  /// From HasWork() to ExecuteInput().
  Inputs Models;
};

#endif
