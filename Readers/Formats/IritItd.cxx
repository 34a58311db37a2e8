// SPDX-License-Identifier: BSD-3-Clause
#include "Scanner.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>

// IRIT .itd: nested brackets. [OBJECT attributes NAME geometry...] holds
// [TRIVAR BSPLINE nu nv nw ou ov ow E3|P3 [KV k...] [KV k...] [KV k...] [point] [point]...], orders
// being degrees + 1, and [TRIVAR BEZIER nu nv nw E3 ...] without knots; SURFACE and CURVE alike.
// A point of type P has its weight first and is multiplied by it. [KVP k...] is periodic: the first
// order - 1 control points come again at the end.

namespace hyperpatch
{

namespace
{

using namespace formats;

constexpr long long MaxInt = std::numeric_limits<int>::max();

/// What an object may hold beside splines; every other bracket is an attribute.
constexpr std::string_view OtherKinds[] = { "POLYGON", "POLYLINE", "POINTLIST", "POLYSTRIP",
  "TRIMSRF", "TRISRF", "MULTIVAR", "MODEL", "VMODEL", "INSTANCE", "STRING", "NUMBER", "POINT",
  "VECTOR", "PLANE", "MATRIX", "CTLPT" };

/// The text with every bracket a token of its own and every quoted string without blanks and
/// brackets. Lines stay.
std::string Separated(std::string_view text)
{
  std::string separated;
  separated.reserve(text.size() + text.size() / 2);
  bool quoted = false;
  for (const char c : text)
  {
    quoted = c == '"' ? !quoted : quoted && c != '\n';
    const bool isBracket = c == '[' || c == ']';
    if (quoted && (isBracket || c == ' ' || c == '\t' || c == '#'))
    {
      separated += '_';
    }
    else if (isBracket)
    {
      separated += { ' ', c, ' ' };
    }
    else
    {
      separated += c;
    }
  }
  return separated;
}

class ItdParser
{
public:
  explicit ItdParser(std::string_view text)
    : Text(Separated(text))
    , In(this->Text)
  {
  }
  FileContents Parse();

private:
  void ReadSpline(const std::string& kind, int dimension);
  KnotVector ReadKnots(std::size_t direction, int size, int order, bool& isPeriodic);
  /// Skips what follows an opening bracket, that bracket's end included.
  void SkipBracket();

