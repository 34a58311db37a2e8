// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Scanner_h
#define hyperpatch_Scanner_h

#include "Aggregate.h"
#include "Error.h"
#include "Formats.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What the parsers of this folder share; not part of the public interface.
namespace hyperpatch::formats
{

/// Blank-separated tokens of a text, with line numbers for messages. Independent of the locale.
/// Every member that reads throws an Error with the line if the text does not fit.
class Scanner
{
public:
  /// \param text must outlive the scanner
  /// \param line the number of the text's first line
  /// \param whole what the text is, for "the ... ends here"
  /// \param comment starts a comment that lasts to the end of its line; '\0' for none
  explicit Scanner(
    std::string_view text, std::size_t line = 1, std::string whole = "file", char comment = '#');

  [[nodiscard]] bool AtEnd();
  /// The next token without taking it; empty at the end.
  [[nodiscard]] std::string_view Peek();
  /// \param what is expected, for the message
  std::string_view Next(const char* what);
  /// Takes one given word.
  void Expect(std::string_view word);
  /// An integer in [low, high].
  long long Integer(const char* what, long long low, long long high);
  /// A finite number.
  double Real(const char* what);
  /// A finite number, also written as a quotient such as 1/3.
  double Quotient(const char* what);
  std::vector<double> Reals(std::size_t count, const char* what);
  /// The number of items of a list that follows.
  /// \throws Error if the rest of the text is too short for that many, each of at least `tokens`
  /// tokens: nothing is allocated on the word of a header.
  std::size_t Count(const char* what, std::size_t tokens = 1);
  /// The check of Count() on its own.
  void CheckRoom(long long count, const char* what, std::size_t tokens = 1);

  /// The line of the next token from that token on, without blanks at its end and comment; takes
  /// it.
  std::string RestOfLine(const char* what);
  /// Goes to the begin of the next line, or the end of the text, and returns that line without its
  /// end and without taking it.
  std::string_view NextLine();
  /// Offset of what is read next.
  [[nodiscard]] std::size_t Position() const { return this->Begin; }

  /// Throws an Error "line n: message", n the line of the token taken last.
  [[noreturn]] void Fail(const std::string& message) const;
  /// The line of the token taken last.
  [[nodiscard]] std::size_t Line() const;

private:
  double ToReal(std::string_view token, const char* what) const;

  std::string_view Text;
  std::string Whole;
  std::size_t FirstLine;
  std::size_t Begin = 0;
  std::size_t Token = 0;
  char Comment;
};

/// A token as a message shows it: short and printable, in quotes.
[[nodiscard]] std::string Quote(std::string_view token);

/// "3 things", "1 thing".
[[nodiscard]] std::string Counted(std::size_t count, const std::string& thing);

/// Runs `make`; an Error that it throws gets `where()` and ": " in front.
template <class Where, class Make>
auto WithContext(Where&& where, Make&& make) -> decltype(make())
{
  try
  {
    return make();
  }
  catch (const Error& error)
  {
    throw Error(where() + ": " + error.what());
  }
}

/// FromHomogeneous with a check of the weights before anything is divided by them.
[[nodiscard]] Spline SplineFromHomogeneous(
  std::array<KnotVector, 3> knots, const Eigen::MatrixXd& homogeneous);

/// Appends a spline to the model. One with fewer coordinates than parameters is a field: it becomes
/// the attribute "Field" of a patch whose geometry is the field's own parameter box.
void AppendPatch(FileContents& contents, int id, Spline spline);

/// Appends the warning that counts the fields of AppendPatch, if there are any.
void WarnOfFields(FileContents& contents);

}

#endif
