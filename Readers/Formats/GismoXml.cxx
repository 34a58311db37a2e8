// SPDX-License-Identifier: BSD-3-Clause
#include "GismoText.h"
#include "GismoTopology.h"
#include "HierarchicalSpline.h"
#include "Scanner.h"

#include <pugixml.hpp>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

// G+Smo XML: <Geometry> elements with a tensor-product basis and Cartesian control points, and
// <MultiPatch> elements that say how geometries touch. Patch numbers in a MultiPatch are the XML
// ids of the geometries.

namespace hyperpatch
{

namespace
{

using namespace formats;
using gismo::Topology;
using gismo::XmlText;

constexpr long long MaxInt = std::numeric_limits<int>::max();

/// Kinds of geometry: parameters and whether they have weights; 0 parameters for all other kinds.
struct Kind
{
  int Dimension = 0;
  bool Rational = false;
  bool Hierarchical = false;
  bool Truncated = false;
};

Kind KindOf(std::string_view type)
{
  for (const std::string_view name : { "HBSpline", "THBSpline" })
  {
    if (type.size() == name.size() + 1 && type.substr(0, name.size()) == name &&
      type.back() >= '1' && type.back() <= '3')
    {
      return { type.back() - '0', false, true, name[0] == 'T' };
    }
  }
  const bool tensor = type.substr(0, 6) == "Tensor";
  std::string_view rest = tensor ? type.substr(6) : type;
  for (const std::string_view name : { "BSpline", "Nurbs" })
  {
    if (rest.substr(0, name.size()) == name)
    {
      rest.remove_prefix(name.size());
      const bool isDigit = rest.size() == 1 && rest[0] >= '1' && rest[0] <= '3';
      if (rest.empty() || isDigit)
      {
        return { isDigit ? rest[0] - '0' : 1, name == "Nurbs", false, false };
      }
    }
  }
  return {};
}

class XmlParser
{
public:
  explicit XmlParser(std::string_view text)
    : Xml(text)
  {
  }
  FileContents Parse();

private:
  struct Entry
  {
    pugi::xml_node Node;
    std::optional<long long> Id;
    Kind Type;
  };

  void ReadGeometry(const Entry& entry, int id);
  std::array<KnotVector, 3> ReadBasis(
    const pugi::xml_node& geometry, const pugi::xml_node& basis, int dimension);
  std::vector<HierarchicalBox> ReadBoxes(const pugi::xml_node& basis, int dimension);
  KnotVector ReadKnots(const pugi::xml_node& basis, int direction);

