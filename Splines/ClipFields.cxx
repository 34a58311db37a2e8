// SPDX-License-Identifier: BSD-3-Clause
// Where the fields of a clip are positive, negative or 0.
#include "ClipWorker.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace hyperpatch
{

bool ClipWorker::IsDecided(unsigned state) const
{
  bool isDecided = true;
  for (std::size_t k = 0; k < this->M.Fields.size(); ++k)
  {
    isDecided = isDecided && SideOf(state, k) != Side::Unknown;
  }
  return isDecided;
}

bool ClipWorker::IsDropped(unsigned state) const
{
  bool isInside = true;
  bool isOutside = false;
  for (std::size_t k = 0; k < this->M.Fields.size(); ++k)
  {
    isInside = isInside && SideOf(state, k) == Side::Inside;
    isOutside = isOutside || SideOf(state, k) == Side::Outside;
  }
  return this->M.Options.KeepInside ? isOutside : isInside;
}

bool ClipWorker::IsDroppedByCorners(const Cell& cell) const
{
  unsigned state = cell.State;
  for (std::size_t k = 0; k < this->M.Fields.size(); ++k)
  {
    if (SideOf(state, k) != Side::Unknown)
    {
      continue;
    }
    bool in = true;
    bool out = true;
    for (int c = 0; c <= this->Simplices->Dimension(); ++c)
    {
      const double value = this->Values[k][Corner(cell, c)];
      in = in && value <= 0.0;
      out = out && value > 0.0;
    }
    Set(state, k, in ? Side::Inside : out ? Side::Outside : Side::Unknown, Verdict::Open);
  }
  return this->IsDropped(state);
}

void ClipWorker::WantValues(const Cell& cell)
{
  if (this->IsDecided(cell.State))
  {
    return;
  }
  const auto want = [this](int node)
  {
    const auto n = static_cast<std::size_t>(node);
    this->IsWanted.resize(std::max(this->IsWanted.size(), n + 1), 0);
    if (node >= 0 && !this->IsWanted[n])
    {
      this->IsWanted[n] = 1;
      this->Wanted.push_back(node);
    }
  };
  for (int c = 0; c <= this->Simplices->Dimension(); ++c)
  {
    want(cell.Corners[static_cast<std::size_t>(c)]);
  }
  for (int e = 0;
       cell.Middles[0] >= 0 && e < SimplexRefinement::NumberOfEdges(this->Simplices->Dimension());
       ++e)
  {
    want(cell.Middles[static_cast<std::size_t>(e)]);
  }
}

bool ClipWorker::EvaluateValues()
{
  this->M.Options.For(static_cast<std::ptrdiff_t>(this->Wanted.size()), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      std::vector<Eigen::Vector3d> u;
      for (std::ptrdiff_t i = begin; i < end; ++i)
      {
        u.push_back(this->Simplices->Parameter(this->Wanted[static_cast<std::size_t>(i)]));
      }
      std::vector<double> values(u.size());
      for (std::size_t k = 0; k < this->M.Fields.size(); ++k)
      {
        this->M.Fields[k]->Evaluate(u.size(), u.front().data(), values.data());
        for (std::size_t i = 0; i < u.size(); ++i)
        {
          const int node = this->Wanted[static_cast<std::size_t>(begin) + i];
          this->Values[k][static_cast<std::size_t>(node)] =
            this->HasBothSigns(k, node) ? 0.0 : values[i];
        }
      }
    });
  this->Wanted.clear();
  return !this->M.Options.Abort();
}

bool ClipWorker::HasBothSigns(std::size_t field, int node) const
{
  if (this->Simplices->Free(node) == 0)
  {
    return false;
  }
  const std::vector<Eigen::Vector3d> u = this->ParametersOf(node);
  std::vector<double> values(u.size());
  this->M.Fields[field]->Evaluate(u.size(), u.front().data(), values.data());
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *low < 0.0 && *high > 0.0;
}

namespace
{

/// f / t, with t from 0 at one end of a direction to 1 at the other, if f cannot be told from 0 at
/// that end.
std::optional<Bernstein> Divided(const Bernstein& f, int direction, int end)
{
  const auto degrees = f.Degrees();
  const int p = degrees[static_cast<std::size_t>(direction)];
  Eigen::Index stride = 1;
  for (int d = 0; d < direction; ++d)
  {
    stride *= degrees[static_cast<std::size_t>(d)] + 1;
  }
  std::vector<double> kept;
  for (Eigen::Index i = 0; i < f.Coefficients().size(); ++i)
  {
    const auto layer = static_cast<int>(i / stride % (p + 1));
    const int from = end == 0 ? layer : p - layer;
    if (from > 0)
    {
      kept.push_back(f.Coefficients()[i] * p / from);
    }
    else if (!(std::abs(f.Coefficients()[i]) <= f.RoundingBound()))
    {
      return {};
    }
  }
  if (kept.empty())
  {
    return {};
  }
  auto less = degrees;
  --less[static_cast<std::size_t>(direction)];
  return Bernstein(less,
    Eigen::Map<const Eigen::VectorXd>(kept.data(), static_cast<Eigen::Index>(kept.size())),
    p * f.RoundingBound());
}

bool HasZero(const Bernstein& f)
{
  return f.Min() <= f.RoundingBound() && f.Max() >= -f.RoundingBound();
}

}

