// SPDX-License-Identifier: BSD-3-Clause
#include "Validity.h"

#include "Bernstein.h"
#include "BezierExtractor.h"
#include "DeterminantKernel.h"
#include "Error.h"
#include "EvaluatorKernel.h"
#include "Measures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>

namespace hyperpatch
{

namespace
{

/// Unit roundoff.
constexpr double U = std::numeric_limits<double>::epsilon() / 2;

/// Covers a handful of roundings of the bounds' own arithmetic.
constexpr double Outward = 1.0 + 32 * U;

double Gamma(double operations)
{
  return operations * U / (1.0 - operations * U);
}

std::size_t Product(const std::array<int, 3>& n)
{
  return static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) *
    static_cast<std::size_t>(n[2]);
}

double Binomial(int n, int k)
{
  double b = 1.0;
  for (int i = 1; i <= k; ++i)
  {
    // Exact as long as the result is: the product is divisible by i.
    b = b * (n - k + i) / i;
  }
  return b;
}

/// The kernel for this processor; HYPERPATCH_INSTRUCTION_SET=baseline in the environment is
/// honoured as Evaluator does.
const DeterminantKernels* ChooseKernels()
{
#ifdef HYPERPATCH_X86
  const char* wanted = std::getenv("HYPERPATCH_INSTRUCTION_SET");
  const bool baseline = wanted && std::strcmp(wanted, DeterminantBaseline.Name) == 0;
  if (!baseline && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
  {
    return &DeterminantAVX2;
  }
#endif
  return &DeterminantBaseline;
}

/// Product tables of the kernel, and how many roundings a coefficient sees.
struct Tables
{
  explicit Tables(const std::array<int, 3>& p)
  {
    for (int d = 0; d < 3; ++d)
    {
      this->Shape.Degrees[d] = p[static_cast<std::size_t>(d)];
      std::array<int, 3> q = p;
      --q[static_cast<std::size_t>(d)];
      Append(q, this->Scales[d], [&](double binomials) { return p[d] * binomials; });
      this->Shape.Scales[d] = this->Scales[d].data();
    }
    Append({ 3 * p[0] - 1, 3 * p[1] - 1, 3 * p[2] - 1 }, this->Unscale,
      [](double binomials) { return 1.0 / binomials; });
    this->Shape.Unscale = this->Unscale.data();
    // Binomials are exact up to row 50, above that they round twice per factor. A table entry is a
    // product of three of them and a degree. Each of three factors: difference, scaling, table.
    // Sums: at most all pairs, twice for a minor, thrice for the determinant. Then unscaling.
    const int row = 3 * *std::max_element(p.begin(), p.end()) - 1;
    const double table = 3 + (row > 50 ? 3 * 2 * row : 0);
    const double minor = 2.0 * static_cast<double>(Product({ p[0] + 1, p[1], p[2] })) + 1;
    const double sum = 3.0 * static_cast<double>(Product({ p[0], p[1] + 1, p[2] + 1 })) + 1;
    this->Gamma = hyperpatch::Gamma(3 * (2 + table) + minor + sum + 2 + table);
  }

  template <class Function>
  static void Append(const std::array<int, 3>& q, std::vector<double>& table, const Function& value)
  {
    for (int k = 0; k <= q[2]; ++k)
    {
      for (int j = 0; j <= q[1]; ++j)
      {
        for (int i = 0; i <= q[0]; ++i)
        {
          table.push_back(value(Binomial(q[0], i) * Binomial(q[1], j) * Binomial(q[2], k)));
        }
      }
    }
  }

  DeterminantShape Shape{};
  std::vector<double> Scales[3];
  std::vector<double> Unscale;
  double Gamma = 0.0;
};

/// A tensor-product polynomial in a block of memory.
struct Grid
{
  std::array<int, 3> Size{ 1, 1, 1 };

  [[nodiscard]] std::size_t Count() const { return Product(this->Size); }
  [[nodiscard]] std::size_t Stride(int direction) const
  {
    return static_cast<std::size_t>(direction > 0 ? this->Size[0] : 1) *
      static_cast<std::size_t>(direction > 1 ? this->Size[1] : 1);
  }
  /// Index of a corner; bits 0..2 of `corner` choose the ends.
  [[nodiscard]] std::size_t Corner(int corner) const
  {
    std::size_t index = 0;
    for (int d = 0; d < 3; ++d)
    {
      index += (corner >> d & 1) *
        static_cast<std::size_t>(this->Size[static_cast<std::size_t>(d)] - 1) * this->Stride(d);
    }
    return index;
  }
};

/// Halves by de Casteljau; every step rounds once. `source` becomes the second half.
void Halve(const Grid& grid, int direction, double* source, double* first)
{
  const std::size_t stride = grid.Stride(direction);
  const auto n = static_cast<std::size_t>(grid.Size[static_cast<std::size_t>(direction)]);
  const std::size_t slab = stride * n;
  for (const double* end = source + grid.Count(); source < end; source += slab, first += slab)
  {
    std::copy_n(source, stride, first);
    for (std::size_t r = 1; r < n; ++r)
    {
      for (std::size_t i = 0; i < stride * (n - r); ++i)
      {
        source[i] = 0.5 * (source[i] + source[i + stride]);
      }
      std::copy_n(source, stride, first + r * stride);
    }
  }
}

/// The bound of errors after halving: every intermediate number is a mean of the ones before, and
/// each step rounds once.
double Grown(double error, int steps, double magnitude)
{
  return (error + Gamma(steps) * (error + magnitude)) * Outward;
}

/// The greatest second difference: what the hull of the coefficients is too large by.
double Curvature(const Grid& grid, int direction, const double* c)
{
  const std::size_t stride = grid.Stride(direction);
  const auto n = static_cast<std::size_t>(grid.Size[static_cast<std::size_t>(direction)]);
  double greatest = 0.0;
  for (const double* end = c + grid.Count(); n > 2 && c < end; c += stride * n)
  {
    for (std::size_t i = 0; i < stride * (n - 2); ++i)
    {
      greatest = std::max(greatest, std::abs(c[i] - 2.0 * c[i + stride] + c[i + 2 * stride]));
    }
  }
  // Of Bernstein coefficients of degree n - 1: the distance to the function grows with n.
  return greatest * static_cast<double>(n);
}

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

bool ComesLater(const Box& a, const Box& b)
{
  return a.Priority < b.Priority;
}

unsigned SideBit(int direction, int end)
{
  return 1u << (2 * direction + end);
}

/// The three sides or two that meet in an edge or corner, as bits.
unsigned EdgeSides(int direction, int ends)
{
  const int first = direction == 0 ? 1 : 0;
  const int second = direction == 2 ? 1 : 2;
  return SideBit(first, ends & 1) | SideBit(second, ends >> 1);
}

unsigned CornerSides(int corner)
{
  return SideBit(0, corner & 1) | SideBit(1, corner >> 1 & 1) | SideBit(2, corner >> 2);
}

bool Holds(unsigned all, unsigned part)
{
  return (all & part) == part;
}

}

struct ValidityTest::Implementation
{
  Implementation(std::array<int, 3> degrees, bool rational, const ValidityOptions& options)
    : Degrees(degrees)
    , Rational(rational)
    , Options(options)
    , Points{ { degrees[0] + 1, degrees[1] + 1, degrees[2] + 1 } }
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      this->Determinant.Size[d] = rational ? 4 * degrees[d] + 1 : 3 * degrees[d];
    }
    this->BlockSize = this->Determinant.Count() * (rational ? 2 : 1);
    this->Ratios.resize(rational ? this->Determinant.Count() : 0);
    if (!rational)
    {
      this->Kernels = ChooseKernels();
      this->T = std::make_unique<Tables>(degrees);
      const auto lanes = static_cast<std::size_t>(this->Kernels->Lanes);
      const std::array<int, 3>& p = degrees;
      this->Packed.resize(3 * this->Points.Count() * lanes);
      std::size_t scratch = Product({ 2 * p[0] + 1, 2 * p[1], 2 * p[2] });
      for (std::size_t d = 0; d < 3; ++d)
      {
        std::array<int, 3> size = this->Points.Size;
        --size[d];
        scratch += Product(size);
      }
      this->Scratch.resize(3 * scratch * lanes);
      this->Coefficients.resize(this->Determinant.Count() * lanes);
      this->Summary.resize(11 * lanes);
    }
  }

  //----------------------------------------------------------------------------------------------
  // Whole elements.

  /// The sign by cones alone. Vectors that are zero to rounding leave it to the coefficients, which
  /// tell where the element is degenerate.
  int SignByCones(const Eigen::MatrixXd& points, double pointError) const
  {
    Cone cones[3];
    for (int d = 0; d < 3; ++d)
    {
      cones[d] = DerivativeCone(points, this->Degrees, d, pointError);
      if (cones[d].IsEverything() || cones[d].ZeroVectors() > 0)
      {
        return 0;
      }
    }
    return TripleProductSign(cones[0], cones[1], cones[2]);
  }

  void Decide(ElementValidity& result, int sign, Certificate by) const
  {
    result.Verdict = 1;
    result.Sign = sign;
    result.By = by;
    (sign > 0 ? result.Positive : result.Negative) = { 0.5, 0.5, 0.5 };
  }

  /// det J of up to as many polynomial elements as there are lanes.
  void RunKernel(std::size_t count, const double* const* points)
  {
    const auto lanes = static_cast<std::size_t>(this->Kernels->Lanes);
    const std::size_t n = this->Points.Count();
    for (std::size_t lane = 0; lane < lanes; ++lane)
    {
      // Lanes that are left over repeat the first element.
      const double* from = points[lane < count ? lane : 0];
      for (std::size_t i = 0; i < n; ++i)
      {
        for (std::size_t c = 0; c < 3; ++c)
        {
          this->Packed[(c * n + i) * lanes + lane] = from[3 * i + c];
        }
      }
    }
    double* summary = this->Summary.data();
    this->Kernels->Determinant(this->T->Shape, this->Packed.data(), this->Scratch.data(),
      this->Coefficients.data(), summary, summary + lanes, summary + 2 * lanes);
  }

  /// Bound of the error of the coefficients in a lane: rounding, and what errors of the points add.
  /// Coefficients are means of determinants of derivative coefficients with weights that sum to 1,
  /// so that the permanent of the greatest magnitudes bounds them and their terms.
  [[nodiscard]] double KernelError(std::size_t lane, double pointError) const
  {
    const auto lanes = static_cast<std::size_t>(this->Kernels->Lanes);
    double m[3][3];
    double e[3];
    for (std::size_t d = 0; d < 3; ++d)
    {
      e[d] = 2.0 * this->Degrees[d] * pointError;
      for (std::size_t c = 0; c < 3; ++c)
      {
        m[d][c] = this->Summary[(2 + 3 * d + c) * lanes + lane] * Outward + e[d];
      }
    }
    const auto permanent = [&m](std::size_t a, std::size_t b, const double* x)
    {
      return x[0] * (m[a][1] * m[b][2] + m[a][2] * m[b][1]) +
        x[1] * (m[a][2] * m[b][0] + m[a][0] * m[b][2]) +
        x[2] * (m[a][0] * m[b][1] + m[a][1] * m[b][0]);
    };
    double error = this->T->Gamma * permanent(1, 2, m[0]);
    for (std::size_t d = 0; pointError > 0.0 && d < 3; ++d)
    {
      const double moved[3] = { e[d], e[d], e[d] };
      error += permanent((d + 1) % 3, (d + 2) % 3, moved);
    }
    return error * Outward;
  }

  void Polynomial(
    std::size_t count, const double* points, const double* pointErrors, ElementValidity* results)
  {
    const auto lanes = static_cast<std::size_t>(this->Kernels->Lanes);
    const std::size_t n = this->Points.Count();
    std::array<const double*, MaxLanes> waiting{};
    std::array<std::size_t, MaxLanes> number{};
    std::size_t filled = 0;
    for (std::size_t e = 0; e < count; ++e)
    {
      results[e] = ElementValidity();
      const double error = pointErrors ? pointErrors[e] : 0.0;
      int sign = 0;
      if (this->Options.Tolerance == 0.0)
      {
        this->Element =
          Eigen::Map<const Eigen::MatrixXd>(points + 3 * n * e, 3, static_cast<Eigen::Index>(n));
        sign = this->SignByCones(this->Element, error);
      }
      if (sign != 0)
      {
        this->Decide(results[e], sign, Certificate::Cones);
      }
      else
      {
        waiting[filled] = points + 3 * n * e;
        number[filled++] = e;
      }
      if (filled == lanes || (e + 1 == count && filled > 0))
      {
        this->RunKernel(filled, waiting.data());
        for (std::size_t lane = 0; lane < filled; ++lane)
        {
          const std::size_t i = number[lane];
          const double bound = this->KernelError(lane, pointErrors ? pointErrors[i] : 0.0);
          const double least = this->Summary[lane];
          const double greatest = this->Summary[lanes + lane];
          results[i].Boxes = 1;
          if (this->Options.Tolerance == 0.0 && (least > bound || greatest < -bound))
          {
            this->Decide(results[i], least > 0.0 ? 1 : -1, Certificate::Bernstein);
            continue;
          }
          this->Pool.resize(std::max(this->Pool.size(), this->BlockSize));
          for (std::size_t j = 0; j < this->BlockSize; ++j)
          {
            this->Pool[j] = this->Coefficients[j * lanes + lane];
          }
          this->Subdivide(bound, 0.0, results[i]);
        }
        filled = 0;
      }
    }
  }

  void RationalElement(const double* points, double pointError, ElementValidity& result)
  {
    result = ElementValidity();
    const auto n = static_cast<Eigen::Index>(this->Points.Count());
    this->Element = Eigen::Map<const Eigen::MatrixXd>(points, 4, n);
    if (!(this->Element.row(3).minCoeff() > pointError))
    {
      throw Error("the sign of det J needs positive weights; the least is " +
        std::to_string(this->Element.row(3).minCoeff()));
    }
    if (this->Options.Tolerance == 0.0)
    {
      if (const int sign = this->SignByCones(this->Element, pointError))
      {
        this->Decide(result, sign, Certificate::Cones);
        return;
      }
    }
    const Bernstein w(this->Degrees, this->Element.row(3).transpose(), pointError);
    const Bernstein w2 = w * w;
    const Bernstein w4 = w2 * w2;
    Bernstein j = JacobianDeterminant(this->Element, this->Degrees, true, pointError);
    for (int d = 0; d < 3; ++d)
    {
      j = j.Elevate(d, 4 * this->Degrees[static_cast<std::size_t>(d)]);
    }
    this->Pool.resize(std::max(this->Pool.size(), this->BlockSize));
    std::copy(w4.Coefficients().begin(), w4.Coefficients().end(),
      std::copy(j.Coefficients().begin(), j.Coefficients().end(), this->Pool.begin()));
    result.Boxes = 1;
    this->Subdivide(j.RoundingBound(), w4.RoundingBound(), result);
  }

  //----------------------------------------------------------------------------------------------
  // Boxes.

  double* Values(const Box& box) { return this->Pool.data() + box.Block * this->BlockSize; }
  double* Weights(const Box& box) { return this->Values(box) + this->Determinant.Count(); }

  std::size_t NewBlock()
  {
    if (!this->Free.empty())
    {
      const std::size_t block = this->Free.back();
      this->Free.pop_back();
      return block;
    }
    const std::size_t block = this->Blocks++;
    this->Pool.resize(std::max(this->Pool.size(), this->Blocks * this->BlockSize));
    return block;
  }

  /// Bounds of the quotient of a coefficient of W^4 J and one of W^4.
  [[nodiscard]] static Interval Quotient(const Box& box, double value, double weight)
  {
    if (!(weight > box.WeightError))
    {
      return { -INFINITY, INFINITY };
    }
    const double low = value - box.Error;
    const double high = value + box.Error;
    const double least = (weight - box.WeightError) * (1.0 - 2 * U);
    const double greatest = (weight + box.WeightError) * (1.0 + 2 * U);
    const double a = low / (low < 0.0 ? least : greatest);
    const double b = high / (high < 0.0 ? greatest : least);
    return { a - 4 * U * std::abs(a), b + 4 * U * std::abs(b) };
  }

  /// det J at a corner of a box, or bounds of what coefficient i contributes to it: the values of
  /// W^4 J / W^4 are means of the quotients of coefficients, because those of W^4 are positive.
  [[nodiscard]] Interval Contribution(const Box& box, std::size_t i)
  {
    const double value = this->Values(box)[i];
    return this->Rational ? Quotient(box, value, this->Weights(box)[i])
                          : Interval{ value - box.Error, value + box.Error };
  }

  /// Layers of coefficients next to the side of the element that are 0 to rounding.
  int ZeroLayers(const Box& root, int direction, int end)
  {
    const int size = this->Determinant.Size[static_cast<std::size_t>(direction)];
    const std::size_t stride = this->Determinant.Stride(direction);
    const double* c = this->Values(root);
    int layers = size;
    for (std::size_t i = 0; i < this->Determinant.Count(); ++i)
    {
      if (!(std::abs(c[i]) <= root.Error))
      {
        const int layer = static_cast<int>(i / stride % static_cast<std::size_t>(size));
        layers = std::min(layers, end == 0 ? layer : size - 1 - layer);
      }
    }
    return layers;
  }

  /// Finds the faces, edges and corners where det J is 0 to rounding.
  std::uint32_t FindDegenerate(const Box& root)
  {
    std::uint32_t bits = 0;
    this->Excused.clear();
    this->Layers.fill(0);
    const double* corners = this->Values(root);
    bool any = false;
    for (int corner = 0; corner < 8; ++corner)
    {
      any = any || std::abs(corners[this->Determinant.Corner(corner)]) <= root.Error;
    }
    if (!any)
    {
      return bits;
    }
    unsigned faces = 0;
    for (int side = 0; side < 6; ++side)
    {
      this->Layers[static_cast<std::size_t>(side)] = this->ZeroLayers(root, side / 2, side % 2);
      if (this->Layers[static_cast<std::size_t>(side)] > 0)
      {
        faces |= 1u << side;
        bits |= 1u << side;
      }
    }
    const auto isZeroWhere = [&](unsigned sides)
    {
      const double* c = this->Values(root);
      for (std::size_t i = 0; i < this->Determinant.Count(); ++i)
      {
        if (Holds(this->SidesOf(i), sides) && !(std::abs(c[i]) <= root.Error))
        {
          return false;
        }
      }
      return true;
    };
    for (int edge = 0; edge < 12; ++edge)
    {
      const unsigned sides = EdgeSides(edge / 4, edge % 4);
      if (!(sides & faces) && isZeroWhere(sides))
      {
        bits |= 1u << (6 + edge);
        this->Excused.push_back(sides);
      }
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      const unsigned sides = CornerSides(corner);
      const bool isKnown = (sides & faces) ||
        std::any_of(this->Excused.begin(), this->Excused.end(),
          [sides](unsigned part) { return Holds(sides, part); });
      if (!isKnown && std::abs(this->Values(root)[this->Determinant.Corner(corner)]) <= root.Error)
      {
        bits |= 1u << (18 + corner);
        this->Excused.push_back(sides);
      }
    }
    return bits;
  }

  /// The sides of its box that a coefficient belongs to.
  [[nodiscard]] unsigned SidesOf(std::size_t i) const
  {
    unsigned sides = 0;
    for (int d = 0; d < 3; ++d)
    {
      const auto size =
        static_cast<std::size_t>(this->Determinant.Size[static_cast<std::size_t>(d)]);
      const std::size_t index = i / this->Determinant.Stride(d) % size;
      sides |= (index == 0 ? SideBit(d, 0) : 0u) | (index + 1 == size ? SideBit(d, 1) : 0u);
    }
    return sides;
  }

  /// Whether a coefficient that is 0 to rounding belongs to a degenerate face, edge or corner.
  [[nodiscard]] bool IsExcused(const Box& box, std::size_t i) const
  {
    for (int side = 0; side < 6; ++side)
    {
      const int layers = this->Layers[static_cast<std::size_t>(side)];
      if (layers > 0 && (box.Sides >> side & 1))
      {
        const int d = side / 2;
        const int size = this->Determinant.Size[static_cast<std::size_t>(d)];
        const int layer =
          static_cast<int>(i / this->Determinant.Stride(d) % static_cast<std::size_t>(size));
        if ((side % 2 == 0 ? layer : size - 1 - layer) < layers)
        {
          return true;
        }
      }
    }
    const unsigned sides = this->SidesOf(i) & box.Sides;
    return std::any_of(this->Excused.begin(), this->Excused.end(),
      [sides](unsigned part) { return Holds(sides, part); });
  }

  /// Range and sign of a box, and what its corners show.
  void Examine(Box& box, ElementValidity& result)
  {
    const double* c = this->Values(box);
    const std::size_t n = this->Determinant.Count();
    double least = c[0];
    double greatest = c[0];
    for (std::size_t i = 1; i < n; ++i)
    {
      least = std::min(least, c[i]);
      greatest = std::max(greatest, c[i]);
    }
    box.Magnitude = std::max(std::abs(least), std::abs(greatest));
    box.Range = { least - box.Error, greatest + box.Error };
    if (this->Rational)
    {
      const double* w = this->Weights(box);
      box.WeightMagnitude = *std::max_element(w, w + n);
      box.Range = { INFINITY, -INFINITY };
      for (std::size_t i = 0; i < n; ++i)
      {
        const Interval q = this->Contribution(box, i);
        box.Range = { std::min(box.Range.Low, q.Low), std::max(box.Range.High, q.High) };
      }
    }
    box.Sign = least > box.Error ? 1 : greatest < -box.Error ? -1 : 0;
    if (box.Sign == 0 && result.Degenerate != 0 && (least >= -box.Error || greatest <= box.Error) &&
      (greatest > box.Error || least < -box.Error))
    {
      // One sign, but for some that are 0 to rounding.
      box.Sign = greatest > box.Error ? 1 : -1;
      for (std::size_t i = 0; i < n && box.Sign != 0; ++i)
      {
        if (std::abs(c[i]) <= box.Error && !this->IsExcused(box, i))
        {
          box.Sign = 0;
        }
      }
    }
    const auto witness = [&result](int sign) -> std::optional<std::array<double, 3>>&
    { return sign > 0 ? result.Positive : result.Negative; };
    if (box.Sign != 0 && !witness(box.Sign))
    {
      witness(box.Sign) = std::array<double, 3>{ box.Low[0] + 0.5 * box.Size[0],
        box.Low[1] + 0.5 * box.Size[1], box.Low[2] + 0.5 * box.Size[2] };
    }
    for (int corner = 0; corner < 8; ++corner)
    {
      const double value = c[this->Determinant.Corner(corner)];
      const Interval j = this->Contribution(box, this->Determinant.Corner(corner));
      this->LeastSample = std::min(this->LeastSample, j.High);
      this->GreatestSample = std::max(this->GreatestSample, j.Low);
      const int sign = value > box.Error ? 1 : value < -box.Error ? -1 : 0;
      if (sign != 0 && !witness(sign))
      {
        witness(sign) = std::array<double, 3>{ box.Low[0] + (corner & 1) * box.Size[0],
          box.Low[1] + (corner >> 1 & 1) * box.Size[1], box.Low[2] + (corner >> 2) * box.Size[2] };
      }
    }
  }

  /// Whether halving the box could tell more that was asked for.
  [[nodiscard]] bool IsOpen(const Box& box, const ElementValidity& result) const
  {
    if (box.Sign == 0 && !(result.Positive && result.Negative))
    {
      return true;
    }
    if (this->Options.Tolerance == 0.0)
    {
      return false;
    }
    const double tolerance =
      this->Options.Tolerance * std::max(this->GreatestSample, -this->LeastSample);
    return !(box.Range.Low >= this->LeastSample - tolerance &&
      box.Range.High <= this->GreatestSample + tolerance);
  }

  /// Halves across the direction in which the coefficients bend most.
  std::array<Box, 2> HalvesOf(const Box& box)
  {
    const double* values = this->Values(box);
    if (this->Rational)
    {
      std::transform(values, values + this->Ratios.size(), this->Weights(box), this->Ratios.begin(),
        [](double value, double weight) { return value / weight; });
      values = this->Ratios.data();
    }
    int direction = 0;
    double most = -1.0;
    for (int d = 0; d < 3; ++d)
    {
      double bend = Curvature(this->Determinant, d, values);
      // A linear function that changes its sign is cut as well.
      bend += 1e-3 * box.Size[static_cast<std::size_t>(d)] *
        std::max(std::abs(box.Range.Low), std::abs(box.Range.High));
      if (bend > most)
      {
        most = bend;
        direction = d;
      }
    }
    std::array<Box, 2> halves{ box, box };
    halves[0].Block = this->NewBlock();
    const auto d = static_cast<std::size_t>(direction);
    Halve(this->Determinant, direction, this->Values(box), this->Values(halves[0]));
    if (this->Rational)
    {
      Halve(this->Determinant, direction, this->Weights(box), this->Weights(halves[0]));
    }
    const double error = Grown(box.Error, this->Determinant.Size[d] - 1, box.Magnitude);
    const double weightError =
      Grown(box.WeightError, this->Determinant.Size[d] - 1, box.WeightMagnitude);
    for (int end = 0; end < 2; ++end)
    {
      Box& half = halves[static_cast<std::size_t>(end)];
      half.Size[d] *= 0.5;
      half.Low[d] += end * half.Size[d];
      half.Sides &= ~SideBit(direction, 1 - end);
      half.Error = error;
      half.WeightError = weightError;
      ++half.Depth;
    }
    return halves;
  }

  /// det J (times W^4) of the element at a point, from its coefficients.
  [[nodiscard]] double ValueAt(const std::array<double, 3>& point) const
  {
    double basis[3][Bernstein::DegreeLimit + 1];
    for (std::size_t d = 0; d < 3; ++d)
    {
      double* b = basis[d];
      b[0] = 1.0;
      for (int r = 1; r < this->Determinant.Size[d]; ++r)
      {
        double saved = 0.0;
        for (int i = 0; i < r; ++i)
        {
          const double value = b[i];
          b[i] = saved + (1.0 - point[d]) * value;
          saved = point[d] * value;
        }
        b[r] = saved;
      }
    }
    const double* c = this->Root.data();
    double sum = 0.0;
    for (int k = 0; k < this->Determinant.Size[2]; ++k)
    {
      for (int j = 0; j < this->Determinant.Size[1]; ++j)
      {
        double row = 0.0;
        for (int i = 0; i < this->Determinant.Size[0]; ++i)
        {
          row += basis[0][i] * *c++;
        }
        sum += basis[2][k] * basis[1][j] * row;
      }
    }
    return sum;
  }

  /// A point of the open element, near one of its border at which det J is known to have a sign,
  /// where it has it too.
  [[nodiscard]] std::array<double, 3> Interior(
    const std::array<double, 3>& point, int sign, double error) const
  {
    if (std::all_of(point.begin(), point.end(), [](double t) { return 0.0 < t && t < 1.0; }))
    {
      return point;
    }
    double magnitude = 0.0;
    for (const double c : this->Root)
    {
      magnitude = std::max(magnitude, std::abs(c));
    }
    // Three roundings per step of the recurrences, then products and sums.
    const std::array<int, 3>& n = this->Determinant.Size;
    const double bound =
      (error + Gamma(4 * (n[0] + n[1] + n[2]) + 4) * (magnitude + error)) * Outward;
    for (double part = 0.25; part > U; part *= 0.25)
    {
      std::array<double, 3> inside;
      for (std::size_t d = 0; d < 3; ++d)
      {
        inside[d] = point[d] + part * (0.5 - point[d]);
      }
      if (sign * this->ValueAt(inside) > bound)
      {
        return inside;
      }
    }
    return point;
  }

  /// Subdivides det J of an element, whose coefficients are in block 0 of the pool.
  void Subdivide(double error, double weightError, ElementValidity& result)
  {
    Box root{ 0, { 0, 0, 0 }, { 1, 1, 1 }, error, weightError, 0, 0, 0x3f, 0, { 0, 0 }, 0, 0 };
    this->Root.assign(this->Pool.begin(),
      this->Pool.begin() + static_cast<std::ptrdiff_t>(this->Determinant.Count()));
    this->Blocks = 1;
    this->Free.clear();
    this->Heap.clear();
    this->LeastSample = INFINITY;
    this->GreatestSample = -INFINITY;
    result.Degenerate = this->FindDegenerate(root);
    this->Examine(root, result);

    Interval closed{ INFINITY, -INFINITY };
    int sign = 2; // of all closed boxes; 2: none yet
    const auto close = [&](const Box& box)
    {
      closed = { std::min(closed.Low, box.Range.Low), std::max(closed.High, box.Range.High) };
      sign = sign == 2 || sign == box.Sign ? box.Sign : 0;
      result.Depth = std::max(result.Depth, box.Depth);
      this->Free.push_back(box.Block);
    };
    const auto add = [&](Box& box)
    {
      box.Priority = box.Range.High - box.Range.Low;
      this->Heap.push_back(box);
      std::push_heap(this->Heap.begin(), this->Heap.end(), ComesLater);
    };
    // Zero all over to rounding: halving it tells nothing.
    if (this->Layers[0] == this->Determinant.Size[0])
    {
      close(root);
    }
    else
    {
      add(root);
    }
    while (!this->Heap.empty())
    {
      std::pop_heap(this->Heap.begin(), this->Heap.end(), ComesLater);
      const Box box = this->Heap.back();
      this->Heap.pop_back();
      if (!this->IsOpen(box, result) || box.Depth >= this->Options.MaxDepth ||
        result.Boxes + 2 > this->Options.MaxBoxes)
      {
        close(box);
        continue;
      }
      for (Box& half : this->HalvesOf(box))
      {
        ++result.Boxes;
        this->Examine(half, result);
        add(half);
      }
    }
    if (result.Positive && result.Negative)
    {
      result.Verdict = -1;
      result.By = Certificate::Bernstein;
      result.Positive = this->Interior(*result.Positive, 1, error);
      result.Negative = this->Interior(*result.Negative, -1, error);
    }
    else if (sign == 1 || sign == -1)
    {
      this->Decide(result, sign, Certificate::Bernstein);
    }
    if (this->Options.Tolerance > 0.0)
    {
      result.Minimum = Interval{ closed.Low, this->LeastSample };
      result.Maximum = Interval{ this->GreatestSample, closed.High };
    }
  }

  std::array<int, 3> Degrees;
  bool Rational;
  ValidityOptions Options;
  Grid Points;
  Grid Determinant;
  std::size_t BlockSize = 0;
  const DeterminantKernels* Kernels = nullptr;
  std::unique_ptr<Tables> T;

  // Scratch of whole elements.
  Eigen::MatrixXd Element;
  std::vector<double> Packed;
  std::vector<double> Scratch;
  std::vector<double> Coefficients;
  std::vector<double> Summary;

  // Scratch of the subdivision of one element.
  std::vector<double> Pool;
  std::vector<double> Root;
  std::vector<double> Ratios;
  std::vector<std::size_t> Free;
  std::size_t Blocks = 0;
  std::vector<Box> Heap;
  std::array<int, 6> Layers{};
  std::vector<unsigned> Excused;
  double LeastSample = 0.0;
  double GreatestSample = 0.0;
};

