// SPDX-License-Identifier: BSD-3-Clause
// Patches that are clipped together: what they have in common is agreed on between steps.
#include "ClipSeamsWorker.h"
#include "ClipWorker.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

/// Fewer members than that: the loops inside each use the threads. More: they are dealt out whole.
constexpr std::size_t FewMembers = 8;

/// Places in [0, 1] at which both sides of an interface are compared.
constexpr std::array<double, 5> Places{ 0.0, 0.21, 0.5, 0.79, 1.0 };

/// Breaks nearer than this part of the domain are the same.
constexpr double SameBreak = 1e-6;

/// An interface between members. Direction d of the first runs along Direction[d] of the second.
struct Joint
{
  std::array<std::size_t, 2> Members;
  std::array<int, 2> Sides; ///< 0..5
  std::array<std::size_t, 3> Direction;
  std::array<bool, 3> Same;
};

/// Breaks from 0 to 1.
std::vector<double> Scaled(const std::vector<double>& breaks)
{
  std::vector<double> scaled;
  for (const double b : breaks)
  {
    scaled.push_back((b - breaks.front()) / (breaks.back() - breaks.front()));
  }
  return scaled;
}

}

class ClipGroup::Worker
{
public:
  Worker(std::vector<Member> members, const std::vector<Interface>& interfaces,
    ParallelFor parallelFor, Kept kept);
  bool Extract();

  std::vector<std::unique_ptr<ClipWorker>> Workers;
  Kept Bends;
  std::int64_t OpenFaces = 0;

private:
  [[nodiscard]] const std::array<KnotVector, 3>& Knots(std::size_t member) const
  {
    return this->Members[member].On->Body.Geometry().Knots();
  }
  void FindJoints(const std::vector<Interface>& interfaces);
  [[nodiscard]] bool Agrees(const Joint& joint) const;
  /// Gives both sides of joints the breaks of the other one.
  std::vector<std::array<std::vector<double>, 3>> ShareBreaks();

  bool ForAll(const std::function<bool(ClipWorker&)>& work);
  void LinkGridNodes();
  void LinkMiddles();
  void TakePoints();
  void ShareRanks();
  /// Edges that one side halves are halved on the other.
  void ShareMarks();
  bool HalveMarked();
  bool Cut();
  void CountOpenFaces();

  std::vector<Member> Members;
  ParallelFor For;
  std::vector<Joint> Joints;
  std::vector<CollapsedSides> Collapsed; ///< per member
  /// Per member, bits: sides at an interface, whether joined or not.
  std::vector<unsigned> Listed;
  Seams Nodes{ 0 };
};

ClipGroup::Worker::Worker(std::vector<Member> members, const std::vector<Interface>& interfaces,
  ParallelFor parallelFor, Kept kept)
  : Bends(std::move(kept))
  , Members(std::move(members))
  , For(std::move(parallelFor))
{
  this->FindJoints(interfaces);
  for (const Member& member : this->Members)
  {
    constexpr double SamePoint = 1e-9;
    const Spline& geometry = member.On->Body.Geometry();
    const auto points = geometry.Coefficients();
    this->Collapsed.emplace_back(
      geometry, SamePoint * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm());
  }
  const auto more = this->ShareBreaks();
  this->Nodes = Seams(this->Joints.size());
  this->Bends.resize(this->Members.size());
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    Member& member = this->Members[m];
    member.Options.For = this->Members.size() < FewMembers ? this->For : SerialFor;
    const auto& tolerances = member.Options.AttributeTolerances;
    std::vector<bool> isMeasured(member.On->Body.Attributes().size(), false);
    for (std::size_t a = 0; a < std::min(tolerances.size(), isMeasured.size()); ++a)
    {
      isMeasured[a] = tolerances[a] > 0.0 && std::isfinite(tolerances[a]);
    }
    auto& bends = this->Bends[m];
    auto made = std::make_shared<BendBounds>(member.On->Body, isMeasured, more[m]);
    if (!bends || !bends->IsLike(*made))
    {
      bends = std::move(made);
    }
    this->Workers.push_back(std::make_unique<ClipWorker>(member, bends, this->Collapsed[m]));
  }
}

