// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetPartsWorker.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Breaks of patches that meet count as one if they differ by less of the whole direction.
constexpr double SameBreak = 1e-9;

/// No more root cells in any direction.
constexpr double MostRoots = 64.0;

/// Root cells are made no longer than this by the numbers of cells that neighbors want.
constexpr double LargestAspect = 4.0;

/// Directions that run along each other, and whether they run against the first of them.
class Directions
{
public:
  explicit Directions(std::size_t count)
    : Parent(count)
    , Against(count, false)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      this->Parent[i] = i;
    }
  }
  [[nodiscard]] std::pair<std::size_t, bool> Find(std::size_t i)
  {
    std::size_t root = i;
    bool against = false;
    for (; this->Parent[root] != root; root = this->Parent[root])
    {
      against = against != this->Against[root];
    }
    // The next time it is one step.
    for (bool rest = against; this->Parent[i] != root && i != root;)
    {
      const std::size_t next = this->Parent[i];
      const bool step = this->Against[i];
      this->Parent[i] = root;
      this->Against[i] = rest;
      rest = rest != step;
      i = next;
    }
    return { root, against };
  }
  [[nodiscard]] bool MayJoin(std::size_t i, std::size_t j, bool against)
  {
    const auto [a, turnedA] = this->Find(i);
    const auto [b, turnedB] = this->Find(j);
    return a != b || (turnedA != turnedB) == against;
  }
  void Join(std::size_t i, std::size_t j, bool against)
  {
    auto [a, turnedA] = this->Find(i);
    auto [b, turnedB] = this->Find(j);
    if (a != b)
    {
      const auto [low, high] = std::minmax(a, b);
      this->Parent[high] = low;
      this->Against[high] = (turnedA != turnedB) != against;
    }
  }

private:
  std::vector<std::size_t> Parent;
  std::vector<bool> Against;
};

std::size_t Index(int i)
{
  return static_cast<std::size_t>(i);
}

}

bool ZeroSetParts::FindElements(std::vector<ZeroSetPart>& parts)
{
  std::set<std::tuple<int, int, std::array<double, 3>>> known;
  std::set<std::pair<int, int>> divided;
  for (const ZeroSetPart& part : parts)
  {
    if (!known.insert({ part.Value, part.Patch, part.First }).second)
    {
      divided.insert({ part.Value, part.Patch });
    }
  }
  for (ZeroSetPart& part : parts)
  {
    part.IsElement = divided.count({ part.Value, part.Patch }) > 0;
    if (part.IsElement)
    {
      part.IsDomainFace.fill(true);
    }
  }
  return !divided.empty();
}

void ZeroSetParts::Set(std::vector<ZeroSetPart> parts, const std::vector<Interface>& interfaces,
  const std::vector<ZeroSetContact>& contacts)
{
  this->P = std::move(parts);
  this->FindPatches();
  this->JoinDirections(interfaces, contacts);
  this->MakeLines();
  this->FindLinks();
}

void ZeroSetParts::FindPatches()
{
  this->W.clear();
  std::map<std::array<int, 3>, int> numbers;
  for (std::size_t p = 0; p < this->P.size(); ++p)
  {
    ZeroSetPart& part = this->P[p];
    const int element = part.IsElement ? static_cast<int>(p) : -1;
    const auto [found, isNew] =
      numbers.try_emplace({ part.Value, part.Patch, element }, static_cast<int>(this->W.size()));
    part.Whole = found->second;
    if (isNew)
    {
      this->W.emplace_back();
      Whole& whole = this->W.back();
      whole.Value = part.Value;
      whole.Patch = part.Patch;
      whole.IsThere = part.IsThere;
      whole.First = part.First;
      whole.Last = part.Last;
    }
    Whole& whole = this->W[Index(part.Whole)];
    whole.Parts.push_back(static_cast<int>(p));
    for (std::size_t d = 0; d < 3; ++d)
    {
      whole.First[d] = std::min(whole.First[d], part.First[d]);
      whole.Last[d] = std::max(whole.Last[d], part.Last[d]);
    }
  }
  for (Whole& whole : this->W)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      std::map<std::pair<double, double>, double> ranges;
      for (const int p : whole.Parts)
      {
        const ZeroSetPart& part = this->P[Index(p)];
        double& length = ranges[{ part.First[d], part.Last[d] }];
        length = std::max(length, part.Lengths[d]);
      }
      for (const auto& range : ranges)
      {
        whole.Lengths[d] += range.second;
      }
    }
  }
}

