// SPDX-License-Identifier: BSD-3-Clause
#include "ModelExchange.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace
{

/// Reads a list from its begin to its end.
class Reader
{
public:
  explicit Reader(const std::vector<double>& numbers)
    : Next(numbers.data())
    , End(numbers.data() + numbers.size())
  {
  }
  [[nodiscard]] bool IsAtEnd() const { return this->Next == this->End; }
  double Number() { return *this->Next++; }
  int Integer() { return static_cast<int>(this->Number()); }
  template <class Integers>
  void Read(Integers& integers)
  {
    for (auto& integer : integers)
    {
      integer = static_cast<std::decay_t<decltype(integer)>>(this->Number());
    }
  }
  const double* Take(std::size_t count)
  {
    const double* begin = this->Next;
    this->Next += count;
    return begin;
  }

private:
  const double* Next;
  const double* End;
};

void Append(std::vector<double>& numbers, const std::optional<std::array<double, 3>>& point)
{
  numbers.push_back(point.has_value());
  const std::array<double, 3> p = point.value_or(std::array<double, 3>{});
  numbers.insert(numbers.end(), p.begin(), p.end());
}

std::optional<std::array<double, 3>> TakePoint(Reader& reader)
{
  const bool has = reader.Number() != 0.0;
  const double* p = reader.Take(3);
  return has ? std::make_optional(std::array<double, 3>{ p[0], p[1], p[2] }) : std::nullopt;
}

}

std::vector<double> ModelExchange::Pack(const hyperpatch::MultiPatch& model)
{
  std::vector<double> numbers;
  const auto append = [&numbers](const auto& values)
  { numbers.insert(numbers.end(), values.begin(), values.end()); };
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    const hyperpatch::Spline& geometry = patch.Body.Geometry();
    numbers.push_back(patch.Id);
    numbers.push_back(patch.WholeHandedness);
    append(patch.FirstSpan);
    append(patch.WholeSpans);
    append(geometry.Degrees());
    append(geometry.Sizes());
    numbers.push_back(geometry.IsRational());
    for (const hyperpatch::KnotVector& knots : geometry.Knots())
    {
      append(knots.Knots());
    }
    append(geometry.Coefficients().reshaped());
    append(geometry.Weights());
  }
  return numbers;
}

hyperpatch::MultiPatch ModelExchange::UnpackModel(const std::vector<double>& numbers)
{
  hyperpatch::MultiPatch model;
  Reader reader(numbers);
  while (!reader.IsAtEnd())
  {
    const int id = reader.Integer();
    const int handedness = reader.Integer();
    std::array<int, 3> first;
    std::array<int, 3> whole;
    std::array<int, 3> degrees;
    std::array<int, 3> sizes;
    reader.Read(first);
    reader.Read(whole);
    reader.Read(degrees);
    reader.Read(sizes);
    const bool isRational = reader.Number() != 0.0;
    std::array<hyperpatch::KnotVector, 3> knots;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const auto count = static_cast<std::size_t>(sizes[d] + degrees[d] + 1);
      const double* begin = reader.Take(count);
      knots[d] = hyperpatch::KnotVector(degrees[d], std::vector<double>(begin, begin + count));
    }
    const Eigen::Index n = static_cast<Eigen::Index>(sizes[0]) * sizes[1] * sizes[2];
    const Eigen::Map<const Eigen::MatrixXd> points(
      reader.Take(3 * static_cast<std::size_t>(n)), 3, n);
    const Eigen::Index m = isRational ? n : 0;
    const Eigen::Map<const Eigen::VectorXd> weights(reader.Take(static_cast<std::size_t>(m)), m);
    hyperpatch::Patch patch{ id,
      hyperpatch::Aggregate(hyperpatch::Spline(std::move(knots), points, weights)) };
    patch.WholeHandedness = handedness;
    patch.FirstSpan = first;
    patch.WholeSpans = whole;
    model.Patches.push_back(std::move(patch));
  }
  return model;
}

std::vector<double> ModelExchange::Pack(const std::vector<hyperpatch::PatchValidity>& validity)
{
  std::vector<double> numbers;
  for (const hyperpatch::PatchValidity& patch : validity)
  {
    numbers.push_back(patch.Handedness);
    numbers.push_back(static_cast<double>(patch.Elements.size()));
    for (const hyperpatch::ElementValidity& element : patch.Elements)
    {
      numbers.push_back(element.Verdict);
      numbers.push_back(element.Sign);
      numbers.push_back(element.Degenerate);
      Append(numbers, element.Positive);
      Append(numbers, element.Negative);
    }
  }
  return numbers;
}

std::vector<hyperpatch::PatchValidity> ModelExchange::UnpackValidity(
  const std::vector<double>& numbers)
{
  std::vector<hyperpatch::PatchValidity> validity;
  Reader reader(numbers);
  while (!reader.IsAtEnd())
  {
    hyperpatch::PatchValidity patch;
    patch.Handedness = reader.Integer();
    patch.Elements.resize(static_cast<std::size_t>(reader.Number()));
    for (hyperpatch::ElementValidity& element : patch.Elements)
    {
      element.Verdict = reader.Integer();
      element.Sign = reader.Integer();
      element.Degenerate = static_cast<std::uint32_t>(reader.Number());
      element.Positive = TakePoint(reader);
      element.Negative = TakePoint(reader);
    }
    validity.push_back(std::move(patch));
  }
  return validity;
}
