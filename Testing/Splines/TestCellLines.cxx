// SPDX-License-Identifier: BSD-3-Clause
#include "CellLines.h"
#include "Error.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace hyperpatch;

TEST(CellLines, AscendFromEndToEndAndHalveAtKnots)
{
  const std::vector<double> breaks{ 0.0, 0.1, 0.3, 0.4, 0.9, 1.0 };
  const CellLines lines(breaks, std::vector<bool>(breaks.size(), false), 1);
  ASSERT_EQ(lines.NumberOfRoots(), 1);
  EXPECT_EQ(lines.Parameter(0), 0.0);
  EXPECT_EQ(lines.Parameter(lines.Length()), 1.0);
  double previous = -1.0;
  std::vector<double> seen;
  for (int i = 0; i <= 8; ++i)
  {
    const double at = lines.Parameter(lines.Length() / 8 * i);
    EXPECT_GT(at, previous);
    previous = at;
    seen.push_back(at);
  }
  for (const double b : breaks)
  {
    EXPECT_EQ(std::count(seen.begin(), seen.end(), b), 1) << b;
  }
  EXPECT_TRUE(lines.IsCrease(0));
  EXPECT_TRUE(lines.IsCrease(lines.Length()));
  EXPECT_FALSE(lines.IsCrease(lines.Length() / 2));
}

TEST(CellLines, CreasesAreLinesOfRootCells)
{
  const std::vector<double> breaks{ 0.0, 0.2, 0.5, 1.0 };
  const CellLines lines(breaks, { false, false, true, false }, 4);
  bool found = false;
  for (int root = 0; root <= lines.NumberOfRoots(); ++root)
  {
    const int line = root * CellLines::RootSize;
    const double at = lines.Parameter(line);
    EXPECT_EQ(lines.IsCrease(line), at == 0.0 || at == 0.5 || at == 1.0);
    found = found || at == 0.5;
  }
  EXPECT_TRUE(found);
  EXPECT_GE(lines.NumberOfRoots(), 4);
}

TEST(CellLines, MirroredBreaksHaveMirroredLines)
{
  const std::vector<double> breaks{ 0.0, 0.125, 0.25, 0.75, 1.0 };
  std::vector<double> turned;
  for (auto b = breaks.rbegin(); b != breaks.rend(); ++b)
  {
    turned.push_back(1.0 - *b);
  }
  const std::vector<bool> isCrease{ false, false, true, false, false };
  const CellLines lines(breaks, isCrease, 3);
  const CellLines mirrored(turned, isCrease, 3, true);
  ASSERT_EQ(lines.Length(), mirrored.Length());
  for (int i = 0; i <= 64; ++i)
  {
    const int line = lines.Length() / 64 * i;
    EXPECT_EQ(mirrored.Parameter(line), 1.0 - lines.Parameter(line));
  }
}

TEST(CellLines, TooManyCreasesAreRefused)
{
  std::vector<double> breaks;
  for (int i = 0; i <= CellLines::MostRoots + 1; ++i)
  {
    breaks.push_back(i);
  }
  EXPECT_THROW(CellLines(breaks, std::vector<bool>(breaks.size(), true), 1), Error);
}
