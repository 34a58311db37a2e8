// SPDX-License-Identifier: BSD-3-Clause
#include "Cone.h"

#include "Bernstein.h"
#include "Error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace hyperpatch
{

namespace
{

/// Unit roundoff.
constexpr double U = std::numeric_limits<double>::epsilon() / 2;
constexpr double Pi = 3.14159265358979323846;

/// Dot and cross products of two unit vectors, themselves right to 2 U, err by at most 8 U.
constexpr double ProductError = 8 * U;

/// The sine of the angle t3 of the cross-product cone, rounded up; 1 or more where there is none.
/// \param sineOfAxes of the angle between the axes
double CrossSine(const Cone& a, const Cone& b, double sineOfAxes)
{
  const double sine = sineOfAxes - ProductError;
  // t1 + t2 < beta; both are acute, so that sines and cosines decide.
  if (!(a.Cosine() * b.Cosine() - a.Sine() * b.Sine() > ProductError) ||
    !(a.Sine() * b.Cosine() + a.Cosine() * b.Sine() + ProductError < sine))
  {
    return 1.0;
  }
  const double cosine = std::min(1.0, std::abs(a.Axis().dot(b.Axis())) + ProductError);
  const double square =
    a.Sine() * a.Sine() + 2.0 * a.Sine() * b.Sine() * cosine + b.Sine() * b.Sine();
  // Dividing moves the axis by ProductError / sine at most.
  return std::sqrt(square) / sine * (1.0 + 8 * U) + 2 * ProductError / sine;
}

/// The sign of a . (b x c) by the order a . (b x c).
int SignInOrder(const Cone& a, const Cone& b, const Cone& c)
{
  const Eigen::Vector3d normal = b.Axis().cross(c.Axis());
  const double sineOfAxes = normal.norm();
  const double s = CrossSine(b, c, sineOfAxes);
  if (!(s < 1.0))
  {
    return 0;
  }
  const double cosine = std::sqrt((1.0 - s) * (1.0 + s)) * (1.0 - 4 * U);
  const double dot = a.Axis().dot(normal) / sineOfAxes;
  // The angle of the axes and both half angles stay together below 90 degrees.
  const bool decided = a.Cosine() * cosine - a.Sine() * s > ProductError &&
    std::abs(dot) > a.Sine() * cosine + a.Cosine() * s + 4 * ProductError;
  return decided ? (dot > 0.0 ? 1 : -1) : 0;
}

/// The interval of the cosine over angles [low, high], of which either may leave [0, pi].
Interval CosineOver(double low, double high)
{
  constexpr double Slack = 16 * U;
  return { std::max(-1.0, std::cos(std::min(Pi, high + Slack)) - 2 * U),
    std::min(1.0, std::cos(std::max(0.0, low - Slack)) + 2 * U) };
}

double AngleOfAxes(const Cone& a, const Cone& b)
{
  return std::atan2(a.Axis().cross(b.Axis()).norm(), a.Axis().dot(b.Axis()));
}

/// Bounds of |a x b| for unit vectors of two cones.
Interval SineBetween(const Cone& a, const Cone& b)
{
  const double angle = AngleOfAxes(a, b);
  const double spread = a.Angle() + b.Angle() + 16 * U;
  const double low = std::max(0.0, angle - spread);
  const double high = std::min(Pi, angle + spread);
  const bool passesRightAngle = low <= Pi / 2 && Pi / 2 <= high;
  return { std::max(0.0, std::min(std::sin(low), std::sin(high)) - 2 * U),
    passesRightAngle ? 1.0 : std::min(1.0, std::max(std::sin(low), std::sin(high)) + 2 * U) };
}

Interval TripleInOrder(const Cone& a, const Cone& b, const Cone& c)
{
  const Interval cosine = Dot(a, Cross(b, c));
  const Interval sine = SineBetween(b, c);
  return { cosine.Low * (cosine.Low < 0.0 ? sine.High : sine.Low) - 2 * U,
    cosine.High * (cosine.High > 0.0 ? sine.High : sine.Low) + 2 * U };
}

/// The coefficients without the last (offset 0) or the first (offset 1) layer of a direction: the
/// two ends X = (1 - u) X_0 + u X_1 of a de Casteljau step.
Bernstein Layers(const Bernstein& f, int direction, int offset)
{
  const auto d = static_cast<std::size_t>(direction);
  std::array<int, 3> degrees = f.Degrees();
  Eigen::Index stride = 1;
  for (std::size_t e = 0; e < d; ++e)
  {
    stride *= degrees[e] + 1;
  }
  const Eigen::Index n = degrees[d] + 1;
  --degrees[d];
  Eigen::VectorXd c(f.Coefficients().size() / n * (n - 1));
  for (Eigen::Index slab = 0; slab * stride * n < f.Coefficients().size(); ++slab)
  {
    c.segment(slab * stride * (n - 1), stride * (n - 1)) =
      f.Coefficients().segment((slab * n + offset) * stride, stride * (n - 1));
  }
  return Bernstein(degrees, c, f.RoundingBound());
}

}

Cone::Cone(const Eigen::Vector3d& axis, double angle)
{
  const double length = axis.stableNorm();
  if (!(length > 0.0) || !std::isfinite(length))
  {
    throw Error("a cone needs an axis that is finite and not 0");
  }
  if (!(angle >= 0.0))
  {
    throw Error("a cone needs a half angle from 0 on, not " + std::to_string(angle));
  }
  *this = angle < Pi / 2 ? Cone::Acute(axis / length, std::cos(angle) - 2 * U) : Cone();
}

Cone Cone::Acute(const Eigen::Vector3d& unitAxis, double cosine)
{
  Cone cone;
  if (cosine > 0.0)
  {
    cone.A = unitAxis;
    cone.C = cosine;
    cone.S =
      std::min(1.0, std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))) * (1.0 + 4 * U));
  }
  return cone;
}

