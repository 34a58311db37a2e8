// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_GismoTopology_h
#define hyperpatch_GismoTopology_h

#include "Aggregate.h"
#include "GismoText.h"

#include <cstddef>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

namespace hyperpatch::formats::gismo
{

/// Reads <MultiPatch> elements: how the geometries of a file touch.
class Topology
{
public:
  /// Keeps references. \param model whose patches are there; gets interfaces and boundaries
  /// \param patchOfId index of a patch by the XML id of its geometry
  Topology(const XmlText& xml, MultiPatch& model,
    const std::unordered_map<long long, std::size_t>& patchOfId)
    : Xml(xml)
    , Model(model)
    , PatchOfId(patchOfId)
  {
  }

  void Read(const pugi::xml_node& multiPatch);
  /// How many interfaces had no direction map.
  [[nodiscard]] std::size_t OldInterfaces() const { return this->Old; }

private:
  bool AppendInterfaces(const std::vector<long long>& numbers, int dimension);
  bool AppendOldInterfaces(const std::vector<long long>& numbers, int dimension);
  void AppendBoundary(const pugi::xml_node& node, int dimension);
  [[nodiscard]] const Patch* FindPatch(long long id) const;

  const XmlText& Xml;
  MultiPatch& Model;
  const std::unordered_map<long long, std::size_t>& PatchOfId;
  std::map<std::string, std::size_t> BoundaryOfName;
  std::size_t Old = 0;
};

}

#endif
