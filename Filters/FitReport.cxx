// SPDX-License-Identifier: BSD-3-Clause
#include "FitReport.h"

#include "ArrayNames.h"
#include "Validity.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <cmath>

using hyperpatch::Interval;

void FitReport::Add(int patchId, const std::string& name, const hyperpatch::Spline& spline,
  const hyperpatch::FitError& error, double range)
{
  this->Rows.push_back(
    { patchId, name, spline.Components(), spline.NumberOfControlPoints(), error, range });
}

void FitReport::CertifyJacobian(
  const hyperpatch::Spline& geometry, const hyperpatch::ParallelFor& parallelFor)
{
  const hyperpatch::PatchValidity validity = hyperpatch::TestValidity(geometry, {}, parallelFor);
  Row& row = this->Rows.back();
  row.Jacobian = { INFINITY, INFINITY };
  row.Invalid = 0;
  row.Undecided = 0;
  for (const hyperpatch::ElementValidity& element : validity.Elements)
  {
    row.Invalid += element.Verdict == -1;
    row.Undecided += element.Verdict == 0;
    const Interval bounds = validity.Handedness < 0
      ? Interval{ -element.Maximum->High, -element.Maximum->Low }
      : *element.Minimum;
    const auto lesser = [](double least, double value)
    { return std::isnan(least) || least < value ? least : value; };
    row.Jacobian.Low = lesser(row.Jacobian.Low, bounds.Low);
    row.Jacobian.High = lesser(row.Jacobian.High, bounds.High);
  }
}

template <typename Array, typename Value>
void FitReport::AddColumn(vtkFieldData* columns, const char* name, Value&& value) const
{
  vtkNew<Array> array;
  array->SetName(name);
  for (const Row& row : this->Rows)
  {
    array->InsertNextValue(static_cast<typename Array::ValueType>(value(row)));
  }
  columns->AddArray(array);
}

void FitReport::Fill(vtkFieldData* columns) const
{
  const auto integers = [this, columns](const char* name, auto&& value)
  { this->AddColumn<vtkIdTypeArray>(columns, name, value); };
  const auto numbers = [this, columns](const char* name, auto&& value)
  { this->AddColumn<vtkDoubleArray>(columns, name, value); };
  vtkNew<vtkStringArray> names;
  names->SetName("Attribute");
  for (const Row& row : this->Rows)
  {
    names->InsertNextValue(row.Attribute);
  }
  columns->AddArray(names);
  integers(hyperpatch::names::PatchId, [](const Row& row) { return row.PatchId; });
  integers("Components", [](const Row& row) { return row.Components; });
  integers("Samples", [](const Row& row) { return row.Error.Count; });
  integers("ControlPoints", [](const Row& row) { return row.ControlPoints; });
  numbers("RMSError", [](const Row& row) { return row.Error.RootMeanSquare; });
  numbers("MaximumError", [](const Row& row) { return row.Error.Maximum; });
  const auto relative = [](const Row& row, double error)
  { return row.Range > 0.0 ? error / row.Range : 0.0; };
  numbers("RelativeRMSError",
    [&relative](const Row& row) { return relative(row, row.Error.RootMeanSquare); });
  numbers(
    "RelativeError", [&relative](const Row& row) { return relative(row, row.Error.Maximum); });
  integers("WorstPoint", [](const Row& row) { return row.Error.Where; });
  numbers("JacobianLower", [](const Row& row) { return row.Jacobian.Low; });
  numbers("JacobianUpper", [](const Row& row) { return row.Jacobian.High; });
  integers(hyperpatch::names::InvalidElements, [](const Row& row) { return row.Invalid; });
  integers(hyperpatch::names::UndecidedElements, [](const Row& row) { return row.Undecided; });
}
