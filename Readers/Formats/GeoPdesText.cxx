// SPDX-License-Identifier: BSD-3-Clause
#include "Interfaces.h"
#include "Scanner.h"

#include <algorithm>
#include <limits>

// GeoPDEs text (NURBS toolbox), versions 0.6, 0.7 and 2.1. A line of counts, then per patch the
// degrees, sizes and knots, one row of numbers per coordinate (multiplied by weights) and one of
// weights, u fastest; then interfaces, subdomains and boundaries, each with a line that names it.

namespace hyperpatch
{

namespace
{

using namespace formats;

constexpr long long MaxInt = std::numeric_limits<int>::max();

class GeoPdesParser
{
public:
  explicit GeoPdesParser(std::string_view text)
    : Text(text)
    , In(text)
  {
  }
  FileContents Parse();

private:
  void ReadHeader();
  void ReadPatch(int id);
  void ReadInterface();
  void ReadSubdomain();
  void ReadBoundary();
  /// A patch and a side, both counted from 0.
  std::array<int, 2> ReadSide();
  /// The line that names what follows; empty if what follows begins with a number.
  std::string ReadName();
  [[nodiscard]] bool IsNumberNext();

  std::string_view Text;
  Scanner In;
  int Dimension = 0;
  int Coordinates = 0;
  long long Patches = 1;
  long long Interfaces = 0;
  long long Subdomains = 0;
  FileContents Contents;
};

FileContents GeoPdesParser::Parse()
{
  this->ReadHeader();
  for (int p = 0; p < this->Patches; ++p)
  {
    WithContext([&] { return "patch " + std::to_string(p + 1); }, [&] { this->ReadPatch(p); });
  }
  for (long long i = 0; i < this->Interfaces; ++i)
  {
    this->ReadInterface();
  }
  for (long long i = 0; i < this->Subdomains; ++i)
  {
    this->ReadSubdomain();
  }
  while (!this->In.AtEnd())
  {
    this->ReadBoundary();
  }
  WarnOfFields(this->Contents);
  return std::move(this->Contents);
}

void GeoPdesParser::ReadHeader()
{
  const std::string_view title = this->Text.substr(0, this->Text.find('\n'));
  const bool isOld = title.find(" v.0") != title.npos;
  if (this->In.AtEnd())
  {
    throw Error("the file ends where its line of counts is expected: it is cut short");
  }
  // How many counts there are depends on the version and on who wrote the file.
  std::vector<long long> counts;
  const std::string line = this->In.RestOfLine("the line of counts");
  Scanner numbers(line, this->In.Line(), "line of counts");
  while (!numbers.AtEnd())
  {
    counts.push_back(numbers.Integer("a count", 0, MaxInt));
  }
  if (!isOld && counts.size() < 2)
  {
    this->In.Fail("a line of counts (parameters, coordinates, patches, interfaces, subdomains) "
                  "has at least two numbers");
  }
  if (isOld)
  {
    counts.insert(counts.begin() + 1, counts[0]);
  }
  counts.resize(5, 0);
  this->Patches = std::max(counts[2], 1LL);
  this->Interfaces = counts[3];
  this->Subdomains = counts[4];
  if (counts[0] < 1 || counts[0] > 3 || counts[1] < 1 || counts[1] > 3)
  {
    this->In.Fail(std::to_string(counts[0]) + " parameters and " + std::to_string(counts[1]) +
      " coordinates: both must be 1 to 3");
  }
  this->Dimension = static_cast<int>(counts[0]);
  this->Coordinates = static_cast<int>(counts[1]);
  this->In.CheckRoom(this->Patches, "patches", 8);
  this->In.CheckRoom(this->Interfaces, "interfaces", 5);
  this->In.CheckRoom(this->Subdomains, "subdomains", 1);
}

bool GeoPdesParser::IsNumberNext()
{
  const std::string_view token = this->In.Peek();
  return !token.empty() && token.find_first_not_of("+-.0123456789eE") == token.npos;
}

std::string GeoPdesParser::ReadName()
{
  return this->In.AtEnd() || this->IsNumberNext() ? std::string() : this->In.RestOfLine("a name");
}

void GeoPdesParser::ReadPatch(int id)
{
  (void)this->ReadName();
  const auto dimension = static_cast<std::size_t>(this->Dimension);
  std::array<int, 3> degrees{};
  std::array<int, 3> sizes{ 1, 1, 1 };
  for (std::size_t d = 0; d < dimension; ++d)
  {
    degrees[d] = static_cast<int>(this->In.Integer("a degree", 0, MaxDegree));
  }
  for (std::size_t d = 0; d < dimension; ++d)
  {
    sizes[d] = static_cast<int>(this->In.Integer("the number of control points", 1, MaxInt));
  }
  std::array<KnotVector, 3> knots;
  long long count = 1;
  for (std::size_t d = 0; d < dimension; ++d)
  {
    const long long size = static_cast<long long>(sizes[d]) + degrees[d] + 1;
    this->In.CheckRoom(size, "knots");
    std::vector<double> values = this->In.Reals(static_cast<std::size_t>(size), "a knot");
    knots[d] = WithContext([&]
      { return "line " + std::to_string(this->In.Line()) + ": direction " + "uvw"[d]; },
      [&] { return KnotVector(degrees[d], std::move(values)); });
    // Every size is less than the number of bytes: no overflow before the check.
    count *= sizes[d];
    this->In.CheckRoom(count, "control points");
  }
  const Eigen::Index rows = this->Coordinates + 1;
  this->In.CheckRoom(count, "control points", static_cast<std::size_t>(rows));
  Eigen::MatrixXd points(rows, count);
  for (Eigen::Index row = 0; row < rows; ++row)
  {
    for (Eigen::Index i = 0; i < count; ++i)
    {
      points(row, i) = this->In.Real(row + 1 < rows ? "a coordinate" : "a weight");
    }
  }
  // The format always has weights; without any that differs from 1 the patch is polynomial.
  const bool rational = (points.row(rows - 1).array() != 1.0).any();
  WithContext([&] { return "control points up to line " + std::to_string(this->In.Line()); },
    [&]
    {
      AppendPatch(this->Contents, id,
        rational ? SplineFromHomogeneous(std::move(knots), points)
                 : Spline(std::move(knots), points.topRows(rows - 1)));
    });
}

std::array<int, 2> GeoPdesParser::ReadSide()
{
  const auto patch = static_cast<int>(this->In.Integer("a patch", 1, this->Patches));
  return { patch - 1, static_cast<int>(this->In.Integer("a side", 1, 2 * this->Dimension)) - 1 };
}

void GeoPdesParser::ReadInterface()
{
  (void)this->ReadName();
  const std::array<int, 2> one = this->ReadSide();
  const std::array<int, 2> two = this->ReadSide();
  // "Flag" says that first directions along the faces match, each orientation the way they run.
  const bool swaps =
    this->Dimension == 3 && this->In.Integer("the flag of an interface", -1, 1) != 1;
  std::array<int, 3> direction{ 0, 1, 2 };
  std::array<bool, 3> same{ true, true, true };
  const auto along = [this](int side)
  {
    std::vector<int> directions;
    for (int d = 0; d < this->Dimension; ++d)
    {
      if (d != side / 2)
      {
        directions.push_back(d);
      }
    }
    return directions;
  };
  const std::vector<int> from = along(one[1]);
  std::vector<int> to = along(two[1]);
  if (swaps)
  {
    std::swap(to[0], to[1]);
  }
  for (std::size_t i = 0; i < from.size(); ++i)
  {
    const auto d = static_cast<std::size_t>(from[i]);
    direction[d] = to[i];
    same[d] = this->In.Integer("the orientation of an interface", -1, 1) == 1;
  }
  this->Contents.Model.Interfaces.push_back(
    MakeInterface(one[0], one[1], two[0], two[1], direction, same));
}

void GeoPdesParser::ReadSubdomain()
{
  (void)this->ReadName();
  while (this->IsNumberNext())
  {
    this->In.Integer("a patch", 1, this->Patches);
  }
}

void GeoPdesParser::ReadBoundary()
{
  std::string name = this->ReadName();
  if (name.empty())
  {
    name = "BOUNDARY " + std::to_string(this->Contents.Model.Boundaries.size() + 1);
  }
  std::vector<std::array<int, 2>> sides(this->In.Count("sides of a boundary", 2));
  for (std::array<int, 2>& side : sides)
  {
    side = this->ReadSide();
  }
  this->Contents.Model.Boundaries.push_back({ std::move(name), std::move(sides) });
}

}

FileContents ParseGeoPdesText(std::string_view text)
{
  return GeoPdesParser(text).Parse();
}

}
