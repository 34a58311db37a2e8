// SPDX-License-Identifier: BSD-3-Clause
// Which elements of a patch take part in a clip, and how their simplices are refined.
#include "Clip.h"

#include "ClipWorker.h"
#include "Error.h"
#include "Tessellation.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

constexpr double NotKnown = std::numeric_limits<double>::quiet_NaN();

}

ClipWorker::ClipWorker(const ClipGroup::Member& member, std::shared_ptr<BendBounds> bends,
  const CollapsedSides& collapsed)
  : M(member)
  , B(std::move(bends))
  , Collapsed(collapsed)
{
  const Aggregate& body = this->M.On->Body;
  const ClipOptions& options = this->M.Options;
  CheckTolerances(*this->M.On, options.Tolerance, options.AttributeTolerances);
  if (this->M.Fields.size() > SimplexCut::MaximumFields)
  {
    throw hyperpatch::Error(
      "simplices are cut by " + std::to_string(SimplexCut::MaximumFields) + " fields at most");
  }
  this->Tolerances.push_back(options.Tolerance);
  for (std::size_t a = 0; a < options.AttributeTolerances.size(); ++a)
  {
    const double tolerance = options.AttributeTolerances[a];
    if (tolerance > 0.0 && std::isfinite(tolerance))
    {
      this->Tolerances.insert(this->Tolerances.end(),
        static_cast<std::size_t>(body.Attributes()[a].Field.Components()), tolerance);
    }
  }
  const auto addCreases = [this](const Spline& spline)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const KnotVector& knots = spline.Knots()[d];
      std::vector<double>& all = this->Creases[d];
      all.insert(all.end(), { knots.First(), knots.Last() });
      const std::vector<double> creases = knots.Creases();
      all.insert(all.end(), creases.begin(), creases.end());
      std::sort(all.begin(), all.end());
    }
  };
  addCreases(body.Geometry());
  for (const Attribute& attribute : body.Attributes())
  {
    addCreases(attribute.Field);
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->Lines[d] = this->B->Axes()[d].Breaks;
  }
  for (const auto& field : this->M.Fields)
  {
    this->HasSampledFields = this->HasSampledFields || !field->HasBounds();
  }
  const auto points = body.Geometry().Coefficients();
  this->DomainWidth = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  this->Values.resize(this->M.Fields.size());
  this->Attributes.resize(body.Attributes().size());
}

bool ClipWorker::AddElements(
  const std::array<int, 3>& first, const std::array<int, 3>& last, unsigned state)
{
  if (++this->Boxes % BoxStep == 0 && this->M.Options.Abort())
  {
    return false;
  }
  ParameterBox box{};
  std::size_t longest = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    box.Low[d] = this->Lines[d][static_cast<std::size_t>(first[d])];
    box.High[d] = this->Lines[d][static_cast<std::size_t>(last[d])];
    longest = last[d] - first[d] > last[longest] - first[longest] ? d : longest;
  }
  for (std::size_t k = 0; k < this->M.Fields.size(); ++k)
  {
    const ScalarField& field = *this->M.Fields[k];
    if (SideOf(state, k) == Side::Unknown && field.HasBounds() && field.Excludes(box))
    {
      double value = 0.0;
      field.Evaluate(1, box.Low.data(), &value);
      Set(state, k,
        value > 0.0     ? Side::Outside
          : value < 0.0 ? Side::Inside
                        : Side::Unknown,
        Verdict::Open);
    }
  }
  if (this->IsDropped(state))
  {
    return true;
  }
  if (last[longest] - first[longest] > 1 && !this->IsDecided(state))
  {
    std::array<int, 3> middle = last;
    middle[longest] = (first[longest] + last[longest]) / 2;
    std::array<int, 3> next = first;
    next[longest] = middle[longest];
    return this->AddElements(first, middle, state) && this->AddElements(next, last, state);
  }
  const std::array<int, 2> size{ this->B->Axes()[0].Cells(), this->B->Axes()[1].Cells() };
  for (int k = first[2]; k < last[2]; ++k)
  {
    for (int j = first[1]; j < last[1]; ++j)
    {
      for (int i = first[0]; i < last[0]; ++i)
      {
        this->Roots.push_back(i + size[0] * (j + size[1] * k));
        this->RootStates.push_back(state);
      }
    }
  }
  return true;
}

