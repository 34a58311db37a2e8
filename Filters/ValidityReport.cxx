// SPDX-License-Identifier: BSD-3-Clause
#include "ValidityReport.h"

#include "ArrayNames.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

namespace
{

constexpr const char* BoundsNames[6] = { "MinimumJacobianLower", "MinimumJacobianUpper",
  "MaximumJacobianLower", "MaximumJacobianUpper", "ScaledJacobianLower", "ScaledJacobianUpper" };

/// What rounding may add to bounds that are as far apart as they may be.
constexpr double Rounded = 1.0 + 1e-9;

/// Bounds 2 and 3 are of a maximum, the others of minima.
bool IsOfMaximum(std::size_t bound)
{
  return bound == 2 || bound == 3;
}

std::string Counted(std::size_t count, const std::string& what)
{
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string InOneLine(const std::vector<std::string>& notes)
{
  std::string all;
  for (const std::string& note : notes)
  {
    all += (all.empty() ? "" : "; ") + note;
  }
  return all;
}

const char* FormName(int form)
{
  constexpr const char* names[] = { "uniform", "uniform form of elements", "Bezier form" };
  return form < 0 ? "" : names[form];
}

template <class Array, class Values>
void AddArray(vtkFieldData* data, const char* name, const Values& values, int components = 1)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  for (const auto& value : values)
  {
    array->InsertNextValue(static_cast<typename Array::ValueType>(value));
  }
  data->AddArray(array);
}

void AddStrings(vtkFieldData* data, const char* name, const std::vector<std::string>& values)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (const std::string& value : values)
  {
    array->InsertNextValue(value);
  }
  data->AddArray(array);
}

}

ValidityReport::Row::Row()
{
  for (std::size_t b = 0; b < 6; ++b)
  {
    this->Bounds[b] = IsOfMaximum(b) ? -INFINITY : INFINITY;
  }
}

void ValidityReport::Row::Merge(const Row& other)
{
  this->Elements += other.Elements;
  this->Valid += other.Valid;
  this->Invalid += other.Invalid;
  this->Undecided += other.Undecided;
  this->Degenerate += other.Degenerate;
  this->Wide += other.Wide;
  this->WideScaled += other.WideScaled;
  this->CondeTorres += other.CondeTorres;
  this->Form = std::max(this->Form, other.Form);
  this->HasRightHanded = this->HasRightHanded || other.HasRightHanded;
  this->HasLeftHanded = this->HasLeftHanded || other.HasLeftHanded;
  this->Tested += other.Tested;
  for (std::size_t b = 0; b < 6; ++b)
  {
    this->Bounds[b] = IsOfMaximum(b) ? std::max(this->Bounds[b], other.Bounds[b])
                                     : std::min(this->Bounds[b], other.Bounds[b]);
  }
}

int ValidityReport::Row::Handedness() const
{
  return static_cast<int>(this->HasRightHanded) - static_cast<int>(this->HasLeftHanded);
}

void ValidityReport::Add(int patchId, const hyperpatch::PatchValidity& validity,
  const hyperpatch::ValidityOptions& options, std::optional<hyperpatch::CondeTorresForm> form,
  std::size_t passes)
{
  Row row;
  row.Elements = validity.Elements.size();
  row.HasRightHanded = validity.Handedness > 0;
  row.HasLeftHanded = validity.Handedness < 0;
  row.Tested = validity.Tested;
  row.Form = form ? static_cast<int>(*form) : -1;
  row.CondeTorres = passes;
  for (const hyperpatch::ElementValidity& element : validity.Elements)
  {
    row.Valid += element.Verdict == 1;
    row.Invalid += element.Verdict == -1;
    row.Undecided += element.Verdict == 0;
    row.Degenerate += element.Degenerate != 0;
    Row bounds;
    if (element.Minimum)
    {
      const hyperpatch::Interval& least = *element.Minimum;
      const hyperpatch::Interval& greatest = *element.Maximum;
      bounds.Bounds = { least.Low, least.High, greatest.Low, greatest.High, INFINITY, INFINITY };
      const double allowed =
        Rounded * options.Tolerance * std::max(std::abs(least.Low), std::abs(greatest.High));
      row.Wide += least.High - least.Low > allowed || greatest.High - greatest.Low > allowed;
    }
    if (element.Scaled)
    {
      // With the sign that the patch has.
      const hyperpatch::Interval least = element.Scaled->Least(validity.Handedness);
      bounds.Bounds[4] = least.Low;
      bounds.Bounds[5] = least.High;
      row.WideScaled += least.High - least.Low > Rounded * options.ScaledTolerance;
    }
    row.Merge(bounds);
  }
  this->Rows[patchId].Merge(row);
}

