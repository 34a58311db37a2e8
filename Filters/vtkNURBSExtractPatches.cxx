// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSExtractPatches.h"

#include "Error.h"
#include "Measures.h"
#include "NURBSConversion.h"

#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkType.h"

#include <algorithm>
#include <array>
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
std::vector<double> PackBounds(const MultiPatch& model)
{
  std::vector<double> records;
  for (const Patch& patch : model.Patches)
  {
    const Eigen::MatrixXd& points = patch.Body.Geometry().Coefficients();
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

std::set<int> FindIds(const PatchBounds& patches, const std::vector<int>& ids)
{
  for (const int id : ids)
  {
    if (patches.count(id) == 0)
    {
      // Thousands of ids would hide the message; they are consecutive as a rule.
      std::string known;
      int listed = 0;
      for (auto it = patches.begin(); it != patches.end() && listed < 20; ++it, ++listed)
      {
        known += (known.empty() ? "" : ", ") + std::to_string(it->first);
      }
      if (patches.size() > 20)
      {
        known += ", ... " + std::to_string(patches.rbegin()->first);
      }
      throw Error("there is no patch " + std::to_string(id) + "; there are " + known);
    }
  }
  return { ids.begin(), ids.end() };
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

std::set<int> FindInBox(const PatchBounds& patches, const double box[6])
{
  std::set<int> ids;
  for (const auto& [id, bounds] : patches)
  {
    bool meets = true;
    for (std::size_t d = 0; d < 3; ++d)
    {
      meets = meets && bounds.Low[d] <= box[2 * d + 1] && bounds.High[d] >= box[2 * d];
    }
    if (meets)
    {
      ids.insert(id);
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
  os << indent << "Box:";
  for (const double end : this->Box)
  {
    os << " " << end;
  }
  os << "\n";
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
  const PatchBounds patches = UnpackBounds(this->AllGather(PackBounds(model)));
  const std::set<int> ids = this->ExtractBy == PATCH_IDS ? FindIds(patches, this->PatchIds)
    : this->ExtractBy == BOUNDARY                        ? this->FindBoundary(model)
                                                         : FindInBox(patches, this->Box);
  MultiPatch chosen = Restrict(model, ids);
  const std::vector<std::string> attributes =
    this->GatherNames(hyperpatch::OwnBasisAttributes(chosen));
  hyperpatch::ToVTK(
    std::move(chosen), vtkPartitionedDataSetCollection::SafeDownCast(output), attributes);
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
