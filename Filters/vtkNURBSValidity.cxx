// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSValidity.h"

#include "CondeTorres.h"
#include "ElementMesh.h"
#include "GlobalInjectivity.h"
#include "Measures.h"
#include "ModelExchange.h"
#include "ValidityReport.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace
{

using hyperpatch::ElementValidity;
using hyperpatch::MultiPatch;
using hyperpatch::Patch;
using hyperpatch::PatchValidity;

/// From here on patches rather than their elements are dealt out to threads.
constexpr std::size_t ManyPatches = 64;

std::size_t CountElements(const std::vector<PatchValidity>& validity)
{
  std::size_t count = 0;
  for (const PatchValidity& patch : validity)
  {
    count += patch.Elements.size();
  }
  return count;
}

/// Adds a cell array with the numbers that value(element, patch's handedness, tuple) sets.
template <class Array, class Value>
void AddCells(vtkUnstructuredGrid* mesh, const char* name, int components,
  const std::vector<PatchValidity>& validity, Value value)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(CountElements(validity)));
  auto* tuple = array->GetPointer(0);
  for (const PatchValidity& patch : validity)
  {
    for (const ElementValidity& element : patch.Elements)
    {
      value(element, patch.Handedness, tuple);
      tuple += components;
    }
  }
  mesh->GetCellData()->AddArray(array);
}

/// The same of an interval, in two arrays: name with Lower and Upper.
template <class Value>
void AddBounds(vtkUnstructuredGrid* mesh, const std::string& name,
  const std::vector<PatchValidity>& validity, const Value& value)
{
  AddCells<vtkDoubleArray>(mesh, (name + "Lower").c_str(), 1, validity,
    [&value](const ElementValidity& element, int handedness, double* tuple)
    { *tuple = value(element, handedness).Low; });
  AddCells<vtkDoubleArray>(mesh, (name + "Upper").c_str(), 1, validity,
    [&value](const ElementValidity& element, int handedness, double* tuple)
    { *tuple = value(element, handedness).High; });
}

}

/// What is known of a model, and of what.
struct vtkNURBSValidity::Results
{
  hyperpatch::ValidityOptions Options;
  hyperpatch::InjectivityOptions InjectivityOptions;
  /// The volumes of this rank without attributes.
  MultiPatch Model;
  std::vector<PatchValidity> Validity;
  std::optional<hyperpatch::Injectivity> Injectivity;
  /// Of the elements of this rank.
  std::vector<bool> PassesCondeTorres;
  std::vector<hyperpatch::CondeTorresForm> Forms;

  /// Whether these tell something of `other`: the same patches, tested in the same way.
  [[nodiscard]] bool Concerns(const Results& other) const
  {
    return this->Options.Tolerance == other.Options.Tolerance &&
      this->Options.ScaledTolerance == other.Options.ScaledTolerance &&
      std::equal(this->Model.Patches.begin(), this->Model.Patches.end(),
        other.Model.Patches.begin(), other.Model.Patches.end(),
        [](const Patch& a, const Patch& b)
        {
          return a.Id == b.Id && a.FirstSpan == b.FirstSpan &&
            a.Body.Geometry().Knots() == b.Body.Geometry().Knots();
        });
  }
};

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSValidity);

vtkNURBSValidity::vtkNURBSValidity()
{
  this->SetNumberOfOutputPorts(2);
}

vtkNURBSValidity::~vtkNURBSValidity() = default;

void vtkNURBSValidity::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "ScaledTolerance: " << this->ScaledTolerance << "\n";
  os << indent << "GlobalInjectivity: " << (this->GlobalInjectivity ? "on" : "off") << "\n";
  os << indent << "MaximumTests: " << this->MaximumTests << "\n";
  os << indent << "ContactTolerance: " << this->ContactTolerance << "\n";
  os << indent << "CondeTorres: " << (this->CondeTorres ? "on" : "off") << "\n";
  os << indent << "Known elements: " << (this->Known ? CountElements(this->Known->Validity) : 0)
     << "\n";
}

