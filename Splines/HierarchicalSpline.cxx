// SPDX-License-Identifier: BSD-3-Clause
#include "HierarchicalSpline.h"

#include "Error.h"
#include "Operators.h"

#include <algorithm>
#include <string>

namespace hyperpatch
{

namespace
{

/// Finest levels of the elements of one level: of each the least inside it.
class ElementLevels
{
public:
  explicit ElementLevels(const std::array<int, 3>& size)
    : Size(size)
    , Levels(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
        static_cast<std::size_t>(size[2]))
  {
  }

  /// The least level in a box of elements.
  [[nodiscard]] int Least(const std::array<int, 3>& begin, const std::array<int, 3>& end) const
  {
    int least = this->At(begin);
    std::array<int, 3> e = begin;
    for (e[2] = begin[2]; e[2] < end[2]; ++e[2])
    {
      for (e[1] = begin[1]; e[1] < end[1]; ++e[1])
      {
        for (e[0] = begin[0]; e[0] < end[0]; ++e[0])
        {
          least = std::min(least, this->At(e));
        }
      }
    }
    return least;
  }

  void RaiseTo(int level, const std::array<int, 3>& begin, const std::array<int, 3>& end)
  {
    std::array<int, 3> e = begin;
    for (e[2] = begin[2]; e[2] < end[2]; ++e[2])
    {
      for (e[1] = begin[1]; e[1] < end[1]; ++e[1])
      {
        for (e[0] = begin[0]; e[0] < end[0]; ++e[0])
        {
          this->At(e) = std::max(this->At(e), level);
        }
      }
    }
  }

  /// The level above, whose elements have twice the length in directions with `factor` 2.
  [[nodiscard]] ElementLevels Coarser(const std::array<int, 3>& factor) const
  {
    ElementLevels coarse(
      { this->Size[0] / factor[0], this->Size[1] / factor[1], this->Size[2] / factor[2] });
    std::array<int, 3> e{};
    for (e[2] = 0; e[2] < coarse.Size[2]; ++e[2])
    {
      for (e[1] = 0; e[1] < coarse.Size[1]; ++e[1])
      {
        for (e[0] = 0; e[0] < coarse.Size[0]; ++e[0])
        {
          const std::array<int, 3> begin{ factor[0] * e[0], factor[1] * e[1], factor[2] * e[2] };
          coarse.At(e) = this->Least(
            begin, { begin[0] + factor[0], begin[1] + factor[1], begin[2] + factor[2] });
        }
      }
    }
    return coarse;
  }

private:
  [[nodiscard]] std::size_t IndexOf(const std::array<int, 3>& e) const
  {
    return static_cast<std::size_t>(e[0]) +
      static_cast<std::size_t>(this->Size[0]) *
      (static_cast<std::size_t>(e[1]) +
        static_cast<std::size_t>(this->Size[1]) * static_cast<std::size_t>(e[2]));
  }
  [[nodiscard]] int At(const std::array<int, 3>& e) const { return this->Levels[this->IndexOf(e)]; }
  int& At(const std::array<int, 3>& e) { return this->Levels[this->IndexOf(e)]; }

