// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSAlgorithm.h"

#include "Error.h"
#include "Models.h"
#include "NURBSConversion.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <new>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

/// Runs a function in place of a filter's work.
class TestedAlgorithm : public vtkNURBSAlgorithm
{
public:
  static TestedAlgorithm* New();
  vtkTypeMacro(TestedAlgorithm, vtkNURBSAlgorithm)

  std::function<void(const MultiPatch&, vtkPolyData*)> Work;
  int Type = VTK_POLY_DATA;

  using vtkNURBSAlgorithm::AllGather;
  using vtkNURBSAlgorithm::AnyRank;
  using vtkNURBSAlgorithm::Diagonal;
  using vtkNURBSAlgorithm::GlobalMaximum;
  using vtkNURBSAlgorithm::GlobalMinimum;
  using vtkNURBSAlgorithm::KernelParallelFor;
  using vtkNURBSAlgorithm::ParallelFor;
  using vtkNURBSAlgorithm::SetProgressRange;

protected:
  int OutputType() const override { return this->Type; }
  void Execute(const MultiPatch& model, vtkDataObject* output) override
  {
    vtkNew<vtkPoints> points;
    points->InsertNextPoint(0, 0, 0);
    vtkPointSet::SafeDownCast(output)->SetPoints(points);
    if (this->Work)
    {
      this->Work(model, vtkPolyData::SafeDownCast(output));
    }
  }
};
vtkStandardNewMacro(TestedAlgorithm);

/// The algorithm on a tube, with what it says.
struct Filtering
{
  Filtering()
  {
    MultiPatch model;
    model.Patches.push_back({ 0, Aggregate(models::QuarterTube()) });
    ToVTK(model, this->Input);
    this->Algorithm->SetInputDataObject(this->Input);
    this->Observe(vtkCommand::ErrorEvent,
      [](vtkObject*, unsigned long, void* self, void* call)
      { static_cast<Filtering*>(self)->Errors.emplace_back(static_cast<const char*>(call)); });
    this->Observe(vtkCommand::ProgressEvent,
      [](vtkObject*, unsigned long, void* self, void* call)
      { static_cast<Filtering*>(self)->Progress.push_back(*static_cast<double*>(call)); });
  }

  void Observe(unsigned long event, void (*callback)(vtkObject*, unsigned long, void*, void*))
  {
    vtkNew<vtkCallbackCommand> observer;
    observer->SetClientData(this);
    observer->SetCallback(callback);
    this->Algorithm->AddObserver(event, observer);
  }

  bool Update()
  {
    this->Algorithm->Modified();
    this->Algorithm->Update();
    return this->Errors.empty();
  }

  [[nodiscard]] vtkIdType OutputPoints()
  {
    return this->Algorithm->GetOutputDataObject(0)->GetNumberOfElements(vtkDataObject::POINT);
  }

  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<TestedAlgorithm> Algorithm;
  std::vector<std::string> Errors;
  std::vector<double> Progress;
};

}

TEST(NURBSAlgorithm, HandsTheModelToTheFilter)
{
  Filtering filtering;
  filtering.Algorithm->Work = [](const MultiPatch& model, vtkPolyData*)
  {
    ASSERT_EQ(model.Patches.size(), 1u);
    EXPECT_TRUE(model.Patches[0].Body.Geometry() == models::QuarterTube());
  };
  EXPECT_TRUE(filtering.Update());
  EXPECT_EQ(filtering.OutputPoints(), 1);
}

TEST(NURBSAlgorithm, ConvertsOnlyWhenTheInputChanges)
{
  Filtering filtering;
  std::vector<const MultiPatch*> models;
  std::vector<double> firstCoordinate;
  filtering.Algorithm->Work = [&](const MultiPatch& model, vtkPolyData*)
  {
    models.push_back(&model);
    firstCoordinate.push_back(model.Patches[0].Body.Geometry().Coefficients()(0, 0));
  };
  filtering.Update();
  filtering.Update();
  EXPECT_EQ(models[0], models[1]);
  auto grid = vtkStructuredGrid::SafeDownCast(filtering.Input->GetPartition(0, 0));
  grid->GetPoints()->SetPoint(0, 0.5, 0, 0);
  grid->GetPoints()->Modified();
  filtering.Update();
  EXPECT_EQ(firstCoordinate, (std::vector<double>{ 1.0, 1.0, 0.5 }));
}

