// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_GoToolsClasses_h
#define hyperpatch_GoToolsClasses_h

#include <string_view>

namespace hyperpatch::formats
{

struct GoToolsClass
{
  int Number;
  const char* Name;
};

/// The class of a header line "class 1 0 n aux..." and nothing else, or nullptr.
[[nodiscard]] const GoToolsClass* SniffGoToolsHeader(std::string_view line);

}

#endif
