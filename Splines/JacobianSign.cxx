// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianSign.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace hyperpatch
{

namespace
{

/// Unit roundoff.
constexpr double U = std::numeric_limits<double>::epsilon() / 2;
/// Ratios beyond this are given up, so that one number bounds the rounding of all.
constexpr double LargestRatio = 100.0;
/// Of the triple product of the unit axes of the frame.
constexpr double LeastVolume = 1e-8;
/// Parts of vectors below this may have lost digits to underflow.
constexpr double LeastPart = 1e-280;

/// The control points that the spans of a block depend on.
struct Window
{
  std::array<int, 3> Count;            ///< numbers of control points
  std::array<std::ptrdiff_t, 3> Steps; ///< from one to the next, in control points
  std::ptrdiff_t First;
};

Window WindowOf(const Spline& geometry, const SpanBlock& spans)
{
  Window window{};
  std::ptrdiff_t step = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = geometry.Knots()[d];
    const int begin = knots.Spans()[static_cast<std::size_t>(spans.First[d])] - knots.Degree();
    window.Count[d] = knots.Spans()[static_cast<std::size_t>(spans.Last[d])] - begin + 1;
    window.Steps[d] = step;
    window.First += begin * step;
    step *= knots.Size();
  }
  return window;
}

/// What is known of the control vectors in the frame: per direction d the greatest ratios to the
/// part along axis d.
struct Ratios
{
  double First[3] = {};  ///< of |part| along axis d + 1
  double Second[3] = {}; ///< of |part| along axis d + 2
  double Sum[3] = {};    ///< of both added

  /// One of the two criteria of the header holds, with every ratio enlarged by its rounding error.
  [[nodiscard]] bool Prove(double error) const
  {
    const auto enlarged = [error](double ratio)
    { return ratio <= LargestRatio ? (ratio + error) / (1.0 - error) : INFINITY; };
    if (enlarged(this->Sum[0]) < 1.0 && enlarged(this->Sum[1]) < 1.0 &&
      enlarged(this->Sum[2]) < 1.0)
    {
      return true;
    }
    double m[3][3];
    for (int d = 0; d < 3; ++d)
    {
      m[(d + 1) % 3][d] = enlarged(this->First[d]);
      m[(d + 2) % 3][d] = enlarged(this->Second[d]);
    }
    // The leading principal minors of I - m are positive.
    const double pair = m[0][1] * m[1][0];
    const double all = pair + m[0][2] * m[2][0] + m[1][2] * m[2][1] + m[0][1] * m[1][2] * m[2][0] +
      m[0][2] * m[1][0] * m[2][1];
    return pair < 1.0 && all * (1.0 + 16 * U) < 1.0;
  }
};

/// The test on one window.
class Test
{
public:
  Test(const Spline& geometry, const Window& window)
    : W(window)
    , Points(geometry.Coefficients().data())
    , Weights(geometry.IsRational() ? geometry.Weights().data() : nullptr)
  {
  }

  int Sign()
  {
    this->FindCentre();
    if (!this->FindFrame())
    {
      return 0;
    }
    Ratios ratios;
    // A few lines first: where the answer is no they mostly know.
    const int longest = std::max(this->W.Count[1], this->W.Count[2]);
    for (int stride = std::max(1, longest / 3);; stride = 1)
    {
      for (int d = 0; d < 3; ++d)
      {
        if (!this->Scan(d, stride, ratios))
        {
          return 0;
        }
      }
      if (stride == 1)
      {
        return this->FrameSign;
      }
    }
  }

private:
  [[nodiscard]] std::ptrdiff_t At(int i, int j, int k) const
  {
    return this->W.First + i * this->W.Steps[0] + j * this->W.Steps[1] + k * this->W.Steps[2];
  }

  /// Rational: the centre of the control points and half the size of their box.
  void FindCentre()
  {
    if (!this->Weights)
    {
      return;
    }
    Eigen::Array3d low = Eigen::Array3d::Constant(INFINITY);
    Eigen::Array3d high = -low;
    for (int k = 0; k < this->W.Count[2]; ++k)
    {
      for (int j = 0; j < this->W.Count[1]; ++j)
      {
        for (int i = 0; i < this->W.Count[0]; ++i)
        {
          const std::ptrdiff_t at = this->At(i, j, k);
          const Eigen::Map<const Eigen::Array3d> p(this->Points + 3 * at);
          low = low.min(p);
          high = high.max(p);
          this->LargestWeight = std::max(this->LargestWeight, this->Weights[at]);
        }
      }
    }
    this->Centre = 0.5 * low + 0.5 * high;
    this->Half = (high - this->Centre).max(this->Centre - low) * (1.0 + 4 * U);
  }

  /// The homogeneous control point about the centre.
  [[nodiscard]] Eigen::Array3d X(std::ptrdiff_t at) const
  {
    const Eigen::Map<const Eigen::Array3d> p(this->Points + 3 * at);
    return this->Weights ? this->Weights[at] * (p - this->Centre) : Eigen::Array3d(p);
  }

  /// The frame of the sums of control vectors, which are differences of two faces of the window.
  bool FindFrame()
  {
    Eigen::Matrix3d axes;
    for (int d = 0; d < 3; ++d)
    {
      const int a = (d + 1) % 3;
      const int b = (d + 2) % 3;
      const auto count = [this](int direction)
      { return this->W.Count[static_cast<std::size_t>(direction)]; };
      const auto step = [this](int direction)
      { return this->W.Steps[static_cast<std::size_t>(direction)]; };
      const std::ptrdiff_t across = (count(d) - 1) * step(d);
      Eigen::Array3d sum = Eigen::Array3d::Zero();
      for (int j = 0; j < count(b); ++j)
      {
        for (int i = 0; i < count(a); ++i)
        {
          const std::ptrdiff_t at = this->W.First + i * step(a) + j * step(b);
          sum += this->X(at + across) - this->X(at);
        }
      }
      const double length = sum.matrix().norm();
      if (!(length > LeastPart) || !std::isfinite(length))
      {
        return false;
      }
      axes.col(d) = sum / length;
    }
    const double volume = axes.determinant();
    if (!(std::abs(volume) > LeastVolume))
    {
      return false;
    }
    this->FrameSign = volume > 0.0 ? 1 : -1;
    // The adjugate: the inverse up to a factor that does not matter.
    this->Frame.row(0) = this->FrameSign * axes.col(1).cross(axes.col(2));
    this->Frame.row(1) = this->FrameSign * axes.col(2).cross(axes.col(0));
    this->Frame.row(2) = this->FrameSign * axes.col(0).cross(axes.col(1));
    // The vector b = F v is computed with an error of 4 U |F| |v| <= 4 U |F| |F^-1| |b|, where the
    // entries of |F| |F^-1| add up to 9 / volume a row at most, and F errs no more than that.
    this->Error = 100 * U / std::abs(volume) * LargestRatio;
    if (this->Weights)
    {
      const Eigen::Array3d rounding = 16 * U * this->LargestWeight * this->Half;
      this->Margin = this->Frame.cwiseAbs() * rounding.matrix() * (1.0 + 8 * U);
      this->MarginPerWeight = this->Frame.cwiseAbs() * this->Half.matrix() * (1.0 + 8 * U);
    }
    return true;
  }

  /// Takes the control vectors of a direction on every stride-th line along u into the ratios.
  bool Scan(int direction, int stride, Ratios& ratios) const
  {
    const auto d = static_cast<std::size_t>(direction);
    std::array<int, 3> count = this->W.Count;
    --count[d];
    for (int k = 0; k < count[2]; k += stride)
    {
      for (int j = 0; j < count[1]; j += stride)
      {
        for (int i = 0; i < count[0]; ++i)
        {
          const std::ptrdiff_t at = this->At(i, j, k);
          if (!this->Take(direction, at, at + this->W.Steps[d], ratios))
          {
            return false;
          }
        }
        if (!ratios.Prove(this->Error))
        {
          return false;
        }
      }
    }
    return true;
  }

  bool Take(int direction, std::ptrdiff_t from, std::ptrdiff_t to, Ratios& ratios) const
  {
    const Eigen::Array3d v = this->X(to) - this->X(from);
    const int k1 = (direction + 1) % 3;
    const int k2 = (direction + 2) % 3;
    const auto part = [this, &v](int k)
    { return this->Frame(k, 0) * v[0] + this->Frame(k, 1) * v[1] + this->Frame(k, 2) * v[2]; };
    double b = part(direction);
    double b1 = std::abs(part(k1));
    double b2 = std::abs(part(k2));
    if (this->Weights)
    {
      const double difference = std::abs(this->Weights[to] - this->Weights[from]) * (1.0 + 4 * U);
      const double margin = this->Margin[direction] + difference * this->MarginPerWeight[direction];
      // So that the rounding of b is still small beside what is left of it.
      b = b * (1.0 - 1.0 / LargestRatio) > margin ? b - margin : 0.0;
      b1 += this->Margin[k1] + difference * this->MarginPerWeight[k1];
      b2 += this->Margin[k2] + difference * this->MarginPerWeight[k2];
    }
    if (!(b > LeastPart))
    {
      return false;
    }
    // NaN is taken in and fails later.
    const auto take = [b](double& ratio, double value)
    {
      if (!(value <= ratio * b))
      {
        ratio = value / b;
      }
    };
    take(ratios.First[direction], b1);
    take(ratios.Second[direction], b2);
    take(ratios.Sum[direction], b1 + b2);
    return true;
  }

  Window W;
  const double* Points;
  const double* Weights;
  Eigen::Array3d Centre = Eigen::Array3d::Zero();
  Eigen::Array3d Half = Eigen::Array3d::Zero();
  double LargestWeight = 0.0;
  Eigen::Matrix3d Frame;
  int FrameSign = 0;
  double Error = 0.0;
  /// What a part of a vector of a rational volume may err by: a constant, and per difference of
  /// weights.
  Eigen::Vector3d Margin = Eigen::Vector3d::Zero();
  Eigen::Vector3d MarginPerWeight = Eigen::Vector3d::Zero();
};

}

int JacobianSign(const Spline& geometry, const ParameterBox& box)
{
  if (geometry.Components() != 3 || geometry.Dimension() != 3)
  {
    return 0;
  }
  return Test(geometry, WindowOf(geometry, SpansOf(geometry, box))).Sign();
}

}
