// SPDX-License-Identifier: BSD-3-Clause
#include "GismoText.h"

#include "Scanner.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

namespace hyperpatch::formats::gismo
{

namespace
{

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

}

XmlText::XmlText(std::string_view text)
  : Text(text)
{
  for (std::size_t i = text.find('\n'); i != text.npos; i = text.find('\n', i + 1))
  {
    this->LineEnds.push_back(i);
  }
}

std::size_t XmlText::LineAt(std::ptrdiff_t offset) const
{
  const auto end = std::lower_bound(this->LineEnds.begin(), this->LineEnds.end(),
    static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
  return static_cast<std::size_t>(end - this->LineEnds.begin()) + 1;
}

std::string XmlText::Element(const pugi::xml_node& node)
{
  const pugi::xml_attribute id = node.attribute("id");
  return "<" + Printable(node.name()) + (id ? " id=" + Quote(id.value()) : std::string()) + ">";
}

std::string XmlText::Where(const pugi::xml_node& node) const
{
  return "line " + std::to_string(this->LineAt(node.offset_debug())) + ", " + Element(node);
}

void XmlText::Fail(const pugi::xml_node& node, const std::string& message) const
{
  throw Error(this->Where(node) + ": " + message);
}

std::string XmlText::Printable(std::string_view name)
{
  const std::string quoted = Quote(name);
  return quoted.substr(1, quoted.size() - 2);
}

long long XmlText::Integer(
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

std::vector<long long> XmlText::Integers(const pugi::xml_node& node) const
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
            numbers.push_back(
              scanner.Integer("a patch, side or direction", 0, std::numeric_limits<int>::max()));
          }
        });
    }
  }
  return numbers;
}

std::vector<double> XmlText::Numbers(const pugi::xml_node& node) const
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

}
