// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetGroup.h"

#include "ZeroSetPartsWorker.h"
#include "ZeroSetWorker.h"

#include <algorithm>
#include <atomic>
#include <climits>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Fewer members than that: the loops inside each use the threads. More: they are dealt out whole.
constexpr std::size_t FewMembers = 8;

/// Places in [0, 1] at which both sides of an interface are compared.
constexpr std::array<double, 5> Places{ 0.0, 0.21, 0.5, 0.79, 1.0 };
constexpr std::size_t SamplesPerSide = Places.size() * Places.size();

/// Sides whose samples differ by less of the extent of the model are the same, where no interfaces
/// are known.
constexpr double ContactTolerance = 1e-9;

/// Reads numbers one after the other.
class Record
{
public:
  explicit Record(const std::vector<double>& numbers)
    : N(numbers)
  {
  }
  [[nodiscard]] bool IsAtEnd() const { return this->At >= this->N.size(); }
  double Number() { return this->N[this->At++]; }
  int Integer() { return static_cast<int>(this->Number()); }
  template <std::size_t Size>
  std::array<double, Size> Numbers()
  {
    std::array<double, Size> numbers{};
    std::copy_n(this->N.begin() + static_cast<std::ptrdiff_t>(this->At), Size, numbers.begin());
    this->At += Size;
    return numbers;
  }
  [[nodiscard]] std::size_t Position() const { return this->At; }
  void Skip(std::size_t count) { this->At += count; }

private:
  const std::vector<double>& N;
  std::size_t At = 0;
};

template <class Numbers>
void Append(std::vector<double>& records, const Numbers& numbers)
{
  for (const auto number : numbers)
  {
    records.push_back(static_cast<double>(number));
  }
}

Numbering::Key KeyOf(int part, const ZeroSetPlace& place)
{
  return { place.Low[0], place.Low[1], place.Low[2], 8 * part + place.Axis };
}

}

class ZeroSetGroup::Worker
{
public:
  using Index = std::int64_t;
  using Engine = ZeroSet::Worker;

  Worker(const std::vector<Member>& members, std::vector<Interface> interfaces, Ranks ranks,
    ParallelFor parallelFor);
  bool Extract(const std::function<void(double, double)>& stage);

  std::vector<std::unique_ptr<ZeroSet>> ZeroSets;

private:
  enum class Outcome
  {
    Finished,
    Aborted,
    Disagreed ///< interfaces were dropped: begin again
  };

  bool Any(bool value) const
  {
    const std::vector<double> all = this->OfAll.All({ value ? 1.0 : 0.0 });
    return std::find(all.begin(), all.end(), 1.0) != all.end();
  }
  /// False if aborted on any rank.
  bool ForAll(const std::function<bool(Engine&)>& work);
  void FindParts();
  /// Sides of parts that are the same: of elements, or of all.
  [[nodiscard]] std::vector<ZeroSetContact> FindAllContacts(
    const std::vector<ZeroSetPart>& parts, bool ofAll);
  void SetSides();
  void CompareSides();
  Outcome Draw(const std::function<void(double, double)>& stage);
  Outcome Finish();
  /// Takes the interfaces away on which a rank has found that both sides differ.
  bool DropDisagreed();
  void ExchangeNodes();
  void ExchangeValues();
  void ExchangeVertices();
  void ExchangeCurves();
  void CountOpenEdges();

  [[nodiscard]] Engine& At(std::size_t member) const { return *this->ZeroSets[member]->W; }
  [[nodiscard]] int PartOf(std::size_t member) const { return this->Parts[member]; }
  [[nodiscard]] const ZeroSetPart& Part(std::size_t member) const
  {
    return this->Topology.All()[static_cast<std::size_t>(this->Parts[member])];
  }
  /// Local lines to those of all, and back.
  [[nodiscard]] ZeroSetPlace ToAll(
    std::size_t member, const Engine::Node& low, int axis, int size) const;
  [[nodiscard]] Engine::Node ToOwn(std::size_t member, const std::array<int, 3>& low) const;
  /// Whether any link reaches the place.
  [[nodiscard]] bool IsShared(int part, const ZeroSetPlace& place) const;
  void Disagree(int part, const ZeroSetPlace& place);
  /// A point taken from another side: what it is here. False if it is no point of the surface here.
  bool Take(std::size_t member, Engine::Samples& samples, Index i, const Eigen::Vector3d& place);

