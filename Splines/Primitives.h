// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Primitives_h
#define hyperpatch_Primitives_h

#include "Aggregate.h"

#include <Eigen/Core>

namespace hyperpatch
{

/// How a primitive is parametrised that has no regular map from one cube.
enum class Parametrisation
{
  Poles,  ///< one patch, whose map degenerates on an axis, in a centre or along an edge
  Patches ///< several patches around a central one, det J > 0 in all of them and on their faces
};

/// Solids of exact shape (rational where they are round), centred at the origin with their axis
/// along z, right-handed, with the interfaces of their patches. Angles run with v (Torus: w) from
/// the direction of x over y; the radius runs with u.
/// All: \throws Error if a length is not positive and finite

[[nodiscard]] MultiPatch MakeBox(const Eigen::Vector3d& lengths);

/// Poles: along the axis.
[[nodiscard]] MultiPatch MakeCylinder(
  double radius, double height, Parametrisation parametrisation);

/// One closed patch, regular.
/// \throws Error also if the inner radius is not less than the outer one
[[nodiscard]] MultiPatch MakeTube(double innerRadius, double outerRadius, double height);

/// A cone, or part of one between two radii. Poles: along the axis.
/// \param topRadius 0 for an apex, in which every parametrisation degenerates
/// \throws Error also if there is an apex and Patches are asked for
[[nodiscard]] MultiPatch MakeCone(
  double bottomRadius, double topRadius, double height, Parametrisation parametrisation);

/// Poles: u radius, v angle from the z axis, w longitude. Patches: a cube and, around it, six
/// patches whose outer faces are rational biquartic (Cobb, Tiling the sphere with rational Bezier
/// patches, 1988: here the stereographic images of biquadratic ones).
[[nodiscard]] MultiPatch MakeSphere(double radius, Parametrisation parametrisation);

/// The space between two spheres; Poles degenerate on the axis only.
/// \throws Error also if the inner radius is not less than the outer one
[[nodiscard]] MultiPatch MakeSphericalShell(
  double innerRadius, double outerRadius, Parametrisation parametrisation);

/// \throws Error also if the minor radius is not less than the major one
[[nodiscard]] MultiPatch MakeTorus(
  double majorRadius, double minorRadius, Parametrisation parametrisation);

/// Half of a box: the prism over the right triangle with legs along x and y.
/// Poles: the edge at the end of the leg along y is collapsed.
[[nodiscard]] MultiPatch MakeWedge(const Eigen::Vector3d& lengths, Parametrisation parametrisation);

/// A disk of the minor radius swept along a helix and across it, w along the wire. A helix is not
/// rational: no point is farther than the tolerance from where it should be (see Screw).
/// \param pitch rise per turn, negative for a left-handed helix
/// \throws Error also if the minor radius is not less than the major one, or coils overlap
[[nodiscard]] MultiPatch MakeHelix(double majorRadius, double minorRadius, double pitch,
  double turns, double tolerance, Parametrisation parametrisation);

}

#endif
