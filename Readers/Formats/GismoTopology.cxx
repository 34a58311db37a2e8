// SPDX-License-Identifier: BSD-3-Clause
#include "GismoTopology.h"

#include "Interfaces.h"
#include "Scanner.h"

#include <algorithm>
#include <array>

namespace hyperpatch::formats::gismo
{

const Patch* Topology::FindPatch(long long id) const
{
  const auto found = this->PatchOfId.find(id);
  return found == this->PatchOfId.end() ? nullptr : &this->Model.Patches[found->second];
}

void Topology::Read(const pugi::xml_node& node)
{
  int dimension = 0;
  for (const pugi::xml_node& patches : node.children("patches"))
  {
    const std::string type = patches.attribute("type").as_string("id_range");
    std::vector<long long> ids = this->Xml.Integers(patches);
    if (type == "id_range")
    {
      if (ids.size() != 2 || ids[1] < ids[0])
      {
        this->Xml.Fail(patches, "an id_range is two numbers, first and last");
      }
      if (ids[1] - ids[0] >= static_cast<long long>(this->Model.Patches.size()))
      {
        this->Xml.Fail(patches,
          "the range " + std::to_string(ids[0]) + " to " + std::to_string(ids[1]) +
            " has more patches than the file has geometries");
      }
      const long long last = ids[1];
      ids.resize(1);
      while (ids.back() < last)
      {
        ids.push_back(ids.back() + 1);
      }
    }
    else if (type != "id_index")
    {
      this->Xml.Fail(patches, "the type " + Quote(type) + " is not read: id_range or id_index");
    }
    for (const long long id : ids)
    {
      const Patch* patch = this->FindPatch(id);
      if (!patch)
      {
        this->Xml.Fail(patches, "no geometry of the file has the id " + std::to_string(id));
      }
      dimension = std::max(dimension, patch->Body.Geometry().Dimension());
    }
  }
  if (dimension == 0)
  {
    this->Xml.Fail(node, "it has no <patches>");
  }
  for (const pugi::xml_node& interfaces : node.children("interfaces"))
  {
    const std::vector<long long> numbers = this->Xml.Integers(interfaces);
    if (!this->AppendInterfaces(numbers, dimension) &&
      !this->AppendOldInterfaces(numbers, dimension))
    {
      this->Xml.Fail(interfaces,
        "the numbers are not interfaces of existing patches, " + std::to_string(4 + 2 * dimension) +
          " each (patch, side, patch, side, " + std::to_string(dimension) + " directions, " +
          std::to_string(dimension) + " orientations)");
    }
  }
  for (const pugi::xml_node& boundary : node.children("boundary"))
  {
    this->AppendBoundary(boundary, dimension);
  }
}

/// False, and nothing done, if the numbers are not interfaces with direction map and orientation.
bool Topology::AppendInterfaces(const std::vector<long long>& numbers, int dimension)
{
  const auto d = static_cast<std::size_t>(dimension);
  const std::size_t length = 4 + 2 * d;
  if (numbers.size() % length != 0)
  {
    return false;
  }
  std::vector<Interface> interfaces;
  for (auto n = numbers.begin(); n != numbers.end(); n += static_cast<std::ptrdiff_t>(length))
  {
    Interface interface {
      {
        0, 0, 0, 0, 0, 1, 2, 1, 1, 1
      }
    };
    std::array<bool, 3> mapped{};
    bool fits = this->FindPatch(n[0]) && this->FindPatch(n[2]);
    for (std::ptrdiff_t i = 0; i < 4; ++i)
    {
      fits = fits && (i % 2 == 0 || (n[i] >= 1 && n[i] <= 2 * dimension));
      interface.Values[static_cast<std::size_t>(i)] = static_cast<int>(n[i]);
    }
    for (std::size_t i = 0; fits && i < d; ++i)
    {
      const long long direction = n[static_cast<std::ptrdiff_t>(4 + i)];
      const long long same = n[static_cast<std::ptrdiff_t>(4 + d + i)];
      fits = direction < dimension && same <= 1 && !mapped[static_cast<std::size_t>(direction)];
      if (fits)
      {
        mapped[static_cast<std::size_t>(direction)] = true;
        interface.Values[4 + i] = static_cast<int>(direction);
        interface.Values[7 + i] = static_cast<int>(same);
      }
    }
    if (!fits)
    {
      return false;
    }
    interfaces.push_back(interface);
  }
  auto& all = this->Model.Interfaces;
  all.insert(all.end(), interfaces.begin(), interfaces.end());
  return true;
}

/// The form before there were direction maps: five numbers, the last an orientation that does not
/// determine the map of a volume's face. The map comes from the control points.
bool Topology::AppendOldInterfaces(const std::vector<long long>& numbers, int dimension)
{
  constexpr std::ptrdiff_t length = 5;
  const auto isSide = [&](long long patch, long long side)
  {
    const Patch* found = this->FindPatch(patch);
    return found && side >= 1 && side <= 2 * dimension &&
      found->Body.Geometry().Knots(static_cast<int>(side - 1) / 2).Degree() > 0;
  };
  if (numbers.size() % length != 0)
  {
    return false;
  }
  for (auto n = numbers.begin(); n != numbers.end(); n += length)
  {
    if (!isSide(n[0], n[1]) || !isSide(n[2], n[3]))
    {
      return false;
    }
  }
  for (auto n = numbers.begin(); n != numbers.end(); n += length)
  {
    const Patch& patch = *this->FindPatch(n[0]);
    const auto points = patch.Body.Geometry().Coefficients();
    const double diagonal = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
    const auto interface = MatchSides(patch, static_cast<int>(n[1]) - 1, *this->FindPatch(n[2]),
      static_cast<int>(n[3]) - 1, 1e-2 * diagonal);
    ++this->Old;
    if (interface)
    {
      this->Model.Interfaces.push_back(*interface);
    }
  }
  return true;
}

void Topology::AppendBoundary(const pugi::xml_node& node, int dimension)
{
  const std::vector<long long> numbers = this->Xml.Integers(node);
  if (numbers.size() % 2 != 0)
  {
    this->Xml.Fail(node,
      "a boundary is pairs of patch and side, but there are " + std::to_string(numbers.size()) +
        " numbers");
  }
  // A nameless boundary is the rest; several of them are one.
  const std::string name = node.attribute("name").as_string("boundary");
  auto& boundaries = this->Model.Boundaries;
  const auto [found, isNew] = this->BoundaryOfName.emplace(name, boundaries.size());
  if (isNew)
  {
    boundaries.push_back({ name, {} });
  }
  for (std::size_t i = 0; i < numbers.size(); i += 2)
  {
    if (!this->FindPatch(numbers[i]) || numbers[i + 1] < 1 || numbers[i + 1] > 2 * dimension)
    {
      this->Xml.Fail(node,
        "patch " + std::to_string(numbers[i]) + " with side " + std::to_string(numbers[i + 1]) +
          " does not exist");
    }
    boundaries[found->second].Sides.push_back(
      { static_cast<int>(numbers[i]), static_cast<int>(numbers[i + 1]) - 1 });
  }
}

}