int vtkNURBSValidity::OutputType() const
{
  return VTK_UNSTRUCTURED_GRID;
}

bool vtkNURBSValidity::IsShared()
{
  return this->GetController() && this->GetController()->GetNumberOfProcesses() > 1;
}

void vtkNURBSValidity::TestElements(Results& results)
{
  const std::vector<Patch>& patches = results.Model.Patches;
  results.Validity.resize(patches.size());
  const auto test = [&](std::size_t p, const hyperpatch::ParallelFor& parallelFor)
  {
    std::optional<hyperpatch::KnownValidity> known;
    if (this->Known)
    {
      known = hyperpatch::KnownValidity{ &this->Known->Model.Patches[p].Body.Geometry(),
        &this->Known->Validity[p] };
    }
    results.Validity[p] = hyperpatch::TestValidity(patches[p].Body.Geometry(), results.Options,
      parallelFor, hyperpatch::Handedness(patches[p]), known ? &*known : nullptr);
  };
  if (patches.size() >= ManyPatches)
  {
    this->ParallelFor(static_cast<vtkIdType>(patches.size()), 1,
      [&test](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType p = begin; p < end; ++p)
        {
          test(static_cast<std::size_t>(p), hyperpatch::SerialFor);
        }
      });
    return;
  }
  for (std::size_t p = 0; p < patches.size(); ++p)
  {
    test(p, this->KernelParallelFor());
  }
}

void vtkNURBSValidity::AgreeOnHandedness(Results& results) const
{
  // Where left-handed and right-handed parts of a patch cancel, its first decided element tells;
  // that may be one of another rank.
  std::vector<double> records;
  for (std::size_t p = 0; p < results.Validity.size(); ++p)
  {
    const Patch& patch = results.Model.Patches[p];
    if (hyperpatch::Handedness(patch) == 0)
    {
      records.insert(records.end(),
        { static_cast<double>(patch.Id), static_cast<double>(patch.FirstSpan[2]),
          static_cast<double>(patch.FirstSpan[1]), static_cast<double>(patch.FirstSpan[0]),
          static_cast<double>(results.Validity[p].Handedness) });
    }
  }
  std::map<int, std::pair<std::array<double, 3>, int>> first;
  records = this->AllGather(records);
  for (std::size_t r = 0; r < records.size(); r += 5)
  {
    const std::array<double, 3> place{ records[r + 1], records[r + 2], records[r + 3] };
    const auto handedness = static_cast<int>(records[r + 4]);
    const auto found = first.find(static_cast<int>(records[r]));
    if (handedness != 0 && (found == first.end() || place < found->second.first))
    {
      first[static_cast<int>(records[r])] = { place, handedness };
    }
  }
  for (std::size_t p = 0; p < results.Validity.size(); ++p)
  {
    const Patch& patch = results.Model.Patches[p];
    const auto found = first.find(patch.Id);
    if (found != first.end() && found->second.second != results.Validity[p].Handedness)
    {
      const std::size_t tested = results.Validity[p].Tested;
      const PatchValidity before = std::move(results.Validity[p]);
      const hyperpatch::KnownValidity known{ &patch.Body.Geometry(), &before };
      results.Validity[p] = hyperpatch::TestValidity(patch.Body.Geometry(), results.Options,
        hyperpatch::SerialFor, found->second.second, &known);
      results.Validity[p].Tested = tested;
    }
  }
}

