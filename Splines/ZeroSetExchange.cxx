// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetGroupWorker.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <tuple>
#include <utility>

namespace hyperpatch
{

namespace
{

Numbering::Key KeyOf(int part, const ZeroSetPlace& place)
{
  return { place.Low[0], place.Low[1], place.Low[2], 8 * part + place.Axis };
}

}

ZeroSetPlace ZeroSetGroup::Worker::ToAll(
  std::size_t member, const Engine::Node& low, int axis, int size) const
{
  ZeroSetPlace place{ low, axis, size };
  for (std::size_t d = 0; d < 3; ++d)
  {
    place.Low[d] += this->Part(member).FirstLine[d];
  }
  return place;
}

ZeroSetGroup::Worker::Engine::Node ZeroSetGroup::Worker::ToOwn(
  std::size_t member, const std::array<int, 3>& low) const
{
  Engine::Node own = low;
  for (std::size_t d = 0; d < 3; ++d)
  {
    own[d] -= this->Part(member).FirstLine[d];
  }
  return own;
}

bool ZeroSetGroup::Worker::IsShared(int part, const ZeroSetPlace& place) const
{
  const auto& links = this->Topology.Links(part);
  return std::any_of(links.begin(), links.end(),
    [&](const ZeroSetLink& link)
    {
      ZeroSetPlace at = place;
      return this->Topology.Map(link, at);
    });
}

void ZeroSetGroup::Worker::Disagree(int part, const ZeroSetPlace& place)
{
  for (const ZeroSetLink& link : this->Topology.Links(part))
  {
    ZeroSetPlace at = place;
    if (this->Topology.Map(link, at))
    {
      this->Disagreed.insert(link.Joint);
      return;
    }
  }
}

void ZeroSetGroup::Worker::ExchangeNodes()
{
  // Until nobody learns anything new: news travel around edges, from part to part.
  std::vector<std::size_t> told(this->Members.size(), 0);
  std::vector<std::vector<std::size_t>> membersOf(this->Topology.All().size());
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    membersOf[static_cast<std::size_t>(this->PartOf(m))].push_back(m);
  }
  for (bool news = true; this->Any(news);)
  {
    news = false;
    std::vector<double> records;
    for (std::size_t m = 0; m < this->Members.size(); ++m)
    {
      const Engine& engine = this->At(m);
      for (; told[m] < engine.NodeAt.size(); ++told[m])
      {
        const ZeroSetPlace place = this->ToAll(m, engine.NodeAt[told[m]], 3, 0);
        if (this->IsShared(this->PartOf(m), place))
        {
          records.push_back(this->PartOf(m));
          Append(records, place.Low);
        }
      }
    }
    records = this->OfAll.All(records);
    for (ZeroSetRecord r(records); !r.IsAtEnd();)
    {
      const int part = r.Integer();
      const ZeroSetPlace place{ { r.Integer(), r.Integer(), r.Integer() }, 3, 0 };
      for (const ZeroSetLink& link : this->Topology.Links(part))
      {
        ZeroSetPlace at = place;
        if (!membersOf[static_cast<std::size_t>(link.Other)].empty() &&
          this->Topology.Map(link, at))
        {
          for (const std::size_t m : membersOf[static_cast<std::size_t>(link.Other)])
          {
            news = this->At(m).AddNode(this->ToOwn(m, at.Low)).second || news;
          }
        }
      }
    }
  }
}

