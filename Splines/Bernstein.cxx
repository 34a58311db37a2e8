// SPDX-License-Identifier: BSD-3-Clause
#include "Bernstein.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

constexpr int Limit = Bernstein::DegreeLimit;
constexpr double UnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

/// Covers the rounding of the bounds' own arithmetic, a handful of operations each.
constexpr double Outward = 1.0 + 16 * UnitRoundoff;

double Gamma(double operations)
{
  return operations * UnitRoundoff / (1.0 - operations * UnitRoundoff);
}

double Magnitude(const Eigen::VectorXd& v)
{
  return v.lpNorm<Eigen::Infinity>();
}

/// Row n of Pascal's triangle.
const double* Binomials(int n)
{
  using Triangle = std::array<std::array<double, Limit + 1>, Limit + 1>;
  static const Triangle triangle = []
  {
    Triangle t{};
    for (std::size_t i = 0; i < t.size(); ++i)
    {
      t[i][0] = 1.0;
      for (std::size_t j = 1; j <= i; ++j)
      {
        t[i][j] = t[i - 1][j - 1] + t[i - 1][j];
      }
    }
    return t;
  }();
  return triangle[static_cast<std::size_t>(n)].data();
}

/// Rounding errors in a binomial of row n: none up to row 56, where they are below 2^53.
int BinomialRoundings(int n)
{
  return n <= 56 ? 0 : n;
}

Eigen::Index Count(const std::array<int, 3>& degrees)
{
  return (degrees[0] + 1) * static_cast<Eigen::Index>(degrees[1] + 1) * (degrees[2] + 1);
}

/// The distance in memory between neighbours in a direction.
Eigen::Index Stride(const std::array<int, 3>& degrees, int direction)
{
  return (direction > 0 ? degrees[0] + 1 : 1) *
    static_cast<Eigen::Index>(direction > 1 ? degrees[1] + 1 : 1);
}

/// The degree in `direction` replaced.
std::array<int, 3> With(std::array<int, 3> degrees, int direction, int degree)
{
  degrees[static_cast<std::size_t>(direction)] = degree;
  return degrees;
}

int DegreeOf(const Bernstein& f, int direction)
{
  return f.Degrees()[static_cast<std::size_t>(direction)];
}

/// Calls body(scale, row, n) for each row of n = degrees[0] + 1 coefficients, where `scale` is the
/// product of the binomials of v and w.
template <typename Body>
void ForEachRow(const std::array<int, 3>& degrees, double* values, const Body& body)
{
  const int n = degrees[0] + 1;
  const double* v = Binomials(degrees[1]);
  const double* w = Binomials(degrees[2]);
  for (int k = 0; k <= degrees[2]; ++k)
  {
    for (int j = 0; j <= degrees[1]; ++j, values += n)
    {
      body(v[j] * w[k], values, n);
    }
  }
}

Eigen::VectorXd Scaled(const Bernstein& f)
{
  Eigen::VectorXd c = f.Coefficients();
  const double* u = Binomials(f.Degrees()[0]);
  ForEachRow(f.Degrees(), c.data(),
    [u](double scale, double* row, int n)
    {
      for (int i = 0; i < n; ++i)
      {
        row[i] *= scale * u[i];
      }
    });
  return c;
}

void Unscale(const std::array<int, 3>& degrees, Eigen::VectorXd& c)
{
  const double* u = Binomials(degrees[0]);
  ForEachRow(degrees, c.data(),
    [u](double scale, double* row, int n)
    {
      for (int i = 0; i < n; ++i)
      {
        row[i] /= scale * u[i];
      }
    });
}