template <class ForEach>
Cone Cone::AroundEach(const ForEach& forEach, double error)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  forEach([&sum](double x, double y, double z) { sum += Eigen::Vector3d(x, y, z); });
  // Squares below must neither underflow nor overflow; without an axis zeros are still counted.
  constexpr double Least = 1e-140;
  constexpr double Greatest = 1e140;
  const double length = sum.norm();
  const bool hasAxis = length > Least && length < Greatest;
  const Eigen::Vector3d axis = hasAxis ? Eigen::Vector3d(sum / length) : Eigen::Vector3d::Zero();
  double cosine = hasAxis ? 1.0 : -1.0;
  int zeros = 0;
  forEach(
    [&](double x, double y, double z)
    {
      const double norm = std::sqrt(x * x + y * y + z * z);
      // A norm that underflowed says nothing.
      if ((x == 0.0 && y == 0.0 && z == 0.0) || (norm <= error && error > Least))
      {
        ++zeros;
      }
      else if (norm > Least && norm > error)
      {
        // The worst vector within the error: its part along the axis is less, its length greater.
        const double dot = axis[0] * x + axis[1] * y + axis[2] * z;
        cosine = std::min(cosine, (dot - error) / (norm + error));
      }
      else
      {
        cosine = -1.0;
      }
    });
  // The dot product, the norm, the axis and differences of points that make up the vectors.
  Cone cone = Cone::Acute(axis, cosine - 16 * U);
  cone.Zeros = zeros;
  return cone;
}

Cone Cone::Around(const Eigen::Ref<const Eigen::Matrix3Xd>& vectors, double error)
{
  return AroundEach(
    [&vectors](const auto& body)
    {
      for (Eigen::Index i = 0; i < vectors.cols(); ++i)
      {
        const double* d = vectors.data() + vectors.outerStride() * i;
        body(d[0], d[1], d[2]);
      }
    },
    error);
}

Cone Cone::Grown(const Eigen::Vector3d& vector) const
{
  const double length = vector.stableNorm();
  if (this->IsEverything() || this->Contains(vector) || !(length > 0.0))
  {
    return *this;
  }
  const Eigen::Vector3d v = vector / length;
  const double cosAlpha = this->A.dot(v);
  const double sinAlpha = this->A.cross(v).norm();
  // sin(theta) times the formula of Sederberg & Meyers, which so holds for theta = 0 as well.
  const Eigen::Vector3d opposite =
    ((this->C * sinAlpha + this->S * cosAlpha) * this->A - this->S * v) / sinAlpha;
  const Eigen::Vector3d bisector = v + opposite;
  const double norm = bisector.norm();
  // The new half angle (alpha + theta) / 2 is acute where alpha + theta < pi.
  if (!(this->S * cosAlpha + this->C * sinAlpha > ProductError) || !(norm > ProductError))
  {
    return Cone();
  }
  const Eigen::Vector3d axis = bisector / norm;
  // Errors of the bisector move the axis: by that much, over its length, the angle grows.
  return Cone::Acute(axis,
    std::min(axis.dot(v), axis.dot(opposite)) - 4 * ProductError / norm -
      4 * ProductError / sinAlpha);
}

double Cone::Angle() const
{
  return this->IsEverything() ? Pi : std::atan2(this->S, this->C);
}

bool Cone::Contains(const Eigen::Vector3d& vector) const
{
  return this->IsEverything() || this->A.dot(vector) >= this->C * vector.norm();
}

