// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSExtractPatches.h"

#include "Error.h"
#include "Measures.h"
#include "NURBSConversion.h"

#include "vtkBox.h"
#include "vtkFieldData.h"
#include "vtkLinearTransform.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkStringArray.h"
#include "vtkType.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace
{

using hyperpatch::Boundary;
using hyperpatch::Bounds;
using hyperpatch::Error;
using hyperpatch::Interface;
using hyperpatch::MultiPatch;
using hyperpatch::Patch;

/// Bounds of the control points of whole patches, by id.
using PatchBounds = std::map<int, Bounds>;

/// The parts of patches on this rank, as AllGather() takes them: id, low and high.
/// \param axes rows are the directions that bounds are in
std::vector<double> PackBounds(const MultiPatch& model, const Eigen::Matrix3d& axes)
{
  std::vector<double> records;
  for (const Patch& patch : model.Patches)
  {
    const Eigen::Matrix3Xd points = axes * patch.Body.Geometry().Coefficients();
    const Eigen::Vector3d low = points.rowwise().minCoeff();
    const Eigen::Vector3d high = points.rowwise().maxCoeff();
    records.push_back(patch.Id);
    records.insert(records.end(), low.begin(), low.end());
    records.insert(records.end(), high.begin(), high.end());
  }
  return records;
}

PatchBounds UnpackBounds(const std::vector<double>& records)
{
  PatchBounds all;
  for (auto part = records.begin(); part != records.end(); part += 7)
  {
    Bounds bounds{};
    std::copy_n(part + 1, 3, bounds.Low.begin());
    std::copy_n(part + 4, 3, bounds.High.begin());
    const auto [whole, isNew] = all.emplace(static_cast<int>(*part), bounds);
    for (std::size_t d = 0; !isNew && d < 3; ++d)
    {
      whole->second.Low[d] = std::min(whole->second.Low[d], bounds.Low[d]);
      whole->second.High[d] = std::max(whole->second.High[d], bounds.High[d]);
    }
  }
  return all;
}

/// The points whose products with the rows of Axes, which have unit length, lie between Low and
/// High.
struct Slabs
{
  Eigen::Matrix3d Axes;
  Eigen::Vector3d Low;
  Eigen::Vector3d High;
};

Slabs SlabsOf(vtkBox* box)
{
  Eigen::Matrix3d edges = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  if (box->GetTransform())
  {
    // The inverse of what is a flat box's transform into itself: its matrix is there all the same.
    auto transform = vtkLinearTransform::SafeDownCast(box->GetTransform()->GetInverse());
    if (!transform)
    {
      throw Error("the transform of the box is not linear");
    }
    const vtkMatrix4x4* matrix = transform->GetMatrix();
    for (int i = 0; i < 3; ++i)
    {
      origin[i] = matrix->GetElement(i, 3);
      for (int j = 0; j < 3; ++j)
      {
        edges(i, j) = matrix->GetElement(i, j);
      }
    }
  }
  std::array<double, 6> bounds{};
  box->GetBounds(bounds.data());
  Eigen::Vector3d low(bounds[0], bounds[2], bounds[4]);
  Eigen::Vector3d high(bounds[1], bounds[3], bounds[5]);
  if (!edges.allFinite() || !origin.allFinite() || !low.allFinite() || !high.allFinite())
  {
    throw Error("the box has parameters that are not finite numbers");
  }
  // A direction in which the transform leaves no extent becomes one across the others.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(edges, Eigen::ComputeFullU);
  int across = 2;
  for (int d = 0; d < 3; ++d)
  {
    if (edges.col(d).isZero(0.0))
    {
      edges.col(d) = svd.matrixU().col(across--);
      low[d] = high[d] = 0.0;
    }
  }
  Slabs slabs{ edges.inverse(), low, high };
  if (!slabs.Axes.allFinite())
  {
    throw Error("the edges of the box lie in a plane");
  }
  for (int d = 0; d < 3; ++d)
  {
    const double length = slabs.Axes.row(d).norm();
    slabs.Axes.row(d) /= length;
    slabs.Low[d] /= length;
    slabs.High[d] /= length;
  }
  const Eigen::Vector3d shift = slabs.Axes * origin;
  slabs.Low += shift;
  slabs.High += shift;
  return slabs;
}

/// Ids of the patches that have a side in a boundary; none if it is not there.
std::vector<double> IdsOnBoundary(const MultiPatch& model, const std::string& name)
{
  std::vector<double> ids;
  for (const Boundary& boundary : model.Boundaries)
  {
    for (const auto& [id, side] : boundary.Sides)
    {
      if (boundary.Name == name)
      {
        ids.push_back(id);
      }
    }
  }
  return ids;
}

/// The patches of these ids, with what of the topology is among them.
MultiPatch Restrict(const MultiPatch& model, const std::set<int>& ids)
{
  MultiPatch chosen;
  std::copy_if(model.Patches.begin(), model.Patches.end(), std::back_inserter(chosen.Patches),
    [&ids](const Patch& patch) { return ids.count(patch.Id) > 0; });
  std::copy_if(model.Interfaces.begin(), model.Interfaces.end(),
    std::back_inserter(chosen.Interfaces),
    [&ids](const Interface& item)
    { return ids.count(item.Values[0]) > 0 && ids.count(item.Values[2]) > 0; });
  for (const Boundary& boundary : model.Boundaries)
  {
    Boundary part{ boundary.Name, {} };
    std::copy_if(boundary.Sides.begin(), boundary.Sides.end(), std::back_inserter(part.Sides),
      [&ids](const std::array<int, 2>& side) { return ids.count(side[0]) > 0; });
    if (!part.Sides.empty())
    {
      chosen.Boundaries.push_back(std::move(part));
    }
  }
  return chosen;
}

}

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSExtractPatches);

