// SPDX-License-Identifier: BSD-3-Clause
#include "Primitives.h"

#include "Bernstein.h"
#include "Error.h"
#include "Interfaces.h"
#include "Modelling.h"
#include "Motions.h"
#include "Operators.h"
#include "Reparametrise.h"

#include <Eigen/Geometry>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d Origin = Vector3d::Zero();
const Vector3d AxisX = Vector3d::UnitX();
const Vector3d AxisY = Vector3d::UnitY();
const Vector3d AxisZ = Vector3d::UnitZ();

void CheckLength(const char* name, double value)
{
  if (!(value > 0.0 && std::isfinite(value)))
  {
    throw Error(std::string("the ") + name + " is " + std::to_string(value) +
      "; it must be positive and finite");
  }
}

void CheckLess(const char* lessName, double less, const char* name, double value)
{
  CheckLength(name, value);
  CheckLength(lessName, less);
  if (less >= value)
  {
    throw Error(std::string("the ") + lessName + ", " + std::to_string(less) +
      ", must be less than the " + name + ", " + std::to_string(value));
  }
}

void CheckLengths(const Vector3d& lengths)
{
  CheckLength("length along x", lengths[0]);
  CheckLength("length along y", lengths[1]);
  CheckLength("length along z", lengths[2]);
}

MultiPatch Model(const std::vector<Aggregate>& bodies)
{
  MultiPatch model;
  for (const Aggregate& body : bodies)
  {
    model.Patches.push_back({ static_cast<int>(model.Patches.size()), body });
  }
  // Faces that are one were computed in different orders, hence the tolerance.
  model.Interfaces = FindInterfaces(model, 1e-9);
  return model;
}

Aggregate Transformed(
  const Aggregate& body, const Matrix3d& matrix, const Vector3d& offset = Vector3d::Zero())
{
  const Spline& g = body.Geometry();
  return Aggregate(Spline(g.Knots(), (matrix * g.Coefficients()).colwise() + offset, g.Weights()));
}

Aggregate Line(const Vector3d& from, const Vector3d& to)
{
  Eigen::MatrixXd points(3, 2);
  points << from, to;
  return Aggregate(Spline({ KnotVector::Uniform(1, 2), {}, {} }, points));
}

/// The bilinear surface with corners at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
Aggregate Quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d)
{
  return Rule(Line(a, b), Line(c, d));
}

/// The curve that a point draws under a motion.
Aggregate Draw(const Vector3d& point, const Spline& motion)
{
  Eigen::MatrixXd points(3, motion.NumberOfControlPoints());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> map(motion.Coefficients().col(i).data());
    points.col(i) = map.leftCols<3>() * point + map.col(3);
  }
  return Aggregate(Spline(motion.Knots(), points, motion.Weights()));
}

/// A disk in the plane z = 0, with its normal along z.
std::vector<Aggregate> Disk(double radius, Parametrisation parametrisation)
{
  if (parametrisation == Parametrisation::Poles)
  {
    return { Revolve(Line(Origin, radius * AxisX), Origin, AxisZ, 360.0) };
  }
  // A square with corners at half the radius, and four patches around it. Elevated, its edges have
  // the control points of those of its neighbours.
  const double half = 0.5 * std::sqrt(0.5) * radius;
  const Vector3d corners[] = { { half, -half, 0 }, { half, half, 0 }, { -half, half, 0 },
    { -half, -half, 0 } };
  std::vector<Aggregate> disk{ Apply(Quad(corners[3], corners[0], corners[2], corners[1]),
    [](const Spline& s) { return ElevateDegree(ElevateDegree(s, 0), 1); }) };
  for (int i = 0; i < 4; ++i)
  {
    const Aggregate arc = Draw(2.0 * corners[i], Rotation(Origin, AxisZ, 90.0));
    const Aggregate ring = Rule(Line(corners[i], corners[(i + 1) % 4]), arc);
    disk.push_back(Apply(ring, [](const Spline& s) { return SwapDirections(s, 0, 1); }));
  }
  return disk;
}