std::vector<double> ValidityReport::Pack() const
{
  std::vector<double> numbers;
  for (const auto& [id, row] : this->Rows)
  {
    for (const std::size_t count : { row.Elements, row.Valid, row.Invalid, row.Undecided,
           row.Degenerate, row.Wide, row.WideScaled, row.CondeTorres, row.Tested })
    {
      numbers.push_back(static_cast<double>(count));
    }
    numbers.insert(numbers.end(),
      { static_cast<double>(id), static_cast<double>(row.Form),
        static_cast<double>(row.HasRightHanded), static_cast<double>(row.HasLeftHanded) });
    numbers.insert(numbers.end(), row.Bounds.begin(), row.Bounds.end());
  }
  return numbers;
}

ValidityReport ValidityReport::Unpack(const std::vector<double>& numbers)
{
  ValidityReport report;
  for (std::size_t i = 0; i + Size <= numbers.size(); i += Size)
  {
    const double* n = numbers.data() + i;
    const auto count = [n](std::size_t at) { return static_cast<std::size_t>(n[at]); };
    Row row;
    row.Elements = count(0);
    row.Valid = count(1);
    row.Invalid = count(2);
    row.Undecided = count(3);
    row.Degenerate = count(4);
    row.Wide = count(5);
    row.WideScaled = count(6);
    row.CondeTorres = count(7);
    row.Tested = count(8);
    row.Form = static_cast<int>(n[10]);
    row.HasRightHanded = n[11] != 0.0;
    row.HasLeftHanded = n[12] != 0.0;
    std::copy_n(n + 13, 6, row.Bounds.begin());
    report.Rows[static_cast<int>(n[9])].Merge(row);
  }
  return report;
}

std::vector<double> ValidityReport::Pack(const hyperpatch::Injectivity& injectivity)
{
  const auto number = [](auto value) { return static_cast<double>(value); };
  std::vector<double> numbers{ number(injectivity.Verdict), number(injectivity.UndecidedElements),
    number(injectivity.UndecidedPairs), number(injectivity.CollapsedElements),
    number(injectivity.Tested), number(injectivity.Boxes),
    number(injectivity.Witness.has_value()) };
  if (injectivity.Witness)
  {
    const hyperpatch::DoublePoint& witness = *injectivity.Witness;
    numbers.insert(numbers.end(), witness.Patches.begin(), witness.Patches.end());
    for (const auto& values : { witness.Parameters[0], witness.Parameters[1], witness.Image })
    {
      numbers.insert(numbers.end(), values.begin(), values.end());
    }
  }
  numbers.resize(ShareSize, 0.0);
  return numbers;
}

