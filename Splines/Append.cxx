// SPDX-License-Identifier: BSD-3-Clause
#include "Append.h"

#include "Error.h"
#include "Interfaces.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

bool IsPart(const Patch& patch)
{
  return patch.WholeSpans != std::array<int, 3>{ 0, 0, 0 };
}

void CheckComponents(const MultiPatch& model)
{
  std::map<std::string, int> components;
  for (const Patch& patch : model.Patches)
  {
    for (const Attribute& attribute : patch.Body.Attributes())
    {
      const auto [known, isNew] = components.emplace(attribute.Name, attribute.Field.Components());
      if (!isNew && known->second != attribute.Field.Components())
      {
        throw Error("attribute \"" + attribute.Name + "\" has " + std::to_string(known->second) +
          " components in one model and " + std::to_string(attribute.Field.Components()) +
          " in another: rename one of them");
      }
    }
  }
}

}

MultiPatch Append(const std::vector<MultiPatch>& models)
{
  MultiPatch all;
  int next = 0;
  for (const MultiPatch& model : models)
  {
    std::map<int, int> ids;
    for (const Patch& patch : model.Patches)
    {
      const auto [id, isNew] = ids.emplace(patch.Id, next);
      next += isNew ? 1 : 0;
      all.Patches.push_back(patch);
      all.Patches.back().Id = id->second;
    }
    // Topology may name patches that are not there any more.
    for (Interface item : model.Interfaces)
    {
      const auto first = ids.find(item.Values[0]);
      const auto second = ids.find(item.Values[2]);
      if (first != ids.end() && second != ids.end())
      {
        item.Values[0] = first->second;
        item.Values[2] = second->second;
        all.Interfaces.push_back(item);
      }
    }
    for (const Boundary& boundary : model.Boundaries)
    {
      auto same = std::find_if(all.Boundaries.begin(), all.Boundaries.end(),
        [&boundary](const Boundary& b) { return b.Name == boundary.Name; });
      if (same == all.Boundaries.end())
      {
        same = all.Boundaries.insert(same, { boundary.Name, {} });
      }
      for (const auto& [id, side] : boundary.Sides)
      {
        const auto found = ids.find(id);
        if (found != ids.end())
        {
          same->Sides.push_back({ found->second, side });
        }
      }
    }
  }
  CheckComponents(all);
  return all;
}

MultiPatch WithFoundInterfaces(MultiPatch model, double relativeTolerance)
{
  std::set<std::pair<int, int>> taken;
  for (const Interface& item : model.Interfaces)
  {
    taken.insert({ item.Values[0], item.Values[1] });
    taken.insert({ item.Values[2], item.Values[3] });
  }
  for (const Interface& item : FindInterfaces(model, relativeTolerance))
  {
    const std::pair<int, int> first{ item.Values[0], item.Values[1] };
    const std::pair<int, int> second{ item.Values[2], item.Values[3] };
    if (taken.count(first) == 0 && taken.count(second) == 0)
    {
      model.Interfaces.push_back(item);
    }
  }
  return model;
}

MultiPatch PartsAsPatches(MultiPatch model)
{
  if (std::none_of(model.Patches.begin(), model.Patches.end(), IsPart))
  {
    return model;
  }
  MultiPatch whole;
  for (const Patch& patch : model.Patches)
  {
    whole.Patches.push_back({ static_cast<int>(whole.Patches.size()), patch.Body });
  }
  return whole;
}

}
