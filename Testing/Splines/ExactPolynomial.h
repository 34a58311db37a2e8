// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_ExactPolynomial_h
#define hyperpatch_testing_ExactPolynomial_h

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

/// Arithmetic without rounding, for bounds of rounding errors to be held against.
namespace exact
{

/// A signed integer of 1024 bits, in two's complement.
class Integer
{
public:
  Integer() = default;
  // NOLINTNEXTLINE(google-explicit-constructor)
  Integer(std::int64_t value)
  {
    this->Words.fill(value < 0 ? ~std::uint64_t{ 0 } : 0);
    this->Words[0] = static_cast<std::uint64_t>(value);
  }
  /// value * 2^shift, which must be an integer.
  static Integer FromDouble(double value, int shift)
  {
    int exponent = 0;
    const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
    int left = exponent - 53 + shift;
    Integer result(mantissa);
    for (; left < 0; ++left)
    {
      if (result.Words[0] & 1)
      {
        throw std::domain_error("the number has bits below the unit");
      }
      result = result.Half();
    }
    if (mantissa != 0 && left + 54 >= static_cast<int>(64 * Size))
    {
      throw std::domain_error("the number is too large");
    }
    while (left >= 62)
    {
      result = result * Integer(std::int64_t{ 1 } << 62);
      left -= 62;
    }
    return result * Integer(std::int64_t{ 1 } << left);
  }

  [[nodiscard]] bool IsNegative() const { return (this->Words.back() >> 63) != 0; }
  [[nodiscard]] int Sign() const { return this->IsNegative() ? -1 : *this == Integer() ? 0 : 1; }

  friend bool operator==(const Integer& a, const Integer& b) { return a.Words == b.Words; }
  friend bool operator<(const Integer& a, const Integer& b) { return (a - b).IsNegative(); }
  friend bool operator<=(const Integer& a, const Integer& b) { return !(b < a); }

  friend Integer operator+(const Integer& a, const Integer& b)
  {
    Integer sum;
    unsigned carry = 0;
    for (std::size_t i = 0; i < Size; ++i)
    {
      const std::uint64_t partial = a.Words[i] + carry;
      carry = partial < carry ? 1 : 0;
      sum.Words[i] = partial + b.Words[i];
      carry += sum.Words[i] < partial ? 1 : 0;
    }
    return sum;
  }
  Integer operator-() const
  {
    Integer complement;
    for (std::size_t i = 0; i < Size; ++i)
    {
      complement.Words[i] = ~this->Words[i];
    }
    return complement + Integer(1);
  }
  friend Integer operator-(const Integer& a, const Integer& b) { return a + -b; }
  friend Integer operator*(const Integer& a, const Integer& b)
  {
    // Schoolbook, on magnitudes: short numbers are quick.
    const Integer x = a.IsNegative() ? -a : a;
    const Integer y = b.IsNegative() ? -b : b;
    const std::size_t nx = x.Length();
    const std::size_t ny = y.Length();
    if (nx + ny > Size)
    {
      throw std::overflow_error("the product has too many bits");
    }
    Integer product;
    for (std::size_t i = 0; i < nx; ++i)
    {
      std::uint64_t carry = 0;
      for (std::size_t j = 0; j < ny; ++j)
      {
        const Wide wide = static_cast<Wide>(x.Words[i]) * y.Words[j] + product.Words[i + j] + carry;
        product.Words[i + j] = static_cast<std::uint64_t>(wide);
        carry = static_cast<std::uint64_t>(wide >> 64);
      }
      product.Words[i + ny] += carry;
    }
    return a.IsNegative() != b.IsNegative() ? -product : product;
  }

private:
  static constexpr std::size_t Size = 16;
  __extension__ using Wide = unsigned __int128;

  [[nodiscard]] std::size_t Length() const
  {
    std::size_t n = Size;
    while (n > 1 && this->Words[n - 1] == 0)
    {
      --n;
    }
    return n;
  }
  /// Half of an even number.
  [[nodiscard]] Integer Half() const
  {
    Integer half;
    for (std::size_t i = 0; i < Size; ++i)
    {
      const std::uint64_t next = i + 1 < Size ? this->Words[i + 1]
        : this->IsNegative()                  ? ~std::uint64_t{ 0 }
                                              : 0;
      half.Words[i] = this->Words[i] >> 1 | next << 63;
    }
    return half;
  }

