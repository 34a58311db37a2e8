// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSAlgorithm.h"

#include "Error.h"
#include "Measures.h"
#include "NURBSConversion.h"

#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTypes.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkSMPTools.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <thread>

namespace
{

/// Thrown to leave Execute() when the user has cancelled.
struct Cancelled
{
};

/// Threads, unless the user has decided about them.
template <typename Function>
void OnAllCores(Function&& function)
{
  const bool chosen = std::getenv("VTK_SMP_BACKEND_IN_USE") != nullptr ||
    std::string(vtkSMPTools::GetBackend()) != "Sequential";
  if (chosen)
  {
    function();
    return;
  }
  vtkSMPTools::LocalScope(vtkSMPTools::Config{ 0, "STDThread", false }, function);
}

/// The latest time at which the data or a leaf of it was made or changed.
vtkMTimeType LatestTime(vtkDataObject* data)
{
  vtkMTimeType latest = std::max(data->GetMTime(), data->GetUpdateTime());
  if (auto composite = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> it;
    it.TakeReference(composite->NewIterator());
    for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem())
    {
      latest = std::max(latest, it->GetCurrentDataObject()->GetMTime());
    }
  }
  return latest;
}

}

struct vtkNURBSAlgorithm::Conversion
{
  /// Compared, never dereferenced.
  const void* Input = nullptr;
  vtkMTimeType Time = 0;
  hyperpatch::MultiPatch Model;
};

vtkNURBSAlgorithm::vtkNURBSAlgorithm()
{
  this->SetController(vtkMultiProcessController::GetGlobalController());
}

vtkNURBSAlgorithm::~vtkNURBSAlgorithm()
{
  this->SetController(nullptr);
}

vtkCxxSetObjectMacro(vtkNURBSAlgorithm, Controller, vtkMultiProcessController);

void vtkNURBSAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Controller: " << this->Controller << "\n";
  os << indent
     << "Converted patches: " << (this->Converted ? this->Converted->Model.Patches.size() : 0)
     << "\n";
  os << indent << "ProgressBegin: " << this->ProgressBegin << "\n";
  os << indent << "ProgressEnd: " << this->ProgressEnd << "\n";
}

int vtkNURBSAlgorithm::OutputType() const
{
  return VTK_POLY_DATA;
}

int vtkNURBSAlgorithm::FillInputPortInformation(int, vtkInformation* info)
{
  // Composite data of other forms are taken or refused by the conversion, with one clear message.
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkStructuredGrid");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkUnstructuredGrid");
  return 1;
}

int vtkNURBSAlgorithm::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkDataObject" : "vtkTable");
  return 1;
}

int vtkNURBSAlgorithm::RequestDataObject(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    if (!vtkDataObjectAlgorithm::SetOutputDataObject(port == 0 ? this->OutputType() : VTK_TABLE,
          outputVector->GetInformationObject(port), true))
    {
      return 0;
    }
  }
  return 1;
}

const hyperpatch::MultiPatch& vtkNURBSAlgorithm::Convert(vtkDataObject* input)
{
  const vtkMTimeType time = input ? LatestTime(input) : 0;
  if (!this->Converted || this->Converted->Input != input || this->Converted->Time != time)
  {
    this->ModelChanged();
    this->Converted.reset();
    hyperpatch::MultiPatch model = hyperpatch::FromVTK(input);
    this->Converted = std::make_unique<Conversion>(Conversion{ input, time, std::move(model) });
  }
  return this->Converted->Model;
}

int vtkNURBSAlgorithm::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  // A source has no input.
  vtkDataObject* input =
    this->GetNumberOfInputPorts() > 0 ? vtkDataObject::GetData(inputVector[0]) : nullptr;
  vtkDataObject* output = vtkDataObject::GetData(outputVector);
  bool good = false;
  OnAllCores([&] { good = this->Run(input, output); });
  return good ? 1 : 0;
}

bool vtkNURBSAlgorithm::HasWork(vtkDataObject* input)
{
  return !this->Convert(input).Patches.empty();
}

void vtkNURBSAlgorithm::ExecuteInput(vtkDataObject* input, vtkDataObject* output)
{
  this->Execute(this->Convert(input), output);
}

void vtkNURBSAlgorithm::Execute(const hyperpatch::MultiPatch&, vtkDataObject*) {}

bool vtkNURBSAlgorithm::Run(vtkDataObject* input, vtkDataObject* output)
{
  this->SetProgressRange(0.0, 1.0);
  // The pipeline has passed on the field data of the input, which say nothing of the output.
  output->GetFieldData()->Initialize();
  // Ranks must agree on how this ends: one that leaves alone lets the others wait for ever.
  const auto attempt = [this](auto&& step)
  {
    std::string message;
    try
    {
      step();
    }
    catch (const hyperpatch::Error& error)
    {
      message = error.what();
    }
    catch (const std::bad_alloc&)
    {
      message = "out of memory";
    }
    // One message: that of the first rank that has one.
    const double rank = this->Controller ? this->Controller->GetLocalProcessId() : 0;
    const double first = this->GlobalMinimum({ message.empty() ? INFINITY : rank })[0];
    if (!message.empty() && first == rank)
    {
      vtkErrorMacro(<< message);
    }
    return first == INFINITY;
  };

  bool work = false;
  bool good = attempt([&] { work = this->HasWork(input); });
  if (good && this->AnyRank(work))
  {
    bool cancelled = false;
    good = attempt(
      [&]
      {
        try
        {
          this->ExecuteInput(input, output);
          // Who cancels at the very end does not want the output either.
          this->SetProgressRange(0.0, 1.0);
          this->ReportProgress(1.0);
        }
        catch (const Cancelled&)
        {
          cancelled = true;
        }
      });
    for (int port = 0; (!good || cancelled) && port < this->GetNumberOfOutputPorts(); ++port)
    {
      this->GetOutputDataObject(port)->Initialize();
    }
  }
  return good;
}