hyperpatch::Injectivity ValidityReport::Joined(const std::vector<double>& numbers)
{
  hyperpatch::Injectivity all;
  for (std::size_t i = 0; i + ShareSize <= numbers.size(); i += ShareSize)
  {
    const double* n = numbers.data() + i;
    all.Verdict = std::min(all.Verdict, static_cast<int>(n[0]));
    all.UndecidedElements += static_cast<std::size_t>(n[1]);
    all.UndecidedPairs += static_cast<std::size_t>(n[2]);
    // All ranks see all elements.
    all.CollapsedElements = static_cast<std::size_t>(n[3]);
    all.Tested += static_cast<std::size_t>(n[4]);
    all.Boxes += static_cast<std::int64_t>(n[5]);
    if (n[6] != 0.0 && !all.Witness)
    {
      all.Witness = hyperpatch::DoublePoint{ { static_cast<int>(n[7]), static_cast<int>(n[8]) },
        { { { n[9], n[10], n[11] }, { n[12], n[13], n[14] } } }, { n[15], n[16], n[17] } };
    }
  }
  return all;
}

ValidityReport::Row ValidityReport::All() const
{
  Row all;
  for (const auto& [id, row] : this->Rows)
  {
    all.Merge(row);
  }
  return all;
}

std::string ValidityReport::NoteOf(const Row& row)
{
  std::vector<std::string> notes;
  if (row.Handedness() < 0 && row.Valid == row.Elements)
  {
    notes.emplace_back("left-handed, det J < 0 everywhere: Reverse Direction of NURBS Refine makes "
                       "it right-handed");
  }
  else if (row.Handedness() < 0)
  {
    notes.emplace_back("left-handed");
  }
  if (row.Invalid > 0)
  {
    notes.push_back(Counted(row.Invalid, "element") + " not valid, see WitnessParameters");
  }
  if (row.Undecided > 0)
  {
    notes.push_back(Counted(row.Undecided, "element") + " undecided");
  }
  if (row.Degenerate > 0)
  {
    notes.push_back(Counted(row.Degenerate, "element") +
      " with faces, edges or corners where det J = 0, which verdicts leave out");
  }
  if (row.Wide > 0)
  {
    notes.push_back("bounds of det J wider than Tolerance on " + Counted(row.Wide, "element"));
  }
  if (row.WideScaled > 0)
  {
    notes.push_back("bounds of the scaled Jacobian wider than Scaled Tolerance on " +
      Counted(row.WideScaled, "element"));
  }
  return InOneLine(notes);
}

std::vector<std::string> ValidityReport::NotesOfAll() const
{
  std::vector<std::string> notes;
  const auto leftHanded = static_cast<std::size_t>(std::count_if(this->Rows.begin(),
    this->Rows.end(), [](const auto& item) { return item.second.Handedness() < 0; }));
  if (leftHanded > 0 && leftHanded < this->Rows.size())
  {
    notes.push_back("patches of both handedness: " + std::to_string(leftHanded) + " of " +
      std::to_string(this->Rows.size()) + " are left-handed");
  }
  if (std::any_of(this->Rows.begin(), this->Rows.end(),
        [](const auto& item) { return item.second.HasRightHanded && item.second.HasLeftHanded; }))
  {
    notes.emplace_back("patches or cells of one PatchId are of both handedness");
  }
  if (!this->Injectivity)
  {
    return notes;
  }
  const hyperpatch::Injectivity& injectivity = *this->Injectivity;
  if (injectivity.Verdict > 0)
  {
    notes.emplace_back("one to one");
  }
  else if (injectivity.Verdict < 0)
  {
    notes.emplace_back(injectivity.Witness ? "not one to one, see DoublePoint"
                                           : "not one to one, det J has both signs");
  }
  else
  {
    notes.push_back(
      "undecided whether one to one: " + Counted(injectivity.UndecidedElements, "element") + ", " +
      Counted(injectivity.UndecidedPairs, "pair"));
  }
  if (injectivity.CollapsedElements > 0)
  {
    notes.push_back(Counted(injectivity.CollapsedElements, "element") +
      " with collapsed edges or faces, whose points count as one");
  }
  return notes;
}

