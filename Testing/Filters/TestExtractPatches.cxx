// SPDX-License-Identifier: BSD-3-Clause
#include "Models.h"
#include "NURBSConversion.h"
#include "vtkNURBSExtractPatches.h"

#include "vtkBox.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkStringArray.h"
#include "vtkThinPlateSplineTransform.h"
#include "vtkTransform.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

/// Three tubes in a row along z, 5 apart, with the ids 3, 8 and 5. 3 has an attribute of its own
/// basis; 3 and 8 share an interface; the boundaries are `wall` (3 and 5) and `end` (8).
MultiPatch Row()
{
  std::mt19937 random(7);
  const Spline tube = models::QuarterTube();
  const Spline field = models::RandomSpline(random,
    { KnotVector::Uniform(2, 4), KnotVector::Uniform(2, 4), KnotVector::Uniform(2, 3) }, 1, true);
  MultiPatch model;
  for (const int id : { 3, 8, 5 })
  {
    Eigen::MatrixXd points = tube.Coefficients();
    points.row(2).array() += 5.0 * static_cast<double>(model.Patches.size());
    const Spline moved(tube.Knots(), points, tube.Weights());
    model.Patches.push_back(
      { id, id == 3 ? Aggregate(moved, { { "Heat", field } }) : Aggregate(moved) });
  }
  model.Interfaces = { { { 3, 6, 8, 5, 0, 1, 2, 1, 1, 1 } }, { { 8, 6, 5, 5, 0, 1, 2, 1, 1, 1 } } };
  model.Boundaries = { { "wall", { { 3, 0 }, { 5, 0 }, { 5, 1 } } }, { "end", { { 8, 4 } } } };
  return model;
}

struct Extraction
{
  explicit Extraction(const MultiPatch& model)
  {
    ToVTK(model, this->Input);
    this->Filter->SetInputDataObject(this->Input);
    vtkNew<vtkCallbackCommand> errors;
    errors->SetClientData(this);
    errors->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<Extraction*>(self)->Errors.emplace_back(static_cast<const char*>(text)); });
    this->Filter->AddObserver(vtkCommand::ErrorEvent, errors);
  }

  MultiPatch Update()
  {
    this->Filter->Update();
    return FromVTK(this->Filter->GetOutputDataObject(0));
  }

  static std::vector<int> Ids(const MultiPatch& model)
  {
    std::vector<int> ids;
    for (const Patch& patch : model.Patches)
    {
      ids.push_back(patch.Id);
    }
    return ids;
  }

  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<vtkNURBSExtractPatches> Filter;
  std::vector<std::string> Errors;
};

void Choose(vtkNURBSExtractPatches* filter, const std::vector<int>& ids)
{
  filter->SetNumberOfPatchIds(static_cast<int>(ids.size()));
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    filter->SetPatchId(static_cast<int>(i), ids[i]);
  }
}

}

TEST(ExtractPatches, PatchesOfTheseIdsArePassedOnBitByBit)
{
  const MultiPatch model = Row();
  Extraction run(model);
  Choose(run.Filter, { 8, 3 });
  const MultiPatch result = run.Update();
  ASSERT_EQ(Extraction::Ids(result), (std::vector<int>{ 3, 8 }));
  for (std::size_t i = 0; i < 2; ++i)
  {
    const Spline& before = model.Patches[i].Body.Geometry();
    const Spline& after = result.Patches[i].Body.Geometry();
    EXPECT_EQ(after.Coefficients(), before.Coefficients());
    EXPECT_EQ(after.Weights(), before.Weights());
  }
  ASSERT_NE(result.Patches[0].Body.FindAttribute("Heat"), nullptr);
  EXPECT_EQ(result.Patches[0].Body.FindAttribute("Heat")->Coefficients(),
    model.Patches[0].Body.FindAttribute("Heat")->Coefficients());
  EXPECT_TRUE(run.Errors.empty());
}

TEST(ExtractPatches, TopologyIsThatAmongTheChosen)
{
  Extraction run(Row());
  Choose(run.Filter, { 3, 8 });
  const MultiPatch two = run.Update();
  ASSERT_EQ(two.Interfaces.size(), 1u);
  EXPECT_EQ(two.Interfaces[0].Values, Row().Interfaces[0].Values);
  ASSERT_EQ(two.Boundaries.size(), 2u);
  EXPECT_EQ(two.Boundaries[0].Sides, (std::vector<std::array<int, 2>>{ { 3, 0 } }));

  Choose(run.Filter, { 5 });
  const MultiPatch one = run.Update();
  EXPECT_TRUE(one.Interfaces.empty());
  ASSERT_EQ(one.Boundaries.size(), 1u);
  EXPECT_EQ(one.Boundaries[0].Name, "wall");
  EXPECT_EQ(one.Boundaries[0].Sides.size(), 2u);
}