void vtkNURBSAlgorithm::SetProgressRange(double begin, double end)
{
  this->ProgressBegin = begin;
  this->ProgressEnd = end;
}

void vtkNURBSAlgorithm::ReportProgress(double fraction)
{
  // A range that begins anew, as that of a second engine in one filter, does not turn the bar back.
  const double progress =
    this->ProgressBegin + fraction * (this->ProgressEnd - this->ProgressBegin);
  this->UpdateProgress(std::max(progress, this->GetProgress()));
  if (!this->IsParallel() && this->CheckAbort())
  {
    throw Cancelled();
  }
}

void vtkNURBSAlgorithm::ParallelFor(
  vtkIdType count, vtkIdType grain, const std::function<void(vtkIdType, vtkIdType)>& function)
{
  // Observers of progress may be a GUI's, so only the calling thread may report: the loop is cut
  // into batches, each of several ranges per thread so that little is lost where a batch ends.
  const vtkIdType step = std::max<vtkIdType>(grain, 1);
  const vtkIdType threads = vtkSMPTools::GetEstimatedNumberOfThreads();
  const vtkIdType batch = std::max(count / 32, 8 * step * threads);

  // Several ranks go through together: see ReportProgress().
  const bool mayAbort = !this->IsParallel();
  std::atomic<bool> stop{ false };
  std::mutex mutex;
  std::exception_ptr failure;
  const auto guarded = [&](vtkIdType begin, vtkIdType end)
  {
    // Some backends hand out ranges larger than the grain.
    for (vtkIdType first = begin; first < end && !stop && !(mayAbort && this->GetAbortExecute());
         first += step)
    {
      try
      {
        function(first, std::min(first + step, end));
      }
      catch (...)
      {
        const std::lock_guard<std::mutex> lock(mutex);
        failure = failure ? failure : std::current_exception();
        stop = true;
      }
    }
  };
  for (vtkIdType begin = 0; begin < count; begin += batch)
  {
    const vtkIdType end = std::min(begin + batch, count);
    vtkSMPTools::For(begin, end, step, guarded);
    if (failure)
    {
      std::rethrow_exception(failure);
    }
    this->ReportProgress(static_cast<double>(end) / static_cast<double>(count));
  }
}

std::function<void(
  std::ptrdiff_t, std::ptrdiff_t, const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>&)>
vtkNURBSAlgorithm::KernelParallelFor()
{
  return [this](std::ptrdiff_t count, std::ptrdiff_t grain,
           const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body)
  {
    // How many loops the kernel runs is not known here: each gets a quarter of what is left.
    const double end = this->ProgressEnd;
    this->ProgressEnd = this->ProgressBegin + 0.25 * (end - this->ProgressBegin);
    this->ParallelFor(count, grain, body);
    this->SetProgressRange(this->ProgressEnd, end);
  };
}

std::function<bool()> vtkNURBSAlgorithm::KernelAbort()
{
  return [this, caller = std::this_thread::get_id()]
  {
    if (std::this_thread::get_id() == caller)
    {
      this->ReportProgress(0.0);
    }
    return !this->IsParallel() && this->GetAbortExecute() != 0;
  };
}

bool vtkNURBSAlgorithm::IsParallel() const
{
  return this->Controller && this->Controller->GetNumberOfProcesses() > 1;
}

bool vtkNURBSAlgorithm::AnyRank(bool value) const
{
  return this->GlobalMaximum({ value ? 1.0 : 0.0 })[0] > 0.0;
}

std::vector<double> vtkNURBSAlgorithm::GlobalMinimum(std::vector<double> values) const
{
  for (double& value : values)
  {
    value = -value;
  }
  values = this->GlobalMaximum(std::move(values));
  for (double& value : values)
  {
    value = -value;
  }
  return values;
}

std::vector<double> vtkNURBSAlgorithm::GlobalMaximum(std::vector<double> values) const
{
  if (!this->IsParallel())
  {
    return values;
  }
  std::vector<double> result(values.size());
  this->Controller->AllReduce(
    values.data(), result.data(), static_cast<vtkIdType>(values.size()), vtkCommunicator::MAX_OP);
  return result;
}

std::vector<double> vtkNURBSAlgorithm::AllGather(const std::vector<double>& records) const
{
  if (!this->IsParallel())
  {
    return records;
  }
  const auto ranks = static_cast<std::size_t>(this->Controller->GetNumberOfProcesses());
  const auto own = static_cast<vtkIdType>(records.size());
  std::vector<vtkIdType> lengths(ranks);
  this->Controller->AllGather(&own, lengths.data(), 1);
  std::vector<vtkIdType> offsets(ranks, 0);
  for (std::size_t r = 1; r < ranks; ++r)
  {
    offsets[r] = offsets[r - 1] + lengths[r - 1];
  }
  std::vector<double> result(static_cast<std::size_t>(offsets.back() + lengths.back()));
  this->Controller->AllGatherV(records.data(), result.data(), own, lengths.data(), offsets.data());
  return result;
}

double vtkNURBSAlgorithm::Diagonal(const hyperpatch::MultiPatch& model) const
{
  const hyperpatch::Bounds bounds = hyperpatch::ControlPointBounds(model);
  const auto [x0, y0, z0] = bounds.Low;
  const auto [x1, y1, z1] = bounds.High;
  const std::vector<double> ends = this->GlobalMaximum({ -x0, -y0, -z0, x1, y1, z1 });
  const double diagonal = std::hypot(ends[0] + ends[3], ends[1] + ends[4], ends[2] + ends[5]);
  return std::isfinite(diagonal) ? diagonal : 0.0;
}