/// The same polynomial with one degree less in a direction, for one that is known to have it.
///
/// In scaled coefficients elevation is a convolution with (1, 1), so that reduction is an
/// alternating sum. Started from both ends it amplifies errors by at most about sqrt(pi n / 2).
Bernstein Reduce(const Bernstein& f, int direction)
{
  const int n = DegreeOf(f, direction);
  const std::array<int, 3> degrees = With(f.Degrees(), direction, n - 1);
  const Eigen::Index stride = Stride(degrees, direction);
  const double* from = Binomials(n);
  const double* to = Binomials(n - 1);
  const int half = n / 2;
  Eigen::VectorXd c(Count(degrees));
  for (Eigen::Index line = 0; line < c.size() / n; ++line)
  {
    const Eigen::Index slab = line / stride * stride;
    const double* source = f.Coefficients().data() + slab * (n + 1) + line % stride;
    double* target = c.data() + slab * n + line % stride;
    double sum = 0.0;
    for (int k = 0; k < half; ++k)
    {
      sum = from[k] * source[k * stride] - sum;
      target[k * stride] = sum / to[k];
    }
    sum = 0.0;
    for (int k = n - 1; k >= half; --k)
    {
      sum = from[k + 1] * source[(k + 1) * stride] - sum;
      target[k * stride] = sum / to[k];
    }
  }
  // The longer of the two sums amplifies most: sum of C(n, j), j <= k, over C(n - 1, k).
  const int last = n - 1 - half;
  double amplification = 0.0;
  for (int j = 0; j <= last; ++j)
  {
    amplification += from[j];
  }
  amplification /= to[last];
  const int roundings = n + 3 + 2 * BinomialRoundings(n);
  const double bound =
    amplification * (f.RoundingBound() + Gamma(roundings) * Magnitude(f.Coefficients())) * Outward;
  return Bernstein(degrees, std::move(c), bound);
}

/// The two halves of a de Casteljau step in w, X = (1 - w) First + w Last, of one degree less.
Bernstein Part(const Bernstein& f, int offset)
{
  const std::array<int, 3>& d = f.Degrees();
  const Eigen::Index slab = Stride(d, 2);
  return Bernstein({ d[0], d[1], d[2] - 1 }, f.Coefficients().segment(offset * slab, d[2] * slab),
    f.RoundingBound());
}

}

Bernstein::Bernstein()
  : D{ 0, 0, 0 }
  , C(Eigen::VectorXd::Zero(1))
{
}

Bernstein::Bernstein(std::array<int, 3> degrees, Eigen::VectorXd coefficients, double roundingBound)
  : D(degrees)
  , C(std::move(coefficients))
  , E(roundingBound)
{
  for (int degree : degrees)
  {
    if (degree < 0 || degree > Limit)
    {
      throw Error(
        "Bernstein degree " + std::to_string(degree) + " is not in 0.." + std::to_string(Limit));
    }
  }
  if (this->C.size() != Count(degrees))
  {
    throw Error(std::to_string(this->C.size()) + " coefficients for degrees " +
      std::to_string(degrees[0]) + ", " + std::to_string(degrees[1]) + ", " +
      std::to_string(degrees[2]) + ", which have " + std::to_string(Count(degrees)));
  }
}

double Bernstein::operator()(double u, double v, double w) const
{
  const double parameters[3] = { u, v, w };
  double basis[3][Limit + 1];
  for (std::size_t d = 0; d < 3; ++d)
  {
    const double t = parameters[d];
    double* b = basis[d];
    b[0] = 1.0;
    for (int r = 1; r <= this->D[d]; ++r)
    {
      double saved = 0.0;
      for (int j = 0; j < r; ++j)
      {
        const double value = b[j];
        b[j] = saved + (1.0 - t) * value;
        saved = t * value;
      }
      b[r] = saved;
    }
  }
  const double* row = this->C.data();
  double sum = 0.0;
  for (int k = 0; k <= this->D[2]; ++k)
  {
    for (int j = 0; j <= this->D[1]; ++j)
    {
      double line = 0.0;
      for (int i = 0; i <= this->D[0]; ++i)
      {
        line += basis[0][i] * row[i];
      }
      sum += basis[2][k] * basis[1][j] * line;
      row += this->D[0] + 1;
    }
  }
  return sum;
}