TEST(ExtractPatches, ABoundaryChoosesThePatchesOnIt)
{
  Extraction run(Row());
  run.Filter->SetExtractBy(vtkNURBSExtractPatches::BOUNDARY);
  run.Filter->SetBoundaryName("wall");
  EXPECT_EQ(Extraction::Ids(run.Update()), (std::vector<int>{ 3, 5 }));
  run.Filter->SetBoundaryName("end");
  EXPECT_EQ(Extraction::Ids(run.Update()), (std::vector<int>{ 8 }));
}

TEST(ExtractPatches, ABoxChoosesThePatchesThatItMeets)
{
  Extraction run(Row());
  vtkNew<vtkBox> box;
  run.Filter->SetExtractBy(vtkNURBSExtractPatches::BOX);
  run.Filter->SetBox(box);
  // The second and the third tube begin at z = 5 and 10; touching is meeting.
  box->SetBounds(-1, 3, -1, 3, 4.5, 10);
  EXPECT_EQ(Extraction::Ids(run.Update()), (std::vector<int>{ 8, 5 }));
  box->SetBounds(-1, 3, -1, 3, 4.5, 9.9);
  EXPECT_EQ(Extraction::Ids(run.Update()), (std::vector<int>{ 8 }));
  box->SetBounds(50, 60, -1, 3, 0, 20);
  EXPECT_TRUE(run.Update().Patches.empty());
  EXPECT_TRUE(run.Errors.empty());
}

TEST(ExtractPatches, ATurnedBoxChoosesByItsOwnAxes)
{
  Extraction run(Row());
  // Long and thin, from the origin up and away: its bounds meet all tubes, it the first alone.
  vtkNew<vtkTransform> transform;
  transform->RotateY(-45.0);
  transform->Scale(20.0, 1.0, 0.1);
  transform->Inverse();
  vtkNew<vtkBox> box;
  box->SetBounds(0, 1, 0, 1, 0, 1);
  box->SetTransform(transform);
  run.Filter->SetExtractBy(vtkNURBSExtractPatches::BOX);
  run.Filter->SetBox(box);
  EXPECT_EQ(Extraction::Ids(run.Update()), (std::vector<int>{ 3 }));
  EXPECT_TRUE(run.Errors.empty());
}

TEST(ExtractPatches, ABoxMayBeFlat)
{
  Extraction run(Row());
  vtkNew<vtkBox> box;
  box->SetBounds(0, 1, 0, 1, 0, 1);
  run.Filter->SetExtractBy(vtkNURBSExtractPatches::BOX);
  run.Filter->SetBox(box);
  for (const double z : { 4.9, 5.0, 10.2 })
  {
    // As ParaView's box: its size is a scale, of which there is no inverse here.
    vtkNew<vtkTransform> transform;
    transform->Translate(-1.0, -1.0, z);
    transform->Scale(4.0, 4.0, 0.0);
    transform->Inverse();
    box->SetTransform(transform);
    EXPECT_EQ(Extraction::Ids(run.Update()),
      (z < 5.0      ? std::vector<int>{}
          : z < 6.0 ? std::vector<int>{ 8 }
                    : std::vector<int>{ 5 }));
  }
  EXPECT_TRUE(run.Errors.empty());
}