void ValidityReport::Fill(vtkTable* table) const
{
  std::vector<std::string> names;
  std::vector<std::string> notes;
  std::vector<int> ids;
  std::vector<Row> rows;
  for (const auto& [id, row] : this->Rows)
  {
    names.push_back("Patch " + std::to_string(id));
    notes.push_back(NoteOf(row));
    ids.push_back(id);
    rows.push_back(row);
  }
  names.emplace_back("All");
  notes.push_back(InOneLine(this->NotesOfAll()));
  ids.push_back(-1);
  rows.push_back(this->All());

  vtkFieldData* columns = table->GetRowData();
  AddStrings(columns, "Name", names);
  AddArray<vtkIntArray>(columns, hyperpatch::names::PatchId, ids);
  const auto add = [&](const char* name, auto&& value)
  {
    std::vector<double> values;
    std::transform(rows.begin(), rows.end(), std::back_inserter(values), value);
    AddArray<vtkIdTypeArray>(columns, name, values);
  };
  const auto number = [](std::size_t count) { return static_cast<double>(count); };
  add("Elements", [&](const Row& row) { return number(row.Elements); });
  add("Valid", [&](const Row& row) { return number(row.Valid); });
  add("Invalid", [&](const Row& row) { return number(row.Invalid); });
  add("Undecided", [&](const Row& row) { return number(row.Undecided); });
  add("Degenerate", [&](const Row& row) { return number(row.Degenerate); });
  add("Handedness", [&](const Row& row) { return row.Handedness(); });
  for (std::size_t b = 0; b < 6; ++b)
  {
    std::vector<double> values;
    for (const Row& row : rows)
    {
      const double value = row.Bounds[b];
      values.push_back(std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN());
    }
    AddArray<vtkDoubleArray>(columns, BoundsNames[b], values);
  }
  if (rows.back().Form >= 0)
  {
    std::vector<std::string> forms;
    for (const Row& row : rows)
    {
      forms.emplace_back(FormName(row.Form));
    }
    forms.back().clear();
    add("CondeTorres", [&](const Row& row) { return number(row.CondeTorres); });
    AddStrings(columns, "CondeTorresForm", forms);
  }
  AddStrings(columns, "Note", notes);
}

void ValidityReport::Fill(vtkFieldData* data) const
{
  const Row all = this->All();
  const auto add = [data](const char* name, std::size_t value)
  { AddArray<vtkIdTypeArray>(data, name, std::array<std::size_t, 1>{ value }); };
  add(hyperpatch::names::InvalidElements, all.Invalid);
  add(hyperpatch::names::UndecidedElements, all.Undecided);
  add("TestedElements", all.Tested);
  std::vector<std::string> notes = this->NotesOfAll();
  for (const auto& [id, row] : this->Rows)
  {
    const std::string note = NoteOf(row);
    if (!note.empty())
    {
      notes.push_back("patch " + std::to_string(id) + ": " + note);
    }
  }
  AddStrings(data, "Notes", notes);
  if (!this->Injectivity)
  {
    return;
  }
  const hyperpatch::Injectivity& injectivity = *this->Injectivity;
  AddArray<vtkIntArray>(data, "GloballyInjective", std::array<int, 1>{ injectivity.Verdict });
  add("UndecidedInjectivity", injectivity.UndecidedElements + injectivity.UndecidedPairs);
  add("TestedPairs", injectivity.Tested);
  if (injectivity.Witness)
  {
    const hyperpatch::DoublePoint& witness = *injectivity.Witness;
    AddArray<vtkDoubleArray>(data, "DoublePoint", witness.Image, 3);
    AddArray<vtkIntArray>(data, "DoublePointPatches", witness.Patches);
    std::vector<double> parameters(witness.Parameters[0].begin(), witness.Parameters[0].end());
    parameters.insert(parameters.end(), witness.Parameters[1].begin(), witness.Parameters[1].end());
    AddArray<vtkDoubleArray>(data, "DoublePointParameters", parameters, 3);
  }
}