Interval Dot(const Cone& a, const Cone& b)
{
  if (a.IsEverything() || b.IsEverything())
  {
    return { -1.0, 1.0 };
  }
  const double angle = AngleOfAxes(a, b);
  const double spread = a.Angle() + b.Angle();
  return CosineOver(angle - spread, angle + spread);
}

Cone Cross(const Cone& a, const Cone& b)
{
  if (a.IsEverything() || b.IsEverything())
  {
    return Cone();
  }
  const Eigen::Vector3d normal = a.Axis().cross(b.Axis());
  const double length = normal.norm();
  const double s = CrossSine(a, b, length);
  return s < 1.0 ? Cone::Acute(normal / length, std::sqrt((1.0 - s) * (1.0 + s)) - 4 * U) : Cone();
}

Interval TripleProduct(const Cone& a, const Cone& b, const Cone& c)
{
  if (a.IsEverything() || b.IsEverything() || c.IsEverything())
  {
    return { -1.0, 1.0 };
  }
  const Interval orders[3] = { TripleInOrder(a, b, c), TripleInOrder(b, c, a),
    TripleInOrder(c, a, b) };
  return { std::max({ orders[0].Low, orders[1].Low, orders[2].Low, -1.0 }),
    std::min({ orders[0].High, orders[1].High, orders[2].High, 1.0 }) };
}

int TripleProductSign(const Cone& a, const Cone& b, const Cone& c)
{
  if (a.IsEverything() || b.IsEverything() || c.IsEverything())
  {
    return 0;
  }
  if (const int sign = SignInOrder(a, b, c))
  {
    return sign;
  }
  if (const int sign = SignInOrder(b, c, a))
  {
    return sign;
  }
  return SignInOrder(c, a, b);
}

Cone DerivativeCone(const Eigen::MatrixXd& homogeneousBezierPoints, std::array<int, 3> degrees,
  int direction, double pointError)
{
  const Eigen::MatrixXd& h = homogeneousBezierPoints;
  if (direction < 0 || direction > 2 || degrees[static_cast<std::size_t>(direction)] < 1)
  {
    throw Error("direction " + std::to_string(direction) + " has no derivative");
  }
  if (h.rows() != 3 && h.rows() != 4)
  {
    throw Error(
      "the cone of a derivative needs 3 or 4 coordinates, not " + std::to_string(h.rows()));
  }
  if (h.rows() == 3)
  {
    // Differences of control points; the factor does not matter.
    Eigen::Index stride = 1;
    for (int d = 0; d < direction; ++d)
    {
      stride *= degrees[static_cast<std::size_t>(d)] + 1;
    }
    const Eigen::Index n = degrees[static_cast<std::size_t>(direction)];
    const Eigen::Index slabs = h.cols() / (stride * (n + 1));
    if (slabs * stride * (n + 1) != h.cols())
    {
      throw Error(std::to_string(h.cols()) + " control points do not fit the degrees");
    }
    return Cone::AroundEach(
      [&](const auto& body)
      {
        for (Eigen::Index s = 0; s < slabs; ++s)
        {
          const double* a = h.data() + 3 * s * stride * (n + 1);
          const double* b = a + 3 * stride;
          for (Eigen::Index i = 0; i < stride * n; ++i, a += 3, b += 3)
          {
            body(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
          }
        }
      },
      2.0 * std::sqrt(3.0) * pointError * (1.0 + 4 * U));
  }
  std::array<Bernstein, 4> first;
  std::array<Bernstein, 4> second;
  const Bernstein weight(degrees, h.row(3).transpose(), pointError);
  for (Eigen::Index r = 0; r < 4; ++r)
  {
    Bernstein x(degrees, h.row(r).transpose(), pointError);
    if (r < 3)
    {
      // N is the same about any origin; near the volume its terms do not cancel.
      x = x - h.row(r).sum() / h.row(3).sum() * weight;
    }
    first[static_cast<std::size_t>(r)] = Layers(x, direction, 0);
    second[static_cast<std::size_t>(r)] = Layers(x, direction, 1);
  }
  std::array<Bernstein, 3> n;
  double square = 0.0;
  for (std::size_t r = 0; r < 3; ++r)
  {
    n[r] = second[r] * first[3] - first[r] * second[3];
    square += n[r].RoundingBound() * n[r].RoundingBound();
  }
  Eigen::Matrix3Xd vectors(3, n[0].Coefficients().size());
  vectors << n[0].Coefficients().transpose(), n[1].Coefficients().transpose(),
    n[2].Coefficients().transpose();
  return Cone::Around(vectors, std::sqrt(square) * (1.0 + 4 * U));
}

}
