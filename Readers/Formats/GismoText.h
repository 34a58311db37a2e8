// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_GismoText_h
#define hyperpatch_GismoText_h

#include <pugixml.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hyperpatch::formats::gismo
{

/// A text of XML: numbers of its elements, and messages that name line and element.
class XmlText
{
public:
  /// \param text must outlive this
  explicit XmlText(std::string_view text);

  [[nodiscard]] std::string_view Source() const { return this->Text; }
  [[nodiscard]] std::size_t LineAt(std::ptrdiff_t offset) const;
  /// "<Geometry id="3">"
  [[nodiscard]] static std::string Element(const pugi::xml_node& node);
  /// "line 12, <Geometry id="3">"
  [[nodiscard]] std::string Where(const pugi::xml_node& node) const;
  [[noreturn]] void Fail(const pugi::xml_node& node, const std::string& message) const;
  /// A name as a message shows it.
  [[nodiscard]] static std::string Printable(std::string_view name);

  /// An attribute, in 0..high.
  [[nodiscard]] long long Integer(
    const pugi::xml_node& node, const char* attribute, const char* what, long long high) const;
  /// All integers of an element, none negative.
  [[nodiscard]] std::vector<long long> Integers(const pugi::xml_node& node) const;
  /// All numbers of an element, in the format that it says.
  [[nodiscard]] std::vector<double> Numbers(const pugi::xml_node& node) const;

private:
  std::string_view Text;
  std::vector<std::size_t> LineEnds;
};

}

#endif