void ZeroSetGroup::Worker::ExchangeValues()
{
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const Engine& engine = this->At(m);
    for (std::size_t n = 0; n < engine.NodeAt.size(); ++n)
    {
      const ZeroSetPlace place = this->ToAll(m, engine.NodeAt[n], 3, 0);
      if (this->IsShared(this->PartOf(m), place))
      {
        records.push_back(this->PartOf(m));
        Append(records, place.Low);
        records.push_back(engine.NodeValues[n]);
      }
    }
  }
  records = this->OfAll.All(records);
  Numbering numbers;
  std::vector<double> values;
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
  {
    const int part = r.Integer();
    const ZeroSetPlace place{ { r.Integer(), r.Integer(), r.Integer() }, 3, 0 };
    const double value = r.Number();
    if (numbers.Number(KeyOf(part, place)).second)
    {
      values.push_back(value);
    }
  }
  std::vector<ZeroSetParts::Seen> all;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    Engine& engine = this->At(m);
    const double differs = this->Differs[this->Members[m].Value];
    for (std::size_t n = 0; n < engine.NodeAt.size(); ++n)
    {
      const ZeroSetPlace place = this->ToAll(m, engine.NodeAt[n], 3, 0);
      for (const ZeroSetLink& link : this->Topology.Links(this->PartOf(m)))
      {
        ZeroSetPlace at = place;
        if (this->Topology.Map(link, at))
        {
          const Index number = numbers.Find(KeyOf(link.Other, at));
          if (number >= 0 &&
            !(std::abs(values[static_cast<std::size_t>(number)] - engine.NodeValues[n]) <= differs))
          {
            this->Disagreed.insert(link.Joint);
          }
        }
      }
      // The value of the first part that has the node; where signs differ, the surface runs through
      // it: no box needs to be there that was excluded before.
      this->Topology.FindAll(this->PartOf(m), place, all);
      const bool isPositive = engine.NodeValues[n] >= 0.0;
      bool differ = false;
      auto best = Numbering::Key{ 0, 0, 0, INT_MAX };
      for (const ZeroSetParts::Seen& seen : all)
      {
        const Numbering::Key key = KeyOf(seen.Part, seen.At);
        const Index number = all.size() > 1 ? numbers.Find(key) : -1;
        if (number < 0)
        {
          continue;
        }
        const double value = values[static_cast<std::size_t>(number)];
        differ = differ || (value >= 0.0) != isPositive;
        if (std::make_pair(key[3], key) < std::make_pair(best[3], best))
        {
          best = key;
          engine.NodeValues[n] = value;
        }
      }
      engine.NodeValues[n] = differ ? 0.0 : engine.NodeValues[n];
    }
  }
}

bool ZeroSetGroup::Worker::Take(
  std::size_t member, Engine::Samples& samples, Index i, const Eigen::Vector3d& place)
{
  // The surface runs through the place of the other side: that is an error of this one.
  ZeroSetCertificate& certificate = this->At(member).Taken;
  const double gap = (samples.Points.col(i) - place).norm();
  certificate.LargestError = std::max(certificate.LargestError, gap);
  samples.Points.col(i) = place;
  return gap <= this->Distance &&
    samples.Residuals[i] <= this->Differs[this->Members[member].Value];
}