void ZeroSetParts::JoinDirections(
  const std::vector<Interface>& interfaces, const std::vector<ZeroSetContact>& contacts)
{
  this->Joints.clear();
  this->Listed.assign(this->P.size(), {});
  Directions directions(3 * this->W.size());
  const auto list = [this](int patch, int side)
  {
    for (const int p : this->W[Index(patch)].Parts)
    {
      if (this->P[Index(p)].IsDomainFace[Index(side)])
      {
        this->Listed[Index(p)][Index(side)] = true;
      }
    }
  };
  const auto join = [&](const Joint& joint, const std::array<bool, 3>& same)
  {
    const auto& [one, side1, two, side2, axis] = joint;
    Whole& whole1 = this->W[Index(one)];
    Whole& whole2 = this->W[Index(two)];
    list(one, side1);
    list(two, side2);
    bool fits = (one != two || side1 != side2) && !whole1.IsTaken[Index(side1)] &&
      !whole2.IsTaken[Index(side2)];
    for (int d = 0; d < 3 && fits; ++d)
    {
      const auto i = Index(3 * one + d);
      const auto j = Index(3 * two + axis[Index(d)]);
      fits = whole1.IsThere[Index(d)] == whole2.IsThere[Index(axis[Index(d)])] &&
        (d == side1 / 2 || directions.MayJoin(i, j, !same[Index(d)]));
      if (fits && d != side1 / 2)
      {
        directions.Join(i, j, !same[Index(d)]);
      }
    }
    if (fits)
    {
      whole1.IsTaken[Index(side1)] = whole2.IsTaken[Index(side2)] = true;
      this->Joints.push_back(joint);
    }
  };
  // Elements can only be in contacts.
  std::multimap<int, int> patchesOf;
  for (std::size_t w = 0; w < this->W.size(); ++w)
  {
    if (!this->P[Index(this->W[w].Parts[0])].IsElement)
    {
      patchesOf.emplace(this->W[w].Patch, static_cast<int>(w));
    }
  }
  std::set<std::array<int, 10>> once;
  for (const Interface& interface : interfaces)
  {
    const auto& v = interface.Values;
    const int side1 = v[1] - 1;
    const int side2 = v[3] - 1;
    const std::array<int, 3> axis{ v[4], v[5], v[6] };
    std::array<int, 3> sorted = axis;
    std::sort(sorted.begin(), sorted.end());
    if (!once.insert(v).second || side1 < 0 || side1 >= NumberOfSides || side2 < 0 ||
      side2 >= NumberOfSides || sorted != std::array<int, 3>{ 0, 1, 2 } ||
      axis[Index(side1 / 2)] != side2 / 2)
    {
      continue;
    }
    const auto [begin, end] = patchesOf.equal_range(v[0]);
    const auto [begin2, end2] = patchesOf.equal_range(v[2]);
    for (auto first = begin; first != end; ++first)
    {
      for (auto second = begin2; second != end2; ++second)
      {
        if (this->W[Index(first->second)].Value == this->W[Index(second->second)].Value)
        {
          join({ first->second, side1, second->second, side2, axis },
            { v[7] != 0, v[8] != 0, v[9] != 0 });
        }
      }
    }
  }
  std::set<std::array<int, 4>> known; // other parts of the same two sides
  for (const ZeroSetContact& contact : contacts)
  {
    const int one = this->P[Index(contact.Part)].Whole;
    const int two = this->P[Index(contact.OtherPart)].Whole;
    if (known.insert({ one, contact.Side, two, contact.OtherSide }).second)
    {
      join({ one, contact.Side, two, contact.OtherSide, contact.Axis }, contact.Same);
    }
  }
  // Classes are numbered in the order of their first directions.
  std::map<std::size_t, std::size_t> numbers;
  for (std::size_t w = 0; w < this->W.size(); ++w)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const auto [root, against] = directions.Find(3 * w + d);
      this->W[w].Class[d] = numbers.try_emplace(root, numbers.size()).first->second;
      this->W[w].Mirrored[d] = against;
    }
  }
  this->BreakAt.assign(numbers.size(), {});
  this->Lines.assign(numbers.size(), CellLines());
}

