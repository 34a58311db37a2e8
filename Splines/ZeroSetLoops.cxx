// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <utility>

namespace hyperpatch
{

bool ZeroSet::Worker::FindLoops(std::size_t leaf, Scratch& scratch) const
{
  bool failed = false;
  std::vector<std::vector<Index>>& loops = scratch.Loops;
  loops.clear();
  std::vector<Scratch::Step>& steps = scratch.Steps;
  using Step = Scratch::Step;
  steps.clear();
  for (Index f = this->FirstFace[leaf]; f < this->FirstFace[leaf + 1]; ++f)
  {
    const Index face = this->FacesOfLeaf[static_cast<std::size_t>(f)];
    const bool high = face % 2 != 0;
    const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face / 2)];
    for (Index c = first; c < first + count; ++c)
    {
      const Index kept = this->CurveOf[static_cast<std::size_t>(c)];
      if (kept >= 0)
      {
        const Curve* curve = &this->Curves[static_cast<std::size_t>(kept)];
        failed = failed || curve->HasFailed;
        const bool same = curve->From == this->Curves[static_cast<std::size_t>(c)].From;
        steps.push_back({ curve, high == same, false });
      }
    }
  }
  // There and back again is nothing.
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    for (std::size_t j = i + 1; j < steps.size() && !steps[i].Used; ++j)
    {
      if (!steps[j].Used && steps[i].Along == steps[j].Along &&
        steps[i].Forward != steps[j].Forward)
      {
        steps[i].Used = steps[j].Used = true;
      }
    }
  }
  const auto from = [](const Step& s) { return s.Forward ? s.Along->From : s.Along->To; };
  const auto to = [](const Step& s) { return s.Forward ? s.Along->To : s.Along->From; };
  // From step to step; where a point is met again, what lies between is a loop of its own.
  std::vector<Step*>& path = scratch.Path;
  path.clear();
  for (Step& start : steps)
  {
    Step* at = start.Used ? nullptr : &start;
    while (at)
    {
      at->Used = true;
      path.push_back(at);
      const Index end = to(*at);
      const auto again =
        std::find_if(path.rbegin(), path.rend(), [&](const Step* s) { return from(*s) == end; });
      if (again != path.rend())
      {
        std::vector<Index> loop;
        for (auto step = again.base() - 1; step != path.end(); ++step)
        {
          const Curve& curve = *(*step)->Along;
          loop.push_back(from(**step));
          for (Index i = 0; i < curve.Count; ++i)
          {
            loop.push_back(curve.First + ((*step)->Forward ? i : curve.Count - 1 - i));
          }
        }
        loops.push_back(std::move(loop));
        path.erase(again.base() - 1, path.end());
      }
      at = nullptr;
      if (!path.empty())
      {
        const auto next = std::find_if(
          steps.begin(), steps.end(), [&](const Step& s) { return !s.Used && from(s) == end; });
        at = next == steps.end() ? nullptr : &*next;
      }
    }
    path.clear();
  }
  return !failed;
}

void ZeroSet::Worker::FindFlatLoops(const Leaf& leaf, std::vector<std::vector<Index>>& loops) const
{
  for (int d = 0; d < 3; ++d)
  {
    for (const bool high : { false, true })
    {
      if (!this->IsDrawn(leaf, d, high))
      {
        continue;
      }
      Node low = leaf.At.Low;
      low[static_cast<std::size_t>(d)] += high ? leaf.At.Size : 0;
      const Index face = this->AtNode[static_cast<std::size_t>(this->Find(low))]
                           .Faces[static_cast<std::size_t>(3 + d)];
      const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face)];
      std::vector<Index> loop;
      for (Index c = first; c < first + count; ++c)
      {
        const Curve& own = this->Curves[static_cast<std::size_t>(c)];
        const Curve& curve =
          this->Curves[static_cast<std::size_t>(this->CurveOf[static_cast<std::size_t>(c)])];
        loop.push_back(own.From);
        for (Index i = 0; i < curve.Count; ++i)
        {
          loop.push_back(curve.First + (curve.From == own.From ? i : curve.Count - 1 - i));
        }
      }
      // f is positive inside: the face is seen from there.
      if (high)
      {
        std::reverse(loop.begin(), loop.end());
      }
      loops.push_back(std::move(loop));
    }
  }
}

}
