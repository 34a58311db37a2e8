// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "GoToolsClasses.h"
#include "Scanner.h"

#include <algorithm>
#include <fstream>
#include <new>

namespace hyperpatch
{

namespace
{

bool StartsWith(std::string_view text, std::string_view begin)
{
  return text.substr(0, begin.size()) == begin;
}

std::string_view SkipBlanks(std::string_view text)
{
  return text.substr(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

/// The kind that the first bracket of an IRIT file names, after comments.
bool IsIrit(std::string_view text)
{
  while (StartsWith(text, "#"))
  {
    text = SkipBlanks(text.substr(std::min(text.find('\n'), text.size())));
  }
  if (!StartsWith(text, "["))
  {
    return false;
  }
  text = SkipBlanks(text.substr(1));
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n["));
  return word == "OBJECT" || word == "TRIVAR";
}

/// The text after comments, processing instructions and declarations.
std::string_view SkipProlog(std::string_view text)
{
  while (true)
  {
    text = SkipBlanks(text);
    const char* end = StartsWith(text, "<!--") ? "-->"
      : StartsWith(text, "<?")                 ? "?>"
      : StartsWith(text, "<!")                 ? ">"
                                               : nullptr;
    if (!end)
    {
      return text;
    }
    const std::size_t found = text.find(end, 2);
    if (found == text.npos)
    {
      return {};
    }
    text.remove_prefix(found + std::string_view(end).size());
  }
}

}

Format SniffFormat(std::string_view begin)
{
  if (StartsWith(begin, "\xef\xbb\xbf"))
  {
    begin.remove_prefix(3);
  }
  begin = SkipBlanks(begin);
  if (StartsWith(begin, "MFEM "))
  {
    return Format::MfemMesh;
  }
  if (StartsWith(begin, "<"))
  {
    const std::string_view root = SkipProlog(begin);
    return StartsWith(root, "<xml") && root.size() > 4 && root.find_first_of(" \t\r\n/>") == 4
      ? Format::GismoXml
      : Format::Unknown;
  }
  const std::string_view line = begin.substr(0, begin.find('\n'));
  if (StartsWith(line, "#") && line.find("nurbs mesh v.") != line.npos)
  {
    return Format::GeoPdesText;
  }
  return formats::SniffGoToolsHeader(line) ? Format::GoToolsG2
    : IsIrit(begin)                        ? Format::IritItd
                                           : Format::Unknown;
}

FileContents ReadSplineFile(const std::string& fileName)
{
  // Enough for the comments that a file may begin with; nothing more is read of a foreign file.
  constexpr std::size_t beginSize = 65536;
  std::ifstream file(fileName, std::ios::binary);
  std::string text(beginSize, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (!file.is_open() || file.bad() || (text.empty() && !file.eof()))
  {
    throw Error(fileName + ": the file cannot be read: check its name and permissions");
  }
  const Format format = SniffFormat(text);
  if (format == Format::Unknown)
  {
    throw Error(fileName +
      (text.empty()                      ? ": the file is empty"
          : StartsWith(text, "\x1f\x8b") ? ": the file is compressed: unpack it with gunzip"
                                         : ": not a G+Smo XML, MFEM mesh, GoTools g2, IRIT itd or "
                                           "GeoPDEs text file: convert it to one of these"));
  }
  return formats::WithContext([&] { return fileName; },
    [&]
    {
      try
      {
        text.append(std::istreambuf_iterator<char>(file), {});
        return format == Format::GismoXml ? ParseGismoXml(text)
          : format == Format::MfemMesh    ? ParseMfemMesh(text)
          : format == Format::GoToolsG2   ? ParseGoToolsG2(text)
          : format == Format::IritItd     ? ParseIritItd(text)
                                          : ParseGeoPdesText(text);
      }
      catch (const std::bad_alloc&)
      {
        throw Error("there is not enough memory for the file");
      }
    });
}

}
