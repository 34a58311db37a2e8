// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_DeterminantSubdivisionWorker_h
#define hyperpatch_DeterminantSubdivisionWorker_h

#include "DegenerateSidesWorker.h"
#include "TensorGridWorker.h"
#include "ValidityTest.h"

#include <array>
#include <cstddef>
#include <vector>

namespace hyperpatch
{

/// Internal to ValidityTest: halves the Bernstein form of det J of one element, the widest box
/// first, until its sign is known or refuted and its least and greatest value are enclosed as
/// narrowly as asked for. Coefficients are halved, never computed again.
class DeterminantSubdivision
{
public:
  DeterminantSubdivision(std::array<int, 3> degrees, bool rational, const ValidityOptions& options);

  /// Where the coefficients of the next element go: those of det J, of degrees 3p - 1, or those of
  /// W^4 J followed by those of W^4, both of degrees 4p.
  [[nodiscard]] double* Coefficients();

  /// \param error, weightError bounds of the error of these coefficients
  /// \param result what the boxes tell is filled in; Boxes counts them, from 1 on
  void operator()(double error, double weightError, ElementValidity& result);

private:
  /// A part of an element.
  struct Box
  {
    std::size_t Block;
    std::array<double, 3> Low;
    std::array<double, 3> Size;
    /// Bounds of the error of the coefficients of det J (times W^4), and of W^4.
    double Error;
    double WeightError;
    /// The greatest coefficients of both.
    double Magnitude;
    double WeightMagnitude;
    /// Sides that lie on those of the element, bits u0 u1 v0 v1 w0 w1.
    unsigned Sides;
    int Depth;
    /// Bounds of det J; the sign of its coefficients, 0 if there are several.
    Interval Range;
    int Sign;
    double Priority;
  };

  static bool ComesLater(const Box& a, const Box& b) { return a.Priority < b.Priority; }

  [[nodiscard]] double* Values(const Box& box)
  {
    return this->Pool.data() + box.Block * this->BlockSize;
  }
  [[nodiscard]] double* Weights(const Box& box)
  {
    return this->Values(box) + this->Determinant.Count();
  }
  [[nodiscard]] std::size_t NewBlock();

  /// Bounds of the quotient of a coefficient of W^4 J and one of W^4.
  [[nodiscard]] static Interval Quotient(const Box& box, double value, double weight);
  /// det J at a corner of a box, or bounds of what coefficient i contributes to it: the values of
  /// W^4 J / W^4 are means of the quotients of coefficients, because those of W^4 are positive.
  [[nodiscard]] Interval Contribution(const Box& box, std::size_t i);
  /// Range and sign of a box, and what its corners show.
  void Examine(Box& box, ElementValidity& result);
  /// Whether halving the box could tell more that was asked for.
  [[nodiscard]] bool IsOpen(const Box& box, const ElementValidity& result) const;
  /// Halves across the direction in which the coefficients bend most.
  [[nodiscard]] std::array<Box, 2> HalvesOf(const Box& box);
  /// det J (times W^4) of the element at a point, from its coefficients.
  [[nodiscard]] double ValueAt(const std::array<double, 3>& point) const;
  /// A point of the open element, near one of its border at which det J is known to have a sign,
  /// where it has it too.
  [[nodiscard]] std::array<double, 3> Interior(
    const std::array<double, 3>& point, int sign, double error) const;

  bool Rational;
  ValidityOptions Options;
  TensorGrid Determinant;
  std::size_t BlockSize;

  // Scratch.
  std::vector<double> Pool;
  std::vector<double> Root;
  std::vector<double> Ratios;
  std::vector<std::size_t> Free;
  std::size_t Blocks = 0;
  std::vector<Box> Heap;
  DegenerateSides Degenerate;
  double LeastSample = 0.0;
  double GreatestSample = 0.0;
};

}

#endif