void ZeroSetParts::MakeLines()
{
  // Root cells are about cubes where neighbors let them.
  std::vector<double> roots(this->Lines.size(), 1.0);
  for (const Whole& whole : this->W)
  {
    double shortest = INFINITY;
    for (const double length : whole.Lengths)
    {
      shortest = length > 0.0 ? std::min(shortest, length) : shortest;
    }
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double wanted = whole.Lengths[d] > 0.0 ? whole.Lengths[d] / shortest : 1.0;
      double& count = roots[whole.Class[d]];
      count = std::max(count, std::min(MostRoots, wanted));
    }
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const Whole& whole : this->W)
    {
      double shortest = INFINITY;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const double width = whole.Lengths[d] / roots[whole.Class[d]];
        shortest = width > 0.0 ? std::min(shortest, width) : shortest;
      }
      for (std::size_t d = 0; d < 3; ++d)
      {
        double& count = roots[whole.Class[d]];
        const double least = std::min(MostRoots, whole.Lengths[d] / (LargestAspect * shortest));
        changed = changed || count < least;
        count = std::max(count, least);
      }
    }
  }

  std::vector<std::vector<ZeroSetPart::Break>> breaks(this->Lines.size());
  for (const ZeroSetPart& part : this->P)
  {
    const Whole& whole = this->W[Index(part.Whole)];
    for (int d = 0; d < 3; ++d)
    {
      auto& all = breaks[whole.Class[Index(d)]];
      for (const ZeroSetPart::Break& b : part.Breaks[Index(d)])
      {
        all.push_back({ this->ToClass(part, d, b.At), b.IsCrease });
      }
      // Where parts end, neighbors cut too.
      if (part.IsThere[Index(d)])
      {
        all.push_back({ this->ToClass(part, d, part.First[Index(d)]), true });
        all.push_back({ this->ToClass(part, d, part.Last[Index(d)]), true });
      }
    }
  }
  for (std::size_t c = 0; c < this->Lines.size(); ++c)
  {
    auto& all = breaks[c];
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.At < b.At; });
    std::vector<double>& at = this->BreakAt[c];
    std::vector<bool> isCrease;
    for (const auto& b : all)
    {
      if (!at.empty() && b.At - at.back() <= SameBreak)
      {
        isCrease.back() = isCrease.back() || b.IsCrease;
        // The ends are exact.
        at.back() = b.At >= 1.0 ? 1.0 : at.back();
        continue;
      }
      at.push_back(b.At);
      isCrease.push_back(b.IsCrease);
    }
    if (!at.empty())
    {
      this->Lines[c] = CellLines(at, isCrease, static_cast<int>(roots[c] + 0.5));
    }
  }
  for (ZeroSetPart& part : this->P)
  {
    const Whole& whole = this->W[Index(part.Whole)];
    for (int d = 0; d < 3; ++d)
    {
      const CellLines& lines = this->Lines[whole.Class[Index(d)]];
      const auto lineAt = [&](double parameter)
      {
        const double t = this->ToClass(part, d, parameter);
        int root = 0;
        while (root < lines.NumberOfRoots() &&
          std::abs(lines.Parameter(root * CellLines::RootSize) - t) > SameBreak)
        {
          ++root;
        }
        return root * CellLines::RootSize;
      };
      const int a = lineAt(part.First[Index(d)]);
      const int b = lineAt(part.Last[Index(d)]);
      part.FirstLine[Index(d)] = std::min(a, b);
      part.LastLine[Index(d)] = std::max(a, b);
    }
  }
}

double ZeroSetParts::ToClass(const ZeroSetPart& part, int direction, double parameter) const
{
  const Whole& whole = this->W[Index(part.Whole)];
  const double first = whole.First[Index(direction)];
  const double last = whole.Last[Index(direction)];
  return (whole.Mirrored[Index(direction)] ? last - parameter : parameter - first) / (last - first);
}

double ZeroSetParts::FromClass(const ZeroSetPart& part, int direction, double t) const
{
  const Whole& whole = this->W[Index(part.Whole)];
  const double first = whole.First[Index(direction)];
  const double last = whole.Last[Index(direction)];
  return whole.Mirrored[Index(direction)] ? last - t * (last - first) : first + t * (last - first);
}

double ZeroSetParts::ClassParameter(const ZeroSetPart& part, int direction, int line) const
{
  return this->Lines[this->W[Index(part.Whole)].Class[Index(direction)]].Parameter(line);
}

std::array<CellLines, 3> ZeroSetParts::LinesOf(const ZeroSetPart& part) const
{
  const Whole& whole = this->W[Index(part.Whole)];
  std::array<CellLines, 3> lines;
  for (int d = 0; d < 3; ++d)
  {
    const auto D = Index(d);
    if (!part.IsThere[D])
    {
      lines[D] = CellLines(part.First[D]);
      continue;
    }
    // Its own breaks with all their bits, those of others as near as they can be given.
    const auto& own = part.Breaks[D];
    const double same = SameBreak * (whole.Last[D] - whole.First[D]);
    std::vector<double> breaks;
    for (const double t : this->BreakAt[whole.Class[D]])
    {
      const double at = this->FromClass(part, d, t);
      const auto near = std::lower_bound(own.begin(), own.end(), at - 2.0 * same,
        [](const ZeroSetPart::Break& b, double x) { return b.At < x; });
      breaks.push_back(near != own.end() && near->At - at <= 2.0 * same ? near->At : at);
    }
    const int root = CellLines::RootSize;
    lines[D] = this->Lines[whole.Class[D]].On(
      std::move(breaks), part.FirstLine[D] / root, part.LastLine[D] / root);
  }
  return lines;
}

