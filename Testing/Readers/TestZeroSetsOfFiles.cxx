// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Interfaces.h"
#include "Measures.h"
#include "QuadricField.h"
#include "RealFiles.h"
#include "Weld.h"
#include "ZeroSetGroup.h"

#include <gtest/gtest.h>

using namespace hyperpatch;

namespace
{

struct Drawn
{
  models::Welded Surface;
  ZeroSetCertificate Certificate;
};

Drawn Draw(const MultiPatch& model, const Quadric& quadric, double tolerance)
{
  std::vector<ZeroSetGroup::Member> members;
  std::vector<std::unique_ptr<QuadricField>> fields;
  for (const Patch& patch : model.Patches)
  {
    auto body = std::make_shared<const PreparedAggregate>(patch.Body);
    fields.push_back(std::make_unique<QuadricField>(body->Geometry(), quadric, true));
    ZeroSetOptions options;
    options.Tolerance = tolerance;
    options.Handedness = Handedness(patch) < 0 ? -1 : 1;
    members.push_back({ &patch, body, fields.back().get(), 0, options });
  }
  ZeroSetGroup group(members, model.Interfaces);
  EXPECT_TRUE(group.Extract());
  std::vector<ZeroSetMesh> meshes;
  for (std::size_t m = 0; m < members.size(); ++m)
  {
    meshes.push_back(group.Mesh(m));
  }
  return { models::Weld(meshes), group.Certificate() };
}

}

TEST(ZeroSetsOfFiles, EightCubesInEveryOrientationAreCutWithoutCracks)
{
  const std::vector<std::string> files = models::RealFiles("splipy");
  if (files.empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  for (const std::string& name : files)
  {
    MultiPatch model = ReadSplineFile(name).Model;
    model.Interfaces = FindInterfaces(model, 1e-9);
    const Bounds bounds = ControlPointBounds(model);
    const Eigen::Vector3d low(bounds.Low.data());
    const Eigen::Vector3d size = Eigen::Vector3d(bounds.High.data()) - low;
    const Eigen::Vector3d middle = low + 0.5 * size;
    const double radius = 0.3 * size.minCoeff();
    const Drawn sphere = Draw(model,
      { Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), -radius * radius,
        Eigen::Vector3d(middle + 0.03 * size) },
      1e-2 * radius);
    EXPECT_EQ(sphere.Surface.Open, 0) << name;
    EXPECT_EQ(sphere.Surface.Twice, 0) << name;
    EXPECT_EQ(sphere.Surface.Euler, 2) << name;
    EXPECT_EQ(sphere.Certificate.UndecidedCells, 0) << name;
    // Through all eight, exactly through their edges, and in their faces.
    for (const Eigen::Vector3d& normal :
      { Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(0, 0, -1) })
    {
      const Drawn plane = Draw(model, { Eigen::MatrixXd(), normal, 0.0, middle }, 1e-2 * radius);
      EXPECT_EQ(plane.Surface.Euler, 1) << name << " " << normal.transpose();
      EXPECT_EQ(plane.Surface.Twice, 0) << name << " " << normal.transpose();
      EXPECT_EQ(plane.Surface.Open, plane.Certificate.OpenEdgesOnBoundary) << name;
      EXPECT_EQ(plane.Certificate.OpenEdgesInside, 0) << name << " " << normal.transpose();
      EXPECT_EQ(plane.Certificate.OpenEdgesOnInterfaces, 0) << name << " " << normal.transpose();
    }
  }
}

TEST(ZeroSetsOfFiles, MultipatchFilesAreCutWithoutCracks)
{
  int cut = 0;
  for (const char* folder : { "geopdes", "gismo", "gotools", "mfem" })
  {
    for (const std::string& name : models::RealFiles(folder))
    {
      MultiPatch model;
      try
      {
        model = ReadSplineFile(name).Model;
      }
      catch (const Error&)
      {
        continue; // a form that is not read
      }
      if (model.Patches.size() < 2 || model.Patches.size() > 40 ||
        model.Patches[0].Body.Geometry().Dimension() != 3)
      {
        continue;
      }
      if (model.Interfaces.empty())
      {
        model.Interfaces = FindInterfaces(model, 1e-9);
      }
      const Bounds bounds = ControlPointBounds(model);
      const Eigen::Vector3d low(bounds.Low.data());
      const Eigen::Vector3d size = Eigen::Vector3d(bounds.High.data()) - low;
      const Drawn plane = Draw(model,
        { Eigen::MatrixXd(), Eigen::Vector3d(0.31, 0.52, 0.79), 0.0,
          Eigen::Vector3d(low + Eigen::Vector3d(0.51, 0.47, 0.53).cwiseProduct(size)) },
        1e-2 * size.norm());
      ++cut;
      // Some files call patches joined that are far from it.
      const bool conforms = std::all_of(model.Interfaces.begin(), model.Interfaces.end(),
        [&model](const Interface& interface)
        { return models::Gap(model, interface) <= 1e-7 * models::Diagonal(model); });
      EXPECT_EQ(plane.Certificate.OpenEdgesInside, 0) << name;
      EXPECT_EQ(plane.Certificate.OpenEdgesOnInterfaces > 0, !conforms) << name;
      EXPECT_EQ(plane.Surface.Open,
        plane.Certificate.OpenEdgesOnBoundary + plane.Certificate.OpenEdgesOnInterfaces)
        << name;
    }
  }
  if (cut == 0)
  {
    GTEST_SKIP() << "no shared data";
  }
  EXPECT_GE(cut, 3);
}