TEST(NURBSAlgorithm, EmptyInputGivesEmptyOutputWithoutAMessage)
{
  Filtering filtering;
  filtering.Algorithm->Work = [](const MultiPatch&, vtkPolyData*) { FAIL() << "called"; };
  vtkNew<vtkPartitionedDataSetCollection> empty;
  filtering.Algorithm->SetInputDataObject(empty);
  EXPECT_TRUE(filtering.Update());
  EXPECT_EQ(filtering.OutputPoints(), 0);
}

TEST(NURBSAlgorithm, BadInputGivesOneErrorAndEmptyOutput)
{
  Filtering filtering;
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(0, 0, 0);
  vtkNew<vtkStructuredGrid> grid;
  grid->SetDimensions(1, 1, 1);
  grid->SetPoints(points);
  filtering.Algorithm->SetInputDataObject(grid);
  EXPECT_FALSE(filtering.Update());
  EXPECT_NE(filtering.Errors[0].find("no control lattice"), std::string::npos)
    << filtering.Errors[0];
  EXPECT_EQ(filtering.OutputPoints(), 0);
}

TEST(NURBSAlgorithm, ErrorsOfTheKernelBecomeOneMessageAndEmptyOutput)
{
  Filtering filtering;
  filtering.Algorithm->Work = [](const MultiPatch&, vtkPolyData*) { throw Error("too thin"); };
  EXPECT_FALSE(filtering.Update());
  EXPECT_NE(filtering.Errors[0].find("too thin"), std::string::npos);
  EXPECT_EQ(filtering.OutputPoints(), 0);
}

TEST(NURBSAlgorithm, RunningOutOfMemoryIsAnError)
{
  Filtering filtering;
  filtering.Algorithm->Work = [](const MultiPatch&, vtkPolyData*) { throw std::bad_alloc(); };
  EXPECT_FALSE(filtering.Update());
  EXPECT_NE(filtering.Errors[0].find("out of memory"), std::string::npos);
  EXPECT_EQ(filtering.OutputPoints(), 0);
}

TEST(NURBSAlgorithm, ErrorsOnWorkerThreadsArriveToo)
{
  Filtering filtering;
  filtering.Algorithm->Work = [&filtering](const MultiPatch&, vtkPolyData*)
  {
    filtering.Algorithm->ParallelFor(1000, 1,
      [](vtkIdType begin, vtkIdType)
      {
        if (begin == 777)
        {
          throw Error("item 777");
        }
      });
  };
  EXPECT_FALSE(filtering.Update());
  EXPECT_NE(filtering.Errors[0].find("item 777"), std::string::npos);
}

TEST(NURBSAlgorithm, ParallelForVisitsEveryItemOnce)
{
  Filtering filtering;
  for (const vtkIdType count : { 0, 1, 7, 1000, 4321 })
  {
    for (const vtkIdType grain : { 1, 10, 5000 })
    {
      std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
      filtering.Algorithm->Work = [&](const MultiPatch&, vtkPolyData*)
      {
        filtering.Algorithm->KernelParallelFor()(count, grain,
          [&](std::ptrdiff_t begin, std::ptrdiff_t end)
          {
            EXPECT_LE(end - begin, grain);
            for (std::ptrdiff_t i = begin; i < end; ++i)
            {
              ++visits[static_cast<std::size_t>(i)];
            }
          });
      };
      EXPECT_TRUE(filtering.Update());
      for (const auto& visit : visits)
      {
        EXPECT_EQ(visit, 1);
      }
    }
  }
}