bool ClipWorker::Begin()
{
  const auto& axes = this->B->Axes();
  if (!this->AddElements({ 0, 0, 0 }, { axes[0].Cells(), axes[1].Cells(), axes[2].Cells() }, 0))
  {
    return false;
  }
  this->B->Find(this->Roots, this->Tolerances, this->M.Options.For);
  const auto degrees = this->M.On->Body.Geometry().Degrees();
  this->Simplices.emplace(this->Lines,
    std::array<bool, 3>{ degrees[0] > 0, degrees[1] > 0, degrees[2] > 0 }, this->Roots,
    this->Collapsed);
  for (int node = 0; node < this->Simplices->NumberOfNodes(); ++node)
  {
    const unsigned free = this->Simplices->Free(node);
    this->Ranks.push_back(static_cast<int>((free & 1) + (free >> 1 & 1) + (free >> 2)));
  }
  return this->Evaluate();
}

bool ClipWorker::Evaluate()
{
  const std::size_t first = this->Points.size();
  const auto count = static_cast<std::size_t>(this->Simplices->NumberOfNodes());
  this->Points.resize(count, Eigen::Vector3d::Zero());
  this->IsMarked.resize(count, 0);
  this->IsWanted.resize(count, 0);
  this->IsShared.resize(count, 0);
  this->Jumps.resize(count, 0.0);
  // Behind those of nodes on interfaces.
  for (std::size_t node = first; node < count; ++node)
  {
    this->Numbers.push_back((std::int64_t{ 1 } << 40) + static_cast<std::int64_t>(node));
  }
  for (auto& values : this->Values)
  {
    values.resize(count, NotKnown);
  }
  const auto& geometry = *this->M.Body->Geometry();
  const auto m = static_cast<std::size_t>(geometry.Spline().Components());
  const auto& attributes = this->M.Body->Attributes();
  const auto& tolerances = this->M.Options.AttributeTolerances;
  for (std::size_t a = 0; a < tolerances.size(); ++a)
  {
    this->Attributes[a].resize(tolerances[a] > 0.0
        ? count * static_cast<std::size_t>(attributes[a]->Spline().Components())
        : 0);
  }
  this->M.Options.For(static_cast<std::ptrdiff_t>(count - first), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      const std::size_t b = first + static_cast<std::size_t>(begin);
      const auto n = static_cast<std::size_t>(end - begin);
      const double* u = this->Simplices->Parameter(static_cast<int>(b)).data();
      std::vector<double> x(m * n);
      geometry.Evaluator().Evaluate(n, u, x.data());
      for (std::size_t i = 0; i < n; ++i)
      {
        std::copy_n(&x[m * i], m, this->Points[b + i].data());
      }
      for (std::size_t a = 0; a < attributes.size(); ++a)
      {
        if (!this->Attributes[a].empty())
        {
          const auto components = static_cast<std::size_t>(attributes[a]->Spline().Components());
          attributes[a]->Evaluator().Evaluate(n, u, &this->Attributes[a][components * b]);
        }
      }
      for (std::size_t node = b; node < b + n; ++node)
      {
        this->FindJump(node);
      }
    });
  return this->EvaluateValues();
}

std::vector<Eigen::Vector3d> ClipWorker::ParametersOf(int node) const
{
  std::vector<Eigen::Vector3d> all{ this->Simplices->Parameter(node) };
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (std::size_t i = 0, n = all.size(); i < n && this->Simplices->Free(node) >> d & 1; ++i)
    {
      for (const double place : { 0.21, 0.5, 0.79, 1.0 })
      {
        Eigen::Vector3d u = all[i];
        const double last = this->Lines[d].back();
        u[static_cast<Eigen::Index>(d)] =
          place == 1.0 ? last : this->Lines[d].front() + place * (last - this->Lines[d].front());
        all.push_back(u);
      }
    }
  }
  return all;
}

void ClipWorker::FindJump(std::size_t node)
{
  if (this->Simplices->Free(static_cast<int>(node)) == 0)
  {
    return;
  }
  const std::vector<Eigen::Vector3d> u = this->ParametersOf(static_cast<int>(node));
  for (std::size_t a = 0; a < this->M.Options.AttributeTolerances.size(); ++a)
  {
    const Evaluator& evaluator = this->M.Body->Attributes()[a]->Evaluator();
    const double tolerance = this->M.Options.AttributeTolerances[a];
    Eigen::MatrixXd values(
      this->M.Body->Attributes()[a]->Spline().Components(), static_cast<Eigen::Index>(u.size()));
    evaluator.Evaluate(u.size(), u.front().data(), values.data());
    const double jump = (values.colwise() - values.col(0)).cwiseAbs().maxCoeff();
    this->Jumps[node] = tolerance > 0.0 ? std::max(this->Jumps[node], jump / tolerance) : 0.0;
  }
}

double ClipWorker::Jump(const Cell& cell) const
{
  double largest = 0.0;
  for (int c = 0; c <= this->Simplices->Dimension(); ++c)
  {
    largest = std::max(largest, this->Jumps[Corner(cell, c)]);
  }
  return largest;
}