/// The part of the unit sphere over the face z = 1 of the cube around it, u along x, v along y.
///
/// Stereographic projection from the south pole takes its edges, arcs of great circles, to arcs of
/// 30 degrees of circles of radius sqrt(2) around (0, -1), ... They bound a rational biquadratic
/// (X, Y, W) whose middle weight is free; the inverse projection squares it.
Spline SphereTile()
{
  const double corner = 0.5 * (std::sqrt(3.0) - 1.0);
  const double edgeWeight = std::cos(15.0 * 3.14159265358979323846 / 180.0);
  const double edge = std::sqrt(2.0) - edgeWeight; // times its weight
  Eigen::VectorXd x(9);
  Eigen::VectorXd y(9);
  Eigen::VectorXd w(9);
  for (int j = 0; j < 3; ++j)
  {
    for (int i = 0; i < 3; ++i)
    {
      x[i + 3 * j] = (i - 1) * (j == 1 ? edge : corner);
      y[i + 3 * j] = (j - 1) * (i == 1 ? edge : corner);
      w[i + 3 * j] = (i == 1 ? edgeWeight : 1.0) * (j == 1 ? edgeWeight : 1.0);
    }
  }
  const std::array<int, 3> degrees{ 2, 2, 0 };
  const Bernstein X(degrees, x);
  const Bernstein Y(degrees, y);
  const Bernstein W(degrees, w);
  const Bernstein plane = X * X + Y * Y;
  Eigen::MatrixXd homogeneous(4, 25);
  homogeneous.row(0) = (2.0 * (X * W)).Coefficients().transpose();
  homogeneous.row(1) = (2.0 * (Y * W)).Coefficients().transpose();
  homogeneous.row(2) = (W * W - plane).Coefficients().transpose();
  homogeneous.row(3) = (W * W + plane).Coefficients().transpose();
  return Spline::FromHomogeneous(
    { KnotVector::Uniform(4, 5), KnotVector::Uniform(4, 5), {} }, homogeneous);
}

/// The turns that take the direction z to the six directions of the axes.
std::vector<Matrix3d> CubeFaces()
{
  std::vector<Matrix3d> turns;
  for (int d = 0; d < 3; ++d)
  {
    for (const double sign : { -1.0, 1.0 })
    {
      const Vector3d outward = sign * Vector3d::Unit(d);
      const Vector3d first = Vector3d::Unit((d + 1) % 3);
      Matrix3d turn;
      turn << first, outward.cross(first), outward;
      turns.push_back(turn);
    }
  }
  return turns;
}

/// Surfaces in the plane z = 0, extruded symmetrically along z.
MultiPatch Prism(const std::vector<Aggregate>& sections, double height)
{
  std::vector<Aggregate> bodies;
  for (const Aggregate& section : sections)
  {
    bodies.push_back(
      Extrude(Transformed(section, Matrix3d::Identity(), -0.5 * height * AxisZ), height * AxisZ));
  }
  return Model(bodies);
}

}

MultiPatch MakeBox(const Vector3d& lengths)
{
  CheckLengths(lengths);
  const double x = 0.5 * lengths[0];
  const double y = 0.5 * lengths[1];
  return Prism({ Quad({ -x, -y, 0 }, { x, -y, 0 }, { -x, y, 0 }, { x, y, 0 }) }, lengths[2]);
}

MultiPatch MakeCylinder(double radius, double height, Parametrisation parametrisation)
{
  CheckLength("radius", radius);
  CheckLength("height", height);
  return Prism(Disk(radius, parametrisation), height);
}

MultiPatch MakeTube(double innerRadius, double outerRadius, double height)
{
  CheckLess("inner radius", innerRadius, "outer radius", outerRadius);
  CheckLength("height", height);
  return Prism(
    { Revolve(Line(innerRadius * AxisX, outerRadius * AxisX), Origin, AxisZ, 360.0) }, height);
}

MultiPatch MakeCone(
  double bottomRadius, double topRadius, double height, Parametrisation parametrisation)
{
  CheckLength("bottom radius", bottomRadius);
  CheckLength("height", height);
  if (topRadius != 0.0)
  {
    CheckLength("top radius", topRadius);
  }
  else if (parametrisation == Parametrisation::Patches)
  {
    throw Error("a cone with an apex degenerates there in every parametrisation: give a top radius "
                "that is not 0, or choose Poles");
  }
  const double scale = topRadius / bottomRadius;
  std::vector<Aggregate> bodies;
  for (const Aggregate& section : Disk(bottomRadius, parametrisation))
  {
    bodies.push_back(Rule(Transformed(section, Matrix3d::Identity(), -0.5 * height * AxisZ),
      Transformed(section, scale * Matrix3d::Identity(), 0.5 * height * AxisZ)));
  }
  return Model(bodies);
}