void ZeroSetGroup::Worker::ExchangeVertices()
{
  struct Found
  {
    double Fraction;
    Eigen::Vector3d Point;
    bool IsZero;
  };
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    Engine& engine = this->At(m);
    engine.Taken = ZeroSetCertificate();
    for (std::size_t v = 0; v < engine.Vertices.size(); ++v)
    {
      const Engine::Vertex& vertex = engine.Vertices[v];
      const ZeroSetPlace place = this->ToAll(m, vertex.At, vertex.Axis, vertex.Size);
      if (this->IsShared(this->PartOf(m), place))
      {
        records.push_back(this->PartOf(m));
        Append(records, place.Low);
        records.insert(records.end(), { static_cast<double>(vertex.Axis), vertex.Fraction });
        Append(records, engine.Shared.Points.col(static_cast<Index>(v)));
        records.push_back(vertex.IsZero ? 1.0 : 0.0);
      }
    }
  }
  records = this->OfAll.All(records);
  Numbering numbers;
  std::vector<Found> found;
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
  {
    const int part = r.Integer();
    const std::array<int, 3> low{ r.Integer(), r.Integer(), r.Integer() };
    const int axis = r.Integer();
    const double fraction = r.Number();
    const Eigen::Vector3d point(r.Numbers<3>().data());
    const bool isZero = r.Number() != 0.0;
    if (numbers.Number(KeyOf(part, { low, axis, 0 })).second)
    {
      found.push_back({ fraction, point, isZero });
    }
  }
  std::vector<ZeroSetParts::Seen> all;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    Engine& engine = this->At(m);
    std::vector<std::pair<Index, const Found*>> taken;
    for (std::size_t v = 0; v < engine.Vertices.size(); ++v)
    {
      Engine::Vertex& vertex = engine.Vertices[v];
      const ZeroSetPlace place = this->ToAll(m, vertex.At, vertex.Axis, vertex.Size);
      this->Topology.FindAll(this->PartOf(m), place, all);
      const Numbering::Key own = KeyOf(all[0].Part, all[0].At);
      Numbering::Key best = own;
      for (const ZeroSetParts::Seen& seen : all)
      {
        const Numbering::Key key = KeyOf(seen.Part, seen.At);
        if (numbers.Find(key) >= 0 &&
          std::make_pair(seen.Part, key) < std::make_pair(best[3] / 8, best))
        {
          best = key;
        }
      }
      if (best == own)
      {
        continue;
      }
      const Found& first = found[static_cast<std::size_t>(numbers.Find(best))];
      vertex.Fraction = first.Fraction;
      vertex.IsZero = first.IsZero;
      taken.emplace_back(static_cast<Index>(v), &first);
    }
    Engine::Samples samples;
    samples.Resize(engine, static_cast<Index>(taken.size()));
    for (std::size_t i = 0; i < taken.size(); ++i)
    {
      const Engine::Vertex& vertex = engine.Vertices[static_cast<std::size_t>(taken[i].first)];
      auto parameters = samples.Parameters.col(static_cast<Index>(i));
      parameters = engine.Shared.Parameters.col(taken[i].first);
      if (vertex.Axis < 3)
      {
        const int line = vertex.At[static_cast<std::size_t>(vertex.Axis)];
        const double low = engine.Line(vertex.Axis, line);
        const double high = engine.Line(vertex.Axis, line + vertex.Size);
        parameters[vertex.Axis] = low + vertex.Fraction * (high - low);
      }
    }
    engine.Evaluate(samples, 0, samples.Count());
    for (std::size_t i = 0; i < taken.size(); ++i)
    {
      const auto& [v, from] = taken[i];
      const Engine::Vertex& vertex = engine.Vertices[static_cast<std::size_t>(v)];
      // The middle of an edge need not be on the surface.
      if (!this->Take(m, samples, static_cast<Index>(i), from->Point) && vertex.Axis <= 3)
      {
        this->Disagree(this->PartOf(m), this->ToAll(m, vertex.At, vertex.Axis, vertex.Size));
      }
      engine.Copy(samples, static_cast<Index>(i), engine.Shared, v, 1);
    }
  }
}