  std::vector<Member> Members;
  std::vector<Interface> Interfaces;
  Ranks OfAll;
  ParallelFor For;
  ZeroSetParts Topology;
  std::vector<int> Parts; ///< per member
  std::set<int> Disagreed;
  double Distance = 0.0;         ///< between two sides that count as one
  std::map<int, double> Differs; ///< the same for the field of each value
};

ZeroSetGroup::Worker::Worker(const std::vector<Member>& members, std::vector<Interface> interfaces,
  Ranks ranks, ParallelFor parallelFor)
  : Members(members)
  , Interfaces(std::move(interfaces))
  , OfAll(std::move(ranks))
  , For(std::move(parallelFor))
{
  for (Member& member : this->Members)
  {
    member.Options.For = this->Members.size() < FewMembers ? this->For : SerialFor;
    this->ZeroSets.push_back(std::make_unique<ZeroSet>(member.Body, *member.Field, member.Options));
  }
}

bool ZeroSetGroup::Worker::ForAll(const std::function<bool(Engine&)>& work)
{
  const std::size_t count = this->ZeroSets.size();
  std::vector<char> finished(count, 0);
  const auto some = [&](std::ptrdiff_t begin, std::ptrdiff_t end)
  {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
    {
      finished[i] = work(this->At(i)) ? 1 : 0;
    }
  };
  if (count < FewMembers)
  {
    some(0, static_cast<std::ptrdiff_t>(count));
  }
  else
  {
    this->For(static_cast<std::ptrdiff_t>(count), 1, some);
  }
  return !this->Any(std::find(finished.begin(), finished.end(), 0) != finished.end());
}

