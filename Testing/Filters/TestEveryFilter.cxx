// SPDX-License-Identifier: BSD-3-Clause
// What holds for every filter of the module, those to come included: the list is made by CMake.
#include "EveryFilter.h"
#include "Models.h"
#include "NURBSConversion.h"

#include "vtkAlgorithm.h"
#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <iostream>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

using Clock = std::chrono::steady_clock;

struct NamedFilter
{
  std::string Name;
  std::function<vtkSmartPointer<vtkAlgorithm>()> New;
};

std::ostream& operator<<(std::ostream& os, const NamedFilter& filter)
{
  return os << filter.Name;
}

std::vector<NamedFilter> EveryFilter()
{
  std::vector<NamedFilter> filters;
  ForEveryFilter(
    [&filters](const char* name, auto maker) {
      filters.push_back({ name, [maker] { return vtkSmartPointer<vtkAlgorithm>::Take(maker()); } });
    });
  return filters;
}

/// A dented cube with elements enough for many steps of progress, and a temperature in a basis of
/// its own. It does not fold.
MultiPatch DentedCube()
{
  constexpr int spans = 12;
  constexpr int degree = 3;
  const KnotVector knots = KnotVector::Uniform(degree, spans + degree);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> dent(-0.1 / spans, 0.1 / spans);
  const Eigen::Index n = knots.Size();
  Eigen::MatrixXd points(3, n * n * n);
  for (Eigen::Index c = 0; c < points.cols(); ++c)
  {
    const auto place = [&](Eigen::Index i)
    { return knots.Greville(static_cast<int>(i % n)) + dent(random); };
    points.col(c) << place(c), place(c / n), place(c / n / n);
  }
  const KnotVector coarse = KnotVector::Uniform(2, 5);
  const Spline temperature = models::RandomSpline(random, { coarse, coarse, coarse }, 1, false);
  MultiPatch model;
  model.Patches.push_back(
    { 0, Aggregate(Spline({ knots, knots, knots }, points), { { "Temperature", temperature } }) });
  return model;
}

/// A parabola in the plane of this y.
vtkSmartPointer<vtkPartitionedDataSetCollection> Parabola(double y)
{
  Eigen::MatrixXd points(3, 3);
  points << 1, 2, 3, y, y, y, 0, 1, 0;
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(Spline({ KnotVector::Uniform(2, 3), {}, {} }, points)) });
  auto lattice = vtkSmartPointer<vtkPartitionedDataSetCollection>::New();
  ToVTK(model, lattice);
  return lattice;
}

/// What a filter needs beyond its defaults to give something, and its input if that is no volume.
void Prepare(vtkAlgorithm* filter)
{
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Temperature");
  if (auto slice = vtkNURBSSlice::SafeDownCast(filter))
  {
    vtkNew<vtkPlane> plane;
    plane->SetOrigin(0.5, 0.5, 0.5);
    plane->SetNormal(1.0, 2.0, 3.0);
    slice->SetSliceFunction(plane);
  }
  else if (auto clip = vtkNURBSClip::SafeDownCast(filter))
  {
    vtkNew<vtkPlane> plane;
    plane->SetOrigin(0.5, 0.5, 0.5);
    plane->SetNormal(1.0, 2.0, 3.0);
    clip->SetClipFunction(plane);
  }
  else if (auto contour = vtkNURBSContour::SafeDownCast(filter))
  {
    contour->SetNumberOfContours(1);
    contour->SetValue(0, 0.0);
  }
  else if (vtkNURBSFit::SafeDownCast(filter))
  {
    // It takes samples.
    vtkNew<vtkImageData> image;
    image->SetDimensions(40, 40, 40);
    image->AllocateScalars(VTK_FLOAT, 3);
    image->GetPointData()->GetScalars()->Fill(1.0);
    filter->SetInputDataObject(image);
  }
  else if (filter->IsA("vtkNURBSExtrude") || filter->IsA("vtkNURBSRevolve") ||
    filter->IsA("vtkNURBSSweep"))
  {
    for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
    {
      filter->SetInputDataObject(port, Parabola(0.0));
    }
  }
  else if (filter->IsA("vtkNURBSLoft") || filter->IsA("vtkNURBSRule"))
  {
    filter->SetInputDataObject(Parabola(0.0));
    filter->AddInputDataObject(Parabola(1.0));
  }
  else if (filter->IsA("vtkNURBSCurveThroughPoints"))
  {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    lines->InsertNextCell(5);
    for (int i = 0; i < 5; ++i)
    {
      lines->InsertCellPoint(points->InsertNextPoint(i, i * i, 0.0));
    }
    vtkNew<vtkPolyData> line;
    line->SetPoints(points);
    line->SetLines(lines);
    filter->SetInputDataObject(line);
  }
}