void ZeroSetGroup::Worker::FindCurve(
  std::size_t member, const Engine::Curve& curve, std::vector<SeenCurve>& seen) const
{
  seen.clear();
  const Engine& engine = this->At(member);
  const int part = this->PartOf(member);
  const auto placeOf = [&](Index v)
  {
    const Engine::Vertex& vertex = engine.Vertices[static_cast<std::size_t>(v)];
    return this->ToAll(member, vertex.At, vertex.Axis, vertex.Size);
  };
  const auto add = [&seen](int where, int normal, ZeroSetPlace a, ZeroSetPlace b,
                     const std::array<int, 3>& axis, int joint)
  {
    const bool turned = std::tie(b.Low, b.Axis) < std::tie(a.Low, a.Axis);
    if (turned)
    {
      std::swap(a, b);
    }
    seen.push_back({ { where, normal, a.Low[0], a.Low[1], a.Low[2], a.Axis, b.Low[0], b.Low[1],
                       b.Low[2], b.Axis },
      turned, axis, joint });
  };
  const ZeroSetPlace from = placeOf(curve.From);
  const ZeroSetPlace to = placeOf(curve.To);
  if (curve.EdgeAxis >= 0)
  {
    // All around the edge; only the parameter along it counts.
    const auto axis = static_cast<std::size_t>(curve.EdgeAxis);
    const bool rises = from.Low < to.Low;
    const int size = std::abs(to.Low[axis] - from.Low[axis]);
    std::vector<ZeroSetParts::Seen> all;
    this->Topology.FindAll(part, { rises ? from.Low : to.Low, curve.EdgeAxis, size }, all);
    for (const ZeroSetParts::Seen& s : all)
    {
      constexpr int NoNormal = 3;
      const ZeroSetPlace low{ s.At.Low, 3, 0 };
      ZeroSetPlace high = low;
      high.Low[static_cast<std::size_t>(s.At.Axis)] += size;
      add(s.Part, NoNormal, rises ? low : high, rises ? high : low,
        { s.At.Axis, s.At.Axis, s.At.Axis }, -1);
    }
    return;
  }
  // On the other side of its face.
  add(part, curve.Normal, from, to, { 0, 1, 2 }, -1);
  const int line =
    curve.Line + this->Part(member).FirstLine[static_cast<std::size_t>(curve.Normal)];
  for (const ZeroSetLink& link : this->Topology.Links(part))
  {
    ZeroSetPlace a = from;
    ZeroSetPlace b = to;
    if (link.Side / 2 == curve.Normal && link.Line == line && this->Topology.Map(link, a) &&
      this->Topology.Map(link, b))
    {
      add(link.Other, link.OtherSide / 2, a, b, link.Axis, link.Joint);
    }
  }
}

void ZeroSetGroup::Worker::ForSharedCurves(std::size_t member,
  const std::function<void(Engine::Curve&, const std::vector<SeenCurve>&)>& visit)
{
  Engine& engine = this->At(member);
  std::vector<SeenCurve> seen;
  for (std::size_t c = 0; c < engine.Curves.size(); ++c)
  {
    if (engine.CurveOf[c] == static_cast<Index>(c) && engine.Curves[c].IsOnCrease)
    {
      this->FindCurve(member, engine.Curves[c], seen);
      if (seen.size() > 1)
      {
        visit(engine.Curves[c], seen);
      }
    }
  }
}

void ZeroSetGroup::Worker::ExchangeCurves()
{
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const Engine& engine = this->At(m);
    this->ForSharedCurves(m,
      [&](const Engine::Curve& curve, const std::vector<SeenCurve>& seen)
      {
        Append(records, seen[0].Key);
        records.insert(records.end(),
          { curve.HasFailed ? 1.0 : 0.0, curve.Measured.Distance,
            static_cast<double>(curve.Count) });
        for (Index i = 0; i < curve.Count; ++i)
        {
          const Index at = curve.First + (seen[0].Turned ? curve.Count - 1 - i : i);
          for (int d = 0; d < 3; ++d)
          {
            records.push_back(
              this->Topology.ToClass(this->Part(m), d, engine.Shared.Parameters(d, at)));
          }
          Append(records, engine.Shared.Points.col(at));
        }
      });
  }
  records = this->OfAll.All(records);
  std::map<CurveKey, FoundCurve> found;
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
  {
    CurveKey key{};
    for (int& k : key)
    {
      k = r.Integer();
    }
    FoundCurve one{};
    one.HasFailed = r.Number() != 0.0;
    one.Error = r.Number();
    one.Count = r.Integer();
    one.Points = records.data() + r.Position();
    r.Skip(6 * static_cast<std::size_t>(one.Count));
    found.emplace(key, one);
  }
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    this->TakeCurves(m, found);
  }
}