ValidityTest::ValidityTest(
  std::array<int, 3> degrees, bool rational, const ValidityOptions& options)
{
  for (int p : degrees)
  {
    if (p < 1 || p > MaxDegree)
    {
      throw Error("det J needs degrees from 1 to " + std::to_string(MaxDegree) + ", not " +
        std::to_string(p));
    }
  }
  if (!(options.Tolerance >= 0.0 && options.Tolerance <= 1.0))
  {
    throw Error("the tolerance of validity bounds is a fraction from 0 to 1, not " +
      std::to_string(options.Tolerance));
  }
  if (!(options.ScaledTolerance >= 0.0))
  {
    throw Error("the tolerance of the scaled Jacobian is not negative, and 0 to leave it out");
  }
  if (options.MaxDepth < 0 || options.MaxBoxes < 1)
  {
    throw Error("a validity test needs a depth of at least 0 and at least 1 box");
  }
  this->I = std::make_unique<Implementation>(degrees, rational, options);
}

ValidityTest::~ValidityTest() = default;
ValidityTest::ValidityTest(ValidityTest&&) noexcept = default;
ValidityTest& ValidityTest::operator=(ValidityTest&&) noexcept = default;

void ValidityTest::operator()(
  std::size_t count, const double* points, const double* pointErrors, ElementValidity* results)
{
  if (!this->I->Rational)
  {
    this->I->Polynomial(count, points, pointErrors, results);
    return;
  }
  for (std::size_t e = 0; e < count; ++e)
  {
    this->I->RationalElement(
      points + 4 * this->I->Points.Count() * e, pointErrors ? pointErrors[e] : 0.0, results[e]);
  }
}

