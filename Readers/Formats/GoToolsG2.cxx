// SPDX-License-Identifier: BSD-3-Clause
#include "GoToolsClasses.h"
#include "Scanner.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>

// GoTools g2: a stream of tokens, objects one after the other. Each has a header "class major minor
// n" and n auxiliary integers (a colour), then its body; there is no count and no topology.

namespace hyperpatch
{

namespace formats
{

namespace
{

constexpr GoToolsClass Classes[] = { { 100, "SplineCurve" }, { 110, "CurveOnSurface" },
  { 111, "CurveOnVolume" }, { 120, "Line" }, { 130, "Circle" }, { 140, "Ellipse" },
  { 150, "BoundedCurve" }, { 160, "Hyperbola" }, { 170, "Parabola" }, { 200, "SplineSurface" },
  { 210, "BoundedSurface" }, { 211, "SurfaceOnVolume" }, { 220, "GoBaryPolSurface" },
  { 230, "GoHBSplineParamSurface" }, { 240, "CompositeSurface" }, { 250, "Plane" },
  { 260, "Cylinder" }, { 261, "SurfaceOfLinearExtrusion" }, { 270, "Sphere" }, { 280, "Cone" },
  { 290, "Torus" }, { 291, "SurfaceOfRevolution" }, { 292, "Disc" }, { 293, "LRSplineSurface" },
  { 294, "TSplineSurface" }, { 400, "PointCloud" }, { 410, "LineCloud" }, { 500, "GoTriangleSets" },
  { 510, "RectGrid" }, { 700, "SplineVolume" }, { 710, "BoundedVolume" }, { 720, "Parallelepiped" },
  { 721, "SphereVolume" }, { 722, "CylinderVolume" }, { 723, "ConeVolume" }, { 724, "TorusVolume" },
  { 793, "LRSplineVolume" } };

const GoToolsClass* FindClass(long long number)
{
  const auto found = std::find_if(std::begin(Classes), std::end(Classes),
    [number](const GoToolsClass& c) { return c.Number == number; });
  return found == std::end(Classes) ? nullptr : found;
}

}

const GoToolsClass* SniffGoToolsHeader(std::string_view line)
{
  try
  {
    Scanner scanner(line);
    const GoToolsClass* known = FindClass(scanner.Integer("class", 100, 999));
    scanner.Integer("major version", 1, 1);
    scanner.Integer("minor version", 0, 0);
    const long long auxiliary = scanner.Integer("number of auxiliary integers", 0, 255);
    for (long long i = 0; i < auxiliary; ++i)
    {
      scanner.Integer(
        "auxiliary", std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
    }
    return scanner.AtEnd() ? known : nullptr;
  }
  catch (const Error&)
  {
    return nullptr;
  }
}

namespace
{

constexpr long long MaxInt = std::numeric_limits<int>::max();

void SkipHeader(Scanner& scanner)
{
  scanner.Integer("the major version of the object", 0, MaxInt);
  scanner.Integer("the minor version of the object", 0, MaxInt);
  const std::size_t auxiliary = scanner.Count("auxiliary integers");
  for (std::size_t i = 0; i < auxiliary; ++i)
  {
    scanner.Integer("an auxiliary integer", -MaxInt, MaxInt);
  }
}

/// \param dimension number of parameters: 1, 2 or 3
Spline ReadSpline(Scanner& scanner, int dimension)
{
  const auto components =
    static_cast<Eigen::Index>(scanner.Integer("the number of coordinates", 1, 3));
  const bool rational = scanner.Integer("the rational flag", 0, 1) == 1;
  std::array<KnotVector, 3> knots;
  long long count = 1;
  for (std::size_t d = 0; d < static_cast<std::size_t>(dimension); ++d)
  {
    const long long size = scanner.Integer("the number of control points", 1, MaxInt);
    const long long order = scanner.Integer("the order (degree + 1)", 1, MaxDegree + 1);
    scanner.CheckRoom(size + order, "knots");
    std::vector<double> values = scanner.Reals(static_cast<std::size_t>(size + order), "a knot");
    knots[d] = WithContext([&]
      { return "line " + std::to_string(scanner.Line()) + ": direction " + "uvw"[d]; },
      [&] { return KnotVector(static_cast<int>(order) - 1, std::move(values)); });
    // Every factor is at most half the number of bytes left: no overflow before the check.
    count *= size;
    scanner.CheckRoom(count, "control points");
  }
  const Eigen::Index rows = components + (rational ? 1 : 0);
  scanner.CheckRoom(count, "control points", static_cast<std::size_t>(rows));
  Eigen::MatrixXd points(rows, count);
  for (Eigen::Index i = 0; i < points.size(); ++i)
  {
    points.data()[i] = scanner.Real("a coordinate");
  }
  return WithContext([&] { return "control points up to line " + std::to_string(scanner.Line()); },
    [&]
    {
      return rational ? SplineFromHomogeneous(std::move(knots), points)
                      : Spline(std::move(knots), std::move(points));
    });
}

}

}

FileContents ParseGoToolsG2(std::string_view text)
{
  using namespace formats;
  Scanner scanner(text);
  FileContents contents;
  std::map<int, std::size_t> skipped;
  int id = 0;
  while (!scanner.AtEnd())
  {
    const long long number = scanner.Integer("the class of the next object", 0, MaxInt);
    const GoToolsClass* known = FindClass(number);
    if (!known)
    {
      scanner.Fail("no GoTools class has the number " + std::to_string(number) +
        ": the numbers of the object before do not fit its sizes, or this is not a g2 file");
    }
    SkipHeader(scanner);
    if (number == 100 || number == 200 || number == 700)
    {
      const int dimension = number == 700 ? 3 : static_cast<int>(number / 100);
      WithContext([&] { return "object " + std::to_string(id) + " (" + known->Name + ")"; },
        [&] { AppendPatch(contents, id, ReadSpline(scanner, dimension)); });
      ++id;
    }
    else
    {
      ++skipped[known->Number];
      // Bodies of other classes have no length: go on at the next line that is a header.
      std::string_view line;
      do
      {
        line = scanner.NextLine();
      } while (scanner.Position() < text.size() && !SniffGoToolsHeader(line));
    }
  }
  std::string list;
  std::size_t total = 0;
  for (const auto& [number, count] : skipped)
  {
    list += (list.empty() ? "" : ", ") + std::to_string(count) + " " + FindClass(number)->Name +
      " (class " + std::to_string(number) + ")";
    total += count;
  }
  if (contents.Model.Patches.empty())
  {
    throw Error("the file holds no tensor-product spline (classes 100, 200 and 700)" +
      (list.empty() ? std::string() : ", only " + list + ": convert to SplineVolume"));
  }
  if (total > 0)
  {
    contents.Warnings.push_back(
      Counted(total, "object") + " of classes that are not read: " + list + ".");
  }
  WarnOfFields(contents);
  return contents;
}

}