vtkNURBSExtractPatches::vtkNURBSExtractPatches() = default;

vtkNURBSExtractPatches::~vtkNURBSExtractPatches() = default;

void vtkNURBSExtractPatches::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const char* types[] = { "Patch Ids", "Boundary", "Box" };
  os << indent << "ExtractBy: " << types[this->ExtractBy] << "\n";
  os << indent << "PatchIds:";
  for (const int id : this->PatchIds)
  {
    os << " " << id;
  }
  os << "\n" << indent << "BoundaryName: " << this->BoundaryName << "\n";
  os << indent << "BoundaryNames: " << this->BoundaryNames.Get() << "\n";
  os << indent << "Box: " << this->Box.Get() << "\n";
}

vtkMTimeType vtkNURBSExtractPatches::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->Box ? std::max(own, this->Box->GetMTime()) : own;
}

void vtkNURBSExtractPatches::SetBox(vtkBox* box)
{
  if (this->Box != box)
  {
    this->Box = box;
    this->Modified();
  }
}

vtkBox* vtkNURBSExtractPatches::GetBox()
{
  return this->Box;
}

vtkStringArray* vtkNURBSExtractPatches::GetBoundaryNames()
{
  this->BoundaryNames = vtkSmartPointer<vtkStringArray>::New();
  vtkDataObject* input =
    this->GetNumberOfInputConnections(0) ? this->GetInputDataObject(0, 0) : nullptr;
  if (input)
  {
    // The boundaries alone, without the patches.
    vtkNew<vtkPartitionedDataSetCollection> topology;
    topology->GetFieldData()->ShallowCopy(input->GetFieldData());
    try
    {
      for (const Boundary& boundary : hyperpatch::FromVTK(topology).Boundaries)
      {
        this->BoundaryNames->InsertNextValue(boundary.Name);
      }
    }
    catch (const Error&)
    {
      // Told by the update.
    }
  }
  return this->BoundaryNames;
}

void vtkNURBSExtractPatches::SetNumberOfPatchIds(int number)
{
  if (number >= 0 && number != this->GetNumberOfPatchIds())
  {
    this->PatchIds.resize(static_cast<std::size_t>(number));
    this->Modified();
  }
}

int vtkNURBSExtractPatches::GetNumberOfPatchIds()
{
  return static_cast<int>(this->PatchIds.size());
}

void vtkNURBSExtractPatches::SetPatchId(int index, int id)
{
  if (index >= 0 && index < this->GetNumberOfPatchIds() && this->GetPatchId(index) != id)
  {
    this->PatchIds[static_cast<std::size_t>(index)] = id;
    this->Modified();
  }
}

int vtkNURBSExtractPatches::GetPatchId(int index)
{
  const bool there = index >= 0 && index < this->GetNumberOfPatchIds();
  return there ? this->PatchIds[static_cast<std::size_t>(index)] : -1;
}

int vtkNURBSExtractPatches::OutputType() const
{
  return VTK_PARTITIONED_DATA_SET_COLLECTION;
}