MultiPatch MakeSphere(double radius, Parametrisation parametrisation)
{
  CheckLength("radius", radius);
  if (parametrisation == Parametrisation::Poles)
  {
    const Aggregate half = Revolve(Line(Origin, radius * AxisZ), Origin, AxisY, 180.0);
    return Model({ Revolve(half, Origin, AxisZ, 360.0) });
  }
  const Aggregate tile(SphereTile());
  // The corners of the cube are at half the radius.
  const double a = 0.5 * radius / std::sqrt(3.0);
  const Aggregate face = Quad({ -a, -a, a }, { a, -a, a }, { -a, a, a }, { a, a, a });
  std::vector<Aggregate> bodies{ Apply(Extrude(face, -2.0 * a * AxisZ),
    [](const Spline& s)
    {
      // Of the degree of its neighbours, so that faces have equal control points.
      return ElevateDegree(ElevateDegree(ElevateDegree(ReverseDirection(s, 2), 0, 3), 1, 3), 2, 3);
    }) };
  for (const Matrix3d& turn : CubeFaces())
  {
    bodies.push_back(Rule(Transformed(face, turn), Transformed(tile, radius * turn)));
  }
  return Model(bodies);
}

MultiPatch MakeSphericalShell(
  double innerRadius, double outerRadius, Parametrisation parametrisation)
{
  CheckLess("inner radius", innerRadius, "outer radius", outerRadius);
  if (parametrisation == Parametrisation::Poles)
  {
    const Aggregate half =
      Revolve(Line(innerRadius * AxisZ, outerRadius * AxisZ), Origin, AxisY, 180.0);
    return Model({ Revolve(half, Origin, AxisZ, 360.0) });
  }
  const Aggregate tile(SphereTile());
  std::vector<Aggregate> bodies;
  for (const Matrix3d& turn : CubeFaces())
  {
    bodies.push_back(
      Rule(Transformed(tile, innerRadius * turn), Transformed(tile, outerRadius * turn)));
  }
  return Model(bodies);
}

MultiPatch MakeTorus(double majorRadius, double minorRadius, Parametrisation parametrisation)
{
  CheckLess("minor radius", minorRadius, "major radius", majorRadius);
  // The normal of the disk is the direction in which it sets out: x, y, z become z, x, y.
  Matrix3d upright;
  upright << AxisZ, AxisX, AxisY;
  std::vector<Aggregate> bodies;
  for (const Aggregate& section : Disk(minorRadius, parametrisation))
  {
    bodies.push_back(
      Revolve(Transformed(section, upright, majorRadius * AxisX), Origin, AxisZ, 360.0));
  }
  return Model(bodies);
}

MultiPatch MakeWedge(const Vector3d& lengths, Parametrisation parametrisation)
{
  CheckLengths(lengths);
  const Vector3d a(-0.5 * lengths[0], -0.5 * lengths[1], 0.0);
  const Vector3d b = a + lengths[0] * AxisX;
  const Vector3d c = a + lengths[1] * AxisY;
  if (parametrisation == Parametrisation::Poles)
  {
    return Prism({ Quad(a, b, c, c) }, lengths[2]);
  }
  const Vector3d centre = (a + b + c) / 3.0;
  const Vector3d ab = 0.5 * (a + b);
  const Vector3d bc = 0.5 * (b + c);
  const Vector3d ca = 0.5 * (c + a);
  return Prism(
    { Quad(a, ab, ca, centre), Quad(b, bc, ab, centre), Quad(c, ca, bc, centre) }, lengths[2]);
}

MultiPatch MakeHelix(double majorRadius, double minorRadius, double pitch, double turns,
  double tolerance, Parametrisation parametrisation)
{
  CheckLess("minor radius", minorRadius, "major radius", majorRadius);
  CheckLength("number of turns", turns);
  CheckLength("tolerance", tolerance);
  if (!std::isfinite(pitch) || (turns > 1.0 && std::abs(pitch) <= 2.0 * minorRadius))
  {
    throw Error("the coils overlap: the pitch, " + std::to_string(pitch) +
      ", must be more than twice the minor radius");
  }
  const double rise = pitch * turns;
  const Spline motion =
    Screw(Origin, AxisZ, 360.0 * turns, rise, majorRadius + minorRadius, tolerance);
  const Vector3d tangent =
    Vector3d(0.0, 2.0 * 3.14159265358979323846 * majorRadius, pitch).normalized();
  Matrix3d upright;
  upright << AxisX, tangent.cross(AxisX), tangent;
  const Vector3d begin = majorRadius * AxisX - 0.5 * rise * AxisZ;
  std::vector<Aggregate> bodies;
  for (const Aggregate& section : Disk(minorRadius, parametrisation))
  {
    bodies.push_back(Sweep(Transformed(section, upright, begin), motion));
  }
  return Model(bodies);
}

}
