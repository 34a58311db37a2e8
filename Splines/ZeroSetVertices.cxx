// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hyperpatch
{

namespace
{

/// What two parameters must differ by to be told apart after a sum or product.
double Resolution(double a, double b)
{
  return std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
}

}

bool ZeroSet::Worker::FindVertices()
{
  const auto count = static_cast<Index>(this->Vertices.size());
  this->Shared.Resize(*this, count);
  return this->Parallel(count, Batch,
    [&](Index begin, Index end)
    {
      // Bracketed roots along edges, all of a batch in step: false position with Illinois' halved
      // weights, and a bisection wherever it does not halve the bracket in three steps.
      struct Bracket
      {
        Index Sample;
        int Axis;
        double Low, High, FLow, FHigh;
        double WeightLow, WeightHigh; ///< Illinois: of an end that stays
        double Width;
        int Side, Steps;
      };
      constexpr int Most = 4 * 64; // steps, should every bracket have to be bisected
      std::vector<Bracket> open;
      std::vector<double> parameters;
      std::vector<double> values;
      std::vector<Index> wanted;
      for (Index v = begin; v < end; ++v)
      {
        if (!this->TakeBefore(v))
        {
          wanted.push_back(v);
        }
      }
      Samples samples;
      samples.Resize(*this, static_cast<Index>(wanted.size()));
      for (Index i = 0; i < samples.Count(); ++i)
      {
        const auto v = static_cast<std::size_t>(wanted[static_cast<std::size_t>(i)]);
        const Vertex& vertex = this->Vertices[v];
        samples.Parameters.col(i) = this->ParameterOf(vertex.At);
        if (vertex.Axis > 3)
        {
          const int axis = vertex.Axis - 4;
          const int line = vertex.At[static_cast<std::size_t>(axis)];
          double& middle = samples.Parameters(axis, i);
          middle = 0.5 * (middle + this->Line(axis, line + vertex.Size));
        }
        if (vertex.Axis < 3)
        {
          const auto axis = static_cast<std::size_t>(vertex.Axis);
          double low = this->Line(vertex.Axis, vertex.At[axis]);
          double high = this->Line(vertex.Axis, vertex.At[axis] + vertex.Size);
          double fLow = vertex.FLow;
          double fHigh = vertex.FHigh;
          if (high < low)
          {
            std::swap(low, high);
            std::swap(fLow, fHigh);
          }
          open.push_back({ i, vertex.Axis, low, high, fLow, fHigh, 1.0, 1.0, high - low, 0, 0 });
        }
      }
      for (int iteration = 0; !open.empty(); ++iteration)
      {
        parameters.resize(3 * open.size());
        values.resize(open.size());
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket& o = open[b];
          const double low = o.WeightLow * o.FLow;
          const double high = o.WeightHigh * o.FHigh;
          double t = o.Low - low * (o.High - o.Low) / (high - low);
          if (o.Steps == 3)
          {
            o.Steps = 0;
            if (o.High - o.Low > 0.5 * o.Width)
            {
              t = 0.5 * (o.Low + o.High);
              o.WeightLow = o.WeightHigh = 1.0;
              o.Side = 0;
            }
            o.Width = o.High - o.Low;
          }
          ++o.Steps;
          // Never closer to an end than it matters: so a root beside an end closes the bracket.
          const double step = std::min(Resolution(o.Low, o.High), 0.5 * (o.High - o.Low));
          t = t > o.Low + step ? t : o.Low + step;
          t = t < o.High - step ? t : o.High - step;
          for (int d = 0; d < 3; ++d)
          {
            parameters[3 * b + static_cast<std::size_t>(d)] = samples.Parameters(d, o.Sample);
          }
          parameters[3 * b + static_cast<std::size_t>(o.Axis)] = t;
        }
        this->Field.Evaluate(open.size(), parameters.data(), values.data());
        std::size_t kept = 0;
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket o = open[b];
          const double t = parameters[3 * b + static_cast<std::size_t>(o.Axis)];
          const double f = values[b];
          if ((f >= 0.0) == (o.FHigh >= 0.0))
          {
            o.High = t;
            o.FHigh = f;
            o.WeightHigh = 1.0;
            o.WeightLow *= o.Side == 1 ? 0.5 : 1.0;
            o.Side = 1;
          }
          else
          {
            o.Low = t;
            o.FLow = f;
            o.WeightLow = 1.0;
            o.WeightHigh *= o.Side == -1 ? 0.5 : 1.0;
            o.Side = -1;
          }
          if (f == 0.0 || o.High - o.Low <= 2.0 * Resolution(o.Low, o.High) || iteration == Most ||
            !std::isfinite(f))
          {
            const bool low = std::abs(o.FLow) < std::abs(o.FHigh);
            samples.Parameters(o.Axis, o.Sample) = low ? o.Low : o.High;
          }
          else
          {
            open[kept++] = o;
          }
        }
        open.resize(kept);
      }
      this->Evaluate(samples, 0, samples.Count());
      for (Index i = 0; i < samples.Count(); ++i)
      {
        const Index v = wanted[static_cast<std::size_t>(i)];
        Vertex& vertex = this->Vertices[static_cast<std::size_t>(v)];
        if (vertex.Axis < 3)
        {
          const int line = vertex.At[static_cast<std::size_t>(vertex.Axis)];
          const double low = this->Line(vertex.Axis, line);
          const double high = this->Line(vertex.Axis, line + vertex.Size);
          vertex.Fraction = (samples.Parameters(vertex.Axis, i) - low) / (high - low);
        }
        vertex.IsZero = samples.Residuals[i] == 0.0;
        this->Copy(samples, i, this->Shared, v, 1);
      }
    });
}

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

