// SPDX-License-Identifier: BSD-3-Clause
#include "CellLines.h"

#include "Error.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace hyperpatch
{

CellLines::CellLines(double parameter)
  : B{ parameter }
{
}

CellLines::CellLines(std::vector<double> breaks, const std::vector<bool>& isCrease, int cells)
  : B(std::move(breaks))
{
  const int last = static_cast<int>(this->B.size()) - 1;
  std::vector<bool> crease = isCrease;
  crease.front() = crease.back() = true;
  const double length = this->B.back() - this->B.front();
  for (int first = 0; first < last;)
  {
    int end = first + 1;
    while (!crease[static_cast<std::size_t>(end)])
    {
      ++end;
    }
    const int spans = end - first;
    const double share =
      (this->B[static_cast<std::size_t>(end)] - this->B[static_cast<std::size_t>(first)]) / length;
    const int wanted = std::max(1, static_cast<int>(cells * share + 0.5));
    this->Creases.push_back(true);
    if (wanted <= spans)
    {
      for (int c = 0; c < wanted; ++c)
      {
        const auto at = [first, spans, wanted](int i)
        { return first + static_cast<int>(static_cast<std::int64_t>(spans) * i / wanted); };
        this->Roots.push_back({ at(c), at(c + 1), 0, 1 });
      }
    }
    else
    {
      const int parts = (wanted + spans - 1) / spans;
      for (int s = first; s < end; ++s)
      {
        for (int part = 0; part < parts; ++part)
        {
          this->Roots.push_back({ s, s + 1, part, parts });
        }
      }
    }
    this->Creases.resize(this->Roots.size(), false);
    first = end;
  }
  this->Creases.push_back(true);
  if (this->Roots.size() > MostRoots)
  {
    throw Error("there are more than " + std::to_string(MostRoots) +
      " knots in one direction at which the model is not smooth: restrict it to a part");
  }
}

CellLines CellLines::On(std::vector<double> breaks, int first, int last) const
{
  CellLines lines;
  lines.B = std::move(breaks);
  lines.Roots.assign(this->Roots.begin() + first, this->Roots.begin() + last);
  lines.Creases.assign(this->Creases.begin() + first, this->Creases.begin() + last + 1);
  return lines;
}

bool CellLines::IsCrease(int line) const
{
  return line % RootSize == 0 && !this->Creases.empty() &&
    this->Creases[static_cast<std::size_t>(line / RootSize)];
}

double CellLines::Parameter(int line) const
{
  if (this->Roots.empty())
  {
    return this->B.front();
  }
  const auto b = [this](int i) { return this->B[static_cast<std::size_t>(i)]; };
  if (line >= this->Length())
  {
    return b(this->Roots.back().Last);
  }
  const Root& root = this->Roots[static_cast<std::size_t>(line / RootSize)];
  int offset = line % RootSize;
  int size = RootSize;
  int first = root.First;
  int last = root.Last;
  while (offset > 0 && last - first > 1)
  {
    const int middle = (first + last) / 2;
    size /= 2;
    if (offset >= size)
    {
      first = middle;
      offset -= size;
    }
    else
    {
      last = middle;
    }
  }
  if (root.Part == 0 && offset == 0)
  {
    return b(first);
  }
  const double t = (root.Part + static_cast<double>(offset) / size) / root.Parts;
  return b(first) + t * (b(last) - b(first));
}

}
