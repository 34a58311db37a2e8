// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ControlBounds_h
#define hyperpatch_ControlBounds_h

#include "Spline.h"

#include <array>
#include <vector>

namespace hyperpatch
{

/// A box in the parameter domain of a patch.
struct ParameterBox
{
  std::array<double, 3> Low;
  std::array<double, 3> High;
};

/// A block of non-empty knot spans, counted from 0, both ends included.
struct SpanBlock
{
  std::array<int, 3> First;
  std::array<int, 3> Last;
};

/// The spans that hold a box; one that the box only touches from below does not count.
[[nodiscard]] SpanBlock SpansOf(const Spline& spline, const ParameterBox& box);

/// Bounds of a spline on parameter boxes of any size, from the convex hull property: a pyramid of
/// component-wise bounds of control points over blocks of knot spans. One pyramid serves every
/// plane and every isovalue.
///
/// Built in time proportional to the lattice; memory is a small fraction of it. A query costs no
/// more than a few dozen blocks or one control window.
class ControlBounds
{
public:
  /// Keeps a reference to the spline, which must outlive it.
  explicit ControlBounds(const Spline& spline);

  /// \param low, high m numbers each: no value of the spline on the box is outside
  void Find(const ParameterBox& box, double* low, double* high) const;

private:
  /// Blocks of Leaf * 2^l non-empty spans in each direction on level l.
  static constexpr int Leaf = 4;
  struct Level
  {
    std::array<int, 3> Size;
    std::vector<double> Low, High; ///< m x blocks
  };

  void Window(const std::array<int, 3>& first, const std::array<int, 3>& last, double* low,
    double* high) const;

  const Spline* S;
  std::vector<Level> Levels;
};

}

#endif