void ZeroSetGroup::Worker::FindParts()
{
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const Patch& patch = *this->Members[m].On;
    const Engine& engine = this->At(m);
    // Samples say how large the model and the range of the field are.
    constexpr Index Steps = 3;
    Eigen::Matrix3Xd at(3, Steps * Steps * Steps);
    for (Index i = 0; i < at.cols(); ++i)
    {
      const Eigen::Vector3d t(static_cast<double>(i % Steps),
        static_cast<double>(i / Steps % Steps), static_cast<double>(i / (Steps * Steps)));
      at.col(i) = engine.Low + t.cwiseProduct(engine.High - engine.Low) / (Steps - 1);
    }
    std::vector<double> values(static_cast<std::size_t>(at.cols()));
    this->Members[m].Field->Evaluate(values.size(), at.data(), values.data());
    Eigen::MatrixXd points(engine.Geometry.Components(), at.cols());
    engine.Geometry.Evaluate(values.size(), at.data(), points.data());
    Eigen::Vector3d low = Eigen::Vector3d::Zero();
    Eigen::Vector3d high = low;
    low.head(points.rows()) = points.rowwise().minCoeff();
    high.head(points.rows()) = points.rowwise().maxCoeff();
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());

    Append(records,
      std::array<int, 4>{ this->Members[m].Value, patch.Id, this->OfAll.Own, static_cast<int>(m) });
    Append(records, patch.IsDomainFace);
    Append(records, patch.FirstSpan);
    records.insert(records.end(), { *least, *greatest });
    Append(records, low);
    Append(records, high);
    for (int d = 0; d < 3; ++d)
    {
      const auto D = static_cast<std::size_t>(d);
      const bool isThere = !engine.BreakAt[D].empty();
      records.insert(records.end(),
        { isThere ? 1.0 : 0.0, engine.Low[d], engine.High[d], engine.Lengths[D],
          static_cast<double>(engine.BreakAt[D].size()) });
      for (std::size_t b = 0; b < engine.BreakAt[D].size(); ++b)
      {
        records.insert(
          records.end(), { engine.BreakAt[D][b], engine.IsCreaseAt[D][b] ? 1.0 : 0.0 });
      }
    }
  }
  records = this->OfAll.All(records);
  std::vector<ZeroSetPart> parts;
  for (Record r(records); !r.IsAtEnd();)
  {
    ZeroSetPart part{};
    part.Value = r.Integer();
    part.Patch = r.Integer();
    part.Rank = r.Integer();
    part.Member = r.Integer();
    for (bool& isDomainFace : part.IsDomainFace)
    {
      isDomainFace = r.Number() != 0.0;
    }
    for (int& span : part.FirstSpan)
    {
      span = r.Integer();
    }
    part.LowValue = r.Number();
    part.HighValue = r.Number();
    part.Bounds = r.Numbers<6>();
    for (std::size_t d = 0; d < 3; ++d)
    {
      part.IsThere[d] = r.Number() != 0.0;
      part.First[d] = r.Number();
      part.Last[d] = r.Number();
      part.Lengths[d] = r.Number();
      part.Breaks[d].resize(static_cast<std::size_t>(r.Integer()));
      for (ZeroSetPart::Break& b : part.Breaks[d])
      {
        b.At = r.Number();
        b.IsCrease = r.Number() != 0.0;
      }
    }
    parts.push_back(std::move(part));
  }
  // In an order that does not depend on who has them.
  std::stable_sort(parts.begin(), parts.end(),
    [](const ZeroSetPart& a, const ZeroSetPart& b)
    { return std::tie(a.Value, a.Patch, a.FirstSpan) < std::tie(b.Value, b.Patch, b.FirstSpan); });

  std::vector<double> flat;
  for (const Interface& interface : this->Interfaces)
  {
    Append(flat, interface.Values);
  }
  flat = this->OfAll.All(flat);
  std::vector<Interface> interfaces;
  for (Record r(flat); !r.IsAtEnd();)
  {
    Interface interface {
    };
    for (int& value : interface.Values)
    {
      value = r.Integer();
    }
    interfaces.push_back(interface);
  }
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY);
  Eigen::Vector3d high = -low;
  std::map<int, std::array<double, 2>> ranges;
  this->Parts.assign(this->Members.size(), -1);
  for (std::size_t p = 0; p < parts.size(); ++p)
  {
    const ZeroSetPart& part = parts[p];
    if (part.Rank == this->OfAll.Own)
    {
      this->Parts[static_cast<std::size_t>(part.Member)] = static_cast<int>(p);
    }
    low = low.cwiseMin(Eigen::Vector3d(part.Bounds.data()));
    high = high.cwiseMax(Eigen::Vector3d(part.Bounds.data() + 3));
    auto& range =
      ranges.try_emplace(part.Value, std::array<double, 2>{ part.LowValue, part.HighValue })
        .first->second;
    range = { std::min(range[0], part.LowValue), std::max(range[1], part.HighValue) };
  }
  this->Distance = parts.empty() ? 0.0 : AgreementTolerance * (high - low).norm();
  const bool hasElements = ZeroSetParts::FindElements(parts);
  const std::vector<ZeroSetContact> contacts = hasElements || interfaces.empty()
    ? this->FindAllContacts(parts, interfaces.empty())
    : std::vector<ZeroSetContact>();
  this->Topology.Set(std::move(parts), interfaces, contacts);
  for (const auto& [value, range] : ranges)
  {
    this->Differs[value] = AgreementTolerance * (range[1] - range[0]);
  }
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    this->At(m).SetLines(this->Topology.LinesOf(this->Part(m)));
  }
}

std::vector<ZeroSetContact> ZeroSetGroup::Worker::FindAllContacts(
  const std::vector<ZeroSetPart>& parts, bool ofAll)
{
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const ZeroSetPart& part = parts[static_cast<std::size_t>(this->PartOf(m))];
    const Engine& engine = this->At(m);
    for (int side = 0; side < NumberOfSides; ++side)
    {
      if (!(ofAll || part.IsElement) || engine.Axes.size() != 3 ||
        !part.IsDomainFace[static_cast<std::size_t>(side)])
      {
        continue;
      }
      constexpr std::size_t Count = ZeroSetSide::Places.size();
      const int normal = side / 2;
      Eigen::Matrix3Xd at(3, static_cast<Index>(ZeroSetSide::Size));
      for (Index i = 0; i < at.cols(); ++i)
      {
        std::size_t rest = static_cast<std::size_t>(i);
        for (int d = 0; d < 3; ++d)
        {
          double t = side % 2;
          if (d != normal)
          {
            t = ZeroSetSide::Places[rest % Count];
            rest /= Count;
          }
          at(d, i) = t == 1.0 ? engine.High[d] : (1.0 - t) * engine.Low[d] + t * engine.High[d];
        }
      }
      Eigen::MatrixXd points(engine.Geometry.Components(), at.cols());
      engine.Geometry.Evaluate(ZeroSetSide::Size, at.data(), points.data());
      records.insert(
        records.end(), { static_cast<double>(this->PartOf(m)), static_cast<double>(side) });
      for (Index i = 0; i < at.cols(); ++i)
      {
        for (Index c = 0; c < 3; ++c)
        {
          records.push_back(c < points.rows() ? points(c, i) : 0.0);
        }
      }
    }
  }
  records = this->OfAll.All(records);
  std::map<int, std::vector<ZeroSetSide>> sides; // by value
  for (Record r(records); !r.IsAtEnd();)
  {
    ZeroSetSide side{};
    side.Part = r.Integer();
    side.Side = r.Integer();
    for (auto& sample : side.Samples)
    {
      sample = r.Numbers<3>();
    }
    sides[parts[static_cast<std::size_t>(side.Part)].Value].push_back(side);
  }
  std::vector<ZeroSetContact> contacts;
  for (auto& [value, some] : sides)
  {
    std::sort(some.begin(), some.end(),
      [](const ZeroSetSide& a, const ZeroSetSide& b)
      { return std::tie(a.Part, a.Side) < std::tie(b.Part, b.Side); });
    const auto found = FindContacts(some, ContactTolerance / AgreementTolerance * this->Distance);
    contacts.insert(contacts.end(), found.begin(), found.end());
  }
  return contacts;
}

