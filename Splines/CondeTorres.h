// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_CondeTorres_h
#define hyperpatch_CondeTorres_h

#include "Aggregate.h"
#include "Parallel.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hyperpatch
{

/// Which control points the test of Conde & Torres looks at.
enum class CondeTorresForm
{
  Uniform,        ///< those of the spline itself, which is a uniform cubic B-spline
  UniformElement, ///< polynomial of degree 3 or less: those of the element's polynomial as a
                  ///< uniform cubic B-spline of one element
  Bezier          ///< otherwise: the Bezier points of the element
};

/// Why an element fails, or that it passes.
enum class CondeTorresResult : std::int8_t
{
  Passes,
  SpanNotOrdered, ///< a row of control points turns back in x, y or z
  SkinsMeet,      ///< two parallel slice skins meet
  MeetsElement    ///< the element meets another one that is no face neighbour
};

/// How the pairs of elements were decided.
struct CondeTorresPairs
{
  std::size_t Contiguous = 0; ///< face neighbours, which the paper does not test
  std::size_t Failed = 0;     ///< both elements fail by themselves: not tested
  std::size_t ByBoxes = 0;    ///< 1. bounds of the control points are disjoint
  std::size_t ByHulls = 0;    ///< 2. their convex hulls are disjoint
  std::size_t ByBorders = 0;  ///< 3. the elements do not meet, but for points that they share
  std::size_t Meeting = 0;    ///< pairs of which that could not be shown
};

struct CondeTorres
{
  /// For each element of the patches, one after the other, u fastest.
  std::vector<CondeTorresResult> Elements;
  /// For each patch.
  std::vector<CondeTorresForm> Forms;
  CondeTorresPairs Pairs;
};

/// The validity condition of Conde & Torres (A Simple Validity Condition for B-Spline Hyperpatches,
/// 2001) for comparison with a certified test. It is *not* sufficient: there are elements that pass
/// and have det J of both signs, and face neighbours, which it does not test against each other,
/// that cross. Nor is it necessary: a row of control points may not turn back in any coordinate.
///
/// An element passes if each row of its control points is monotone in x, y and z (the paper's
/// formula as it is meant), none of its parallel slice skins (of bilinear patches) meet, and it
/// meets no other element of its patch. The last in three tests: boxes, convex hulls, borders;
/// edge and corner neighbours ignore the points that they share. Skins and borders are compared by
/// the pair test of IntersectionTest, and meet if it does not show that they do not.
///
/// \param maxTests pieces that are looked at for a pair of skins or elements
/// \throws Error if a geometry is not a volume of three coordinates
[[nodiscard]] CondeTorres TestCondeTorres(
  const MultiPatch& model, const ParallelFor& parallelFor = SerialFor, int maxTests = 1000);

/// The test of one lattice of control points: all but MeetsElement.
/// \param points 3 x product of sizes, u fastest
[[nodiscard]] CondeTorresResult TestCondeTorresLattice(
  const Eigen::Matrix3Xd& points, std::array<int, 3> sizes, int maxTests = 1000);

}

#endif
