// SPDX-License-Identifier: BSD-3-Clause
#include "vtkBSplineReader.h"

#include "Error.h"
#include "Measures.h"
#include "Models.h"
#include "NURBSConversion.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkXMLPartitionedDataSetCollectionWriter.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>

#include <unistd.h>

using namespace hyperpatch;

namespace
{

const std::string DataFolder = HYPERPATCH_DATA;

/// A folder of this test's own, gone at the end.
class TemporaryFolder
{
public:
  TemporaryFolder()
  {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    this->Path = std::filesystem::temp_directory_path() /
      (std::string("hyperpatch-") + test->name() + "-" + std::to_string(getpid()));
    std::filesystem::create_directories(this->Path);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(this->Path); }

  [[nodiscard]] std::string File(const std::string& name) const
  {
    return (this->Path / name).string();
  }

private:
  std::filesystem::path Path;
};

/// A reader that keeps its errors and warnings.
struct ReaderRun
{
  explicit ReaderRun(const std::string& fileName)
  {
    this->Observe(vtkCommand::ErrorEvent, this->Errors);
    this->Observe(vtkCommand::WarningEvent, this->Warnings);
    this->Reader->SetFileName(fileName.c_str());
    this->Reader->Update();
  }

  [[nodiscard]] MultiPatch Model() const { return FromVTK(this->Reader->GetOutput()); }

  void Observe(unsigned long event, std::vector<std::string>& messages)
  {
    vtkNew<vtkCallbackCommand> observer;
    observer->SetClientData(&messages);
    observer->SetCallback(
      [](vtkObject*, unsigned long, void* client, void* call) {
        static_cast<std::vector<std::string>*>(client)->emplace_back(
          static_cast<const char*>(call));
      });
    this->Reader->AddObserver(event, observer);
  }

  std::vector<std::string> Errors;
  std::vector<std::string> Warnings;
  vtkNew<vtkBSplineReader> Reader;
};

void Write(const MultiPatch& model, const std::string& fileName)
{
  vtkNew<vtkPartitionedDataSetCollection> collection;
  ToVTK(model, collection);
  vtkNew<vtkXMLPartitionedDataSetCollectionWriter> writer;
  writer->SetInputDataObject(collection);
  writer->SetFileName(fileName.c_str());
  writer->SetDataModeToBinary();
  ASSERT_TRUE(writer->Write());
}

MultiPatch PipeBend()
{
  return ReaderRun(DataFolder + "/heated_pipe_bend.vtpc").Model();
}

}

TEST(BSplineReader, ReadsTheSamples)
{
  for (const char* name : { "heated_pipe_bend.vtpc", "folded_sweep.xml", "tube_on_block.xml",
         "quarter_tube.g2", "twisted_bar.mesh" })
  {
    const std::string file = DataFolder + "/" + name;
    EXPECT_EQ(vtkBSplineReader::CanReadFile(file.c_str()), 1) << file;
    const ReaderRun run(file);
    EXPECT_TRUE(run.Errors.empty()) << run.Errors.front();
    EXPECT_TRUE(run.Warnings.empty()) << run.Warnings.front();
    for (const Patch& patch : run.Model().Patches)
    {
      EXPECT_EQ(Handedness(patch.Body.Geometry()), file.find("folded") == std::string::npos ? 1 : 0)
        << file;
    }
  }
}

TEST(BSplineReader, SamplesAreWhatTheyShow)
{
  const Spline sweep =
    ReaderRun(DataFolder + "/folded_sweep.xml").Model().Patches[0].Body.Geometry();
  EXPECT_TRUE(sweep == models::SweptHalfCylinder());
  // Printed with 17 digits: the g2 file differs by the products with the weights.
  const Spline tube = ReaderRun(DataFolder + "/quarter_tube.g2").Model().Patches[0].Body.Geometry();
  EXPECT_LE((tube.Coefficients() - models::QuarterTube().Coefficients()).norm(), 1e-15 * 12);
}