TEST(NURBSAlgorithm, UsesThreadsAndLeavesTheBackendAsItWas)
{
  if (std::getenv("VTK_SMP_BACKEND_IN_USE"))
  {
    GTEST_SKIP() << "the user has chosen a backend";
  }
  const std::string before = vtkSMPTools::GetBackend();
  std::string during;
  Filtering filtering;
  filtering.Algorithm->Work = [&during](const MultiPatch&, vtkPolyData*)
  { during = vtkSMPTools::GetBackend(); };
  filtering.Update();
  EXPECT_EQ(during, before == "Sequential" ? "STDThread" : before);
  EXPECT_EQ(vtkSMPTools::GetBackend(), before);
}

TEST(NURBSAlgorithm, ProgressOnlyGrowsAndEndsAtOne)
{
  Filtering filtering;
  filtering.Algorithm->Work = [&filtering](const MultiPatch&, vtkPolyData*)
  {
    filtering.Algorithm->SetProgressRange(0.0, 0.3);
    filtering.Algorithm->ParallelFor(1000, 1, [](vtkIdType, vtkIdType) {});
    filtering.Algorithm->SetProgressRange(0.3, 1.0);
    filtering.Algorithm->ParallelFor(5000, 1, [](vtkIdType, vtkIdType) {});
  };
  EXPECT_TRUE(filtering.Update());
  ASSERT_GT(filtering.Progress.size(), 20u);
  EXPECT_TRUE(std::is_sorted(filtering.Progress.begin(), filtering.Progress.end()));
  EXPECT_EQ(filtering.Progress.back(), 1.0);
}

TEST(NURBSAlgorithm, ACancelledRunHasEmptyOutput)
{
  Filtering filtering;
  std::atomic<int> visits{ 0 };
  filtering.Algorithm->Work = [&](const MultiPatch&, vtkPolyData*)
  {
    filtering.Algorithm->ParallelFor(100000, 1,
      [&](vtkIdType begin, vtkIdType)
      {
        ++visits;
        if (begin == 10)
        {
          filtering.Algorithm->SetAbortExecuteAndUpdateTime();
        }
      });
    FAIL() << "not left";
  };
  filtering.Update();
  EXPECT_LT(visits, 100000);
  EXPECT_EQ(filtering.OutputPoints(), 0);
  filtering.Algorithm->SetAbortExecute(0);
  filtering.Algorithm->Work = nullptr;
  EXPECT_TRUE(filtering.Update());
  EXPECT_EQ(filtering.OutputPoints(), 1);
}

TEST(NURBSAlgorithm, OutputTypeFollowsTheProperty)
{
  Filtering filtering;
  EXPECT_TRUE(filtering.Update());
  EXPECT_NE(vtkPolyData::SafeDownCast(filtering.Algorithm->GetOutputDataObject(0)), nullptr);
  filtering.Algorithm->Type = VTK_UNSTRUCTURED_GRID;
  EXPECT_TRUE(filtering.Update());
  EXPECT_NE(
    vtkUnstructuredGrid::SafeDownCast(filtering.Algorithm->GetOutputDataObject(0)), nullptr);
}

TEST(NURBSAlgorithm, DiagonalIsThatOfTheControlPoints)
{
  Filtering filtering;
  MultiPatch model;
  EXPECT_EQ(filtering.Algorithm->Diagonal(model), 0.0);
  model.Patches.push_back({ 0, Aggregate(models::QuarterTube()) });
  EXPECT_DOUBLE_EQ(filtering.Algorithm->Diagonal(model), 3.0); // 2 x 2 x 1
}

TEST(NURBSAlgorithm, OneRankReducesToItself)
{
  Filtering filtering;
  const std::vector<double> values{ 3.0, -1.0 };
  EXPECT_EQ(filtering.Algorithm->GlobalMinimum(values), values);
  EXPECT_EQ(filtering.Algorithm->GlobalMaximum(values), values);
  EXPECT_EQ(filtering.Algorithm->AllGather(values), values);
  EXPECT_TRUE(filtering.Algorithm->AnyRank(true));
  EXPECT_FALSE(filtering.Algorithm->AnyRank(false));
}