void ClipGroup::Worker::FindJoints(const std::vector<Interface>& interfaces)
{
  std::map<int, std::size_t> memberOf;
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    memberOf.emplace(this->Members[m].On->Id, m);
  }
  this->Listed.assign(this->Members.size(), 0);
  for (const Interface& interface : interfaces)
  {
    const auto& v = interface.Values;
    const auto first = memberOf.find(v[0]);
    const auto second = memberOf.find(v[2]);
    const std::array<int, 2> sides{ v[1] - 1, v[3] - 1 };
    if (first != memberOf.end())
    {
      this->Listed[first->second] |= 1u << sides[0];
    }
    if (second != memberOf.end())
    {
      this->Listed[second->second] |= 1u << sides[1];
    }
    if (first == memberOf.end() || second == memberOf.end())
    {
      continue;
    }
    Joint joint{ { first->second, second->second }, sides, {}, {} };
    for (std::size_t d = 0; d < 3; ++d)
    {
      joint.Direction[d] = static_cast<std::size_t>(v[4 + d]);
      joint.Same[d] = v[7 + d] != 0;
    }
    if (this->Agrees(joint))
    {
      this->Joints.push_back(joint);
    }
  }
}

bool ClipGroup::Worker::Agrees(const Joint& joint) const
{
  const Member& a = this->Members[joint.Members[0]];
  const Member& b = this->Members[joint.Members[1]];
  const auto& knots = this->Knots(joint.Members[0]);
  const auto& others = this->Knots(joint.Members[1]);
  const auto normal = static_cast<std::size_t>(joint.Sides[0] / 2);
  if (a.Fields.size() != b.Fields.size() ||
    !a.On->IsDomainFace[static_cast<std::size_t>(joint.Sides[0])] ||
    !b.On->IsDomainFace[static_cast<std::size_t>(joint.Sides[1])] ||
    joint.Direction[normal] != static_cast<std::size_t>(joint.Sides[1] / 2))
  {
    return false;
  }
  std::vector<Eigen::Vector3d> ua;
  std::vector<Eigen::Vector3d> ub;
  for (const double s : Places)
  {
    for (const double t : Places)
    {
      Eigen::Vector3d& u = ua.emplace_back();
      Eigen::Vector3d& v = ub.emplace_back();
      bool isFirst = true;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const std::size_t e = joint.Direction[d];
        if ((knots[d].Degree() > 0) != (others[e].Degree() > 0))
        {
          return false;
        }
        double own = isFirst ? s : t;
        double other = joint.Same[d] ? own : 1.0 - own;
        isFirst = isFirst && d == normal;
        if (d == normal)
        {
          own = joint.Sides[0] % 2;
          other = joint.Sides[1] % 2;
        }
        const auto at = [](const KnotVector& k, double x)
        { return x == 1.0 ? k.Last() : k.First() + x * (k.Last() - k.First()); };
        u[static_cast<Eigen::Index>(d)] = at(knots[d], own);
        v[static_cast<Eigen::Index>(e)] = at(others[e], other);
      }
    }
  }
  const auto& ga = *a.Body->Geometry();
  const auto& gb = *b.Body->Geometry();
  if (ga.Spline().Components() != gb.Spline().Components())
  {
    return false;
  }
  const auto count = static_cast<Eigen::Index>(ua.size());
  Eigen::MatrixXd xa(ga.Spline().Components(), count);
  Eigen::MatrixXd xb = xa;
  ga.Evaluator().Evaluate(ua.size(), ua.front().data(), xa.data());
  gb.Evaluator().Evaluate(ub.size(), ub.front().data(), xb.data());
  double extent = 0.0;
  for (const Member& member : this->Members)
  {
    const auto points = member.On->Body.Geometry().Coefficients();
    extent = std::max(extent, (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm());
  }
  if (!((xa - xb).colwise().norm().maxCoeff() <= AgreementTolerance * extent))
  {
    return false;
  }
  for (std::size_t k = 0; k < a.Fields.size(); ++k)
  {
    Eigen::VectorXd fa(count);
    Eigen::VectorXd fb(count);
    a.Fields[k]->Evaluate(ua.size(), ua.front().data(), fa.data());
    b.Fields[k]->Evaluate(ub.size(), ub.front().data(), fb.data());
    // Fields are known up to positive factors: what has to agree is their sign.
    const double scale = std::max(fa.cwiseAbs().maxCoeff(), fb.cwiseAbs().maxCoeff());
    if (!((fa - fb).cwiseAbs().maxCoeff() <= AgreementTolerance * scale))
    {
      return false;
    }
  }
  return true;
}