TEST(BSplineReader, PipeBendIsAnExactTorusWithAFieldOfItsOwnBasis)
{
  const MultiPatch model = PipeBend();
  ASSERT_EQ(model.Patches.size(), 1u);
  const Aggregate& pipe = model.Patches[0].Body;
  const Spline* temperature = pipe.FindAttribute("Temperature");
  ASSERT_NE(temperature, nullptr);
  EXPECT_EQ(temperature->Degrees(), (std::array<int, 3>{ 3, 3, 3 }));
  EXPECT_NE(pipe.FindAttribute("Displacement"), nullptr);
  for (const double v : { 0.0, 0.13, 0.5, 0.77 })
  {
    for (const double w : { 0.0, 0.31, 0.5, 1.0 })
    {
      for (const double u : { 0.0, 1.0 })
      {
        const Eigen::Vector3d x = pipe.Geometry().Evaluate(u, v, w);
        const double radius = std::hypot(std::hypot(x[0], x[1]) - 2.0, x[2]);
        EXPECT_NEAR(radius, u == 0.0 ? 0.6 : 1.0, 1e-14);
      }
    }
  }
}

TEST(BSplineReader, WrittenCollectionsComeBackBitByBit)
{
  const TemporaryFolder folder;
  std::mt19937 random(1);
  MultiPatch model = PipeBend();
  model.Patches.push_back({ 3, Aggregate(models::QuarterTube()) });
  model.Interfaces = { { { 0, 3, 0, 4, 0, 1, 2, 1, 1, 1 } } };
  model.Boundaries = { { "inlet", { { 0, 4 } } } };
  Write(model, folder.File("model.vtpc"));
  EXPECT_EQ(vtkBSplineReader::CanReadFile(folder.File("model.vtpc").c_str()), 1);
  const MultiPatch back = ReaderRun(folder.File("model.vtpc")).Model();
  ASSERT_EQ(back.Patches.size(), 2u);
  for (std::size_t p = 0; p < 2; ++p)
  {
    EXPECT_EQ(back.Patches[p].Id, model.Patches[p].Id);
    EXPECT_TRUE(back.Patches[p].Body.Geometry() == model.Patches[p].Body.Geometry());
    for (const Attribute& attribute : model.Patches[p].Body.Attributes())
    {
      const Spline* other = back.Patches[p].Body.FindAttribute(attribute.Name);
      ASSERT_NE(other, nullptr);
      EXPECT_TRUE(*other == attribute.Field);
    }
  }
}

TEST(BSplineReader, FindsInterfacesThatTheFileDoesNotName)
{
  // The pipe is closed: its sides v = first and v = last are one.
  const MultiPatch model = PipeBend();
  ASSERT_EQ(model.Interfaces.size(), 1u);
  EXPECT_EQ(model.Interfaces[0].Values, (std::array<int, 10>{ 0, 3, 0, 4, 0, 1, 2, 1, 1, 1 }));
}

TEST(BSplineReader, KeepsInterfacesOfTheFile)
{
  const MultiPatch model = ReaderRun(DataFolder + "/tube_on_block.xml").Model();
  ASSERT_EQ(model.Interfaces.size(), 1u);
  EXPECT_EQ(model.Interfaces[0].Values, (std::array<int, 10>{ 0, 3, 1, 4, 0, 1, 2, 1, 1, 1 }));
}

TEST(BSplineReader, GivesThePieceThatIsAskedFor)
{
  int elements = 0;
  for (int piece = 0; piece < 3; ++piece)
  {
    vtkNew<vtkBSplineReader> reader;
    reader->SetFileName((DataFolder + "/heated_pipe_bend.vtpc").c_str());
    reader->UpdatePiece(piece, 3, 0);
    EXPECT_EQ(reader->GetOutput()->GetNumberOfPartitionedDataSets(), 2u);
    for (const Patch& patch : FromVTK(reader->GetOutput()).Patches)
    {
      const auto& knots = patch.Body.Geometry().Knots();
      elements += static_cast<int>(
        knots[0].Spans().size() * knots[1].Spans().size() * knots[2].Spans().size());
      EXPECT_EQ(patch.WholeSpans, (std::array<int, 3>{ 1, 4, 3 }));
    }
  }
  EXPECT_EQ(elements, 12);
}