Bernstein Bernstein::Derivative(int direction) const
{
  const int p = DegreeOf(*this, direction);
  if (p == 0)
  {
    return Bernstein(this->D, Eigen::VectorXd::Zero(this->C.size()));
  }
  const std::array<int, 3> degrees = With(this->D, direction, p - 1);
  const Eigen::Index stride = Stride(this->D, direction);
  const Eigen::Index slabs = this->C.size() / (stride * (p + 1));
  Eigen::VectorXd c(slabs * stride * p);
  for (Eigen::Index s = 0; s < slabs; ++s)
  {
    const auto source = this->C.segment(s * stride * (p + 1), stride * (p + 1));
    c.segment(s * stride * p, stride * p) = p * (source.tail(stride * p) - source.head(stride * p));
  }
  const double bound = (2.0 * p * this->E + Gamma(3) * Magnitude(c)) * Outward;
  return Bernstein(degrees, std::move(c), bound);
}

Bernstein Bernstein::Elevate(int direction, int to) const
{
  const int p = DegreeOf(*this, direction);
  if (to < p)
  {
    throw Error("degree " + std::to_string(p) + " cannot be elevated to " + std::to_string(to));
  }
  if (to == p)
  {
    return *this;
  }
  return *this * Bernstein(With({ 0, 0, 0 }, direction, to - p), Eigen::VectorXd::Ones(to - p + 1));
}

std::array<Bernstein, 2> Bernstein::Split(int direction, double t) const
{
  if (!(0.0 <= t && t <= 1.0))
  {
    throw Error("a polynomial is split at a parameter in [0, 1], not " + std::to_string(t));
  }
  const int p = DegreeOf(*this, direction);
  const Eigen::Index stride = Stride(this->D, direction);
  const Eigen::Index slab = stride * (p + 1);
  const double bound = (this->E + (this->E + Magnitude(this->C)) * Gamma(3.0 * p)) * Outward;
  std::array<Bernstein, 2> parts{ Bernstein(this->D, this->C, bound),
    Bernstein(this->D, this->C, bound) };
  for (Eigen::Index s = 0; s < this->C.size(); s += slab)
  {
    // Works in place in the second part; each step leaves one coefficient of the first behind.
    double* left = parts[0].C.data() + s;
    double* right = parts[1].C.data() + s;
    for (int r = 1; r <= p; ++r)
    {
      for (Eigen::Index i = 0; i < stride * (p + 1 - r); ++i)
      {
        right[i] = (1.0 - t) * right[i] + t * right[i + stride];
      }
      std::copy(right, right + stride, left + r * stride);
    }
  }
  return parts;
}

Bernstein Bernstein::Sum(const Bernstein& a, const Bernstein& b, double sign)
{
  for (int d = 0; d < 3; ++d)
  {
    const int p = DegreeOf(a, d);
    const int q = DegreeOf(b, d);
    if (p != q)
    {
      return p < q ? Sum(a.Elevate(d, q), b, sign) : Sum(a, b.Elevate(d, p), sign);
    }
  }
  Eigen::VectorXd c = a.C + sign * b.C;
  const double bound = (a.E + b.E + Gamma(1) * Magnitude(c)) * Outward;
  return Bernstein(a.D, std::move(c), bound);
}

Bernstein operator*(double factor, const Bernstein& a)
{
  Eigen::VectorXd c = factor * a.C;
  const double bound = (std::abs(factor) * a.E + Gamma(1) * Magnitude(c)) * Outward;
  return Bernstein(a.D, std::move(c), bound);
}

