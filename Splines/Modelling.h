// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Modelling_h
#define hyperpatch_Modelling_h

#include "Aggregate.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace hyperpatch
{

/// Operators that make a surface of curves, or a volume of surfaces (Martin & Cohen 2001, section
/// 3). The new direction is the first one that the sections do not have, and runs over [0, 1];
/// directions of the sections close up (u, w becomes u, v).
///
/// Attributes are carried by the paper's rule: constant along the new direction where there is one
/// section, ruled or interpolated like the geometry between corresponding attributes where there
/// are several. An attribute in the basis of the geometry stays in it; one with a basis of its own
/// keeps that, with degree 0 in the new direction where it is constant.

/// What a section draws under a motion (Motions.h): control point (i, j) is map j of the motion
/// applied to point i of the section, with the product of their weights. Exact for every motion.
/// \throws Error if the section is no curve or surface, or the motion none of 12 components
[[nodiscard]] Aggregate Sweep(const Aggregate& section, const Spline& motion);

/// The section moved along a vector. \throws Error as Sweep and Translation
[[nodiscard]] Aggregate Extrude(const Aggregate& section, const Eigen::Vector3d& vector);

/// The section turned about an axis, in exact circular arcs.
/// \param angle in degrees
/// \throws Error as Sweep and Rotation, and if the section crosses the axis (FindAxisCrossing)
[[nodiscard]] Aggregate Revolve(const Aggregate& section, const Eigen::Vector3d& point,
  const Eigen::Vector3d& axis, double angle);

/// Straight lines between points of equal parameters of two sections, which may have other degrees,
/// knots and domains. \throws Error as Loft
[[nodiscard]] Aggregate Rule(const Aggregate& first, const Aggregate& second);

/// A spline that interpolates sections of any degrees, knots and domains (The NURBS Book, section
/// 10.3): they are made compatible and interpolated as the points of a curve, in homogeneous
/// coordinates, at parameters that follow the distances of their control points.
/// \param degree of the new direction; the number of sections less 1 if that is less
/// \throws Error if there are fewer than 2 sections, they have other numbers of directions or other
/// attributes, two in a row coincide, or weights of rational sections differ so much that weights
/// in between are not positive
[[nodiscard]] Aggregate Loft(const std::vector<Aggregate>& sections, int degree);

/// An operator above on every patch of a model of sections. Sides of the sections stay sides, so
/// interfaces and boundaries come along (but not where directions close up).
[[nodiscard]] MultiPatch ForEachSection(
  const MultiPatch& sections, const std::function<Aggregate(const Aggregate&)>& operation);

/// Loft of models: between patches that correspond, the i-th of each; the patches of a single model
/// are the sections of one loft. Boundaries of the first of several models come along.
/// \throws Error as Loft, and if the models have other numbers of patches
[[nodiscard]] MultiPatch LoftModels(const std::vector<MultiPatch>& models, int degree);

}

#endif