void ZeroSetGroup::Worker::TakeCurves(
  std::size_t member, const std::map<CurveKey, FoundCurve>& found)
{
  Engine& engine = this->At(member);
  struct Taken
  {
    Engine::Curve* Curve;
    FoundCurve From;
    SeenCurve As;
  };
  std::vector<Taken> taken;
  const Index before = engine.Shared.Count();
  Index total = before;
  this->ForSharedCurves(member,
    [&](Engine::Curve& curve, const std::vector<SeenCurve>& seen)
    {
      // The finest of those that succeeded, then that of the first part.
      const auto rank = [&found](const SeenCurve& s)
      {
        const auto one = found.find(s.Key);
        return one == found.end()
          ? std::make_tuple(true, Index(1), s.Key)
          : std::make_tuple(one->second.HasFailed, -one->second.Count, s.Key);
      };
      const auto best = std::min_element(seen.begin(), seen.end(),
        [&rank](const SeenCurve& a, const SeenCurve& b) { return rank(a) < rank(b); });
      if (best != seen.begin())
      {
        const FoundCurve& from = found.at(best->Key);
        curve.HasFailed = from.HasFailed;
        curve.Measured.Distance = from.Error;
        curve.Count = from.Count;
        curve.First = total;
        total += curve.Count;
        taken.push_back({ &curve, from, *best });
      }
    });
  const auto pointOf = [](const Taken& t, Index i)
  { return t.From.Points + 6 * (t.As.Turned ? t.From.Count - 1 - i : i); };
  engine.Shared.Resize(engine, total);
  for (const Taken& t : taken)
  {
    const Engine::Curve& curve = *t.Curve;
    for (Index i = 0; i < curve.Count; ++i)
    {
      for (int d = 0; d < 3; ++d)
      {
        const double a = engine.Shared.Parameters(d, curve.From);
        const double b = engine.Shared.Parameters(d, curve.To);
        const double there = pointOf(t, i)[t.As.Axis[static_cast<std::size_t>(d)]];
        const double x = std::clamp(
          this->Topology.FromClass(this->Part(member), d, there), engine.Low[d], engine.High[d]);
        // What runs along a line has its bits.
        const bool isOnLine = curve.EdgeAxis >= 0 ? d != curve.EdgeAxis : d == curve.Normal;
        const double same = 1e-12 * (engine.High[d] - engine.Low[d]);
        engine.Shared.Parameters(d, curve.First + i) =
          isOnLine || (a == b && std::abs(x - a) <= same) ? a : x;
      }
    }
  }
  engine.Evaluate(engine.Shared, before, total);
  for (const Taken& t : taken)
  {
    bool agrees = true;
    for (Index i = 0; i < t.Curve->Count; ++i)
    {
      const Eigen::Vector3d place(pointOf(t, i) + 3);
      agrees = this->Take(member, engine.Shared, t.Curve->First + i, place) && agrees;
    }
    if (!agrees && t.As.Joint >= 0)
    {
      this->Disagreed.insert(t.As.Joint);
    }
  }
}