  XmlText Xml;
  FileContents Contents;
  std::unordered_map<long long, std::size_t> PatchOfId;
  std::size_t Hierarchical = 0;
};

FileContents XmlParser::Parse()
{
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(
    this->Xml.Source().data(), this->Xml.Source().size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
  {
    throw Error("line " + std::to_string(this->Xml.LineAt(result.offset)) +
      ": not well-formed XML (" + result.description() + "): the file is damaged or cut short");
  }
  const pugi::xml_node root = document.child("xml");
  if (!root)
  {
    throw Error("the file has no element <xml>: it is not a G+Smo file");
  }

  std::vector<Entry> entries;
  std::vector<pugi::xml_node> multiPatches;
  std::map<std::string, std::size_t> skipped;
  for (const pugi::xml_node& node : root.children())
  {
    const std::string name = node.name();
    if (node.type() != pugi::node_element)
    {
      continue;
    }
    if (name == "MultiPatch")
    {
      multiPatches.push_back(node);
      continue;
    }
    if (name != "Geometry")
    {
      ++skipped["<" + XmlText::Printable(name) + ">"];
      continue;
    }
    const std::string type = node.attribute("type").value();
    const Kind kind = KindOf(type);
    if (kind.Dimension == 0)
    {
      ++skipped["<Geometry type=" + Quote(type) + ">"];
      continue;
    }
    Entry entry{ node, std::nullopt, kind };
    if (node.attribute("id"))
    {
      entry.Id = this->Xml.Integer(node, "id", "the id", MaxInt);
    }
    entries.push_back(entry);
  }

  std::string list;
  std::size_t total = 0;
  for (const auto& [name, count] : skipped)
  {
    list += (list.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    total += count;
  }
  if (entries.empty())
  {
    throw Error("the file holds no tensor-product spline geometry" +
      (list.empty() ? std::string() : ", only " + list) +
      ": export TensorBSpline or TensorNurbs geometries");
  }

  std::set<long long> used;
  bool repeated = false;
  for (const Entry& entry : entries)
  {
    repeated = repeated || (entry.Id && !used.insert(*entry.Id).second);
  }
  int next = 0;
  for (const Entry& entry : entries)
  {
    if (repeated || !entry.Id)
    {
      while (!repeated && used.count(next) > 0)
      {
        ++next;
      }
      this->ReadGeometry(entry, next++);
    }
    else
    {
      this->ReadGeometry(entry, static_cast<int>(*entry.Id));
    }
  }

  if (total > 0)
  {
    this->Contents.Warnings.push_back(
      Counted(total, "element") + " skipped that are no splines: " + list + ".");
  }
  if (repeated)
  {
    this->Contents.Warnings.push_back(
      std::string("Several geometries have the same id: patches are numbered from 0 in the order "
                  "of the file") +
      (multiPatches.empty() ? "."
                            : ", and interfaces and boundaries are left out because their patch "
                              "numbers are ambiguous."));
  }
  if (this->Hierarchical > 0)
  {
    this->Contents.Warnings.push_back(Counted(this->Hierarchical, "hierarchical spline") +
      " read as the same tensor-product spline on its finest level.");
  }
  Topology topology(this->Xml, this->Contents.Model, this->PatchOfId);
  for (const pugi::xml_node& node : multiPatches)
  {
    if (!repeated)
    {
      topology.Read(node);
    }
  }
  if (topology.OldInterfaces() > 0)
  {
    this->Contents.Warnings.push_back(Counted(topology.OldInterfaces(), "interface") +
      " without direction map (an old form of the file): it was taken from control points that "
      "coincide to 1% of the patch; where they do not, the interface is left out.");
  }
  WarnOfFields(this->Contents);
  return std::move(this->Contents);
}

KnotVector XmlParser::ReadKnots(const pugi::xml_node& basis, int direction)
{
  const pugi::xml_node node = basis.child("KnotVector");
  if (!node)
  {
    this->Xml.Fail(basis, std::string("direction ") + "uvw"[direction] + " has no <KnotVector>");
  }
  if (!node.attribute("degree"))
  {
    this->Xml.Fail(node, "the attribute degree is missing");
  }
  const auto degree = static_cast<int>(this->Xml.Integer(node, "degree", "the degree", MaxDegree));
  std::vector<double> knots = this->Xml.Numbers(node);
  return WithContext([&] { return this->Xml.Where(node) + ", direction " + "uvw"[direction]; },
    [&] { return KnotVector(degree, std::move(knots)); });
}

std::array<KnotVector, 3> XmlParser::ReadBasis(
  const pugi::xml_node& geometry, const pugi::xml_node& basis, int dimension)
{
  std::array<KnotVector, 3> knots;
  int directions = 0;
  if (basis.child("KnotVector"))
  {
    knots[0] = this->ReadKnots(basis, 0);
    directions = 1;
  }
  else
  {
    std::array<bool, 3> seen{};
    for (const pugi::xml_node& child : basis.children("Basis"))
    {
      const int index = child.attribute("index").as_int(directions);
      if (index < 0 || index >= dimension || seen[static_cast<std::size_t>(index)])
      {
        this->Xml.Fail(child,
          "its index " + std::to_string(index) + " is repeated or not in 0.." +
            std::to_string(dimension - 1));
      }
      knots[static_cast<std::size_t>(index)] = this->ReadKnots(child, index);
      seen[static_cast<std::size_t>(index)] = true;
      ++directions;
    }
  }
  if (directions != dimension)
  {
    this->Xml.Fail(geometry,
      "its basis has " + std::to_string(directions) + " knot vectors where " +
        std::to_string(dimension) + " are needed");
  }
  return knots;
}

std::vector<HierarchicalBox> XmlParser::ReadBoxes(const pugi::xml_node& basis, int dimension)
{
  std::vector<HierarchicalBox> boxes;
  for (const pugi::xml_node& node : basis.children("box"))
  {
    const std::vector<long long> numbers = this->Xml.Integers(node);
    const auto d = static_cast<std::size_t>(dimension);
    if (numbers.size() != 2 * d)
    {
      this->Xml.Fail(node,
        "a box is " + std::to_string(2 * d) + " numbers, first and last knots, but there are " +
          std::to_string(numbers.size()));
    }
    HierarchicalBox box{ static_cast<int>(this->Xml.Integer(node, "level", "the level", 30)),
      { 0, 0, 0 }, { 1, 1, 1 } };
    for (std::size_t i = 0; i < d; ++i)
    {
      box.Begin[i] = static_cast<int>(numbers[i]);
      box.End[i] = static_cast<int>(numbers[d + i]);
    }
    boxes.push_back(box);
  }
  return boxes;
}

void XmlParser::ReadGeometry(const Entry& entry, int id)
{
  const pugi::xml_node& geometry = entry.Node;
  pugi::xml_node basis = geometry.child("Basis");
  Eigen::VectorXd weights;
  if (!basis)
  {
    this->Xml.Fail(geometry, "it has no <Basis>");
  }
  if (entry.Type.Rational)
  {
    const pugi::xml_node node = basis.child("weights");
    if (!node)
    {
      this->Xml.Fail(geometry, "it is rational but its basis has no <weights>");
    }
    const std::vector<double> values = this->Xml.Numbers(node);
    weights =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    if (values.empty())
    {
      this->Xml.Fail(node, "it is empty: a rational spline has one weight per control point");
    }
    if (basis.child("Basis"))
    {
      basis = basis.child("Basis");
    }
  }
  std::vector<HierarchicalBox> boxes;
  if (entry.Type.Hierarchical)
  {
    boxes = this->ReadBoxes(basis, entry.Type.Dimension);
    basis = basis.child("Basis");
    if (!basis)
    {
      this->Xml.Fail(geometry, "its hierarchical basis has no <Basis> of level 0");
    }
  }
  std::array<KnotVector, 3> knots = this->ReadBasis(geometry, basis, entry.Type.Dimension);

  const pugi::xml_node coefs = geometry.child("coefs");
  if (!coefs)
  {
    this->Xml.Fail(geometry, "it has no <coefs>");
  }
  const std::vector<double> values = this->Xml.Numbers(coefs);
  const auto available = static_cast<long long>(values.size());
  if (entry.Type.Hierarchical)
  {
    const long long coordinates = coefs.attribute("geoDim").as_int(3);
    if (coordinates < 1 || coordinates > 3 || available % coordinates != 0)
    {
      this->Xml.Fail(coefs,
        std::to_string(available) + " numbers do not make control points of " +
          std::to_string(coordinates) + " coordinates: correct the attribute geoDim");
    }
    WithContext([&] { return this->Xml.Where(geometry); },
      [&]
      {
        AppendPatch(this->Contents, id,
          FlattenHierarchicalSpline(knots, boxes,
            Eigen::Map<const Eigen::MatrixXd>(values.data(), coordinates, available / coordinates),
            entry.Type.Truncated));
      });
    this->PatchOfId.emplace(id, this->Contents.Model.Patches.size() - 1);
    ++this->Hierarchical;
    return;
  }
  long long count = 1;
  for (const KnotVector& k : knots)
  {
    // Stays a product of two numbers below the file size: no overflow.
    count *= k.Size();
    if (count > available)
    {
      break;
    }
  }
  const long long coordinates = coefs.attribute("geoDim").as_int(
    static_cast<int>(std::clamp<long long>(available / count, 1, 3)));
  if (coordinates < 1 || count > available || available % count != 0 ||
    available / count != coordinates)
  {
    this->Xml.Fail(coefs,
      std::to_string(available) + " numbers do not make " + std::to_string(knots[0].Size()) +
        " x " + std::to_string(knots[1].Size()) + " x " + std::to_string(knots[2].Size()) +
        " control points of " + std::to_string(coordinates) +
        " coordinates: the attribute geoDim or the knots do not fit, or numbers are missing");
  }
  WithContext([&] { return this->Xml.Where(geometry); },
    [&]
    {
      AppendPatch(this->Contents, id,
        Spline(std::move(knots),
          Eigen::Map<const Eigen::MatrixXd>(values.data(), coordinates, count), weights));
    });
  this->PatchOfId.emplace(id, this->Contents.Model.Patches.size() - 1);
}

}

FileContents ParseGismoXml(std::string_view text)
{
  return XmlParser(text).Parse();
}

}