  std::array<std::uint64_t, Size> Words{};
};

inline std::int64_t Binomial(int n, int k)
{
  std::int64_t b = 1;
  for (int i = 1; i <= k; ++i)
  {
    b = b * (n - k + i) / i;
  }
  return b;
}

/// A tensor-product polynomial by its Bernstein coefficients, each times its binomials: so products
/// and elevations are sums of integers. u fastest.
struct Polynomial
{
  std::array<int, 3> Degrees{};
  std::vector<Integer> Scaled;

  [[nodiscard]] std::size_t Index(int i, int j, int k) const
  {
    return static_cast<std::size_t>(i + (this->Degrees[0] + 1) * (j + (this->Degrees[1] + 1) * k));
  }
  explicit Polynomial(std::array<int, 3> degrees)
    : Degrees(degrees)
    , Scaled(static_cast<std::size_t>((degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1)))
  {
  }
  /// From coefficients that are multiples of 2^-shift.
  Polynomial(std::array<int, 3> degrees, const Eigen::VectorXd& coefficients, int shift)
    : Polynomial(degrees)
  {
    this->ForAll(
      [&](int i, int j, int k)
      {
        const std::size_t at = this->Index(i, j, k);
        this->Scaled[at] = this->Binomials(i, j, k) *
          Integer::FromDouble(coefficients[static_cast<Eigen::Index>(at)], shift);
      });
  }

  template <class Function>
  void ForAll(const Function& function) const
  {
    for (int k = 0; k <= this->Degrees[2]; ++k)
    {
      for (int j = 0; j <= this->Degrees[1]; ++j)
      {
        for (int i = 0; i <= this->Degrees[0]; ++i)
        {
          function(i, j, k);
        }
      }
    }
  }
  [[nodiscard]] Integer Binomials(int i, int j, int k) const
  {
    return Integer(Binomial(this->Degrees[0], i)) * Integer(Binomial(this->Degrees[1], j)) *
      Integer(Binomial(this->Degrees[2], k));
  }

  /// n (c_{i+1} - c_i) times C(n - 1, i): (i + 1) s_{i+1} - (n - i) s_i of the scaled ones.
  [[nodiscard]] Polynomial Derivative(int direction) const
  {
    const auto d = static_cast<std::size_t>(direction);
    std::array<int, 3> degrees = this->Degrees;
    const int n = degrees[d]--;
    Polynomial result(degrees);
    result.ForAll(
      [&](int i, int j, int k)
      {
        const std::array<int, 3> low{ i, j, k };
        std::array<int, 3> high = low;
        ++high[d];
        result.Scaled[result.Index(i, j, k)] =
          Integer(low[d] + 1) * this->Scaled[this->Index(high[0], high[1], high[2])] -
          Integer(n - low[d]) * this->Scaled[this->Index(i, j, k)];
      });
    return result;
  }

  /// The same with one degree less, which it must have. s_i = s'_i + s'_{i-1} of elevation, solved.
  [[nodiscard]] Polynomial Reduced(int direction) const
  {
    const auto d = static_cast<std::size_t>(direction);
    std::array<int, 3> degrees = this->Degrees;
    --degrees[d];
    Polynomial result(degrees);
    this->ForAll(
      [&](int i, int j, int k)
      {
        std::array<int, 3> at{ i, j, k };
        Integer rest = this->Scaled[this->Index(i, j, k)];
        if (at[d] > 0)
        {
          --at[d];
          rest = rest - result.Scaled[result.Index(at[0], at[1], at[2])];
        }
        if ((d == 0 ? i : d == 1 ? j : k) <= degrees[d])
        {
          result.Scaled[result.Index(i, j, k)] = rest;
        }
        else if (rest.Sign() != 0)
        {
          throw std::domain_error("the polynomial has its full degree");
        }
      });
    return result;
  }