void ZeroSetGroup::Worker::SetSides()
{
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    for (std::size_t side = 0; side < 6; ++side)
    {
      this->At(m).GoesBeyond[side] = !this->Members[m].On->IsDomainFace[side];
    }
    for (const ZeroSetLink& link : this->Topology.Links(this->PartOf(m)))
    {
      this->At(m).GoesBeyond[static_cast<std::size_t>(link.Side)] = true;
    }
  }
}

void ZeroSetGroup::Worker::CompareSides()
{
  // Both sides of each link give a grid of samples of what they have in common.
  constexpr std::size_t Size = 4 * SamplesPerSide;
  std::vector<double> records;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const ZeroSetPart& own = this->Part(m);
    for (const ZeroSetLink& link : this->Topology.Links(this->PartOf(m)))
    {
      const ZeroSetPart& other = this->Topology.All()[static_cast<std::size_t>(link.Other)];
      // In the order of the directions of the first side.
      const std::size_t normal = static_cast<std::size_t>(link.Side / 2);
      std::array<std::size_t, 3> axes{ 0, 1, 2 };
      if (!link.IsFirst)
      {
        std::sort(axes.begin(), axes.end(),
          [&link](std::size_t a, std::size_t b) { return link.Axis[a] < link.Axis[b]; });
      }
      Eigen::Matrix3Xd at(3, static_cast<Index>(SamplesPerSide));
      std::size_t stride = 1;
      for (const std::size_t d : axes)
      {
        const auto D = static_cast<int>(d);
        const auto e = static_cast<std::size_t>(link.Axis[d]);
        double begin = link.Side % 2 == 0 ? own.First[d] : own.Last[d];
        double end = begin;
        if (d != normal && own.IsThere[d])
        {
          const int low = std::max(own.FirstLine[d], other.FirstLine[e]);
          const int high = std::min(own.LastLine[d], other.LastLine[e]);
          begin = this->Topology.ClassParameter(own, D, low);
          end = this->Topology.ClassParameter(own, D, high);
        }
        for (std::size_t i = 0; i < SamplesPerSide; ++i)
        {
          const double t = Places[i / stride % Places.size()];
          double& x = at(D, static_cast<Index>(i));
          x = d == normal || !own.IsThere[d]
            ? begin
            : std::clamp(this->Topology.FromClass(own, D, begin + t * (end - begin)), own.First[d],
                own.Last[d]);
        }
        stride *= d == normal ? 1 : Places.size();
      }
      const Engine& engine = this->At(m);
      std::vector<double> values(SamplesPerSide);
      this->Members[m].Field->Evaluate(SamplesPerSide, at.data(), values.data());
      Eigen::MatrixXd points(engine.Geometry.Components(), at.cols());
      engine.Geometry.Evaluate(SamplesPerSide, at.data(), points.data());
      records.insert(records.end(),
        { static_cast<double>(link.Number), link.IsFirst ? 1.0 : 0.0,
          static_cast<double>(link.Joint), static_cast<double>(this->Members[m].Value) });
      for (std::size_t i = 0; i < SamplesPerSide; ++i)
      {
        for (Eigen::Index c = 0; c < 3; ++c)
        {
          records.push_back(c < points.rows() ? points(c, static_cast<Index>(i)) : 0.0);
        }
        records.push_back(values[i]);
      }
    }
  }
  records = this->OfAll.All(records);
  std::map<int, std::array<std::size_t, 2>> places; // of the samples of both sides
  this->Disagreed.clear();
  for (Record r(records); !r.IsAtEnd(); r.Skip(Size))
  {
    const int number = r.Integer();
    const bool isFirst = r.Number() != 0.0;
    const int joint = r.Integer();
    const double differs = this->Differs[r.Integer()];
    const auto [found, isNew] = places.try_emplace(number, std::array<std::size_t, 2>{});
    found->second[isFirst ? 0 : 1] = r.Position();
    if (isNew)
    {
      continue;
    }
    for (std::size_t i = 0; i < SamplesPerSide; ++i)
    {
      const double* a = &records[found->second[0] + 4 * i];
      const double* b = &records[found->second[1] + 4 * i];
      const double gap = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
      if (!(gap <= this->Distance && std::abs(a[3] - b[3]) <= differs))
      {
        this->Disagreed.insert(joint);
      }
    }
  }
}

