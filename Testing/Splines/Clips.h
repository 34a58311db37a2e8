// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_Clips_h
#define hyperpatch_testing_Clips_h

#include "Clip.h"
#include "QuadricField.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

/// Clips of the patches of a model by fields that are made for each.
namespace models
{

using Fields = std::vector<std::shared_ptr<const hyperpatch::ScalarField>>;
using MakeFields = std::function<Fields(const hyperpatch::PreparedAggregate&)>;

inline MakeFields Inside(const std::vector<hyperpatch::Quadric>& quadrics)
{
  return [quadrics](const hyperpatch::PreparedAggregate& body)
  {
    Fields fields;
    for (const hyperpatch::Quadric& quadric : quadrics)
    {
      fields.push_back(
        std::make_shared<const hyperpatch::QuadricField>(body.Geometry(), quadric, true));
    }
    return fields;
  };
}

inline hyperpatch::Quadric Sphere(const Eigen::Vector3d& centre, double radius)
{
  return { Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), -radius * radius, centre };
}

inline hyperpatch::Quadric Plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& origin)
{
  return { Eigen::MatrixXd(), normal, 0.0, origin };
}

struct Clipped
{
  std::vector<hyperpatch::ClipMesh> Meshes;
  hyperpatch::ZeroSetCertificate Certificate;
  std::int64_t OpenFaces = 0;
};

inline Clipped ClipAll(const hyperpatch::MultiPatch& model, const MakeFields& fields,
  const hyperpatch::ClipOptions& common)
{
  std::vector<hyperpatch::ClipGroup::Member> members;
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    auto body = std::make_shared<const hyperpatch::PreparedAggregate>(patch.Body);
    hyperpatch::ClipOptions options = common;
    options.Handedness = patch.WholeHandedness < 0 ? -1 : 1;
    members.push_back({ &patch, body, fields(*body), options });
  }
  hyperpatch::ClipGroup group(members, model.Interfaces);
  EXPECT_TRUE(group.Extract());
  Clipped clipped{ {}, group.Certificate(), group.OpenFacesOnInterfaces() };
  for (std::size_t m = 0; m < members.size(); ++m)
  {
    clipped.Meshes.push_back(group.Mesh(m));
  }
  return clipped;
}

inline double SignedVolume(const hyperpatch::ClipMesh& mesh, Eigen::Index cell)
{
  const auto at = [&](Eigen::Index i) -> Eigen::Vector3d
  { return mesh.Points.col(mesh.Cells(i, cell)); };
  return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6.0;
}

inline hyperpatch::ClipOptions Coarse(double tolerance)
{
  hyperpatch::ClipOptions options;
  options.Tolerance = tolerance;
  return options;
}

}

#endif
