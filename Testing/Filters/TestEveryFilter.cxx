// SPDX-License-Identifier: BSD-3-Clause
// What holds for every filter of the module, those to come included: the list is made by CMake.
#include "EveryFilter.h"
#include "EveryFilterInput.h"

#include "vtkAlgorithm.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkNew.h"
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
#include <string>
#include <thread>
#include <vector>

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

/// A filter on the cube and what it reports.
class ObservedRun
{
public:
  explicit ObservedRun(const NamedFilter& named)
    : Filter(named.New())
  {
    static const EveryFilterInput input({ 12, 3, 40 });
    input.Prepare(this->Filter);
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

  vtkSmartPointer<vtkAlgorithm> Filter;
  std::vector<std::string> Errors;
  std::vector<double> Progress;
  /// The event at which another thread cancels, counted from 0.
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
      std::thread([this] { this->Filter->SetAbortExecuteAndUpdateTime(); }).join();
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
