// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetGroup.h"

#include "ZeroSetGroupWorker.h"

#include <algorithm>
#include <atomic>
#include <cmath>
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

}

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
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
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
  for (ZeroSetRecord r(flat); !r.IsAtEnd();)
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
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
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
  for (ZeroSetRecord r(records); !r.IsAtEnd(); r.Skip(Size))
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
    this->CountTouches();
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
    const bool assembled = this->ForAll([](Engine& engine) { return engine.Assemble(); });
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

ZeroSetMesh ZeroSetGroup::TakeMesh(std::size_t member)
{
  return std::move(this->W->ZeroSets[member]->W->Mesh);
}

const std::vector<ParameterBox>& ZeroSetGroup::UndecidedBoxes(std::size_t member) const
{
  return this->W->ZeroSets[member]->UndecidedBoxes();
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

ZeroSetCertificate ZeroSetGroup::TotalCertificate() const
{
  const ZeroSetCertificate own = this->Certificate();
  const std::vector<double> records = this->W->Gathered(
    { static_cast<double>(own.CertifiedCells), static_cast<double>(own.UndecidedCells),
      own.LargestResidual, own.LargestError, own.LargestAttributeError,
      own.ToleranceReached ? 1.0 : 0.0, static_cast<double>(own.OpenEdgesOnBoundary),
      static_cast<double>(own.OpenEdgesOnInterfaces), static_cast<double>(own.OpenEdgesInside) });
  ZeroSetCertificate all;
  for (ZeroSetRecord r(records); !r.IsAtEnd();)
  {
    ZeroSetCertificate one;
    one.CertifiedCells = static_cast<std::int64_t>(r.Number());
    one.UndecidedCells = static_cast<std::int64_t>(r.Number());
    one.LargestResidual = r.Number();
    one.LargestError = r.Number();
    one.LargestAttributeError = r.Number();
    one.ToleranceReached = r.Number() != 0.0;
    one.OpenEdgesOnBoundary = static_cast<std::int64_t>(r.Number());
    one.OpenEdgesOnInterfaces = static_cast<std::int64_t>(r.Number());
    one.OpenEdgesInside = static_cast<std::int64_t>(r.Number());
    all.Add(one);
  }
  return all;
}

}