TEST(BSplineReader, ClaimsNoForeignFiles)
{
  const TemporaryFolder folder;
  const auto can = [&folder](const std::string& name, const std::string& text)
  {
    std::ofstream(folder.File(name)) << text;
    return vtkBSplineReader::CanReadFile(folder.File(name).c_str());
  };
  EXPECT_EQ(can("empty.xml", ""), 0);
  EXPECT_EQ(can("other.xml", "<?xml version=\"1.0\"?>\n<note>hello</note>\n"), 0);
  EXPECT_EQ(can("other.txt", "1 2 3\n4 5 6\n"), 0);
  EXPECT_EQ(can("other.vtpc",
              "<VTKFile type=\"vtkPartitionedDataSetCollection\">\n<DataSet file=\"a.vts\"/>"),
    0);
  EXPECT_EQ(vtkBSplineReader::CanReadFile(folder.File("missing.xml").c_str()), 0);
  EXPECT_EQ(vtkBSplineReader::CanReadFile(nullptr), 0);
}

TEST(BSplineReader, FailsWithOneErrorAndEmptyOutput)
{
  const TemporaryFolder folder;
  std::ofstream(folder.File("short.g2")) << "700 1 0 0\n3 0\n2 2\n0 0 1 1\n";
  std::ofstream(folder.File("broken.vtpc"))
    << "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkPartitionedDataSetCollection\" "
       "version=\"1.0\"><vtkPartitionedDataSetCollection>";
  Write(PipeBend(), folder.File("cut.vtpc"));
  const std::string grid = folder.File("cut/cut_0_0.vts");
  ASSERT_TRUE(std::filesystem::exists(grid));
  std::filesystem::resize_file(grid, std::filesystem::file_size(grid) / 2);
  for (const char* name : { "missing.g2", "short.g2", "broken.vtpc", "cut.vtpc" })
  {
    const std::string file = folder.File(name);
    ReaderRun run(file);
    ASSERT_EQ(run.Errors.size(), 1u) << name;
    EXPECT_NE(run.Errors[0].find(file), std::string::npos) << run.Errors[0];
    EXPECT_EQ(run.Reader->GetOutput()->GetNumberOfPartitionedDataSets(), 0u);
  }
}

TEST(BSplineReader, ReadsAFileAgainWhenItHasChanged)
{
  const TemporaryFolder folder;
  const std::string file = folder.File("model.g2");
  std::filesystem::copy_file(DataFolder + "/quarter_tube.g2", file);
  ReaderRun run(file);
  EXPECT_EQ(run.Model().Patches.size(), 1u);
  {
    std::ifstream original(DataFolder + "/quarter_tube.g2");
    std::ofstream(file, std::ios::app) << original.rdbuf();
  }
  run.Reader->Modified();
  run.Reader->Update();
  EXPECT_EQ(run.Model().Patches.size(), 2u);
}

TEST(BSplineReader, ReadsFilesOfOtherProjects)
{
  if (!std::filesystem::exists(HYPERPATCH_SHARED_DATA))
  {
    GTEST_SKIP() << "no shared data";
  }
  int files = 0;
  for (const char* folder : { "gismo", "gotools", "mfem" })
  {
    for (const auto& entry :
      std::filesystem::directory_iterator(std::string(HYPERPATCH_SHARED_DATA) + "/" + folder))
    {
      const std::string file = entry.path().string();
      if (!vtkBSplineReader::CanReadFile(file.c_str()))
      {
        continue;
      }
      ++files;
      const ReaderRun run(file);
      if (!run.Errors.empty())
      {
        // What is recognised and not supported is refused by name.
        EXPECT_NE(run.Errors[0].find(file), std::string::npos) << run.Errors[0];
        std::cout << run.Errors[0];
        continue;
      }
      EXPECT_FALSE(run.Model().Patches.empty()) << file;
    }
  }
  EXPECT_GT(files, 15);
}