TEST(ExtractPatches, ABoxThatIsNoneIsAnError)
{
  Extraction run(Row());
  run.Filter->SetExtractBy(vtkNURBSExtractPatches::BOX);
  EXPECT_TRUE(run.Update().Patches.empty());
  ASSERT_EQ(run.Errors.size(), 1u);
  EXPECT_NE(run.Errors[0].find("there is no box to choose by: set Box"), std::string::npos);

  vtkNew<vtkBox> box;
  box->SetBounds(0, NAN, 0, 1, 0, 1);
  run.Filter->SetBox(box);
  EXPECT_TRUE(run.Update().Patches.empty());
  ASSERT_EQ(run.Errors.size(), 2u);
  EXPECT_NE(run.Errors[1].find("not finite"), std::string::npos);

  vtkNew<vtkThinPlateSplineTransform> bent;
  box->SetBounds(0, 1, 0, 1, 0, 1);
  box->SetTransform(bent);
  EXPECT_TRUE(run.Update().Patches.empty());
  ASSERT_EQ(run.Errors.size(), 3u);
  EXPECT_NE(run.Errors[2].find("the transform of the box is not linear"), std::string::npos);

  const double sheared[16] = { 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
  vtkNew<vtkTransform> flat;
  flat->SetMatrix(sheared);
  flat->Inverse();
  box->SetTransform(flat);
  EXPECT_TRUE(run.Update().Patches.empty());
  ASSERT_EQ(run.Errors.size(), 4u);
  EXPECT_NE(run.Errors[3].find("the edges of the box lie in a plane"), std::string::npos);
}

TEST(ExtractPatches, NamesOfBoundariesAreOfferedAsTheyAre)
{
  vtkNew<vtkNURBSExtractPatches> bare;
  EXPECT_EQ(bare->GetBoundaryNames()->GetNumberOfValues(), 0);
  Extraction run(Row());
  vtkStringArray* names = run.Filter->GetBoundaryNames();
  ASSERT_EQ(names->GetNumberOfValues(), 2);
  EXPECT_EQ(names->GetValue(0), "wall");
  EXPECT_EQ(names->GetValue(1), "end");
}

TEST(ExtractPatches, PartsOfAPatchAreChosenTogether)
{
  std::mt19937 random(9);
  const KnotVector knots = KnotVector::Uniform(2, 6);
  MultiPatch whole;
  whole.Patches.push_back(
    { 4, Aggregate(models::RandomSpline(random, { knots, knots, knots }, 3, false)) });
  MultiPatch parts = ExtractPiece(whole, 0, 2);
  const MultiPatch second = ExtractPiece(whole, 1, 2);
  parts.Patches.insert(parts.Patches.end(), second.Patches.begin(), second.Patches.end());
  ASSERT_EQ(parts.Patches.size(), 2u);
  Extraction run(parts);
  run.Filter->SetExtractBy(vtkNURBSExtractPatches::BOX);
  // The lowest point along x of a single part.
  Eigen::Index lowest = 0;
  const auto points = whole.Patches[0].Body.Geometry().Coefficients();
  points.row(0).minCoeff(&lowest);
  const Eigen::Vector3d x = points.col(lowest);
  vtkNew<vtkBox> box;
  box->SetBounds(x[0] - 1.0, x[0], x[1], x[1], x[2], x[2]);
  run.Filter->SetBox(box);
  EXPECT_EQ(run.Update().Patches.size(), parts.Patches.size());
}

TEST(ExtractPatches, WhatIsNotThereIsAnErrorThatListsWhatIs)
{
  Extraction run(Row());
  Choose(run.Filter, { 3, 4 });
  EXPECT_TRUE(run.Update().Patches.empty());
  ASSERT_EQ(run.Errors.size(), 1u);
  EXPECT_NE(run.Errors[0].find("no patch 4; there are 3, 5, 8"), std::string::npos);

  run.Filter->SetExtractBy(vtkNURBSExtractPatches::BOUNDARY);
  run.Filter->SetBoundaryName("inlet");
  EXPECT_TRUE(run.Update().Patches.empty());
  ASSERT_EQ(run.Errors.size(), 2u);
  EXPECT_NE(run.Errors[1].find("no boundary \"inlet\"; there are end, wall"), std::string::npos);

  MultiPatch bare = Row();
  bare.Boundaries.clear();
  Extraction unnamed(bare);
  unnamed.Filter->SetExtractBy(vtkNURBSExtractPatches::BOUNDARY);
  unnamed.Filter->SetBoundaryName("inlet");
  EXPECT_TRUE(unnamed.Update().Patches.empty());
  ASSERT_EQ(unnamed.Errors.size(), 1u);
  EXPECT_NE(unnamed.Errors[0].find("no named boundaries"), std::string::npos);
}

TEST(ExtractPatches, ManyIdsAreListedInShort)
{
  MultiPatch model;
  for (int id = 0; id < 100; ++id)
  {
    model.Patches.push_back({ id, Aggregate(models::QuarterTube()) });
  }
  Extraction run(model);
  Choose(run.Filter, { 100 });
  EXPECT_TRUE(run.Update().Patches.empty());
  ASSERT_EQ(run.Errors.size(), 1u);
  EXPECT_NE(run.Errors[0].find("18, 19, ... 99"), std::string::npos);
}