//------------------------------------------------------------------------------------------------
namespace
{

/// From the unit cube to the patch's knots.
void Rescale(
  ElementValidity& element, const std::array<double, 3>& low, const std::array<double, 3>& size)
{
  const double volume = size[0] * size[1] * size[2];
  // Lengths and their product round four times, the division once.
  const auto outward = [volume](std::optional<Interval>& interval)
  {
    if (interval)
    {
      const double a = interval->Low / volume;
      const double b = interval->High / volume;
      *interval = { a - 8 * U * std::abs(a), b + 8 * U * std::abs(b) };
    }
  };
  outward(element.Minimum);
  outward(element.Maximum);
  for (auto* point : { &element.Positive, &element.Negative })
  {
    for (std::size_t d = 0; *point && d < 3; ++d)
    {
      (**point)[d] = low[d] + (**point)[d] * size[d];
    }
  }
}

}

PatchValidity TestValidity(const Spline& geometry, const ValidityOptions& options,
  const ParallelFor& parallelFor, int handedness)
{
  if (geometry.Components() != 3 || geometry.Dimension() != 3)
  {
    throw Error("the Jacobian determinant needs a volume with three coordinates");
  }
  const std::array<int, 3> p = geometry.Degrees();
  std::array<std::vector<double>, 3> breaks;
  std::array<int, 3> spans;
  int operations = 6;
  for (std::size_t d = 0; d < 3; ++d)
  {
    breaks[d] = geometry.Knots()[d].Breaks();
    spans[d] = static_cast<int>(breaks[d].size()) - 1;
    operations += 6 * p[d];
  }
  // Blossom weights in a span are sums of positive terms of degree factors with five roundings
  // each; they sum to 1 (Higham 2002, section 3.1).
  const double extraction = 2 * U * operations;
  // Refuses bad options before the work is divided.
  static_cast<void>(ValidityTest(p, geometry.IsRational(), options));

  PatchValidity result;
  result.Elements.resize(Product(spans));
  constexpr std::ptrdiff_t Chunk = 64;
  parallelFor(static_cast<std::ptrdiff_t>(result.Elements.size()), Chunk,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      ValidityTest test(p, geometry.IsRational(), options);
      const BezierExtractor extractor(geometry);
      const std::array<int, 3> sizes = geometry.Sizes();
      Eigen::MatrixXd element;
      std::vector<double> points;
      std::vector<double> errors;
      for (std::ptrdiff_t first = begin; first < end; first += Chunk)
      {
        const std::ptrdiff_t last = std::min(end, first + Chunk);
        points.clear();
        errors.clear();
        const auto spansOf = [&spans](std::ptrdiff_t e)
        {
          return std::array<int, 3>{ static_cast<int>(e % spans[0]),
            static_cast<int>(e / spans[0] % spans[1]), static_cast<int>(e / spans[0] / spans[1]) };
        };
        for (std::ptrdiff_t e = first; e < last; ++e)
        {
          const std::array<int, 3> at = spansOf(e);
          extractor.Extract(at, element);
          points.insert(points.end(), element.data(), element.data() + element.size());
          // The greatest number among the control points that reach the element.
          std::array<int, 3> low;
          for (std::size_t d = 0; d < 3; ++d)
          {
            low[d] = geometry.Knots()[d].Spans()[static_cast<std::size_t>(at[d])] - p[d];
          }
          double largest = 0.0;
          for (int k = low[2]; k <= low[2] + p[2]; ++k)
          {
            for (int j = low[1]; j <= low[1] + p[1]; ++j)
            {
              const Eigen::Index row =
                low[0] + sizes[0] * (j + static_cast<Eigen::Index>(sizes[1]) * k);
              for (Eigen::Index i = row; i <= row + p[0]; ++i)
              {
                const double m = geometry.Coefficients().col(i).lpNorm<Eigen::Infinity>();
                largest = std::max(
                  largest, geometry.IsRational() ? geometry.Weights()[i] * std::max(1.0, m) : m);
              }
            }
          }
          errors.push_back(extraction * largest);
        }
        ElementValidity* results = result.Elements.data() + first;
        test(errors.size(), points.data(), errors.data(), results);
        for (std::ptrdiff_t e = first; e < last; ++e)
        {
          const std::array<int, 3> at = spansOf(e);
          std::array<double, 3> low;
          std::array<double, 3> size;
          for (std::size_t d = 0; d < 3; ++d)
          {
            const auto i = static_cast<std::size_t>(at[d]);
            low[d] = breaks[d][i];
            size[d] = breaks[d][i + 1] - breaks[d][i];
          }
          Rescale(results[e - first], low, size);
          if (options.ScaledTolerance > 0.0)
          {
            const auto i = static_cast<std::size_t>(e - first);
            const Eigen::Map<const Eigen::MatrixXd> bezier(
              points.data() + i * static_cast<std::size_t>(element.size()), element.rows(),
              element.cols());
            results[i].Scaled =
              BoundScaledJacobian(bezier, p, options.ScaledTolerance, options.MaxBoxes, errors[i]);
          }
        }
      }
    });

  result.Handedness = handedness != 0 ? handedness : Handedness(geometry);
  for (const ElementValidity& element : result.Elements)
  {
    // Only where left-handed and right-handed volumes cancel.
    result.Handedness = result.Handedness != 0 ? result.Handedness : element.Sign;
  }
  for (ElementValidity& element : result.Elements)
  {
    if (element.Verdict == 1 && element.Sign != result.Handedness)
    {
      element.Verdict = -1;
    }
  }
  return result;
}

}