  std::string Text;
  Scanner In;
  FileContents Contents;
};

FileContents ItdParser::Parse()
{
  std::map<std::string, std::size_t> skipped;
  int depth = 0;
  while (!this->In.AtEnd())
  {
    const std::string_view token = this->In.Next("a bracket");
    depth -= token == "]" ? 1 : 0;
    if (depth < 0)
    {
      this->In.Fail("a bracket is closed that was not opened");
    }
    if (token != "[")
    {
      continue; // an object's name, or a comment between objects
    }
    const std::string kind(this->In.Peek());
    const int dimension = kind == "TRIVAR" ? 3 : kind == "SURFACE" ? 2 : kind == "CURVE" ? 1 : 0;
    if (kind == "OBJECT")
    {
      this->In.Expect(kind);
      ++depth;
    }
    else if (dimension > 0)
    {
      this->In.Expect(kind);
      this->ReadSpline(kind, dimension);
    }
    else
    {
      if (std::find(std::begin(OtherKinds), std::end(OtherKinds), kind) != std::end(OtherKinds))
      {
        ++skipped[kind];
      }
      this->SkipBracket();
    }
  }
  if (depth > 0)
  {
    this->In.Fail("the file ends inside " +
      Counted(static_cast<std::size_t>(depth), "open bracket") + ": it is cut short");
  }
  std::string list;
  for (const auto& [kind, count] : skipped)
  {
    list += (list.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  if (this->Contents.Model.Patches.empty())
  {
    throw Error("the file holds no spline (TRIVAR, SURFACE or CURVE)" +
      (list.empty() ? std::string() : ", only " + list) + ": save it as TRIVAR");
  }
  if (!list.empty())
  {
    this->Contents.Warnings.push_back("Objects that are not read: " + list + ".");
  }
  WarnOfFields(this->Contents);
  return std::move(this->Contents);
}

void ItdParser::SkipBracket()
{
  for (int depth = 1; depth > 0;)
  {
    const std::string_view token = this->In.Next("\"]\"");
    depth += token == "[" ? 1 : token == "]" ? -1 : 0;
  }
}

KnotVector ItdParser::ReadKnots(std::size_t direction, int size, int order, bool& isPeriodic)
{
  while (true)
  {
    this->In.Expect("[");
    const std::string_view word = this->In.Next("\"KV\"");
    isPeriodic = word == "KVP";
    if (isPeriodic || word == "KV")
    {
      break;
    }
    this->SkipBracket(); // an attribute
  }
  const long long count = static_cast<long long>(size) + order + (isPeriodic ? order - 1 : 0);
  this->In.CheckRoom(count, "knots");
  std::vector<double> knots = this->In.Reals(static_cast<std::size_t>(count), "a knot");
  this->In.Expect("]");
  return WithContext([&]
    { return "line " + std::to_string(this->In.Line()) + ": direction " + "uvw"[direction]; },
    [&] { return KnotVector(order - 1, std::move(knots)); });
}

void ItdParser::ReadSpline(const std::string& kind, int dimension)
{
  const auto directions = static_cast<std::size_t>(dimension);
  const std::string_view form = this->In.Next("BSPLINE or BEZIER");
  if (form != "BSPLINE" && form != "BEZIER")
  {
    this->In.Fail(Quote(form) + " where BSPLINE or BEZIER is expected");
  }
  std::array<int, 3> sizes{ 1, 1, 1 };
  std::array<int, 3> orders{ 1, 1, 1 };
  for (std::size_t d = 0; d < directions; ++d)
  {
    sizes[d] = static_cast<int>(this->In.Integer("the number of control points", 1, MaxInt));
  }
  for (std::size_t d = 0; d < directions; ++d)
  {
    const long long order =
      form == "BEZIER" ? sizes[d] : this->In.Integer("the order (degree + 1)", 1, MaxDegree + 1);
    if (order > MaxDegree + 1)
    {
      this->In.Fail(
        "the order is " + std::to_string(order) + ", not in 1.." + std::to_string(MaxDegree + 1));
    }
    orders[d] = static_cast<int>(order);
  }
  const std::string type(this->In.Next("the type of the points"));
  const bool rational = type[0] == 'P';
  if (type.size() != 2 || (type[0] != 'E' && !rational) || type[1] < '1' || type[1] > '3')
  {
    this->In.Fail(Quote(type) +
      " where the type of the points is expected, E1 to E3 or P1 to P3 (with weights)");
  }

  std::array<KnotVector, 3> knots;
  std::array<bool, 3> isPeriodic{};
  for (std::size_t d = 0; d < directions; ++d)
  {
    knots[d] = form == "BEZIER" ? KnotVector::Uniform(orders[d] - 1, sizes[d])
                                : this->ReadKnots(d, sizes[d], orders[d], isPeriodic[d]);
  }
  // Every size is at most the number of bytes left (of a Bezier patch, 32): no overflow.
  long long count = 1;
  for (const int size : sizes)
  {
    count *= size;
    this->In.CheckRoom(count, "control points", 3);
  }

  const Eigen::Index coordinates = type[1] - '0';
  Eigen::MatrixXd points(coordinates + (rational ? 1 : 0), count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    this->In.Expect("[");
    if (rational)
    {
      points(coordinates, i) = this->In.Real("a weight");
    }
    for (Eigen::Index c = 0; c < coordinates; ++c)
    {
      points(c, i) = this->In.Real("a coordinate");
    }
    this->In.Expect("]");
  }
  this->In.Expect("]");

  if (isPeriodic[0] || isPeriodic[1] || isPeriodic[2])
  {
    const std::array<int, 3> all{ knots[0].Size(), knots[1].Size(), knots[2].Size() };
    Eigen::MatrixXd unrolled(points.rows(), static_cast<Eigen::Index>(all[0]) * all[1] * all[2]);
    Eigen::Index to = 0;
    for (int k = 0; k < all[2]; ++k)
    {
      for (int j = 0; j < all[1]; ++j)
      {
        for (int i = 0; i < all[0]; ++i, ++to)
        {
          const Eigen::Index row =
            j % sizes[1] + static_cast<Eigen::Index>(sizes[1]) * (k % sizes[2]);
          unrolled.col(to) = points.col(i % sizes[0] + sizes[0] * row);
        }
      }
    }
    points = std::move(unrolled);
  }
  const int id = static_cast<int>(this->Contents.Model.Patches.size());
  WithContext([&]
    { return "line " + std::to_string(this->In.Line()) + ": " + kind + " " + std::to_string(id); },
    [&]
    {
      AppendPatch(this->Contents, id,
        rational ? SplineFromHomogeneous(std::move(knots), points)
                 : Spline(std::move(knots), std::move(points)));
    });
}

}

FileContents ParseIritItd(std::string_view text)
{
  return ItdParser(text).Parse();
}

}