void ClipWorker::DecideBesidesPoles(const ScalarField& field, Decision& decision) const
{
  std::optional<Bernstein> f;
  bool isDivided = false;
  for (int side = 0; side < NumberOfSides; ++side)
  {
    const auto d = static_cast<std::size_t>(side / 2);
    const bool isAt = side % 2 == 0 ? decision.Box.Low[d] == this->Lines[d].front()
                                    : decision.Box.High[d] == this->Lines[d].back();
    if (!isAt || this->Collapsed.Free(1u << side) == 0)
    {
      continue;
    }
    f = f ? f : field.OnBox(decision.Box);
    if (auto divided = f ? Divided(*f, side / 2, side % 2) : std::nullopt)
    {
      f = std::move(divided);
      isDivided = true;
    }
  }
  if (!isDivided)
  {
    return;
  }
  decision.IsZero = HasZero(*f);
  for (int d = 0; d < 3; ++d)
  {
    decision.Found = HasZero(f->Derivative(d)) ? decision.Found : Verdict::Sheet;
  }
}

void ClipWorker::Decide(Cell& cell, std::size_t field, std::optional<Decision>& last) const
{
  const int dimension = this->Simplices->Dimension();
  const std::vector<double>& values = this->Values[field];
  const ScalarField& own = *this->M.Fields[field];
  const auto parameters = this->Simplices->Parameters(cell);
  double low = INFINITY;
  double high = -INFINITY;
  const auto extend = [&](std::size_t node)
  {
    low = std::min(low, values[node]);
    high = std::max(high, values[node]);
  };
  ParameterBox box{};
  for (int c = 0; c <= dimension; ++c)
  {
    // At a node that is free f may have other values than here.
    if (!own.HasBounds() || this->Simplices->Free(cell.Corners[static_cast<std::size_t>(c)]) == 0)
    {
      extend(Corner(cell, c));
    }
    const Eigen::Vector3d& u = parameters[static_cast<std::size_t>(c)].Values;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double at = u[static_cast<Eigen::Index>(d)];
      box.Low[d] = c == 0 ? at : std::min(box.Low[d], at);
      box.High[d] = c == 0 ? at : std::max(box.High[d], at);
    }
  }
  if (!own.HasBounds())
  {
    for (int e = 0; e < SimplexRefinement::NumberOfEdges(dimension); ++e)
    {
      extend(Middle(cell, e));
    }
    const bool isNarrow = this->Width(cell) <= this->DomainWidth / SampledDivisions;
    Set(cell.State, field,
      isNarrow && (low > 0.0 || high < 0.0) ? (low > 0.0 ? Side::Outside : Side::Inside)
                                            : Side::Unknown,
      Verdict::Open);
    return;
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (this->M.On->Body.Geometry().Knots()[d].Degree() == 0)
    {
      box.Low[d] = this->Lines[d].front();
      box.High[d] = this->Lines[d].back();
    }
  }
  // What is one sheet in a box is one in its parts.
  const bool isSheet = VerdictOf(cell.State, field) == Verdict::Sheet;
  if (!last)
  {
    last.emplace();
  }
  if (isSheet || last->Box.Low != box.Low || last->Box.High != box.High)
  {
    constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };
    BoxSpline& f = last->Scratch;
    last->Box = isSheet ? ParameterBox{} : box;
    last->IsZero = !own.Excludes(box);
    last->Found = isSheet ? Verdict::Sheet : Verdict::Open;
    if (last->IsZero && !isSheet && own.Restrict(box, f))
    {
      last->IsZero = f.Values(Everywhere).Contains(0.0);
      last->Found = f.Vanishes(Everywhere) || f.IsLostInNoise() ? Verdict::Lost : Verdict::Open;
      for (int d = 0; d < 3 && last->Found == Verdict::Open; ++d)
      {
        last->Found = f.Derivative(d, Everywhere).Contains(0.0) ? last->Found : Verdict::Sheet;
      }
    }
    if (last->IsZero && last->Found != Verdict::Sheet)
    {
      this->DecideBesidesPoles(own, *last);
    }
  }
  Set(cell.State, field,
    last->IsZero   ? Side::Unknown
      : high > 0.0 ? Side::Outside
                   : Side::Inside,
    last->Found);
}

}