  std::array<int, 3> Size;
  std::vector<int> Levels;
};

/// The spans, counted without the empty ones, on which each control point's function is not zero.
std::vector<std::array<int, 2>> Supports(const KnotVector& knots)
{
  const std::vector<int>& spans = knots.Spans();
  std::vector<std::array<int, 2>> supports;
  for (int i = 0; i < knots.Size(); ++i)
  {
    const auto begin = std::lower_bound(spans.begin(), spans.end(), i);
    const auto end = std::upper_bound(spans.begin(), spans.end(), i + knots.Degree());
    supports.push_back(
      { static_cast<int>(begin - spans.begin()), static_cast<int>(end - spans.begin()) });
  }
  return supports;
}

std::array<int, 3> SpanCounts(const std::array<KnotVector, 3>& knots)
{
  std::array<int, 3> counts{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    counts[d] = static_cast<int>(knots[d].Spans().size());
  }
  return counts;
}

}

Spline FlattenHierarchicalSpline(const std::array<KnotVector, 3>& base,
  const std::vector<HierarchicalBox>& boxes, const Eigen::MatrixXd& coefficients, bool truncated)
{
  int finest = 0;
  for (const HierarchicalBox& box : boxes)
  {
    if (box.Level < 0)
    {
      throw Error("a box has level " + std::to_string(box.Level) + "; levels begin with 0");
    }
    finest = std::max(finest, box.Level);
  }
  const std::array<int, 3> spans = SpanCounts(base);
  std::array<int, 3> factor{};
  long long size = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    factor[d] = base[d].Degree() > 0 ? 2 : 1;
    const long long added =
      base[d].Degree() > 0 ? ((1LL << std::min(finest, 24)) - 1) * spans[d] : 0;
    size *= base[d].Size() + added;
    if (size > MaxFlattenedSize)
    {
      throw Error("the finest of " + std::to_string(finest + 1) + " levels has more than " +
        std::to_string(MaxFlattenedSize) + " control points: export it with fewer levels");
    }
  }

  // From the finest level to level 0.
  std::array<int, 3> elements{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    elements[d] = factor[d] == 2 ? spans[d] << finest : spans[d];
  }
  std::vector<ElementLevels> levels{ ElementLevels(elements) };
  for (const HierarchicalBox& box : boxes)
  {
    std::array<int, 3> begin{};
    std::array<int, 3> end{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      const int shift = factor[d] == 2 ? finest - box.Level : 0;
      if (box.Begin[d] < 0 || box.End[d] <= box.Begin[d] || box.End[d] > elements[d] >> shift)
      {
        throw Error("the box of level " + std::to_string(box.Level) + " from element " +
          std::to_string(box.Begin[d]) + " to " + std::to_string(box.End[d]) + " in direction " +
          "uvw"[d] + " is empty or outside: the level has " + std::to_string(elements[d] >> shift) +
          " elements there");
      }
      begin[d] = box.Begin[d] << shift;
      end[d] = box.End[d] << shift;
    }
    levels.front().RaiseTo(box.Level, begin, end);
  }
  for (int level = finest; level > 0; --level)
  {
    levels.push_back(levels.back().Coarser(factor));
  }

  Eigen::Index next = 0;
  Spline flat(base,
    Eigen::MatrixXd::Zero(coefficients.rows(),
      static_cast<Eigen::Index>(base[0].Size()) * base[1].Size() * base[2].Size()));
  for (int level = 0; level <= finest; ++level)
  {
    if (level > 0)
    {
      flat = RefineUniformly(flat, factor);
    }
    const ElementLevels& least = levels[static_cast<std::size_t>(finest - level)];
    const std::array<std::vector<std::array<int, 2>>, 3> supports{ Supports(flat.Knots(0)),
      Supports(flat.Knots(1)), Supports(flat.Knots(2)) };
    Eigen::MatrixXd points = flat.Coefficients();
    Eigen::Index column = 0;
    for (const auto& w : supports[2])
    {
      for (const auto& v : supports[1])
      {
        for (const auto& u : supports[0])
        {
          const int inside = least.Least({ u[0], v[0], w[0] }, { u[1], v[1], w[1] });
          if (inside >= level && truncated)
          {
            points.col(column).setZero();
          }
          if (inside == level)
          {
            if (next == coefficients.cols())
            {
              throw Error("there are " + std::to_string(next) +
                " control points, fewer than active functions: boxes and coefficients do not fit");
            }
            points.col(column) += coefficients.col(next);
            ++next;
          }
          ++column;
        }
      }
    }
    flat = Spline(flat.Knots(), std::move(points));
  }
  if (next != coefficients.cols())
  {
    throw Error("there are " + std::to_string(coefficients.cols()) + " control points for " +
      std::to_string(next) + " active functions: boxes and coefficients do not fit");
  }
  return flat;
}

}