  friend Polynomial operator*(const Polynomial& a, const Polynomial& b)
  {
    Polynomial product(
      { a.Degrees[0] + b.Degrees[0], a.Degrees[1] + b.Degrees[1], a.Degrees[2] + b.Degrees[2] });
    a.ForAll(
      [&](int i, int j, int k)
      {
        const Integer& factor = a.Scaled[a.Index(i, j, k)];
        b.ForAll(
          [&](int l, int m, int n)
          {
            Integer& sum = product.Scaled[product.Index(i + l, j + m, k + n)];
            sum = sum + factor * b.Scaled[b.Index(l, m, n)];
          });
      });
    return product;
  }
  friend Polynomial operator+(Polynomial a, const Polynomial& b)
  {
    for (std::size_t i = 0; i < a.Scaled.size(); ++i)
    {
      a.Scaled[i] = a.Scaled[i] + b.Scaled[i];
    }
    return a;
  }
  friend Polynomial operator-(Polynomial a, const Polynomial& b)
  {
    for (std::size_t i = 0; i < a.Scaled.size(); ++i)
    {
      a.Scaled[i] = a.Scaled[i] - b.Scaled[i];
    }
    return a;
  }

  /// The value at (i, j, k) / steps, times steps to the sum of the degrees.
  [[nodiscard]] Integer At(const std::array<int, 3>& at, int steps) const
  {
    // Of each direction: t^i (steps - t)^(n - i).
    std::array<std::vector<Integer>, 3> powers;
    for (std::size_t d = 0; d < 3; ++d)
    {
      for (int i = 0; i <= this->Degrees[d]; ++i)
      {
        Integer power(1);
        for (int l = 0; l < this->Degrees[d]; ++l)
        {
          power = power * Integer(l < i ? at[d] : steps - at[d]);
        }
        powers[d].push_back(power);
      }
    }
    Integer sum;
    this->ForAll(
      [&](int i, int j, int k)
      {
        sum = sum +
          this->Scaled[this->Index(i, j, k)] *
            (powers[0][static_cast<std::size_t>(i)] * powers[1][static_cast<std::size_t>(j)] *
              powers[2][static_cast<std::size_t>(k)]);
      });
    return sum;
  }
};

/// Numbers with so many bits behind the point, to which the points below must be rounded.
inline constexpr int PointShift = 60;

inline double Rounded(double value)
{
  return std::ldexp(std::round(std::ldexp(value, PointShift)), -PointShift);
}

/// det(P_u, P_v, P_w) of a polynomial Bezier volume, times 2^(3 PointShift); degrees 3p - 1.
inline Polynomial Determinant(const std::array<int, 3>& degrees, const Eigen::Matrix3Xd& points)
{
  std::vector<std::array<Polynomial, 3>> rows;
  for (Eigen::Index r = 0; r < 3; ++r)
  {
    const Polynomial x(degrees, points.row(r).transpose(), PointShift);
    rows.push_back({ x.Derivative(0), x.Derivative(1), x.Derivative(2) });
  }
  const auto minor = [&rows](std::size_t i, std::size_t j)
  { return rows[i][1] * rows[j][2] - rows[j][1] * rows[i][2]; };
  return rows[0][0] * minor(1, 2) + rows[1][0] * minor(2, 0) + rows[2][0] * minor(0, 1);
}

/// W^4 det J of a rational one, det[X_u X_v X_w X], times 2^(4 PointShift); degrees 4p - 2.
/// \param points homogeneous
inline Polynomial HomogeneousDeterminant(
  const std::array<int, 3>& degrees, const Eigen::Matrix4Xd& points)
{
  std::vector<std::array<Polynomial, 4>> rows;
  for (Eigen::Index r = 0; r < 4; ++r)
  {
    const Polynomial x(degrees, points.row(r).transpose(), PointShift);
    rows.push_back({ x.Derivative(0), x.Derivative(1), x.Derivative(2), x });
  }
  // Laplace expansion by rows of the first two columns.
  const auto term = [&rows](std::size_t i, std::size_t j, std::size_t k, std::size_t l)
  {
    return (rows[i][0] * rows[j][1] - rows[j][0] * rows[i][1]) *
      (rows[k][2] * rows[l][3] - rows[l][2] * rows[k][3]);
  };
  const Polynomial sum = term(0, 1, 2, 3) + term(0, 2, 3, 1) + term(0, 3, 1, 2) + term(1, 2, 0, 3) +
    term(1, 3, 2, 0) + term(2, 3, 0, 1);
  return sum.Reduced(0).Reduced(1).Reduced(2);
}

}

#endif