SimplexRefinement::Before ClipWorker::Order() const
{
  return [this](int a, int b)
  {
    const auto i = static_cast<std::size_t>(a);
    const auto j = static_cast<std::size_t>(b);
    for (int d = 0; d < 3; ++d)
    {
      if (this->Points[i][d] != this->Points[j][d])
      {
        return this->Points[i][d] < this->Points[j][d];
      }
    }
    return this->Numbers[i] < this->Numbers[j];
  };
}

double ClipWorker::LengthAround(int middle) const
{
  const auto& ends = this->Simplices->Ends(middle);
  return (this->Point(ends[0]) - this->Point(ends[1])).norm();
}

bool ClipWorker::Triangulate()
{
  const auto isBefore = [this, order = this->Order()](int a, int b)
  { return this->Rank(a) != this->Rank(b) ? this->Rank(a) < this->Rank(b) : order(a, b); };
  if (!this->Simplices->Triangulate(this->Roots, this->RootStates, isBefore, this->M.Options.Abort))
  {
    return false;
  }
  this->IsNew.assign(this->Simplices->Cells().size(), 1);
  return true;
}

void ClipWorker::SetPoint(int node, const Eigen::Vector3d& x, std::int64_t number)
{
  const auto n = static_cast<std::size_t>(node);
  this->Points[n] = x;
  this->Numbers[n] = number;
  this->IsShared[n] = 1;
}

bool ClipWorker::MarkNode(int node)
{
  const auto n = static_cast<std::size_t>(node);
  this->IsMarked.resize(std::max(this->IsMarked.size(), n + 1), 0);
  if (this->IsMarked[n])
  {
    return false;
  }
  this->IsMarked[n] = 1;
  this->MarkedNodes.push_back(node);
  return true;
}

bool ClipWorker::DropCells()
{
  auto& cells = this->Simplices->Cells();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    if (i % Step == 0 && this->M.Options.Abort())
    {
      return false;
    }
    for (std::size_t k = 0; k < this->M.Fields.size() && this->IsNew[i]; ++k)
    {
      this->Sampled +=
        !this->M.Fields[k]->HasBounds() && SideOf(cells[i].State, k) != Side::Unknown ? 1 : 0;
    }
    if (!this->IsDropped(cells[i].State))
    {
      cells[kept] = cells[i];
      this->IsNew[kept] = this->IsNew[i];
      this->Plans[kept++] = this->Plans[i];
    }
  }
  cells.resize(kept);
  this->IsNew.resize(kept);
  this->Plans.resize(kept);
  return true;
}

namespace
{

/// The edges that are wrong by themselves, or the worst.
unsigned char WorstEdges(const std::array<double, 6>& errors, int count, double target)
{
  const double worst = *std::max_element(errors.begin(), errors.begin() + count);
  unsigned char bits = 0;
  for (int e = 0; e < count; ++e)
  {
    const double own = errors[static_cast<std::size_t>(e)];
    bits |= static_cast<unsigned char>(own >= std::min(target, worst) ? 1 << e : 0);
  }
  return bits;
}

}

unsigned char ClipWorker::Plan(const Cell& cell) const
{
  if (this->IsDropped(cell.State))
  {
    return 0;
  }
  if (const unsigned char bent = this->IsDecided(cell.State) ? 0 : this->EdgesBentAtPole(cell))
  {
    return bent;
  }
  bool isMeasured = false;
  const double width = this->IsDecided(cell.State) ? 0.0 : this->Width(cell);
  for (std::size_t k = 0; k < this->M.Fields.size() && width > this->M.Options.Tolerance; ++k)
  {
    if (SideOf(cell.State, k) != Side::Unknown)
    {
      continue;
    }
    const bool isUncertain = this->M.Fields[k]->HasBounds()
      ? VerdictOf(cell.State, k) == Verdict::Open
      : width > this->DomainWidth / SampledDivisions;
    if (isUncertain)
    {
      return this->LongestEdge(cell);
    }
    isMeasured = true;
  }
  if (!this->IsDroppedByCorners(cell))
  {
    if (this->IsTurnedOver(cell))
    {
      return this->MostBentEdge(cell);
    }
    const Bound bound = this->BoundError(cell);
    if (bound.IsCoarse)
    {
      return WorstEdges(
        bound.Edges, SimplexRefinement::NumberOfEdges(this->Simplices->Dimension()), 1.0);
    }
    isMeasured = isMeasured || !bound.IsCertain;
  }
  return isMeasured ? Measure : 0;
}

