// SPDX-License-Identifier: BSD-3-Clause
#include "HierarchicalSpline.h"
#include "Interfaces.h"
#include "Scanner.h"

#include <pugixml.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
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

/// \throws Error if a character is not of the alphabet or bytes are missing from a number
std::vector<double> DecodeBase64(std::string_view text)
{
  static_assert(sizeof(double) == 8);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t buffer = 0;
  int bits = 0;
  for (const char c : text)
  {
    const int value = c >= 'A' && c <= 'Z' ? c - 'A'
      : c >= 'a' && c <= 'z'               ? c - 'a' + 26
      : c >= '0' && c <= '9'               ? c - '0' + 52
      : c == '+'                           ? 62
      : c == '/'                           ? 63
                                           : -1;
    if (value < 0)
    {
      if (c == '=' || c == ' ' || (c >= '\t' && c <= '\r'))
      {
        continue;
      }
      throw Error("the base64 text has the character " + Quote(std::string_view(&c, 1)));
    }
    buffer = (buffer << 6 | static_cast<std::uint32_t>(value)) & 0xffffff;
    bits += 6;
    if (bits >= 8)
    {
      bits -= 8;
      bytes += static_cast<char>(buffer >> bits & 0xff);
    }
  }
  if (bytes.size() % 8 != 0)
  {
    throw Error("the base64 text has " + std::to_string(bytes.size()) +
      " bytes, not a multiple of 8: it is cut short");
  }
  std::vector<double> values(bytes.size() / 8);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    // Little-endian on every machine.
    std::uint64_t word = 0;
    for (std::size_t b = 8; b-- > 0;)
    {
      word = word << 8 | static_cast<unsigned char>(bytes[8 * i + b]);
    }
    std::memcpy(&values[i], &word, 8);
  }
  return values;
}