Bernstein operator*(const Bernstein& a, const Bernstein& b)
{
  // The runs below are those of the longer rows.
  if (a.D[0] > b.D[0])
  {
    return b * a;
  }
  std::array<int, 3> degrees;
  // Three factors and two binomial products per scaling, three of them, and the product itself.
  double roundings = 10.0;
  double summands = 1.0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    degrees[d] = a.D[d] + b.D[d];
    if (degrees[d] > Limit)
    {
      throw Error("the product has degree " + std::to_string(degrees[d]) + "; the limit is " +
        std::to_string(Limit));
    }
    roundings +=
      BinomialRoundings(a.D[d]) + BinomialRoundings(b.D[d]) + BinomialRoundings(degrees[d]);
    summands *= std::min(a.D[d], b.D[d]) + 1;
  }
  const Eigen::VectorXd scaledA = Scaled(a);
  // The rows of b at the distance of those of the product: then a plane of b, multiplied by a
  // coefficient of a, is added in one run.
  const Eigen::Index row = degrees[0] + 1;
  const Eigen::Index run = row * b.D[1] + b.D[0] + 1;
  Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(row * (b.D[1] + 1), b.D[2] + 1);
  spread.reshaped(row, (b.D[1] + 1) * (b.D[2] + 1)).topRows(b.D[0] + 1) =
    Scaled(b).reshaped(b.D[0] + 1, (b.D[1] + 1) * (b.D[2] + 1));
  Eigen::VectorXd c = Eigen::VectorXd::Zero(Count(degrees));
  const double* factor = scaledA.data();
  for (int k = 0; k <= a.D[2]; ++k)
  {
    for (int j = 0; j <= a.D[1]; ++j)
    {
      for (int i = 0; i <= a.D[0]; ++i, ++factor)
      {
        for (int l = 0; l <= b.D[2]; ++l)
        {
          c.segment(i + row * (j + (k + l) * (degrees[1] + 1)), run) +=
            *factor * Eigen::Map<const Eigen::VectorXd>(spread.col(l).data(), run);
        }
      }
    }
  }
  Unscale(degrees, c);
  const double magnitudeA = Magnitude(a.C);
  const double magnitudeB = Magnitude(b.C);
  const double bound = (magnitudeA * b.E + magnitudeB * a.E + a.E * b.E +
                         Gamma(summands + roundings) * magnitudeA * magnitudeB) *
    Outward;
  return Bernstein(degrees, std::move(c), bound);
}

Bernstein JacobianDeterminant(const Eigen::MatrixXd& homogeneousBezierPoints,
  std::array<int, 3> degrees, bool rational, double pointError)
{
  const Eigen::MatrixXd& h = homogeneousBezierPoints;
  const Eigen::Index rows = rational ? 4 : 3;
  if (h.rows() != rows)
  {
    throw Error("the Jacobian determinant of a " +
      std::string(rational ? "rational" : "polynomial") + " volume needs " + std::to_string(rows) +
      " coordinates, not " + std::to_string(h.rows()));
  }
  if (std::min({ degrees[0], degrees[1], degrees[2] }) < 1)
  {
    throw Error("a Jacobian determinant needs a volume: each degree at least 1");
  }
  std::array<Bernstein, 4> x;
  std::array<Bernstein, 4> u;
  std::array<Bernstein, 4> v;
  for (Eigen::Index r = 0; r < rows; ++r)
  {
    const auto i = static_cast<std::size_t>(r);
    x[i] = Bernstein(degrees, h.row(r).transpose(), pointError);
    if (rational && r < 3)
    {
      // The determinant is the same about any origin; near the volume its terms do not cancel.
      const double origin = h.row(r).sum() / h.row(3).sum();
      x[i] = x[i] - origin * Bernstein(degrees, h.row(3).transpose(), pointError);
    }
    u[i] = x[i].Derivative(0);
    v[i] = x[i].Derivative(1);
  }
  if (!rational)
  {
    std::array<Bernstein, 3> w;
    for (std::size_t i = 0; i < 3; ++i)
    {
      w[i] = x[i].Derivative(2);
    }
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
      u[2] * (v[0] * w[1] - v[1] * w[0]);
  }
  // Laplace expansion by the minors of columns (X_u, X_v) and (X_w, X). With X = (1 - w) A + w B
  // the latter are X_w Y - X Y_w = p (B_x A_y - A_x B_y), of degree 2p - 2 in w.
  std::array<Bernstein, 4> a;
  std::array<Bernstein, 4> b;
  for (std::size_t i = 0; i < 4; ++i)
  {
    a[i] = Part(x[i], 0);
    b[i] = Part(x[i], 1);
  }
  const auto term = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l)
  { return (u[i] * v[j] - u[j] * v[i]) * (b[k] * a[l] - a[k] * b[l]); };
  const Bernstein sum = term(0, 1, 2, 3) + term(0, 2, 3, 1) + term(0, 3, 1, 2) + term(1, 2, 0, 3) +
    term(1, 3, 2, 0) + term(2, 3, 0, 1);
  // X_u has one degree less in u than the others, and so has the determinant, by the same identity.
  return Reduce(Reduce(degrees[2] * sum, 0), 1);
}

}
