// SPDX-License-Identifier: BSD-3-Clause
#include "Scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace hyperpatch::formats
{

namespace
{

bool IsBlank(char c)
{
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// from_chars takes no leading plus, which C and Fortran write.
std::string_view WithoutPlus(std::string_view token)
{
  return token.size() > 1 && token[0] == '+' && token[1] != '-' ? token.substr(1) : token;
}

}

Scanner::Scanner(std::string_view text, std::size_t line, std::string whole, char comment)
  : Text(text)
  , Whole(std::move(whole))
  , FirstLine(line)
  , Comment(comment)
{
}

bool Scanner::AtEnd()
{
  while (this->Begin < this->Text.size())
  {
    const char c = this->Text[this->Begin];
    if (this->Comment != '\0' && c == this->Comment)
    {
      this->Begin = std::min(this->Text.find('\n', this->Begin), this->Text.size());
    }
    else if (IsBlank(c))
    {
      ++this->Begin;
    }
    else
    {
      return false;
    }
  }
  return true;
}

std::string_view Scanner::Peek()
{
  if (this->AtEnd())
  {
    return {};
  }
  std::size_t end = this->Begin;
  while (end < this->Text.size() && !IsBlank(this->Text[end]))
  {
    ++end;
  }
  return this->Text.substr(this->Begin, end - this->Begin);
}

std::string_view Scanner::Next(const char* what)
{
  const std::string_view token = this->Peek();
  this->Token = this->Begin;
  if (token.empty())
  {
    this->Fail("the " + this->Whole + " ends where " + what + " is expected: it is cut short");
  }
  this->Begin += token.size();
  return token;
}

void Scanner::Expect(std::string_view word)
{
  const std::string expected = '"' + std::string(word) + '"';
  const std::string_view token = this->Next(expected.c_str());
  if (token != word)
  {
    this->Fail(Quote(token) + " where " + expected + " is expected");
  }
}

long long Scanner::Integer(const char* what, long long low, long long high)
{
  const std::string_view token = this->Next(what);
  const std::string_view digits = WithoutPlus(token);
  long long value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
  {
    this->Fail(Quote(token) + " where " + what + ", an integer, is expected");
  }
  if (error != std::errc() || value < low || value > high)
  {
    this->Fail(std::string(what) + " is " + Quote(token) + ", not in " + std::to_string(low) +
      ".." + std::to_string(high));
  }
  return value;
}

double Scanner::ToReal(std::string_view token, const char* what) const
{
  const std::string_view digits = WithoutPlus(token);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
  {
    this->Fail(Quote(token) + " where " + what + ", a number, is expected");
  }
  if (error == std::errc::result_out_of_range)
  {
    // Too small for a double is zero; too large is an error.
    if (digits.find("e-") != digits.npos || digits.find("E-") != digits.npos)
    {
      return 0.0;
    }
    this->Fail(std::string(what) + " is " + Quote(token) + ", too large for a double");
  }
  if (!std::isfinite(value))
  {
    this->Fail(std::string(what) + " is " + Quote(token) + "; a finite number is needed");
  }
  return value;
}

double Scanner::Real(const char* what)
{
  return this->ToReal(this->Next(what), what);
}

double Scanner::Quotient(const char* what)
{
  const std::string_view token = this->Next(what);
  const std::size_t slash = token.find('/');
  if (slash == token.npos)
  {
    return this->ToReal(token, what);
  }
  const double value =
    this->ToReal(token.substr(0, slash), what) / this->ToReal(token.substr(slash + 1), what);
  if (!std::isfinite(value))
  {
    this->Fail(std::string(what) + " is " + Quote(token) + "; a finite number is needed");
  }
  return value;
}

std::vector<double> Scanner::Reals(std::size_t count, const char* what)
{
  std::vector<double> values(count);
  for (double& value : values)
  {
    value = this->Real(what);
  }
  return values;
}

std::size_t Scanner::Count(const char* what, std::size_t tokens)
{
  const std::string number = std::string("the number of ") + what;
  const long long count = this->Integer(number.c_str(), 0, std::numeric_limits<long long>::max());
  this->CheckRoom(count, what, tokens);
  return static_cast<std::size_t>(count);
}

void Scanner::CheckRoom(long long count, const char* what, std::size_t tokens)
{
  // A token and the blank before it take two characters.
  const std::size_t room = (this->Text.size() - this->Begin + 1) / 2 / tokens;
  if (count < 0 || static_cast<unsigned long long>(count) > room)
  {
    this->Fail(std::to_string(count) + " " + what + " are announced, but the rest of the " +
      this->Whole + " has room for at most " + std::to_string(room) +
      ": the number is wrong or the " + this->Whole + " is cut short");
  }
}

std::string Scanner::RestOfLine(const char* what)
{
  this->Next(what);
  const std::size_t line = std::min(this->Text.find('\n', this->Token), this->Text.size());
  this->Begin = std::min(this->Text.find(this->Comment, this->Token), line);
  std::string_view rest = this->Text.substr(this->Token, this->Begin - this->Token);
  while (!rest.empty() && IsBlank(rest.back()))
  {
    rest.remove_suffix(1);
  }
  return std::string(rest);
}

std::string_view Scanner::NextLine()
{
  this->Begin = std::min(this->Text.find('\n', this->Begin), this->Text.size());
  this->Begin += this->Begin < this->Text.size() ? 1 : 0;
  const std::size_t end = std::min(this->Text.find('\n', this->Begin), this->Text.size());
  return this->Text.substr(this->Begin, end - this->Begin);
}

std::size_t Scanner::Line() const
{
  const auto begin = this->Text.begin();
  return this->FirstLine +
    static_cast<std::size_t>(
      std::count(begin, begin + static_cast<std::ptrdiff_t>(this->Token), '\n'));
}

void Scanner::Fail(const std::string& message) const
{
  throw Error("line " + std::to_string(this->Line()) + ": " + message);
}

std::string Quote(std::string_view token)
{
  constexpr std::size_t longest = 40;
  std::string text = "\"";
  for (char c : token.substr(0, longest))
  {
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return text + (token.size() > longest ? "...\"" : "\"");
}

std::string Counted(std::size_t count, const std::string& thing)
{
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

Spline SplineFromHomogeneous(std::array<KnotVector, 3> knots, const Eigen::MatrixXd& homogeneous)
{
  const Eigen::Index last = homogeneous.rows() - 1;
  for (Eigen::Index i = 0; i < homogeneous.cols(); ++i)
  {
    if (!(homogeneous(last, i) > 0.0))
    {
      throw Error("weight " + std::to_string(i) + " is " + std::to_string(homogeneous(last, i)) +
        "; weights must be positive");
    }
  }
  return Spline::FromHomogeneous(std::move(knots), homogeneous);
}

namespace
{

/// The box of a field's parameters, as the identity.
Spline ParameterBox(const Spline& field)
{
  std::array<KnotVector, 3> knots;
  Eigen::Index corners = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& k = field.Knots()[d];
    if (k.Degree() > 0)
    {
      knots[d] = KnotVector::Uniform(1, 2, k.First(), k.Last());
      corners *= 2;
    }
  }
  Eigen::MatrixXd points(field.Dimension(), corners);
  for (Eigen::Index i = 0; i < corners; ++i)
  {
    Eigen::Index row = 0;
    for (const KnotVector& k : knots)
    {
      if (k.Degree() > 0)
      {
        points(row, i) = (i >> row) % 2 == 0 ? k.First() : k.Last();
        ++row;
      }
    }
  }
  return Spline(std::move(knots), std::move(points));
}

}

void AppendPatch(FileContents& contents, int id, Spline spline)
{
  if (spline.Components() >= spline.Dimension())
  {
    contents.Model.Patches.push_back({ id, Aggregate(std::move(spline)) });
    return;
  }
  Spline box = ParameterBox(spline);
  contents.Model.Patches.push_back(
    { id, Aggregate(std::move(box), { { "Field", std::move(spline) } }) });
}

void WarnOfFields(FileContents& contents)
{
  const auto& patches = contents.Model.Patches;
  const auto fields = std::count_if(patches.begin(), patches.end(),
    [](const Patch& patch) { return !patch.Body.Attributes().empty(); });
  if (fields > 0)
  {
    contents.Warnings.push_back(Counted(static_cast<std::size_t>(fields), "spline") +
      " with fewer coordinates than parameters: read as attribute \"Field\" over the parameter "
      "domain.");
  }
}

}
