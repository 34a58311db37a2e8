// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_BoxSpline_h
#define hyperpatch_BoxSpline_h

#include "Bernstein.h"
#include "ControlBounds.h"
#include "Range.h"
#include "Spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace hyperpatch
{

/// Which part of a box a question is about: per direction the whole of it, or one of its ends.
enum class Part
{
  Whole,
  Low,
  High
};

/// A scalar piecewise polynomial on a box in the parameter domain, as a tensor-product spline whose
/// knot vectors are clamped at the ends of the box: its coefficients are a hull of the function on
/// the box, those of a boundary layer a hull on that face. Reuse one object: no memory is taken
/// once it has its size.
class BoxSpline
{
public:
  /// Restricts a spline of one component by inserting the ends of the box into its knots (Oslo
  /// algorithm).
  /// \param spline gives the knots
  /// \param box inside the domain, of positive width in every direction that is there
  /// \param coefficient (index of a control point) -> scalar, the control points of the function
  /// \param most no more control points are looked at than this
  /// \returns false if it would take more
  template <typename Coefficient>
  bool Restrict(const Spline& spline, const ParameterBox& box, Coefficient&& coefficient,
    double most = INFINITY)
  {
    this->FindWindow(spline, box);
    const auto n = spline.Sizes();
    const auto& first = this->WindowFirst;
    const auto& size = this->WindowSize;
    if (static_cast<double>(size[0]) * size[1] * size[2] > most)
    {
      return false;
    }
    Reserve(Product(size), this->C);
    std::size_t to = 0;
    for (int k = first[2]; k < first[2] + size[2]; ++k)
    {
      for (int j = first[1]; j < first[1] + size[1]; ++j)
      {
        const Eigen::Index row = n[0] * (j + static_cast<Eigen::Index>(n[1]) * k);
        for (int i = first[0]; i < first[0] + size[0]; ++i)
        {
          this->C[to++] = coefficient(row + i);
        }
      }
    }
    this->InsertEnds(spline, box);
    return true;
  }

  /// Adds a bound of the error that each coefficient had before.
  void AddNoise(double bound) { this->Noise += bound; }

  /// Makes this an enclosure of every function that differs from the spline by no more than this,
  /// and its derivatives with respect to the unit cube by no more than that.
  void Widen(double values, const std::array<double, 3>& derivatives);

  /// A polynomial on the unit cube.
  void Assign(const Bernstein& polynomial);

  /// Encloses the function on a part of the box, rounding included.
  [[nodiscard]] Range Values(const std::array<Part, 3>& part) const;
  /// Whether rounding alone decides if the function has a zero in the box: then smaller boxes tell
  /// no more.
  [[nodiscard]] bool IsLostInNoise() const;
  /// Encloses its derivative by a direction in which the part is whole, with respect to the unit
  /// cube.
  [[nodiscard]] Range Derivative(int direction, const std::array<Part, 3>& part) const;
  /// Whether the function cannot be told from 0 anywhere on the part.
  [[nodiscard]] bool Vanishes(const std::array<Part, 3>& part) const;

private:
  [[nodiscard]] static std::ptrdiff_t Product(const std::array<int, 3>& sizes)
  {
    return static_cast<std::ptrdiff_t>(sizes[0]) * sizes[1] * sizes[2];
  }
  /// Memory for so many numbers; it never shrinks, so that growing again sets nothing to 0.
  static void Reserve(std::ptrdiff_t count, std::vector<double>& numbers)
  {
    numbers.resize(std::max(numbers.size(), static_cast<std::size_t>(count)));
  }
  void FindWindow(const Spline& spline, const ParameterBox& box);
  void InsertEnds(const Spline& spline, const ParameterBox& box);
  void InsertEnds(const KnotVector& knots, int direction, double low, double high);
  struct Layers
  {
    std::array<int, 3> First, Last;
  };
  [[nodiscard]] Layers LayersOf(const std::array<Part, 3>& part) const;
  [[nodiscard]] Range Hull(const std::array<Part, 3>& part) const;
  [[nodiscard]] const double* Row(int j, int k) const
  {
    return this->C.data() + this->N[0] * (j + static_cast<std::ptrdiff_t>(this->N[1]) * k);
  }

  std::array<int, 3> P{};
  std::array<int, 3> N{ 1, 1, 1 };
  std::array<std::vector<double>, 3> K; ///< of the unit cube, clamped
  std::vector<double> C;                ///< u fastest, Product(N) of them
  Range All{ 0.0, 0.0 };                ///< of them
  double Noise = 0.0;
  double Slack = 0.0; ///< of values, besides noise
  std::array<double, 3> DerivativeSlack{};

  std::array<int, 3> WindowFirst{}, WindowSize{};
  std::vector<double> Next;
};

}

#endif