void vtkNURBSExtractPatches::Execute(const MultiPatch& model, vtkDataObject* output)
{
  // Parts of a patch may be on several ranks, which must choose and fail alike.
  const std::set<int> ids = this->ExtractBy == PATCH_IDS ? this->FindIds(model)
    : this->ExtractBy == BOUNDARY                        ? this->FindBoundary(model)
                                                         : this->FindInBox(model);
  MultiPatch chosen = Restrict(model, ids);
  const std::vector<std::string> attributes =
    this->GatherNames(hyperpatch::OwnBasisAttributes(chosen));
  hyperpatch::ToVTK(
    std::move(chosen), vtkPartitionedDataSetCollection::SafeDownCast(output), attributes);
}

std::set<int> vtkNURBSExtractPatches::FindIds(const MultiPatch& model) const
{
  std::vector<double> own;
  for (const Patch& patch : model.Patches)
  {
    own.push_back(patch.Id);
  }
  const std::vector<double> all = this->AllGather(own);
  const std::set<int> patches(all.begin(), all.end());
  for (const int id : this->PatchIds)
  {
    if (patches.count(id) == 0)
    {
      // Thousands of ids would hide the message; they are consecutive as a rule.
      std::string known;
      int listed = 0;
      for (auto it = patches.begin(); it != patches.end() && listed < 20; ++it, ++listed)
      {
        known += (known.empty() ? "" : ", ") + std::to_string(*it);
      }
      if (patches.size() > 20)
      {
        known += ", ... " + std::to_string(*patches.rbegin());
      }
      throw Error("there is no patch " + std::to_string(id) + "; there are " + known);
    }
  }
  return { this->PatchIds.begin(), this->PatchIds.end() };
}

std::set<int> vtkNURBSExtractPatches::FindInBox(const MultiPatch& model) const
{
  if (!this->Box)
  {
    throw Error("there is no box to choose by: set Box");
  }
  const Slabs slabs = SlabsOf(this->Box);
  std::set<int> ids;
  for (const auto& [id, bounds] : UnpackBounds(this->AllGather(PackBounds(model, slabs.Axes))))
  {
    bool meets = true;
    for (int d = 0; d < 3; ++d)
    {
      const double low = bounds.Low[static_cast<std::size_t>(d)];
      const double high = bounds.High[static_cast<std::size_t>(d)];
      // To touch is to meet, though the axes of the box are rounded.
      const double slack = 1e-12 *
        std::max(
          { std::abs(low), std::abs(high), std::abs(slabs.Low[d]), std::abs(slabs.High[d]) });
      meets = meets && low <= slabs.High[d] + slack && high >= slabs.Low[d] - slack;
    }
    if (meets)
    {
      ids.insert(id);
    }
  }
  return ids;
}

std::set<int> vtkNURBSExtractPatches::FindBoundary(const MultiPatch& model) const
{
  std::vector<std::string> names;
  for (const Boundary& boundary : model.Boundaries)
  {
    names.push_back(boundary.Name);
  }
  names = this->GatherNames(names);
  if (std::find(names.begin(), names.end(), this->BoundaryName) == names.end())
  {
    std::string known;
    for (const std::string& name : names)
    {
      known += (known.empty() ? "there are " : ", ") + name;
    }
    throw Error("there is no boundary \"" + this->BoundaryName + "\"; " +
      (known.empty() ? "the model has no named boundaries" : known));
  }
  const std::vector<double> ids = this->AllGather(IdsOnBoundary(model, this->BoundaryName));
  std::set<int> all;
  for (const double id : ids)
  {
    all.insert(static_cast<int>(id));
  }
  return all;
}

std::vector<std::string> vtkNURBSExtractPatches::GatherNames(
  const std::vector<std::string>& names) const
{
  // Characters as numbers; no name holds a 0.
  std::vector<double> characters;
  for (const std::string& name : names)
  {
    characters.insert(characters.end(), name.begin(), name.end());
    characters.push_back(0.0);
  }
  std::set<std::string> all;
  std::string name;
  for (const double character : this->AllGather(characters))
  {
    if (character != 0.0)
    {
      name.push_back(static_cast<char>(character));
    }
    else
    {
      all.insert(std::move(name));
      name.clear();
    }
  }
  return { all.begin(), all.end() };
}

VTK_ABI_NAMESPACE_END