std::vector<std::array<std::vector<double>, 3>> ClipGroup::Worker::ShareBreaks()
{
  std::vector<std::array<std::vector<double>, 3>> breaks(this->Members.size());
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    const Aggregate& body = this->Members[m].On->Body;
    std::vector<const Spline*> splines{ &body.Geometry() };
    for (const Attribute& attribute : body.Attributes())
    {
      splines.push_back(&attribute.Field);
    }
    for (std::size_t d = 0; d < 3; ++d)
    {
      breaks[m][d] = Scaled(MakeElementAxis(splines, static_cast<int>(d)).Breaks);
      if (breaks[m][d].size() == 2 && this->Collapsed[m].NeedsMiddle(static_cast<int>(d)))
      {
        breaks[m][d].insert(breaks[m][d].begin() + 1, 0.5);
      }
    }
  }
  const auto add = [](const std::vector<double>& from, bool same, std::vector<double>& to)
  {
    bool isAny = false;
    for (const double b : from)
    {
      const double at = same ? b : 1.0 - b;
      const auto near = std::lower_bound(to.begin(), to.end(), at - SameBreak);
      if (near == to.end() || *near > at + SameBreak)
      {
        to.insert(near, at);
        isAny = true;
      }
    }
    return isAny;
  };
  for (bool isChanged = true; isChanged;)
  {
    isChanged = false;
    for (const Joint& joint : this->Joints)
    {
      for (std::size_t d = 0; d < 3; ++d)
      {
        if (d != static_cast<std::size_t>(joint.Sides[0] / 2))
        {
          auto& a = breaks[joint.Members[0]][d];
          auto& b = breaks[joint.Members[1]][joint.Direction[d]];
          isChanged = add(a, joint.Same[d], b) || isChanged;
          isChanged = add(b, joint.Same[d], a) || isChanged;
        }
      }
    }
  }
  for (std::size_t m = 0; m < this->Members.size(); ++m)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const KnotVector& knots = this->Knots(m)[d];
      for (double& b : breaks[m][d])
      {
        b = knots.First() + b * (knots.Last() - knots.First());
      }
    }
  }
  return breaks;
}