bool ZeroSetGroup::Worker::DropDisagreed()
{
  std::vector<double> records;
  Append(records, this->Disagreed);
  this->Disagreed.clear();
  bool any = false;
  for (const double joint : this->OfAll.All(records))
  {
    any = this->Topology.Drop(static_cast<int>(joint)) || any;
  }
  return any;
}

bool ZeroSetGroup::Worker::Extract(const std::function<void(double, double)>& stage)
{
  this->FindParts();
  this->CompareSides();
  this->DropDisagreed();
  Outcome outcome = Outcome::Disagreed;
  while (outcome == Outcome::Disagreed)
  {
    outcome = this->Draw(stage);
  }
  if (outcome == Outcome::Finished)
  {
    this->CountOpenEdges();
  }
  return outcome == Outcome::Finished;
}

ZeroSetGroup::Worker::Outcome ZeroSetGroup::Worker::Draw(
  const std::function<void(double, double)>& stage)
{
  this->SetSides();
  stage(0.0, 0.3);
  if (!this->ForAll([](Engine& engine) { return engine.Search(); }))
  {
    return Outcome::Aborted;
  }
  stage(0.3, 0.8);
  this->ExchangeNodes();
  Outcome outcome = this->Finish();
  stage(0.8, 1.0);
  for (int round = 0; round < Engine::MostRefinements && outcome == Outcome::Finished; ++round)
  {
    std::atomic<bool> refined{ false };
    if (!this->ForAll(
          [&refined](Engine& engine)
          {
            if (engine.Refine())
            {
              refined = true;
            }
            return !engine.Options.Abort();
          }))
    {
      return Outcome::Aborted;
    }
    if (!this->Any(refined))
    {
      break;
    }
    this->ExchangeNodes();
    outcome = this->Finish();
  }
  if (outcome == Outcome::Finished)
  {
    const bool assembled = this->ForAll(
      [](Engine& engine)
      {
        engine.Assemble();
        return !engine.Options.Abort();
      });
    outcome = assembled ? Outcome::Finished : Outcome::Aborted;
  }
  return outcome;
}

