// SPDX-License-Identifier: BSD-3-Clause
#ifndef FilterRun_h
#define FilterRun_h

#include "Models.h"
#include "NURBSConversion.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPolyData.h"

#include <random>
#include <string>
#include <vector>

/// A quarter tube with a scalar of its own rational basis and a vector in the geometry's basis, and
/// a second one beside it that has neither.
inline hyperpatch::MultiPatch TwoTubes()
{
  std::mt19937 random(5);
  const hyperpatch::Spline tube = models::QuarterTube();
  const hyperpatch::KnotVector u(3, { 0, 0, 0, 0, 0.4, 0.4, 1, 1, 1, 1 });
  const hyperpatch::Spline temperature = models::RandomSpline(random,
    { u, hyperpatch::KnotVector::Uniform(2, 4), hyperpatch::KnotVector::Uniform(2, 3) }, 1, true);
  const hyperpatch::Spline velocity(tube.Knots(), 2.0 * tube.Coefficients(), tube.Weights());
  Eigen::MatrixXd moved = tube.Coefficients();
  moved.row(2).array() += 5.0;
  hyperpatch::MultiPatch model;
  model.Patches.push_back({ 3,
    hyperpatch::Aggregate(tube, { { "Temperature", temperature }, { "Velocity", velocity } }) });
  model.Patches.push_back(
    { 8, hyperpatch::Aggregate(hyperpatch::Spline(tube.Knots(), moved, tube.Weights())) });
  return model;
}

inline hyperpatch::MultiPatch Alone(const hyperpatch::Spline& geometry)
{
  hyperpatch::MultiPatch model;
  model.Patches.push_back({ 0, hyperpatch::Aggregate(geometry) });
  return model;
}

/// Runs a filter on a model and keeps what it says.
template <typename Filter>
struct FilterRun
{
  explicit FilterRun(const hyperpatch::MultiPatch& model)
  {
    hyperpatch::ToVTK(model, this->Input);
    this->F->SetInputDataObject(this->Input);
    vtkNew<vtkCallbackCommand> errors;
    errors->SetClientData(this);
    errors->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<FilterRun*>(self)->Errors.emplace_back(static_cast<const char*>(text)); });
    this->F->AddObserver(vtkCommand::ErrorEvent, errors);
    vtkNew<vtkCallbackCommand> warnings;
    warnings->SetClientData(this);
    warnings->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<FilterRun*>(self)->Warnings.emplace_back(static_cast<const char*>(text)); });
    this->F->AddObserver(vtkCommand::WarningEvent, warnings);
  }

  vtkPolyData* Update()
  {
    this->F->Update();
    return vtkPolyData::SafeDownCast(this->F->GetOutputDataObject(0));
  }

  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<Filter> F;
  std::vector<std::string> Errors;
  std::vector<std::string> Warnings;
};

inline double FieldNumber(vtkDataObject* data, const char* name)
{
  return data->GetFieldData()->GetArray(name)->GetTuple1(0);
}

#endif