class XmlParser
{
public:
  explicit XmlParser(std::string_view text)
    : Source(text)
  {
    for (std::size_t i = text.find('\n'); i != text.npos; i = text.find('\n', i + 1))
    {
      this->LineEnds.push_back(i);
    }
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
  void ReadMultiPatch(const pugi::xml_node& node);
  bool AppendInterfaces(const std::vector<long long>& numbers, int dimension);
  bool AppendOldInterfaces(const std::vector<long long>& numbers, int dimension);
  void AppendBoundary(const pugi::xml_node& node, int dimension);
  std::vector<long long> Integers(const pugi::xml_node& node);
  std::vector<double> Numbers(const pugi::xml_node& node);
  [[nodiscard]] const Patch* FindPatch(long long id) const;

  [[nodiscard]] std::size_t LineAt(std::ptrdiff_t offset) const
  {
    const auto end = std::lower_bound(this->LineEnds.begin(), this->LineEnds.end(),
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
    return static_cast<std::size_t>(end - this->LineEnds.begin()) + 1;
  }
  /// "<Geometry id="3">"
  [[nodiscard]] static std::string Element(const pugi::xml_node& node)
  {
    const pugi::xml_attribute id = node.attribute("id");
    return "<" + Printable(node.name()) + (id ? " id=" + Quote(id.value()) : std::string()) + ">";
  }
  /// "line 12, <Geometry id="3">"
  [[nodiscard]] std::string Where(const pugi::xml_node& node) const
  {
    return "line " + std::to_string(this->LineAt(node.offset_debug())) + ", " + Element(node);
  }
  [[nodiscard]] long long Integer(
    const pugi::xml_node& node, const char* attribute, const char* what, long long high) const
  {
    return WithContext([&] { return Element(node); },
      [&]
      {
        return Scanner(
          node.attribute(attribute).value(), this->LineAt(node.offset_debug()), "attribute")
          .Integer(what, 0, high);
      });
  }
  [[noreturn]] void Fail(const pugi::xml_node& node, const std::string& message) const
  {
    throw Error(this->Where(node) + ": " + message);
  }
  static std::string Printable(std::string_view name)
  {
    const std::string quoted = Quote(name);
    return quoted.substr(1, quoted.size() - 2);
  }

  std::string_view Source;
  std::vector<std::size_t> LineEnds;
  FileContents Contents;
  std::unordered_map<long long, std::size_t> PatchOfId;
  std::map<std::string, std::size_t> BoundaryOfName;
  std::size_t OldInterfaces = 0;
  std::size_t Hierarchical = 0;
};

FileContents XmlParser::Parse()
{
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(
    this->Source.data(), this->Source.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
  {
    throw Error("line " + std::to_string(this->LineAt(result.offset)) + ": not well-formed XML (" +
      result.description() + "): the file is damaged or cut short");
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
      ++skipped["<" + Printable(name) + ">"];
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
      entry.Id = this->Integer(node, "id", "the id", MaxInt);
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
  else
  {
    for (const pugi::xml_node& node : multiPatches)
    {
      this->ReadMultiPatch(node);
    }
  }
  if (this->Hierarchical > 0)
  {
    this->Contents.Warnings.push_back(Counted(this->Hierarchical, "hierarchical spline") +
      " read as the same tensor-product spline on its finest level.");
  }
  if (this->OldInterfaces > 0)
  {
    this->Contents.Warnings.push_back(Counted(this->OldInterfaces, "interface") +
      " without direction map (an old form of the file): it was taken from control points that "
      "coincide to 1% of the patch; where they do not, the interface is left out.");
  }
  WarnOfFields(this->Contents);
  return std::move(this->Contents);
}

std::vector<double> XmlParser::Numbers(const pugi::xml_node& node)
{
  // Comments split a text into several nodes.
  std::vector<double> numbers;
  const std::string format = node.attribute("format").as_string("ASCII");
  if (format != "ASCII" && format != "ascii" && format != "B64Float64")
  {
    this->Fail(node, "the format " + Quote(format) + " is not read: write ASCII or B64Float64");
  }
  std::string encoded;
  for (const pugi::xml_node& child : node.children())
  {
    if (child.type() != pugi::node_pcdata && child.type() != pugi::node_cdata)
    {
      continue;
    }
    if (format == "B64Float64")
    {
      encoded += child.value();
      continue;
    }
    WithContext([&] { return Element(node); },
      [&]
      {
        Scanner scanner(child.value(), this->LineAt(child.offset_debug()), "element", '\0');
        while (!scanner.AtEnd())
        {
          numbers.push_back(scanner.Quotient("a number"));
        }
      });
  }
  if (format == "B64Float64")
  {
    numbers = WithContext([&] { return this->Where(node); }, [&] { return DecodeBase64(encoded); });
  }
  return numbers;
}

std::vector<long long> XmlParser::Integers(const pugi::xml_node& node)
{
  std::vector<long long> numbers;
  for (const pugi::xml_node& child : node.children())
  {
    if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata)
    {
      WithContext([&] { return Element(node); },
        [&]
        {
          Scanner scanner(child.value(), this->LineAt(child.offset_debug()), "element", '\0');
          while (!scanner.AtEnd())
          {
            numbers.push_back(scanner.Integer("a patch, side or direction", 0, MaxInt));
          }
        });
    }
  }
  return numbers;
}

KnotVector XmlParser::ReadKnots(const pugi::xml_node& basis, int direction)
{
  const pugi::xml_node node = basis.child("KnotVector");
  if (!node)
  {
    this->Fail(basis, std::string("direction ") + "uvw"[direction] + " has no <KnotVector>");
  }
  if (!node.attribute("degree"))
  {
    this->Fail(node, "the attribute degree is missing");
  }
  const auto degree = static_cast<int>(this->Integer(node, "degree", "the degree", MaxDegree));
  std::vector<double> knots = this->Numbers(node);
  return WithContext([&] { return this->Where(node) + ", direction " + "uvw"[direction]; },
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
        this->Fail(child,
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
    this->Fail(geometry,
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
    const std::vector<long long> numbers = this->Integers(node);
    const auto d = static_cast<std::size_t>(dimension);
    if (numbers.size() != 2 * d)
    {
      this->Fail(node,
        "a box is " + std::to_string(2 * d) + " numbers, first and last knots, but there are " +
          std::to_string(numbers.size()));
    }
    HierarchicalBox box{ static_cast<int>(this->Integer(node, "level", "the level", 30)),
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
    this->Fail(geometry, "it has no <Basis>");
  }
  if (entry.Type.Rational)
  {
    const pugi::xml_node node = basis.child("weights");
    if (!node)
    {
      this->Fail(geometry, "it is rational but its basis has no <weights>");
    }
    const std::vector<double> values = this->Numbers(node);
    weights =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    if (values.empty())
    {
      this->Fail(node, "it is empty: a rational spline has one weight per control point");
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
      this->Fail(geometry, "its hierarchical basis has no <Basis> of level 0");
    }
  }
  std::array<KnotVector, 3> knots = this->ReadBasis(geometry, basis, entry.Type.Dimension);

  const pugi::xml_node coefs = geometry.child("coefs");
  if (!coefs)
  {
    this->Fail(geometry, "it has no <coefs>");
  }
  const std::vector<double> values = this->Numbers(coefs);
  const auto available = static_cast<long long>(values.size());
  if (entry.Type.Hierarchical)
  {
    const long long coordinates = coefs.attribute("geoDim").as_int(3);
    if (coordinates < 1 || coordinates > 3 || available % coordinates != 0)
    {
      this->Fail(coefs,
        std::to_string(available) + " numbers do not make control points of " +
          std::to_string(coordinates) + " coordinates: correct the attribute geoDim");
    }
    WithContext([&] { return this->Where(geometry); },
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
    this->Fail(coefs,
      std::to_string(available) + " numbers do not make " + std::to_string(knots[0].Size()) +
        " x " + std::to_string(knots[1].Size()) + " x " + std::to_string(knots[2].Size()) +
        " control points of " + std::to_string(coordinates) +
        " coordinates: the attribute geoDim or the knots do not fit, or numbers are missing");
  }
  WithContext([&] { return this->Where(geometry); },
    [&]
    {
      AppendPatch(this->Contents, id,
        Spline(std::move(knots),
          Eigen::Map<const Eigen::MatrixXd>(values.data(), coordinates, count), weights));
    });
  this->PatchOfId.emplace(id, this->Contents.Model.Patches.size() - 1);
}

const Patch* XmlParser::FindPatch(long long id) const
{
  const auto found = this->PatchOfId.find(id);
  return found == this->PatchOfId.end() ? nullptr : &this->Contents.Model.Patches[found->second];
}

void XmlParser::ReadMultiPatch(const pugi::xml_node& node)
{
  int dimension = 0;
  for (const pugi::xml_node& patches : node.children("patches"))
  {
    const std::string type = patches.attribute("type").as_string("id_range");
    std::vector<long long> ids = this->Integers(patches);
    if (type == "id_range")
    {
      if (ids.size() != 2 || ids[1] < ids[0])
      {
        this->Fail(patches, "an id_range is two numbers, first and last");
      }
      if (ids[1] - ids[0] >= static_cast<long long>(this->Contents.Model.Patches.size()))
      {
        this->Fail(patches,
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
      this->Fail(patches, "the type " + Quote(type) + " is not read: id_range or id_index");
    }
    for (const long long id : ids)
    {
      const Patch* patch = this->FindPatch(id);
      if (!patch)
      {
        this->Fail(patches, "no geometry of the file has the id " + std::to_string(id));
      }
      dimension = std::max(dimension, patch->Body.Geometry().Dimension());
    }
  }
  if (dimension == 0)
  {
    this->Fail(node, "it has no <patches>");
  }
  for (const pugi::xml_node& interfaces : node.children("interfaces"))
  {
    const std::vector<long long> numbers = this->Integers(interfaces);
    if (!this->AppendInterfaces(numbers, dimension) &&
      !this->AppendOldInterfaces(numbers, dimension))
    {
      this->Fail(interfaces,
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
bool XmlParser::AppendInterfaces(const std::vector<long long>& numbers, int dimension)
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
  auto& all = this->Contents.Model.Interfaces;
  all.insert(all.end(), interfaces.begin(), interfaces.end());
  return true;
}

/// The form before there were direction maps: five numbers, the last an orientation that does not
/// determine the map of a volume's face. The map comes from the control points.
bool XmlParser::AppendOldInterfaces(const std::vector<long long>& numbers, int dimension)
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
    const Eigen::MatrixXd& points = patch.Body.Geometry().Coefficients();
    const double diagonal = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
    const auto interface = MatchSides(patch, static_cast<int>(n[1]) - 1, *this->FindPatch(n[2]),
      static_cast<int>(n[3]) - 1, 1e-2 * diagonal);
    ++this->OldInterfaces;
    if (interface)
    {
      this->Contents.Model.Interfaces.push_back(*interface);
    }
  }
  return true;
}

void XmlParser::AppendBoundary(const pugi::xml_node& node, int dimension)
{
  const std::vector<long long> numbers = this->Integers(node);
  if (numbers.size() % 2 != 0)
  {
    this->Fail(node,
      "a boundary is pairs of patch and side, but there are " + std::to_string(numbers.size()) +
        " numbers");
  }
  // A nameless boundary is the rest; several of them are one.
  const std::string name = node.attribute("name").as_string("boundary");
  auto& boundaries = this->Contents.Model.Boundaries;
  const auto [found, isNew] = this->BoundaryOfName.emplace(name, boundaries.size());
  if (isNew)
  {
    boundaries.push_back({ name, {} });
  }
  for (std::size_t i = 0; i < numbers.size(); i += 2)
  {
    if (!this->FindPatch(numbers[i]) || numbers[i + 1] < 1 || numbers[i + 1] > 2 * dimension)
    {
      this->Fail(node,
        "patch " + std::to_string(numbers[i]) + " with side " + std::to_string(numbers[i + 1]) +
          " does not exist");
    }
    boundaries[found->second].Sides.push_back(
      { static_cast<int>(numbers[i]), static_cast<int>(numbers[i + 1]) - 1 });
  }
}

}

FileContents ParseGismoXml(std::string_view text)
{
  return XmlParser(text).Parse();
}

}