unsigned char ClipWorker::EdgesToHalve(const Cell& cell) const
{
  unsigned char bits = 0;
  const int edges = SimplexRefinement::NumberOfEdges(this->Simplices->Dimension());
  const auto add = [&bits, edges](const Error& error)
  { bits |= error.Largest > Target ? WorstEdges(error.Edges, edges, Target) : 0; };
  const bool isWide = this->Width(cell) > this->M.Options.Tolerance;
  for (std::size_t k = 0; k < this->M.Fields.size() && isWide; ++k)
  {
    if (SideOf(cell.State, k) != Side::Unknown)
    {
      continue;
    }
    Error error = this->CutError(cell, k);
    // All edges of a cell that is far from its tolerance; near it, the worst.
    const double worst = *std::max_element(error.Edges.begin(), error.Edges.begin() + edges);
    for (double& own : error.Edges)
    {
      own = own >= 0.5 * worst ? INFINITY : 0.0;
    }
    add(error);
  }
  if (!this->IsDroppedByCorners(cell) && !this->BoundError(cell).IsCertain)
  {
    add(this->PositionError(cell));
    if (this->Jump(cell) <= Target)
    {
      add(this->AttributeError(cell));
    }
    else
    {
      // No smaller cell has less of it.
      bits |= isWide ? this->LongestEdge(cell) : 0;
    }
  }
  return bits;
}

void ClipWorker::MarkEdges(const Cell& cell, unsigned char edges)
{
  for (int e = 0; e < 6; ++e)
  {
    if (edges >> e & 1)
    {
      this->MarkNode(this->Simplices->Middle(
        static_cast<int>(End(cell, e, 0)), static_cast<int>(End(cell, e, 1))));
    }
  }
}

bool ClipWorker::ForCells(const std::function<void(std::size_t, std::size_t)>& body)
{
  this->M.Options.For(static_cast<std::ptrdiff_t>(this->Simplices->Cells().size()), Grain,
    [&body](std::ptrdiff_t begin, std::ptrdiff_t end)
    { body(static_cast<std::size_t>(begin), static_cast<std::size_t>(end)); });
  return !this->M.Options.Abort();
}

bool ClipWorker::Mark()
{
  auto& cells = this->Simplices->Cells();
  const auto forNew = [&](const auto& visit)
  {
    for (std::size_t i = 0; i < cells.size(); ++i)
    {
      if (i % Step == 0 && this->M.Options.Abort())
      {
        return false;
      }
      if (this->IsNew[i])
      {
        visit(i);
      }
    }
    return true;
  };
  if (!forNew(
        [&](std::size_t i)
        {
          if (this->HasSampledFields && !this->IsDecided(cells[i].State))
          {
            this->Simplices->FindMiddles(cells[i]);
          }
          this->WantValues(cells[i]);
        }) ||
    !this->Evaluate())
  {
    return false;
  }
  this->Plans.assign(cells.size(), 0);
  const bool isPlanned = this->ForCells(
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<std::optional<Decision>> last(this->M.Fields.size());
      for (std::size_t i = begin; i < end; ++i)
      {
        for (std::size_t k = 0; k < this->M.Fields.size() && this->IsNew[i]; ++k)
        {
          if (SideOf(cells[i].State, k) == Side::Unknown)
          {
            this->Decide(cells[i], k, last[k]);
          }
        }
        this->Plans[i] = this->IsNew[i] ? this->Plan(cells[i]) : 0;
      }
    });
  // What is certainly on the other side takes no part any more.
  if (!isPlanned || !this->DropCells() ||
    !forNew(
      [&](std::size_t i)
      {
        if (this->Plans[i] == Measure)
        {
          this->Simplices->FindMiddles(cells[i]);
          this->WantValues(cells[i]);
        }
      }) ||
    !this->Evaluate())
  {
    return false;
  }
  const bool isMeasured = this->ForCells(
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        this->Plans[i] = this->Plans[i] == Measure ? this->EdgesToHalve(cells[i]) : this->Plans[i];
      }
    });
  const bool isMarked =
    isMeasured && forNew([&](std::size_t i) { this->MarkEdges(cells[i], this->Plans[i]); });
  this->IsCapped = !this->MarkedNodes.empty() &&
    static_cast<double>(cells.size()) >= 0.25 * this->M.Options.MaximumCells;
  return isMarked;
}

bool ClipWorker::Halve()
{
  const auto isBefore = [this, order = this->Order()](int a, int b)
  {
    const double la = this->LengthAround(a);
    const double lb = this->LengthAround(b);
    return la != lb ? la > lb : order(a, b);
  };
  if (!this->Simplices->Refine(this->IsMarked, isBefore, this->IsNew, this->M.Options.Abort))
  {
    return false;
  }
  for (const int node : this->MarkedNodes)
  {
    this->IsMarked[static_cast<std::size_t>(node)] = 0;
  }
  this->MarkedNodes.clear();
  return true;
}

}
