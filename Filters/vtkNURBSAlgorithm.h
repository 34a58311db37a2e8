// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSAlgorithm
 * @brief Base class of the filters on spline volumes.
 *
 * Does once what all filters need: it converts the input, catches errors, runs loops on all cores,
 * reports progress, obeys Cancel and joins the ranks of a parallel run. A filter overrides
 * Execute(), and OutputType() unless its output is vtkPolyData.
 *
 * Input: a control lattice in one of the forms of NURBSConversion.h:
 * vtkPartitionedDataSetCollection, another composite of vtkStructuredGrid, one of these alone, or
 * vtkUnstructuredGrid of VTK_BEZIER_HEXAHEDRON. The converted model is kept until the input
 * changes, so that another value of a property does not convert again.
 *
 * Output: of a subclass. Empty input gives empty output without a message; bad input gives one
 * error message and empty outputs; a cancelled run gives empty outputs. In a parallel run that
 * holds for all ranks as soon as one of them fails.
 *
 * Threads: the loops of a filter run on the STDThread backend of vtkSMPTools with all cores, unless
 * a backend other than Sequential is in use or VTK_SMP_BACKEND_IN_USE is set in the environment;
 * VTK_SMP_MAX_THREADS limits the number of threads.
 */
#ifndef vtkNURBSAlgorithm_h
#define vtkNURBSAlgorithm_h

#include "vtkDataObjectAlgorithm.h"
#include "vtkNURBSFiltersModule.h" // for the export macro

#include <cstddef>    // for the kernel's loops
#include <functional> // for the body of ParallelFor
#include <memory>     // for the converted model
#include <vector>     // for reductions

namespace hyperpatch
{
struct MultiPatch;
}
class vtkMultiProcessController;

class VTKNURBSFILTERS_EXPORT vtkNURBSAlgorithm : public vtkDataObjectAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkNURBSAlgorithm, vtkDataObjectAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The ranks that share the model. Default: the global controller at construction; nullptr if the
   * input is all there is.
   */
  virtual void SetController(vtkMultiProcessController* controller);
  vtkGetObjectMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkNURBSAlgorithm();
  ~vtkNURBSAlgorithm() override;

  /**
   * Type of the output: VTK_POLY_DATA here. Asked before every update, so it may depend on a
   * property. A second output, which a filter asks for by SetNumberOfOutputPorts(2), is a vtkTable:
   * its report.
   */
  virtual int OutputType() const;

  /**
   * Fills the empty output from the model.
   *
   * In a parallel run the model is this rank's part and may be empty, and all ranks call Execute()
   * if one of them has patches: take part in every reduction all the same. Report errors by
   * throwing hyperpatch::Error; where ranks may disagree about one, let AnyRank() decide before the
   * next reduction. Not called where ExecuteInput() is overridden.
   */
  virtual void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output);

  ///@{
  /**
   * The two steps between which the ranks meet: whether there is something to do on this one, and
   * the work, if there is on any. Here the input is converted, and Execute() gets the model; a
   * filter whose input is no model overrides both. Errors are reported by throwing.
   */
  virtual bool HasWork(vtkDataObject* input);
  virtual void ExecuteInput(vtkDataObject* input, vtkDataObject* output);
  ///@}

  /**
   * Called when another model than before is about to come: what a filter keeps of the old one, it
   * drops here.
   */
  virtual void ModelChanged() {}

  /**
   * The part of the whole progress that the following loops report, at first from 0 to 1.
   */
  void SetProgressRange(double begin, double end);

  /**
   * Calls function(begin, end) for ranges of about `grain` items that cover [0, count), on several
   * threads at once. Reports progress and checks for Cancel on the calling thread, between batches.
   * The first exception of the function ends the loop and is thrown again here; a cancelled run
   * ends it by an exception that RequestData() catches. Not to be called from the function.
   */
  void ParallelFor(
    vtkIdType count, vtkIdType grain, const std::function<void(vtkIdType, vtkIdType)>& function);

  /**
   * ParallelFor() in the form that the kernel takes (hyperpatch::ParallelFor in Parallel.h).
   */
  std::function<void(
    std::ptrdiff_t, std::ptrdiff_t, const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>&)>
  KernelParallelFor();

  /**
   * Reports progress (0..1 of the progress range) and checks for Cancel, as ParallelFor() does; for
   * loops on the calling thread.
   */
  void ReportProgress(double fraction);

  /**
   * Whether the user has cancelled, in the form that the kernel takes and asks inside long steps.
   * On the thread that calls this function it reports progress as well, and a cancelled run ends as
   * in ReportProgress().
   */
  std::function<bool()> KernelAbort();

  ///@{
  /**
   * Reductions over all ranks, for which all must call them: whether any rank says yes; the least
   * and the largest of each value; the records of all ranks, one after the other in the order of
   * the ranks.
   */
  bool AnyRank(bool value) const;
  std::vector<double> GlobalMinimum(std::vector<double> values) const;
  std::vector<double> GlobalMaximum(std::vector<double> values) const;
  std::vector<double> AllGather(const std::vector<double>& records) const;
  ///@}

  /**
   * Diagonal of the bounds of the control points over all patches and ranks: the length that
   * relative tolerances refer to. All ranks must call it. 0 if there are no patches.
   */
  double Diagonal(const hyperpatch::MultiPatch& model) const;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestDataObject(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) final;

private:
  vtkNURBSAlgorithm(const vtkNURBSAlgorithm&) = delete;
  void operator=(const vtkNURBSAlgorithm&) = delete;

  struct Conversion;
  const hyperpatch::MultiPatch& Convert(vtkDataObject* input);
  bool IsParallel() const;
  bool Run(vtkDataObject* input, vtkDataObject* output);

  vtkMultiProcessController* Controller = nullptr;
  std::unique_ptr<Conversion> Converted;
  double ProgressBegin = 0.0;
  double ProgressEnd = 1.0;
};

#endif
