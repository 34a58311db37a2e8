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

TEST(CellLines, DirectionsThatMeetHaveTheSameLines)
{
  const std::vector<double> breaks{ 0.0, 0.125, 0.25, 0.75, 1.0 };
  const CellLines lines(breaks, { false, false, true, false, false }, 3);
  std::vector<double> longer;
  std::vector<double> against;
  for (const double b : breaks)
  {
    longer.push_back(4.0 * b + 1.0);
    against.push_back(1.0 - b);
  }
  const CellLines along = lines.On(longer, 0, lines.NumberOfRoots());
  const CellLines mirrored = lines.On(against, 0, lines.NumberOfRoots());
  EXPECT_FALSE(along.IsMirrored());
  EXPECT_TRUE(mirrored.IsMirrored());
  ASSERT_EQ(lines.Length(), mirrored.Length());
  for (int i = 0; i <= 64; ++i)
  {
    const int line = lines.Length() / 64 * i;
    EXPECT_EQ(along.Parameter(line), 4.0 * lines.Parameter(line) + 1.0);
    EXPECT_EQ(mirrored.Parameter(line), 1.0 - lines.Parameter(line));
    EXPECT_EQ(mirrored.IsCrease(line), lines.IsCrease(line));
  }
}

TEST(CellLines, APartHasTheLinesOfTheWhole)
{
  const std::vector<double> breaks{ 0.0, 0.125, 0.25, 0.75, 1.0 };
  const CellLines lines(breaks, { false, false, true, false, false }, 5);
  int crease = 1;
  while (!lines.IsCrease(crease * CellLines::RootSize))
  {
    ++crease;
  }
  const CellLines below = lines.On(breaks, 0, crease);
  const CellLines above = lines.On(breaks, crease, lines.NumberOfRoots());
  EXPECT_EQ(below.Parameter(below.Length()), 0.25);
  EXPECT_TRUE(below.IsCrease(below.Length()));
  EXPECT_EQ(below.Length() + above.Length(), lines.Length());
  for (int i = 0; i <= 64; ++i)
  {
    const int line = above.Length() / 64 * i;
    EXPECT_EQ(above.Parameter(line), lines.Parameter(below.Length() + line));
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