bool ClipGroup::Worker::ForAll(const std::function<bool(ClipWorker&)>& work)
{
  const std::size_t count = this->Workers.size();
  std::vector<char> isFinished(count, 0);
  const auto some = [&](std::ptrdiff_t begin, std::ptrdiff_t end)
  {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
    {
      isFinished[i] = work(*this->Workers[i]) ? 1 : 0;
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
  return std::find(isFinished.begin(), isFinished.end(), 0) == isFinished.end();
}

void ClipGroup::Worker::LinkGridNodes()
{
  for (std::size_t j = 0; j < this->Joints.size(); ++j)
  {
    const Joint& joint = this->Joints[j];
    const ClipWorker& a = *this->Workers[joint.Members[0]];
    const ClipWorker& b = *this->Workers[joint.Members[1]];
    SimplexRefinement& mesh = this->Workers[joint.Members[0]]->Mesh();
    const SimplexRefinement& other = this->Workers[joint.Members[1]]->Mesh();
    const auto normal = static_cast<std::size_t>(joint.Sides[0] / 2);
    const int own = joint.Sides[0] % 2 == 0 ? 0 : a.Bends()->Axes()[normal].Cells();
    for (const std::array<int, 3>& place : mesh.GridPlaces())
    {
      if (place[normal] != own)
      {
        continue;
      }
      std::array<int, 3> at{};
      for (std::size_t d = 0; d < 3; ++d)
      {
        const std::size_t e = joint.Direction[d];
        const int last = b.Bends()->Axes()[e].Cells();
        at[e] = d == normal ? (joint.Sides[1] % 2 == 0 ? 0 : last)
          : joint.Same[d]   ? place[d]
                            : a.Bends()->Axes()[d].Cells() - place[d];
      }
      const int partner = other.GridNode(at);
      if (partner >= 0)
      {
        this->Nodes.Link(j, joint.Members, mesh.GridNode(place), partner);
      }
    }
  }
}

void ClipGroup::Worker::LinkMiddles()
{
  for (std::size_t j = 0; j < this->Joints.size(); ++j)
  {
    const Joint& joint = this->Joints[j];
    for (std::size_t side = 0; side < 2; ++side)
    {
      const SimplexRefinement& mesh = this->Workers[joint.Members[side]]->Mesh();
      const SimplexRefinement& other = this->Workers[joint.Members[1 - side]]->Mesh();
      int& node = this->Nodes.FirstUnseen(j, side);
      for (; node < mesh.NumberOfNodes(); ++node)
      {
        const auto& ends = mesh.Ends(node);
        if (ends[0] < 0 || !(mesh.Sides(node) >> joint.Sides[side] & 1))
        {
          continue;
        }
        const int a = this->Nodes.Partner(j, side, ends[0]);
        const int b = this->Nodes.Partner(j, side, ends[1]);
        const int partner = a >= 0 && b >= 0 ? other.FindMiddle(a, b) : -1;
        if (partner >= 0)
        {
          this->Nodes.Link(
            j, joint.Members, side == 0 ? node : partner, side == 0 ? partner : node);
        }
      }
    }
  }
}

void ClipGroup::Worker::TakePoints()
{
  this->Nodes.ForAll(
    [this](std::size_t member, int node, std::size_t leader, int leading, std::size_t number)
    {
      this->Workers[member]->SetPoint(
        node, this->Workers[leader]->Point(leading), static_cast<std::int64_t>(number));
    });
}

void ClipGroup::Worker::ShareRanks()
{
  std::map<std::size_t, int> ranks;
  this->Nodes.ForAll(
    [&](std::size_t member, int node, std::size_t, int, std::size_t number)
    {
      int& rank = ranks[number];
      rank = std::max(rank, this->Workers[member]->Rank(node));
    });
  this->Nodes.ForAll([&](std::size_t member, int node, std::size_t, int, std::size_t number)
    { this->Workers[member]->SetRank(node, ranks[number]); });
}

void ClipGroup::Worker::ShareMarks()
{
  // Marks that have been passed on, per joint and side.
  std::vector<std::array<std::size_t, 2>> passed(this->Joints.size());
  for (bool isChanged = true; isChanged;)
  {
    isChanged = false;
    for (std::size_t j = 0; j < this->Joints.size(); ++j)
    {
      const Joint& joint = this->Joints[j];
      for (std::size_t side = 0; side < 2; ++side)
      {
        ClipWorker& from = *this->Workers[joint.Members[side]];
        ClipWorker& to = *this->Workers[joint.Members[1 - side]];
        // Where a patch meets itself this loop sees what it adds.
        for (std::size_t& i = passed[j][side]; i < from.Marked().size(); ++i)
        {
          const int node = from.Marked()[i];
          const auto ends = from.Mesh().Ends(node);
          if (!(from.Mesh().Sides(node) >> joint.Sides[side] & 1))
          {
            continue;
          }
          const int a = this->Nodes.Partner(j, side, ends[0]);
          const int b = this->Nodes.Partner(j, side, ends[1]);
          if (a >= 0 && b >= 0)
          {
            isChanged = to.MarkNode(to.Mesh().Middle(a, b)) || isChanged;
          }
        }
      }
    }
  }
}

bool ClipGroup::Worker::HalveMarked()
{
  this->ShareMarks();
  if (!this->ForAll([](ClipWorker& w) { return w.Evaluate(); }))
  {
    return false;
  }
  this->LinkMiddles();
  this->TakePoints();
  return this->ForAll([](ClipWorker& w) { return w.Halve(); });
}

bool ClipGroup::Worker::Cut()
{
  if (!this->ForAll([](ClipWorker& w) { return w.BeginCut(); }))
  {
    return false;
  }
  Seams points(this->Joints.size());
  for (std::size_t j = 0; j < this->Joints.size(); ++j)
  {
    const Joint& joint = this->Joints[j];
    const ClipWorker& a = *this->Workers[joint.Members[0]];
    const ClipWorker& b = *this->Workers[joint.Members[1]];
    this->Nodes.ForPairs(j,
      [&](int nodeA, int nodeB)
      {
        const SimplexCut::Index pointA = a.PointOf(nodeA);
        const SimplexCut::Index pointB = b.PointOf(nodeB);
        if (pointA >= 0 && pointB >= 0)
        {
          points.Link(j, joint.Members, static_cast<int>(pointA), static_cast<int>(pointB));
        }
      });
  }
  const std::size_t fields = this->Members.empty() ? 0 : this->Members[0].Fields.size();
  for (std::size_t k = 0; k < fields; ++k)
  {
    const auto options = [](const ClipWorker& w) -> const ClipOptions&
    { return w.Member().Options; };
    if (!this->ForAll([&](ClipWorker& w)
          { return w.Pieces().FindValues(static_cast<int>(k), options(w).For, options(w).Abort); }))
    {
      return false;
    }
    points.ForAll(
      [this](std::size_t member, int point, std::size_t leader, int leading, std::size_t)
      {
        this->Workers[member]->Pieces().SetValue(
          point, this->Workers[leader]->Pieces().Value(leading));
      });
    if (!this->ForAll(
          [&](ClipWorker& w) { return w.Pieces().FindPoints(options(w).For, options(w).Abort); }))
    {
      return false;
    }
    for (std::size_t j = 0; j < this->Joints.size(); ++j)
    {
      const Joint& joint = this->Joints[j];
      const SimplexCut& mesh = this->Workers[joint.Members[0]]->Pieces();
      const SimplexCut& other = this->Workers[joint.Members[1]]->Pieces();
      for (SimplexCut::Index p = mesh.FirstNewPoint();
           p < static_cast<SimplexCut::Index>(mesh.Points().size()); ++p)
      {
        const auto& ends = mesh.Between()[static_cast<std::size_t>(p)];
        const int a = points.Partner(j, 0, static_cast<int>(ends[0]));
        const int b = points.Partner(j, 0, static_cast<int>(ends[1]));
        const SimplexCut::Index partner = a >= 0 && b >= 0 ? other.PointBetween(a, b) : -1;
        if (partner >= 0)
        {
          points.Link(j, joint.Members, static_cast<int>(p), static_cast<int>(partner));
        }
      }
    }
    points.ForAll(
      [this](std::size_t member, int point, std::size_t leader, int leading, std::size_t)
      {
        this->Workers[member]->Pieces().SetPoint(
          point, this->Workers[leader]->Pieces().Points()[static_cast<std::size_t>(leading)]);
      });
    if (!this->ForAll([&](ClipWorker& w)
          { return w.Pieces().Split(!options(w).KeepInside, options(w).Abort); }))
    {
      return false;
    }
  }
  return true;
}

bool ClipGroup::Worker::Extract()
{
  constexpr int MostRounds = 12;
  if (!this->ForAll([](ClipWorker& w) { return w.Begin(); }))
  {
    return false;
  }
  this->LinkGridNodes();
  this->TakePoints();
  this->ShareRanks();
  if (!this->ForAll([](ClipWorker& w) { return w.Triangulate(); }))
  {
    return false;
  }
  const auto isAny = [this](const auto& property)
  {
    return std::any_of(this->Workers.begin(), this->Workers.end(),
      [&property](const auto& w) { return property(*w); });
  };
  const auto isMarked = [](const ClipWorker& w) { return !w.Marked().empty(); };
  const auto wasCapped = [](const ClipWorker& w) { return w.WasCapped(); };
  for (int round = 0;; ++round)
  {
    while (true)
    {
      if (!this->ForAll([](ClipWorker& w) { return w.Mark(); }))
      {
        return false;
      }
      if (!isAny(isMarked) || isAny(wasCapped))
      {
        break;
      }
      if (!this->HalveMarked())
      {
        return false;
      }
    }
    if (!this->Cut())
    {
      return false;
    }
    if (round == MostRounds || isAny(wasCapped))
    {
      break;
    }
    if (!this->ForAll([](ClipWorker& w) { return w.MarkBadCuts(); }))
    {
      return false;
    }
    if (!isAny(isMarked))
    {
      break;
    }
    if (!this->HalveMarked())
    {
      return false;
    }
  }
  if (!this->ForAll([](ClipWorker& w) { return w.Assemble(); }))
  {
    return false;
  }
  this->CountOpenFaces();
  return true;
}

void ClipGroup::Worker::CountOpenFaces()
{
  // By the bits of their corners; equal ones of two sides cancel.
  using Corner = std::array<double, 3>;
  std::set<std::vector<Corner>> open;
  for (std::size_t m = 0; m < this->Workers.size(); ++m)
  {
    const ClipMesh& mesh = this->Workers[m]->Result;
    const auto isOn = [&](std::int64_t point, int side)
    { return this->Collapsed[m].SidesOf(mesh.Parameters.col(point)) >> side & 1; };
    for (Eigen::Index c = 0; c < mesh.Cells.cols() && this->Listed[m] != 0; ++c)
    {
      for (int side = 0; side < NumberOfSides; ++side)
      {
        if (!(this->Listed[m] >> side & 1))
        {
          continue;
        }
        std::vector<Corner> face;
        for (Eigen::Index i = 0; i < mesh.Cells.rows(); ++i)
        {
          const std::int64_t point = mesh.Cells(i, c);
          if (isOn(point, side))
          {
            face.push_back({ mesh.Points(0, point), mesh.Points(1, point), mesh.Points(2, point) });
          }
        }
        if (static_cast<Eigen::Index>(face.size()) + 1 != mesh.Cells.rows())
        {
          continue;
        }
        std::sort(face.begin(), face.end());
        const auto [at, isNew] = open.insert(std::move(face));
        if (!isNew)
        {
          open.erase(at);
        }
      }
    }
  }
  this->OpenFaces = static_cast<std::int64_t>(open.size());
}

ClipGroup::ClipGroup(std::vector<Member> members, const std::vector<Interface>& interfaces,
  ParallelFor parallelFor, Kept kept)
  : W(std::make_unique<Worker>(
      std::move(members), interfaces, std::move(parallelFor), std::move(kept)))
{
}

ClipGroup::~ClipGroup() = default;

bool ClipGroup::Extract()
{
  return this->W->Extract();
}

ClipMesh& ClipGroup::Mesh(std::size_t member)
{
  return this->W->Workers[member]->Result;
}

ZeroSetCertificate ClipGroup::Certificate() const
{
  ZeroSetCertificate all;
  for (const auto& worker : this->W->Workers)
  {
    all.Add(worker->Result.Certificate);
  }
  return all;
}

std::int64_t ClipGroup::OpenFacesOnInterfaces() const
{
  return this->W->OpenFaces;
}

const ClipGroup::Kept& ClipGroup::Bends() const
{
  return this->W->Bends;
}

ClipMesh Clip(const Patch& patch, std::shared_ptr<const PreparedAggregate> body,
  const std::vector<std::shared_ptr<const ScalarField>>& fields, const ClipOptions& options)
{
  ClipGroup group({ { &patch, std::move(body), fields, options } }, {}, options.For);
  return group.Extract() ? std::move(group.Mesh(0)) : ClipMesh{};
}

}
