// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <array>
#include <utility>

namespace hyperpatch
{

std::vector<ZeroSet::Worker::Index> ZeroSet::Worker::JoinAround(const Node& node,
  const std::vector<Index>& vertices, const std::vector<std::array<Index, 2>>& links) const
{
  const std::size_t count = vertices.size();
  std::vector<Index> joined = vertices;
  // The creases through the node in which the edge of a vertex does not lie. Those that stay in all
  // of them can stand for the others.
  std::vector<char> leaves(count, 0);
  int creases = 0;
  for (const int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const bool isCrease = this->Lines[D].IsCrease(node[D]);
    creases += isCrease ? 1 : 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      leaves[i] |= isCrease && this->Vertices[static_cast<std::size_t>(vertices[i])].Axis == d;
    }
  }
  std::array<std::array<bool, MostAround>, MostAround> isLinked{};
  const auto place = [&vertices](Index v)
  {
    return static_cast<std::size_t>(
      std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  for (const auto& [from, to] : links)
  {
    const std::size_t a = place(from);
    const std::size_t b = place(to);
    isLinked[a][b] = isLinked[b][a] = true;
  }
  // Of what is collapsed around one that is added: vertices less curves, plus triangles of three.
  const auto euler = [&](const std::vector<std::size_t>& some)
  {
    int sum = 0;
    for (std::size_t i = 0; i < some.size(); ++i)
    {
      ++sum;
      for (std::size_t j = 0; j < i; ++j)
      {
        sum -= isLinked[some[i]][some[j]] ? 1 : 0;
        for (std::size_t k = 0; k < j; ++k)
        {
          sum +=
            isLinked[some[i]][some[j]] && isLinked[some[j]][some[k]] && isLinked[some[k]][some[i]]
            ? 1
            : 0;
        }
      }
    }
    return sum;
  };
  std::vector<std::vector<std::size_t>> groups;
  std::vector<char> isKnown(count, 0);
  for (std::size_t first = 0; first < count; ++first)
  {
    if (isKnown[first] || leaves[first])
    {
      continue;
    }
    std::vector<std::size_t> group{ first };
    isKnown[first] = 1;
    for (std::size_t i = 0; i < group.size() && creases < 2; ++i)
    {
      for (std::size_t j = 0; j < count; ++j)
      {
        if (isLinked[group[i]][j] && !isKnown[j] && !leaves[j])
        {
          isKnown[j] = 1;
          group.push_back(j);
        }
      }
    }
    if (euler(group) == 1)
    {
      groups.push_back(std::move(group));
      continue;
    }
    for (const std::size_t i : group)
    {
      groups.push_back({ i });
    }
  }
  for (std::vector<std::size_t>& group : groups)
  {
    // By place in space, which all patches around have the same bits of.
    const std::size_t best = *std::min_element(group.begin(), group.end(),
      [&](std::size_t a, std::size_t b)
      {
        const auto x = this->Shared.Points.col(vertices[a]);
        const auto y = this->Shared.Points.col(vertices[b]);
        return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
      });
    for (const std::size_t i : group)
    {
      joined[i] = vertices[best];
    }
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    if (!leaves[i])
    {
      continue;
    }
    std::vector<std::size_t>* only = nullptr;
    int found = 0;
    for (std::vector<std::size_t>& group : groups)
    {
      if (std::any_of(group.begin(), group.end(), [&](std::size_t j) { return isLinked[i][j]; }))
      {
        only = &group;
        ++found;
      }
    }
    if (found == 1)
    {
      only->push_back(i);
      if (euler(*only) == 1)
      {
        joined[i] = joined[only->front()];
      }
      else
      {
        only->pop_back();
      }
    }
  }
  return joined;
}

std::vector<ZeroSet::Worker::Index> ZeroSet::Worker::JoinVertices() const
{
  // Vertices of the edges around a node, if they are near to it: (node, vertex).
  constexpr double Near = 0.1;
  std::vector<std::pair<Node, Index>> around;
  for (std::size_t v = 0; v < this->Vertices.size(); ++v)
  {
    const Vertex& vertex = this->Vertices[v];
    if (vertex.Axis > 3)
    {
      continue;
    }
    Node node = vertex.At;
    if (vertex.Axis < 3)
    {
      if (vertex.Fraction > Near && vertex.Fraction < 1.0 - Near)
      {
        continue;
      }
      node[static_cast<std::size_t>(vertex.Axis)] += vertex.Fraction > 0.5 ? vertex.Size : 0;
    }
    around.emplace_back(node, static_cast<Index>(v));
  }
  std::sort(around.begin(), around.end());
  // The curves between those of one node.
  std::vector<Index> firstAround(this->Vertices.size(), -1);
  for (std::size_t first = 0, i = 0; i < around.size(); ++i)
  {
    first = around[i].first == around[first].first ? first : i;
    firstAround[static_cast<std::size_t>(around[i].second)] = static_cast<Index>(first);
  }
  std::vector<std::pair<Index, std::array<Index, 2>>> links;
  for (const Curve& curve : this->Curves)
  {
    const Index node = firstAround[static_cast<std::size_t>(curve.From)];
    if (node >= 0 && node == firstAround[static_cast<std::size_t>(curve.To)] &&
      curve.From != curve.To)
    {
      links.push_back({ node, { curve.From, curve.To } });
    }
  }
  std::sort(links.begin(), links.end());
  std::vector<Index> vertexOf(this->Vertices.size());
  for (std::size_t v = 0; v < vertexOf.size(); ++v)
  {
    vertexOf[v] = static_cast<Index>(v);
  }
  auto link = links.begin();
  std::vector<Index> some;
  std::vector<std::array<Index, 2>> between;
  while (link != links.end())
  {
    const auto first = static_cast<std::size_t>(link->first);
    some.clear();
    for (std::size_t i = first; i < around.size() && around[i].first == around[first].first; ++i)
    {
      some.push_back(around[i].second);
    }
    between.clear();
    for (; link != links.end() && link->first == static_cast<Index>(first); ++link)
    {
      between.push_back(link->second);
    }
    const std::vector<Index> joined = this->JoinAround(around[first].first, some, between);
    for (std::size_t i = 0; i < some.size(); ++i)
    {
      vertexOf[static_cast<std::size_t>(some[i])] = joined[i];
    }
  }
  return vertexOf;
}

void ZeroSet::Worker::JoinCurves(const std::vector<Index>& vertexOf)
{
  // Curves with the same ends become one, except that of creases those in one plane only (which is
  // all that the patch on the other side of it sees), and of edges those that are that edge.
  constexpr int Anywhere = 0;
  constexpr int OnEdge = -1;
  this->CurveOf.assign(this->Curves.size(), -1);
  for (Curve& curve : this->Curves)
  {
    curve.HasTwin = false;
  }
  // Chained by the lower end: there are few at a vertex, and they are near in memory.
  struct Ends
  {
    Index High;
    int Where;
    Index First; ///< the first curve with them
    Index Next;
  };
  std::vector<Ends> ends;
  std::vector<Index> chains(this->Vertices.size(), -1);
  const auto firstWith = [&](const std::array<Index, 2>& some, int where, Index c)
  {
    const auto [low, high] = std::minmax(some[0], some[1]);
    Index& chain = chains[static_cast<std::size_t>(low)];
    for (Index i = chain; i >= 0; i = ends[static_cast<std::size_t>(i)].Next)
    {
      const Ends& known = ends[static_cast<std::size_t>(i)];
      if (known.High == high && known.Where == where)
      {
        return known.First;
      }
    }
    ends.push_back({ high, where, c, chain });
    chain = static_cast<Index>(ends.size()) - 1;
    return c;
  };
  for (const bool onCrease : { true, false })
  {
    for (std::size_t c = 0; c < this->Curves.size(); ++c)
    {
      Curve& curve = this->Curves[c];
      if (curve.IsOnCrease != onCrease)
      {
        continue;
      }
      if (curve.EdgeAxis >= 0)
      {
        const Node& at = std::min(this->Vertices[static_cast<std::size_t>(curve.From)].At,
          this->Vertices[static_cast<std::size_t>(curve.To)].At);
        const Index middle = this->AtNode[static_cast<std::size_t>(this->Find(at))]
                               .Vertices[static_cast<std::size_t>(4 + curve.EdgeAxis)];
        curve.EdgeAxis =
          this->Vertices[static_cast<std::size_t>(middle)].IsZero ? curve.EdgeAxis : -1;
      }
      const std::array<Index, 2> joined{ vertexOf[static_cast<std::size_t>(curve.From)],
        vertexOf[static_cast<std::size_t>(curve.To)] };
      if (joined[0] == joined[1])
      {
        continue;
      }
      const auto own = static_cast<Index>(c);
      const int plane = 1 + curve.Normal + 3 * (curve.Line / CellLines::RootSize);
      const Index first = firstWith(joined,
        !onCrease               ? Anywhere
          : curve.EdgeAxis >= 0 ? OnEdge
                                : plane,
        own);
      this->CurveOf[c] = first;
      const Index anywhere = onCrease ? firstWith(joined, Anywhere, own) : first;
      if (anywhere != first)
      {
        this->Curves[static_cast<std::size_t>(anywhere)].HasTwin = true;
        this->Curves[static_cast<std::size_t>(first)].HasTwin = true;
      }
    }
  }
}

bool ZeroSet::Worker::PartLost(std::vector<Index>& vertexOf) const
{
  // Of curves that became one: how many of those in its plane run forward less those that run
  // backward, and whether any leaf has it as a side of what it draws.
  struct Joined
  {
    int Count = 0;
    int Balance = 0;
    bool IsSide = false;
  };
  std::vector<Joined> joined(this->Curves.size());
  const auto runsForward = [&](std::size_t c)
  {
    const Curve& kept = this->Curves[static_cast<std::size_t>(this->CurveOf[c])];
    return vertexOf[static_cast<std::size_t>(this->Curves[c].From)] ==
      vertexOf[static_cast<std::size_t>(kept.From)];
  };
  bool any = false;
  for (std::size_t c = 0; c < this->Curves.size(); ++c)
  {
    if (this->CurveOf[c] >= 0)
    {
      Joined& all = joined[static_cast<std::size_t>(this->CurveOf[c])];
      ++all.Count;
      any = any || all.Count > 1;
      all.Balance += !this->Curves[c].IsOnCrease ? 0 : runsForward(c) ? 1 : -1;
    }
  }
  std::vector<std::pair<Index, int>> balances;
  for (std::size_t leaf = 0; any && leaf < this->Leaves.size(); ++leaf)
  {
    balances.clear();
    for (Index f = this->FirstFace[leaf]; f < this->FirstFace[leaf + 1]; ++f)
    {
      const Index face = this->FacesOfLeaf[static_cast<std::size_t>(f)];
      const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face / 2)];
      for (Index c = first; c < first + count; ++c)
      {
        const Index kept = this->CurveOf[static_cast<std::size_t>(c)];
        if (kept >= 0 && joined[static_cast<std::size_t>(kept)].Count > 1)
        {
          const bool forward = runsForward(static_cast<std::size_t>(c)) == (face % 2 != 0);
          balances.emplace_back(kept, forward ? 1 : -1);
        }
      }
    }
    std::sort(balances.begin(), balances.end());
    for (std::size_t i = 0; i < balances.size();)
    {
      const Index kept = balances[i].first;
      int sum = 0;
      for (; i < balances.size() && balances[i].first == kept; ++i)
      {
        sum += balances[i].second;
      }
      bool& isSide = joined[static_cast<std::size_t>(kept)].IsSide;
      isSide = isSide || sum != 0;
    }
  }
  // In a plane beyond which the model goes on, only by what lies in it: both sides have to agree.
  const auto planesOf = [this](const Vertex& vertex)
  {
    unsigned planes = 0;
    for (const int d : this->Axes)
    {
      planes |=
        vertex.Axis != d && this->GoesOn(d, vertex.At[static_cast<std::size_t>(d)]) ? 1u << d : 0u;
    }
    return planes;
  };
  struct Ended
  {
    bool Parts = false;    ///< a curve that ends there would be lost
    bool Stays = false;    ///< any curve ends there
    unsigned InPlanes = 0; ///< normals of the planes of those lost
  };
  std::vector<Ended> ended(this->Vertices.size());
  for (std::size_t c = 0; c < this->Curves.size(); ++c)
  {
    if (this->CurveOf[c] != static_cast<Index>(c))
    {
      continue;
    }
    const Curve& curve = this->Curves[c];
    const Joined& all = joined[c];
    const bool isLost =
      curve.EdgeAxis < 0 && all.Count > 1 && (curve.IsOnCrease ? all.Balance == 0 : !all.IsSide);
    for (const Index end : { curve.From, curve.To })
    {
      const auto kept = static_cast<std::size_t>(vertexOf[static_cast<std::size_t>(end)]);
      Ended& at = ended[kept];
      at.Parts = at.Parts || isLost;
      at.InPlanes |= isLost && curve.IsOnCrease ? 1u << curve.Normal : 0u;
      at.Stays = at.Stays || curve.IsOnCrease || planesOf(this->Vertices[kept]) == 0;
    }
  }
  bool changed = false;
  for (std::size_t v = 0; v < this->Vertices.size(); ++v)
  {
    const auto own = static_cast<Index>(v);
    const Ended& at = ended[static_cast<std::size_t>(vertexOf[v])];
    if (vertexOf[v] != own &&
      (!at.Stays || (at.Parts && (planesOf(this->Vertices[v]) & ~at.InPlanes) == 0)))
    {
      vertexOf[v] = own;
      changed = true;
    }
  }
  return changed;
}

void ZeroSet::Worker::Snap()
{
  std::vector<Index> vertexOf = this->JoinVertices();
  this->JoinCurves(vertexOf);
  while (this->PartLost(vertexOf))
  {
    this->JoinCurves(vertexOf);
  }
  for (Curve& curve : this->Curves)
  {
    curve.From = vertexOf[static_cast<std::size_t>(curve.From)];
    curve.To = vertexOf[static_cast<std::size_t>(curve.To)];
  }
}

}
