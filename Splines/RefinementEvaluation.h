// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_RefinementEvaluation_h
#define hyperpatch_RefinementEvaluation_h

#include "Spline.h"

namespace hyperpatch
{

/// A point of a spline with its first partial derivatives.
struct PointWithPartials
{
  /// m numbers.
  Eigen::VectorXd Value;
  /// m x 3: columns d/du, d/dv, d/dw.
  Eigen::MatrixXd Partials;
};

/// Evaluation by refinement (Martin & Cohen 2001, section 4): degree knots are stacked at the point
/// in each direction, then a control point lies on the volume and its neighbours give the partials
/// by equations (5) and (6), which hold for rational splines as they are.
///
/// This is the readable reference that Evaluator is tested against, not a fast path. Parameters are
/// moved into the domain; derivatives are limits from the right, at the end of the domain from the
/// left. A partial loses accuracy as the parameter nears the end of its span: it is a difference of
/// control points divided by that distance.
[[nodiscard]] PointWithPartials EvaluateByRefinement(
  const Spline& spline, double u, double v = 0.0, double w = 0.0);

}

#endif