void vtkNURBSValidity::TestModel(Results& results)
{
  if (!this->CondeTorres && !this->GlobalInjectivity)
  {
    return;
  }
  // Pairs are of all ranks.
  const bool isShared = this->IsShared();
  std::size_t first = 0;
  MultiPatch gathered;
  std::vector<PatchValidity> gatheredValidity;
  if (isShared)
  {
    const double own = static_cast<double>(CountElements(results.Validity));
    const std::vector<double> counts = this->AllGather({ own });
    const int rank = this->GetController()->GetLocalProcessId();
    for (int r = 0; r < rank; ++r)
    {
      first += static_cast<std::size_t>(counts[static_cast<std::size_t>(r)]);
    }
    gathered = ModelExchange::UnpackModel(this->AllGather(ModelExchange::Pack(results.Model)));
    gatheredValidity =
      ModelExchange::UnpackValidity(this->AllGather(ModelExchange::Pack(results.Validity)));
  }
  const MultiPatch& all = isShared ? gathered : results.Model;
  const std::vector<PatchValidity>& validity = isShared ? gatheredValidity : results.Validity;
  if (this->CondeTorres)
  {
    this->SetProgressRange(0.5, 0.65);
    const hyperpatch::CondeTorres condeTorres =
      hyperpatch::TestCondeTorres(all, this->KernelParallelFor());
    const std::size_t own = CountElements(results.Validity);
    for (std::size_t e = first; e < first + own; ++e)
    {
      results.PassesCondeTorres.push_back(
        condeTorres.Elements[e] == hyperpatch::CondeTorresResult::Passes);
    }
    std::map<int, hyperpatch::CondeTorresForm> forms;
    for (std::size_t p = 0; p < all.Patches.size(); ++p)
    {
      forms[all.Patches[p].Id] = condeTorres.Forms[p];
    }
    for (const Patch& patch : results.Model.Patches)
    {
      results.Forms.push_back(forms[patch.Id]);
    }
  }
  if (this->GlobalInjectivity)
  {
    this->SetProgressRange(0.65, 0.95);
    std::optional<hyperpatch::KnownInjectivity> known;
    // Pieces of other ranks are not kept.
    if (!isShared && this->Known && this->Known->Injectivity &&
      this->Known->InjectivityOptions.MaxTests == this->MaximumTests &&
      this->Known->InjectivityOptions.ContactTolerance == this->ContactTolerance)
    {
      known = hyperpatch::KnownInjectivity{ &*this->Known->Injectivity, {} };
      for (std::size_t p = 0; p < all.Patches.size(); ++p)
      {
        const std::vector<bool> changed = hyperpatch::ChangedElements(
          this->Known->Model.Patches[p].Body.Geometry(), results.Model.Patches[p].Body.Geometry());
        known->Changed.insert(known->Changed.end(), changed.begin(), changed.end());
      }
    }
    results.InjectivityOptions.MaxTests = this->MaximumTests;
    results.InjectivityOptions.ContactTolerance = this->ContactTolerance;
    if (isShared)
    {
      results.InjectivityOptions.Share =
        static_cast<std::size_t>(this->GetController()->GetLocalProcessId());
      results.InjectivityOptions.Shares =
        static_cast<std::size_t>(this->GetController()->GetNumberOfProcesses());
    }
    results.Injectivity = hyperpatch::TestInjectivity(all, validity, results.InjectivityOptions,
      this->KernelParallelFor(), known ? &*known : nullptr);
  }
}

