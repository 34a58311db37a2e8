// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_EvaluatorKernel_h
#define hyperpatch_EvaluatorKernel_h

#include <cstddef>

/// Internal to Evaluator: what its kernels read. EvaluatorKernel.inl is compiled once per
/// instruction set, so this header and that file hold plain data and internal linkage only: an
/// inline function or template with external linkage, compiled for AVX-512, could replace the
/// baseline's copy of it at link time and stop the program on an older machine.
namespace hyperpatch
{

/// Up to this degree the basis functions come from tables of polynomials, above it from the
/// recurrence.
inline constexpr int MaxTableDegree = 4;

/// Largest number of doubles of a vector register; rows of scratch are padded to it, and the
/// control points end with as many numbers that are never used.
inline constexpr int MaxLanes = 8;

/// One parametric direction. Spans are the non-empty ones, counted from 0.
struct EvaluatorDirection
{
  int Degree;
  int Spans;
  int Buckets;
  /// Doubles between rows (value, derivative, second derivative) of basis functions.
  int Pitch;
  double First;
  double Last;
  double BucketsPerUnit;
  /// Per bucket: the last span that begins in an earlier bucket, or 0.
  const int* Bucket;
  /// Spans + 1 ascending numbers.
  const double* Breaks;
  const double* InverseLengths;
  /// Per span: index in the control points of the first control point that matters there.
  const std::size_t* Offsets;
  /// Doubles between neighbouring control points.
  std::size_t Stride;
  /// Per span, `TableSize` doubles.
  ///
  /// Degree up to MaxTableDegree: for each half of the span, the power coefficients of the basis
  /// functions about that half's own knot, lowest power first, each row of `Pitch` functions; the
  /// unit of length is the span. So values at knots are exact, and zeros there are exact zeros.
  ///
  /// Above: the 2 p knots around the span, then the reciprocals of the knot differences in the
  /// order in which the recurrence (The NURBS Book A2.2) wants them.
  const double* Table;
  std::size_t TableSize;
};

struct EvaluatorData
{
  EvaluatorDirection Directions[3];
  int Components;
  bool Rational;
  /// Doubles per control point: 1, 2 or a multiple of 4; components first, the weight last.
  int Width;
  const double* Points;
};

/// The bucket of a parameter; a monotone function, 0 for NaN.
static inline int EvaluatorBucket(const EvaluatorDirection& direction, double t)
{
  const double x = (t - direction.First) * direction.BucketsPerUnit;
  const double last = direction.Buckets - 1;
  return static_cast<int>(x > 0.0 ? (x < last ? x : last) : 0.0);
}

/// Doubles in a row of scratch that holds `count` numbers.
static inline std::size_t EvaluatorPadded(std::size_t count)
{
  return (count + MaxLanes - 1) / MaxLanes * MaxLanes;
}

struct EvaluatorKernels
{
  const char* Name;

  /// \param order 0, 1 or 2: how many of the outputs are wanted
  /// \param scratch 1, 3 or 6 (by order) padded rows of (degree u + 1) control points
  void (*Evaluate)(const EvaluatorData& data, std::size_t count, const double* parameters,
    int order, double* values, double* first, double* second, double* scratch);

  /// \param first nullptr, or the derivatives are wanted
  /// \param bases per direction: counts[d] x (1 or 2) x Pitch doubles
  /// \param offsets per direction: counts[d] numbers
  /// \param planes 1 or 2 planes of nv padded rows of nu control points
  /// \param rows 1 or 3 padded rows of nu control points
  void (*EvaluateGrid)(const EvaluatorData& data, const std::size_t* counts,
    const double* const* parameters, double* values, double* first, double* const* bases,
    std::size_t* const* offsets, double* planes, double* rows);
};

extern const EvaluatorKernels EvaluatorBaseline;
extern const EvaluatorKernels EvaluatorAVX2;
extern const EvaluatorKernels EvaluatorAVX512;

/// The kernels that this processor can run, fastest first.
/// \return their number, at most 3
int AvailableEvaluatorKernels(const EvaluatorKernels* kernels[3]);

}

#endif