void ZeroSetGroup::Worker::CountTouches()
{
  // A face between two parts on which f is 0 is drawn by the negative side. Where both are positive
  // nobody draws it, and both count it.
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const Engine& engine = this->At(m);
    for (const Engine::Leaf& leaf : engine.Leaves)
    {
      for (const ZeroSetLink& link : this->Topology.Links(this->PartOf(m)))
      {
        const int normal = link.Side / 2;
        const auto n = static_cast<std::size_t>(normal);
        const int line = link.Line - this->Part(m).FirstLine[n];
        const bool high = line != leaf.At.Low[n];
        if (!engine.IsFlat(leaf, normal, high) ||
          line != leaf.At.Low[n] + (high ? leaf.At.Size : 0))
        {
          continue;
        }
        records.insert(
          records.end(), { static_cast<double>(link.Number), link.IsFirst ? 1.0 : 0.0 });
        for (int d = 0; d < 3; ++d)
        {
          const int low = leaf.At.Low[static_cast<std::size_t>(d)];
          const double middle = 0.5 * (engine.Line(d, low) + engine.Line(d, low + leaf.At.Size));
          records.push_back(this->Topology.ToClass(this->Part(m), d, middle));
        }
      }
    }
  }
  records = this->OfAll.All(records);
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
  {
    const int number = r.Integer();
    const bool isFirst = r.Number() != 0.0;
    const std::array<double, 3> at = r.Numbers<3>();
    for (std::size_t m = 0; m < this->Members.size(); ++m)
    {
      for (const ZeroSetLink& link : this->Topology.Links(this->PartOf(m)))
      {
        if (link.Number != number || link.IsFirst == isFirst)
        {
          continue;
        }
        // A little inside of the face.
        const Engine& engine = this->At(m);
        Eigen::Vector3d x;
        for (int d = 0; d < 3; ++d)
        {
          const double own = this->Topology.FromClass(
            this->Part(m), d, at[static_cast<std::size_t>(link.Axis[static_cast<std::size_t>(d)])]);
          x[d] = std::clamp(own, engine.Low[d], engine.High[d]);
        }
        const int normal = link.Side / 2;
        x[normal] = link.Side % 2 == 0 ? engine.Low[normal] + 0.25 * engine.Scale[normal]
                                       : engine.High[normal] - 0.25 * engine.Scale[normal];
        double value = 0.0;
        this->Members[m].Field->Evaluate(1, x.data(), &value);
        if (value > 0.0)
        {
          // The place on the face.
          ParameterBox place{};
          x[normal] = link.Side % 2 == 0 ? engine.Low[normal] : engine.High[normal];
          Eigen::Map<Eigen::Vector3d>(place.Low.data()) = x;
          place.High = place.Low;
          this->At(m).AddUndecided(place);
        }
      }
    }
  }
}

void ZeroSetGroup::Worker::CountOpenEdges()
{
  // Edges are open only if no other side has them too: the other of an interface, or the same where
  // it is collapsed.
  using Key = std::array<double, 7>;
  const auto keyOf = [this](std::size_t m, const std::array<Index, 2>& edge, int& sign)
  {
    const Engine& engine = this->At(m);
    std::array<std::array<double, 3>, 2> ends{};
    for (std::size_t k = 0; k < 2; ++k)
    {
      const auto x = engine.Shared.Points.col(edge[k]);
      ends[k] = { x[0] + 0.0, x[1] + 0.0, x[2] + 0.0 };
    }
    sign = ends[0] < ends[1] ? 1 : -1;
    const auto& [low, high] = std::minmax(ends[0], ends[1]);
    return Key{ static_cast<double>(this->Members[m].Value), low[0], low[1], low[2], high[0],
      high[1], high[2] };
  };
  const auto hasLink = [this](std::size_t m, unsigned sides)
  {
    const auto& links = this->Topology.Links(this->PartOf(m));
    return std::any_of(links.begin(), links.end(),
      [sides](const ZeroSetLink& link) { return (sides >> link.Side & 1u) != 0; });
  };
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    for (const auto& edge : this->At(m).OpenEdges)
    {
      int sign = 0;
      Append(records, keyOf(m, edge, sign));
      records.push_back(sign);
    }
  }
  records = this->OfAll.All(records);
  std::map<Key, int> balance;
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
  {
    const Key key = r.Numbers<7>();
    balance[key] += r.Integer();
  }
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const Engine& engine = this->At(m);
    for (const auto& edge : engine.OpenEdges)
    {
      int sign = 0;
      if (balance[keyOf(m, edge, sign)] * sign <= 0)
      {
        continue;
      }
      const unsigned sides = engine.SidesOf(edge);
      bool isBoundary = false;
      bool isInterface = false;
      for (int side = 0; side < NumberOfSides; ++side)
      {
        const bool isOn = (sides >> side & 1u) != 0;
        const bool isListed = this->Topology.IsListed(this->PartOf(m), side);
        isBoundary = isBoundary || (isOn && !isListed);
        isInterface = isInterface || (isOn && isListed && !hasLink(m, 1u << side));
      }
      ZeroSetCertificate& certificate = this->At(m).Certificate;
      ++(isBoundary     ? certificate.OpenEdgesOnBoundary
          : isInterface ? certificate.OpenEdgesOnInterfaces
                        : certificate.OpenEdgesInside);
    }
  }
}

}