ZeroSetGroup::Worker::Outcome ZeroSetGroup::Worker::Finish()
{
  if (!this->ForAll([](Engine& engine) { return engine.FindValues(); }))
  {
    return Outcome::Aborted;
  }
  this->ExchangeValues();
  if (this->DropDisagreed())
  {
    return Outcome::Disagreed;
  }
  if (!this->ForAll([](Engine& engine) { return engine.TraceFaces(); }))
  {
    return Outcome::Aborted;
  }
  this->ExchangeVertices();
  if (this->DropDisagreed())
  {
    return Outcome::Disagreed;
  }
  if (!this->ForAll([](Engine& engine) { return engine.FollowCurves(); }))
  {
    return Outcome::Aborted;
  }
  this->ExchangeCurves();
  if (this->DropDisagreed())
  {
    return Outcome::Disagreed;
  }
  return this->ForAll([](Engine& engine) { return engine.Fill(); }) ? Outcome::Finished
                                                                    : Outcome::Aborted;
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
    for (Record r(records); !r.IsAtEnd();)
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
            news = this->At(m).Learn(this->ToOwn(m, at.Low)) || news;
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
  for (Record r(records); !r.IsAtEnd();)
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
  for (Record r(records); !r.IsAtEnd();)
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

void ZeroSetGroup::Worker::ExchangeCurves()
{
  // A curve is known by its ends and, if it is no edge, by its plane.
  using Key = std::array<int, 10>;
  const auto keyOf = [](int part, int normal, ZeroSetPlace a, ZeroSetPlace b, bool& turned)
  {
    turned = std::tie(b.Low, b.Axis) < std::tie(a.Low, a.Axis);
    if (turned)
    {
      std::swap(a, b);
    }
    return Key{ part, normal, a.Low[0], a.Low[1], a.Low[2], a.Axis, b.Low[0], b.Low[1], b.Low[2],
      b.Axis };
  };
  constexpr int Edge = 3;
  struct Seen
  {
    Key At;
    bool Turned;
  };
  const auto see = [&](std::size_t m, const Engine::Curve& curve, std::vector<Seen>& seen)
  {
    seen.clear();
    const Engine& engine = this->At(m);
    const int part = this->PartOf(m);
    const auto placeOf = [&](Index v)
    {
      const Engine::Vertex& vertex = engine.Vertices[static_cast<std::size_t>(v)];
      return this->ToAll(m, vertex.At, vertex.Axis, vertex.Size);
    };
    const ZeroSetPlace from = placeOf(curve.From);
    const ZeroSetPlace to = placeOf(curve.To);
    bool turned = false;
    if (curve.EdgeAxis >= 0)
    {
      const auto axis = static_cast<std::size_t>(curve.EdgeAxis);
      const int size = std::abs(to.Low[axis] - from.Low[axis]);
      std::vector<ZeroSetParts::Seen> all;
      this->Topology.FindAll(part, { std::min(from.Low, to.Low), curve.EdgeAxis, size }, all);
      for (const ZeroSetParts::Seen& s : all)
      {
        ZeroSetPlace low{ s.At.Low, 3, 0 };
        ZeroSetPlace high = low;
        high.Low[static_cast<std::size_t>(s.At.Axis)] += size;
        const bool rises = from.Low < to.Low;
        const Key key = keyOf(s.Part, Edge, rises ? low : high, rises ? high : low, turned);
        seen.push_back({ key, turned });
      }
      return;
    }
    const Key own = keyOf(part, curve.Normal, from, to, turned);
    seen.push_back({ own, turned });
    const int line = curve.Line + this->Part(m).FirstLine[static_cast<std::size_t>(curve.Normal)];
    for (const ZeroSetLink& link : this->Topology.Links(part))
    {
      ZeroSetPlace a = from;
      ZeroSetPlace b = to;
      if (link.Side / 2 == curve.Normal && link.Line == line && this->Topology.Map(link, a) &&
        this->Topology.Map(link, b))
      {
        const Key key = keyOf(link.Other, link.OtherSide / 2, a, b, turned);
        seen.push_back({ key, turned });
      }
    }
  };

  std::vector<double> records;
  std::vector<Seen> seen;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const Engine& engine = this->At(m);
    for (std::size_t c = 0; c < engine.Curves.size(); ++c)
    {
      const Engine::Curve& curve = engine.Curves[c];
      if (engine.CurveOf[c] != static_cast<Index>(c) || !curve.IsOnCrease)
      {
        continue;
      }
      see(m, curve, seen);
      if (seen.size() < 2)
      {
        continue;
      }
      Append(records, seen[0].At);
      records.insert(records.end(),
        { curve.HasFailed ? 1.0 : 0.0, curve.Measured.Distance, static_cast<double>(curve.Count) });
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
    }
  }
  records = this->OfAll.All(records);
  struct Found
  {
    bool HasFailed;
    double Error;
    Index Count;
    std::size_t Points; ///< where they are in the records
  };
  std::map<Key, Found> found;
  for (Record r(records); !r.IsAtEnd();)
  {
    Key key{};
    for (int& k : key)
    {
      k = r.Integer();
    }
    Found one{};
    one.HasFailed = r.Number() != 0.0;
    one.Error = r.Number();
    one.Count = r.Integer();
    one.Points = r.Position();
    r.Skip(6 * static_cast<std::size_t>(one.Count));
    found.emplace(key, one);
  }
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    Engine& engine = this->At(m);
    struct Taken
    {
      std::size_t Curve;
      const Found* From;
      Key At;
      bool Turned;
    };
    std::vector<Taken> taken;
    const Index before = engine.Shared.Count();
    Index total = before;
    for (std::size_t c = 0; c < engine.Curves.size(); ++c)
    {
      Engine::Curve& curve = engine.Curves[c];
      if (engine.CurveOf[c] != static_cast<Index>(c) || !curve.IsOnCrease)
      {
        continue;
      }
      see(m, curve, seen);
      if (seen.size() < 2)
      {
        continue;
      }
      // The finest of those that succeeded, then that of the first part.
      const auto rank = [](const Key& key, const Found& one)
      { return std::make_tuple(one.HasFailed, -one.Count, key); };
      const Seen* best = &seen[0];
      const Found* from = &found.at(best->At);
      for (const Seen& s : seen)
      {
        const auto other = found.find(s.At);
        if (other != found.end() && rank(s.At, other->second) < rank(best->At, *from))
        {
          best = &s;
          from = &other->second;
        }
      }
      if (best == &seen[0])
      {
        continue;
      }
      curve.HasFailed = from->HasFailed;
      curve.Measured.Distance = from->Error;
      curve.Count = from->Count;
      curve.First = total;
      total += curve.Count;
      taken.push_back({ c, from, best->At, best->Turned });
    }
    engine.Shared.Resize(engine, total);
    for (const Taken& t : taken)
    {
      const Engine::Curve& curve = engine.Curves[t.Curve];
      // The class parameters of the other side, by our directions.
      std::array<int, 3> axis{ 0, 1, 2 };
      for (const ZeroSetLink& link : this->Topology.Links(this->PartOf(m)))
      {
        if (t.At[1] != Edge && link.Other == t.At[0] && link.Side / 2 == curve.Normal &&
          link.OtherSide / 2 == t.At[1])
        {
          axis = link.Axis;
        }
      }
      if (t.At[1] == Edge)
      {
        // Only the direction of the edge counts: the one in which its ends differ.
        const int far = t.At[2] != t.At[6] ? 0 : t.At[3] != t.At[7] ? 1 : 2;
        axis = { far, far, far };
      }
      for (Index i = 0; i < curve.Count; ++i)
      {
        const double* from = &records[t.From->Points +
          6 * static_cast<std::size_t>(t.Turned ? curve.Count - 1 - i : i)];
        for (int d = 0; d < 3; ++d)
        {
          const double a = engine.Shared.Parameters(d, curve.From);
          const double b = engine.Shared.Parameters(d, curve.To);
          const double x = std::clamp(
            this->Topology.FromClass(this->Part(m), d, from[axis[static_cast<std::size_t>(d)]]),
            engine.Low[d], engine.High[d]);
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
      const Engine::Curve& curve = engine.Curves[t.Curve];
      bool agrees = true;
      for (Index i = 0; i < curve.Count; ++i)
      {
        const double* from = &records[t.From->Points +
          6 * static_cast<std::size_t>(t.Turned ? curve.Count - 1 - i : i)];
        agrees = this->Take(m, engine.Shared, curve.First + i, Eigen::Vector3d(from + 3)) && agrees;
      }
      for (const ZeroSetLink& link : this->Topology.Links(this->PartOf(m)))
      {
        if (!agrees && link.Other == t.At[0] && link.Side / 2 == curve.Normal)
        {
          this->Disagreed.insert(link.Joint);
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
  for (Record r(records); !r.IsAtEnd();)
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

ZeroSetGroup::ZeroSetGroup(const std::vector<Member>& members, std::vector<Interface> interfaces,
  Ranks ranks, ParallelFor parallelFor)
  : W(std::make_unique<Worker>(
      members, std::move(interfaces), std::move(ranks), std::move(parallelFor)))
{
}

ZeroSetGroup::ZeroSetGroup(const std::vector<Member>& members, std::vector<Interface> interfaces)
  : ZeroSetGroup(members, std::move(interfaces), Ranks())
{
}

ZeroSetGroup::~ZeroSetGroup() = default;

bool ZeroSetGroup::Extract(const std::function<void(double begin, double end)>& stage)
{
  return this->W->Extract(stage);
}

const ZeroSetMesh& ZeroSetGroup::Mesh(std::size_t member) const
{
  return this->W->ZeroSets[member]->Mesh();
}

ZeroSetCertificate ZeroSetGroup::Certificate() const
{
  ZeroSetCertificate all;
  for (const auto& zeroSet : this->W->ZeroSets)
  {
    all.Add(zeroSet->Certificate());
  }
  return all;
}

}