void vtkNURBSValidity::Execute(const MultiPatch& model, vtkDataObject* output)
{
  auto results = std::make_unique<Results>();
  results->Options.Tolerance = this->Tolerance;
  results->Options.ScaledTolerance = this->ScaledTolerance;
  int leftOut = 0;
  for (const Patch& patch : model.Patches)
  {
    if (patch.Body.Geometry().Dimension() < 3)
    {
      ++leftOut;
      continue;
    }
    Patch volume = patch;
    volume.Body = hyperpatch::Aggregate(patch.Body.Geometry());
    results->Model.Patches.push_back(std::move(volume));
  }
  if (leftOut > 0)
  {
    vtkWarningMacro(<< leftOut << " patches are curves or surfaces and have no Jacobian");
  }
  if (this->Known && !this->Known->Concerns(*results))
  {
    this->Known.reset();
  }
  this->SetProgressRange(0.0, 0.5);
  this->TestElements(*results);
  this->AgreeOnHandedness(*results);
  this->TestModel(*results);
  this->SetProgressRange(0.95, 1.0);

  // The report is of all ranks.
  ValidityReport own;
  const std::vector<PatchValidity>& validity = results->Validity;
  std::size_t e = 0;
  for (std::size_t p = 0; p < validity.size(); ++p)
  {
    std::size_t passes = 0;
    for (std::size_t i = 0; i < validity[p].Elements.size(); ++i, ++e)
    {
      passes += this->CondeTorres && results->PassesCondeTorres[e];
    }
    own.Add(results->Model.Patches[p].Id, validity[p], results->Options,
      this->CondeTorres ? std::make_optional(results->Forms[p]) : std::nullopt, passes);
  }
  ValidityReport report = ValidityReport::Unpack(this->AllGather(own.Pack()));
  if (results->Injectivity)
  {
    report.SetInjectivity(this->IsShared()
        ? ValidityReport::Joined(this->AllGather(ValidityReport::Pack(*results->Injectivity)))
        : *results->Injectivity);
  }

  ElementMesh elements;
  for (std::size_t p = 0; p < validity.size(); ++p)
  {
    elements.Add(results->Model.Patches[p], validity[p].Handedness);
  }
  auto mesh = vtkUnstructuredGrid::SafeDownCast(output);
  elements.Fill(mesh);
  AddCells<vtkIntArray>(mesh, "Verdict", 1, validity,
    [](const ElementValidity& element, int, int* tuple) { *tuple = element.Verdict; });
  AddCells<vtkDoubleArray>(mesh, "WitnessParameters", 3, validity,
    [](const ElementValidity& element, int handedness, double* tuple)
    {
      const auto& witness = handedness > 0 ? element.Negative : element.Positive;
      std::fill_n(tuple, 3, std::numeric_limits<double>::quiet_NaN());
      if (element.Verdict == -1 && witness)
      {
        std::copy(witness->begin(), witness->end(), tuple);
      }
    });
  AddCells<vtkIntArray>(mesh, "Handedness", 1, validity,
    [](const ElementValidity&, int handedness, int* tuple) { *tuple = handedness; });
  AddCells<vtkIntArray>(mesh, "Degenerate", 1, validity,
    [](const ElementValidity& element, int, int* tuple)
    { *tuple = static_cast<int>(element.Degenerate); });
  AddCells<vtkIntArray>(mesh, "CertificateDepth", 1, validity,
    [](const ElementValidity& element, int, int* tuple) { *tuple = element.Depth; });
  if (this->Tolerance > 0.0)
  {
    AddBounds(mesh, "MinimumJacobian", validity,
      [](const ElementValidity& element, int) { return *element.Minimum; });
    AddBounds(mesh, "MaximumJacobian", validity,
      [](const ElementValidity& element, int) { return *element.Maximum; });
  }
  if (this->ScaledTolerance > 0.0)
  {
    AddBounds(mesh, "ScaledJacobian", validity,
      [](const ElementValidity& element, int handedness)
      { return element.Scaled->Least(handedness); });
  }
  if (this->CondeTorres)
  {
    AddCells<vtkIntArray>(mesh, "CondeTorres", 1, validity,
      [next = results->PassesCondeTorres.begin()](const ElementValidity&, int, int* tuple) mutable
      { *tuple = *next++; });
  }
  report.Fill(mesh->GetFieldData());
  auto table = vtkTable::SafeDownCast(this->GetOutputDataObject(1));
  table->Initialize();
  // A spreadsheet shows the rows of all ranks.
  if (!this->IsShared() || this->GetController()->GetLocalProcessId() == 0)
  {
    report.Fill(table);
  }
  report.Fill(table->GetFieldData());
  this->Known = std::move(results);
}

VTK_ABI_NAMESPACE_END