bool ZeroSet::Worker::TakeBefore(Index v)
{
  Vertex& vertex = this->Vertices[static_cast<std::size_t>(v)];
  if (this->Before.Vertices.empty())
  {
    return false;
  }
  const auto node = static_cast<std::size_t>(this->Find(vertex.At));
  const Index before = node < this->Before.AtNode.size()
    ? this->Before.AtNode[node].Vertices[static_cast<std::size_t>(vertex.Axis)]
    : -1;
  if (before < 0)
  {
    return false;
  }
  const Vertex& same = this->Before.Vertices[static_cast<std::size_t>(before)];
  if (same.Size != vertex.Size || same.FLow != vertex.FLow || same.FHigh != vertex.FHigh)
  {
    return false;
  }
  vertex = same;
  this->Copy(this->Before.Shared, before, this->Shared, v, 1);
  return true;
}

void ZeroSet::Worker::Snap()
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
  // Curves with the same ends become one, except that of creases those in one plane only (which is
  // all that the patch on the other side of it sees), and of edges those that are that edge.
  constexpr int Anywhere = 0;
  constexpr int OnEdge = -1;
  this->CurveOf.assign(this->Curves.size(), -1);
  Numbering ends;
  std::vector<Index> firstOf;
  const auto join = [&](std::size_t c, int where, bool isNewAnywhere)
  {
    const auto [low, high] = std::minmax(this->Curves[c].From, this->Curves[c].To);
    const auto [number, isNew] =
      ends.Number({ static_cast<int>(low), static_cast<int>(high), where, 0 });
    if (isNew)
    {
      firstOf.push_back(static_cast<Index>(c));
    }
    if (isNewAnywhere)
    {
      this->CurveOf[c] = firstOf[static_cast<std::size_t>(number)];
    }
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
      curve.From = vertexOf[static_cast<std::size_t>(curve.From)];
      curve.To = vertexOf[static_cast<std::size_t>(curve.To)];
      if (curve.From == curve.To)
      {
        continue;
      }
      const int plane = 1 + curve.Normal + 3 * (curve.Line / CellLines::RootSize);
      join(c, !onCrease ? Anywhere : curve.EdgeAxis >= 0 ? OnEdge : plane, true);
      if (onCrease)
      {
        join(c, Anywhere, false); // for those that are not on a crease
      }
    }
  }
}

}