/// A filter on the cube and what it reports.
class ObservedRun
{
public:
  explicit ObservedRun(const NamedFilter& named)
    : Filter(named.New())
  {
    static const MultiPatch model = DentedCube();
    ToVTK(model, this->Input);
    for (int port = 0; port < this->Filter->GetNumberOfInputPorts(); ++port)
    {
      if (!this->Filter->GetInputPortInformation(port)->Get(vtkAlgorithm::INPUT_IS_OPTIONAL()))
      {
        this->Filter->SetInputDataObject(port, this->Input);
      }
    }
    Prepare(this->Filter);
    vtkNew<vtkCallbackCommand> progress;
    progress->SetClientData(this);
    progress->SetCallback([](vtkObject*, unsigned long, void* self, void* fraction)
      { static_cast<ObservedRun*>(self)->OnProgress(*static_cast<double*>(fraction)); });
    this->Filter->AddObserver(vtkCommand::ProgressEvent, progress);
    vtkNew<vtkCallbackCommand> errors;
    errors->SetClientData(this);
    errors->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<ObservedRun*>(self)->Errors.emplace_back(static_cast<const char*>(text)); });
    this->Filter->AddObserver(vtkCommand::ErrorEvent, errors);
  }

  void Update()
  {
    this->Progress.clear();
    this->Last = Clock::now();
    this->Filter->Modified();
    this->Filter->Update();
    this->LongestSilence = std::max(this->LongestSilence, Clock::now() - this->Last);
  }

  [[nodiscard]] std::array<vtkIdType, 2> OutputSize() const
  {
    vtkDataObject* output = this->Filter->GetOutputDataObject(0);
    return { output->GetNumberOfElements(vtkDataObject::POINT),
      output->GetNumberOfElements(vtkDataObject::CELL) };
  }

  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkSmartPointer<vtkAlgorithm> Filter;
  std::vector<std::string> Errors;
  std::vector<double> Progress;
  /// The event at which the user cancels, counted from 0.
  std::size_t CancelAt = std::numeric_limits<std::size_t>::max();
  /// A user who cancels waits that long at most: Cancel is seen where progress is reported.
  Clock::duration LongestSilence{};

private:
  void OnProgress(double fraction)
  {
    const Clock::time_point now = Clock::now();
    this->LongestSilence = std::max(this->LongestSilence, now - this->Last);
    this->Last = now;
    if (this->Progress.size() == this->CancelAt)
    {
      this->Filter->SetAbortExecuteAndUpdateTime();
    }
    this->Progress.push_back(fraction);
  }

  Clock::time_point Last;
};

double Milliseconds(Clock::duration time)
{
  return std::chrono::duration<double, std::milli>(time).count();
}

class EveryFilterOfTheModule : public testing::TestWithParam<NamedFilter>
{
};

}

TEST_P(EveryFilterOfTheModule, ReportsProgressThatGrowsToOne)
{
  ObservedRun run(GetParam());
  run.Update();
  ASSERT_TRUE(run.Errors.empty()) << "Prepare() must give it what it needs: " << run.Errors[0];
  EXPECT_GT(run.OutputSize()[0], 0);
  ASSERT_FALSE(run.Progress.empty());
  EXPECT_TRUE(std::is_sorted(run.Progress.begin(), run.Progress.end()));
  EXPECT_GE(run.Progress.front(), 0.0);
  EXPECT_EQ(run.Progress.back(), 1.0);
  std::cout << run.Progress.size() << " reports, the longest silence is "
            << Milliseconds(run.LongestSilence) << " ms\n";
}

TEST_P(EveryFilterOfTheModule, StopsWithEmptyOutputWhenCancelled)
{
  ObservedRun whole(GetParam());
  whole.Update();
  const std::size_t reports = whole.Progress.size();
  if (reports < 3)
  {
    GTEST_SKIP() << "done before it can be cancelled";
  }
  for (const std::size_t at : { std::size_t{ 0 }, reports / 2 })
  {
    ObservedRun run(GetParam());
    run.CancelAt = at;
    run.Update();
    EXPECT_TRUE(run.Errors.empty()) << run.Errors[0];
    EXPECT_EQ(run.OutputSize(), (std::array<vtkIdType, 2>{ 0, 0 })) << at;
    // At most one step of work follows, and the pipeline's own report that it has ended.
    EXPECT_LE(run.Progress.size(), at + 3);

    // The next update is as if nothing had happened.
    run.CancelAt = std::numeric_limits<std::size_t>::max();
    run.Filter->SetAbortExecute(0);
    run.Update();
    EXPECT_EQ(run.OutputSize(), whole.OutputSize()) << at;
    EXPECT_EQ(run.Progress.back(), 1.0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryFilterOfTheModule, testing::ValuesIn(EveryFilter()),
  [](const testing::TestParamInfo<NamedFilter>& named) { return named.param.Name; });
