// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Formats_h
#define hyperpatch_Formats_h

#include "Aggregate.h"

#include <string>
#include <string_view>
#include <vector>

namespace hyperpatch
{

/// The text formats that are read.
enum class Format
{
  Unknown,
  GismoXml,   ///< G+Smo XML
  MfemMesh,   ///< MFEM NURBS mesh v1.0, v1.1, NC-patch
  GoToolsG2,  ///< GoTools g2
  IritItd,    ///< IRIT itd, text
  GeoPdesText ///< GeoPDEs (NURBS toolbox) text
};

/// What a file held.
struct FileContents
{
  MultiPatch Model;
  /// One sentence each, for what was skipped, counted.
  std::vector<std::string> Warnings;
};

/// The format of a file from its first bytes; strict and cheap. Unknown if it is not ours.
[[nodiscard]] Format SniffFormat(std::string_view begin);

/// \throws Error with one sentence that says line (or element, or object), thing and remedy.
[[nodiscard]] FileContents ParseGismoXml(std::string_view text);
[[nodiscard]] FileContents ParseMfemMesh(std::string_view text);
[[nodiscard]] FileContents ParseGoToolsG2(std::string_view text);
[[nodiscard]] FileContents ParseIritItd(std::string_view text);
[[nodiscard]] FileContents ParseGeoPdesText(std::string_view text);

/// Sniffs and parses a file.
/// \throws Error, the message begins with the file name.
[[nodiscard]] FileContents ReadSplineFile(const std::string& fileName);

}

#endif