int ZeroSetParts::LineOf(const ZeroSetPart& part, int side) const
{
  const auto d = Index(side / 2);
  const bool atEnd = (side % 2 != 0) != this->W[Index(part.Whole)].Mirrored[d];
  return atEnd ? part.LastLine[d] : part.FirstLine[d];
}

void ZeroSetParts::AddLinks(
  int part, int side, int other, int otherSide, const std::array<int, 3>& axis, int joint)
{
  // Only where their sides overlap.
  const ZeroSetPart& one = this->P[Index(part)];
  const ZeroSetPart& two = this->P[Index(other)];
  std::array<int, 3> back{};
  for (int d = 0; d < 3; ++d)
  {
    const auto D = Index(d);
    const auto E = Index(axis[D]);
    back[E] = d;
    if (d != side / 2 && one.IsThere[D] &&
      (one.FirstLine[D] >= two.LastLine[E] || two.FirstLine[E] >= one.LastLine[D]))
    {
      return;
    }
  }
  const int line = this->LineOf(one, side);
  const int otherLine = this->LineOf(two, otherSide);
  const int number = this->LinkCount++;
  this->L[Index(part)].push_back(
    { side, other, otherSide, line, otherLine, axis, joint, number, true });
  this->L[Index(other)].push_back(
    { otherSide, part, side, otherLine, line, back, joint, number, false });
}

void ZeroSetParts::FindLinks()
{
  this->LinkCount = 0;
  this->L.assign(this->P.size(), {});
  int joint = 0;
  for (const Joint& j : this->Joints)
  {
    for (const int one : this->W[Index(j.Patch1)].Parts)
    {
      for (const int two : this->W[Index(j.Patch2)].Parts)
      {
        if (this->P[Index(one)].IsDomainFace[Index(j.Side1)] &&
          this->P[Index(two)].IsDomainFace[Index(j.Side2)])
        {
          this->AddLinks(one, j.Side1, two, j.Side2, j.Axis, joint);
        }
      }
    }
    ++joint;
  }
  // Cuts: the sides in one plane of a patch.
  std::map<std::array<int, 3>, std::array<std::vector<int>, 2>> cuts;
  for (std::size_t p = 0; p < this->P.size(); ++p)
  {
    const ZeroSetPart& part = this->P[p];
    for (int side = 0; side < NumberOfSides; ++side)
    {
      if (part.IsThere[Index(side / 2)] && !part.IsDomainFace[Index(side)])
      {
        this->Listed[p][Index(side)] = true;
        cuts[{ part.Whole, side / 2, this->LineOf(part, side) }][Index(side % 2)].push_back(
          static_cast<int>(p));
      }
    }
  }
  for (const auto& [plane, sides] : cuts)
  {
    for (const int below : sides[1])
    {
      for (const int above : sides[0])
      {
        this->AddLinks(below, 2 * plane[1] + 1, above, 2 * plane[1], { 0, 1, 2 }, joint);
      }
    }
    ++joint;
  }
}

bool ZeroSetParts::Drop(int joint)
{
  bool any = false;
  for (auto& links : this->L)
  {
    const auto end = std::remove_if(
      links.begin(), links.end(), [joint](const ZeroSetLink& link) { return link.Joint == joint; });
    any = any || end != links.end();
    links.erase(end, links.end());
  }
  return any;
}

bool ZeroSetParts::Map(const ZeroSetLink& link, ZeroSetPlace& place) const
{
  const int normal = link.Side / 2;
  const int along = place.Along();
  if (place.Low[Index(normal)] != link.Line || along == normal)
  {
    return false;
  }
  const ZeroSetPart& other = this->P[Index(link.Other)];
  ZeroSetPlace mapped = place;
  for (int d = 0; d < 3; ++d)
  {
    const auto E = Index(link.Axis[Index(d)]);
    const int low = d == normal ? link.OtherLine : place.Low[Index(d)];
    if (low < other.FirstLine[E] || low + (d == along ? place.Size : 0) > other.LastLine[E])
    {
      return false;
    }
    mapped.Low[E] = low;
  }
  if (along >= 0)
  {
    mapped.Axis = link.Axis[Index(along)] + (place.Axis > 3 ? 4 : 0);
  }
  place = mapped;
  return true;
}

void ZeroSetParts::FindAll(int part, const ZeroSetPlace& place, std::vector<Seen>& all) const
{
  all.assign(1, { part, place });
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    for (const ZeroSetLink& link : this->Links(all[i].Part))
    {
      ZeroSetPlace at = all[i].At;
      if (this->Map(link, at) &&
        std::none_of(all.begin(), all.end(),
          [&](const Seen& s)
          { return s.Part == link.Other && s.At.Low == at.Low && s.At.Axis == at.Axis; }))
      {
        all.push_back({ link.Other, at });
      }
    }
  }
}

}
