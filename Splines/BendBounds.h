// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_BendBounds_h
#define hyperpatch_BendBounds_h

#include "Aggregate.h"
#include "ElementAxis.h"
#include "Parallel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hyperpatch
{

/// How much the geometry and attributes of a patch bend in its elements, the cells of all their
/// breaks: bounds of second derivatives, from the convex hull property (ChordBound). Found for the
/// elements that are asked for, and kept.
class BendBounds
{
public:
  /// Bounds of |f_uu|, |f_uv|, |f_uw|, |f_vv|, |f_vw|, |f_ww|, parameters of the element from 0 to
  /// 1, and f the position or one component of an attribute.
  using Bend = std::array<double, 6>;

  /// Keeps a reference to the aggregate, which must outlive it.
  /// \param isMeasured per attribute, whether it takes part
  /// \param more parameters per direction at which elements are divided besides
  BendBounds(const Aggregate& body, std::vector<bool> isMeasured,
    const std::array<std::vector<double>, 3>& more = {});

  /// Whether the other one has the same elements and attributes, of the same aggregate.
  [[nodiscard]] bool IsLike(const BendBounds& other) const
  {
    bool isLike = this->Body == other.Body && this->IsMeasured == other.IsMeasured;
    for (std::size_t d = 0; d < 3; ++d)
    {
      isLike = isLike && this->A[d].Breaks == other.A[d].Breaks;
    }
    return isLike;
  }

  [[nodiscard]] const std::array<ElementAxis, 3>& Axes() const { return this->A; }
  /// Of an element: the position, and every component of the attributes that take part.
  [[nodiscard]] std::size_t NumberOfBends() const { return this->Count; }

  /// Finds what is not known yet. Bounds are tightened where linear interpolation on the element is
  /// not certainly within the tolerance. \param elements their numbers, u fastest; none twice
  /// \param tolerances one per bend
  void Find(const std::vector<int>& elements, const std::vector<double>& tolerances,
    const ParallelFor& parallel);

  /// NumberOfBends() of them, of an element that was asked for.
  [[nodiscard]] const Bend* Of(int element) const
  {
    return &this->Bends[this->Count *
      static_cast<std::size_t>(this->Slots[static_cast<std::size_t>(element)])];
  }

  /// A bound of the error of linear interpolation on simplices inside a box of these widths.
  [[nodiscard]] static double LinearError(const Bend& bend, const std::array<double, 3>& widths)
  {
    const auto& [u, v, w] = widths;
    return 0.125 *
      (u * u * bend[0] + v * v * bend[3] + w * w * bend[5] +
        2.0 * (u * v * bend[1] + u * w * bend[2] + v * w * bend[4]));
  }

private:
  const Aggregate* Body;
  std::vector<bool> IsMeasured;
  std::array<ElementAxis, 3> A;
  std::size_t Count = 1;
  std::vector<std::int32_t> Slots; ///< per element; -1: not asked for yet
  std::vector<char> IsTight;       ///< per slot
  std::vector<Bend> Bends;
};

}

#endif
