// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_DoublePointWorker_h
#define hyperpatch_DoublePointWorker_h

#include "BezierPieceWorker.h"

#include <array>
#include <optional>

namespace hyperpatch
{

/// Internal to injectivity. Value and Jacobian of an element at a point of its unit cube.
struct ElementValue
{
  Eigen::Vector3d X;
  Eigen::Matrix3d J;
  /// Bound of the rounding error of X, each coordinate.
  double Error;
};
[[nodiscard]] ElementValue EvaluateElement(
  const BezierPiece& element, const std::array<double, 3>& parameters);

/// Parameters of two elements with the same image.
struct SameImage
{
  std::array<double, 3> A;
  std::array<double, 3> B;
  Eigen::Vector3d Point;
};

/// Looks for a point of element b with the image of the point `start` of element a, by Newton's
/// iteration from `guess`. What it returns is certain (Newton-Kantorovich): b has an exact solution
/// that close to B, which is inside its open unit cube and, where both are the same element, not A.
[[nodiscard]] std::optional<SameImage> FindSameImage(const BezierPiece& a,
  const std::array<double, 3>& start, const BezierPiece& b, std::array<double, 3> guess,
  bool areOneElement);

/// Looks for two points of an element with the same image, close to where det J changes its sign.
/// \param positive, negative points with these signs of det J
[[nodiscard]] std::optional<SameImage> FindSameImageAtFold(const BezierPiece& element,
  const std::array<double, 3>& positive, const std::array<double, 3>& negative);

}

#endif
