// SPDX-License-Identifier: BSD-3-Clause
#include "ModelElementsWorker.h"

#include "BezierExtractor.h"
#include "Error.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Makes rows of control points on the border that are one point up to `distance` exactly that.
void SnapCollapsedRows(const BezierPiece& piece, double distance, Eigen::MatrixXd& points)
{
  for (int d = 0; d < 3; ++d)
  {
    const int p = piece.Degree(d);
    const Eigen::Index step = piece.Stride(d);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
    {
      bool isFirst = i / step % (p + 1) == 0;
      bool isOnBorder = false;
      for (int e = 0; e < 3; ++e)
      {
        const auto index = static_cast<int>(i / piece.Stride(e) % (piece.Degree(e) + 1));
        isOnBorder = isOnBorder || (e != d && (index == 0 || index == piece.Degree(e)));
      }
      bool isOnePoint = isFirst && isOnBorder;
      for (int r = 1; r <= p && isOnePoint; ++r)
      {
        isOnePoint =
          (piece.Projected().col(i + r * step) - piece.Projected().col(i)).norm() <= distance;
      }
      for (int r = 1; r <= p && isOnePoint; ++r)
      {
        points.col(i + r * step).head<3>() =
          piece.Projected().col(i) * (piece.IsRational() ? points(3, i + r * step) : 1.0);
      }
    }
  }
}

ModelElement MakeElement(const Patch& patch, std::size_t number, std::array<int, 3> spans,
  double distance, const BezierExtractor& extractor)
{
  const Spline& geometry = patch.Body.Geometry();
  ModelElement element{ number, patch.Id, patch.FirstSpan, {}, {}, {}, 0 };
  for (std::size_t d = 0; d < 3; ++d)
  {
    element.Span[d] += spans[d];
    const KnotVector& knots = geometry.Knots()[d];
    const int s = knots.Spans()[static_cast<std::size_t>(spans[d])];
    element.Low[d] = knots[s];
    element.High[d] = knots[s + 1];
  }
  Eigen::MatrixXd points;
  extractor.Extract(spans, points);
  const double error = extractor.ErrorBound(spans);
  element.Piece = BezierPiece(geometry.Degrees(), points, error);
  element.Collapsed = CollapsedEdges(element.Piece, distance);
  if (element.Collapsed != 0)
  {
    points = element.Piece.Points();
    SnapCollapsedRows(element.Piece, distance, points);
    element.Piece = BezierPiece(geometry.Degrees(), points, element.Piece.Error());
  }
  return element;
}

int CornersInCommon(const BezierPiece& a, const BezierPiece& b, double distance)
{
  int count = 0;
  for (int i = 0; i < 64; ++i)
  {
    count +=
      (a.Projected().col(a.Corner(i % 8)) - b.Projected().col(b.Corner(i / 8))).norm() <= distance;
  }
  return count;
}

}

std::array<double, 3> ModelElement::ToPatch(const std::array<double, 3>& parameters) const
{
  std::array<double, 3> result;
  for (std::size_t d = 0; d < 3; ++d)
  {
    result[d] = this->Low[d] + parameters[d] * (this->High[d] - this->Low[d]);
  }
  return result;
}

std::array<double, 3> ModelElement::FromPatch(const std::array<double, 3>& parameters) const
{
  std::array<double, 3> result;
  for (std::size_t d = 0; d < 3; ++d)
  {
    result[d] = (parameters[d] - this->Low[d]) / (this->High[d] - this->Low[d]);
  }
  return result;
}

std::optional<std::array<int, 3>> LatticeOffset(const ModelElement& a, const ModelElement& b)
{
  if (a.PatchId != b.PatchId)
  {
    return std::nullopt;
  }
  std::array<int, 3> offset;
  for (std::size_t d = 0; d < 3; ++d)
  {
    offset[d] = b.Span[d] - a.Span[d];
    const bool fits = offset[d] == 0 ? a.Low[d] == b.Low[d] && a.High[d] == b.High[d]
      : offset[d] > 0                ? a.High[d] <= b.Low[d]
                                     : b.High[d] <= a.Low[d];
    const bool isApart = std::abs(offset[d]) == 1 && a.High[d] != b.Low[d] && b.High[d] != a.Low[d];
    if (!fits || isApart)
    {
      return std::nullopt;
    }
  }
  return offset;
}

std::vector<ModelElement> MakeElements(
  const MultiPatch& model, double distance, const ParallelFor& parallelFor)
{
  std::vector<ModelElement> elements;
  for (std::size_t number = 0; number < model.Patches.size(); ++number)
  {
    const Patch& patch = model.Patches[number];
    const Spline& geometry = patch.Body.Geometry();
    if (geometry.Components() != 3 || geometry.Dimension() != 3)
    {
      throw Error("patch " + std::to_string(patch.Id) + " is not a volume with three coordinates");
    }
    const std::size_t first = elements.size();
    const auto nu = static_cast<std::ptrdiff_t>(geometry.Knots(0).Spans().size());
    const auto nv = static_cast<std::ptrdiff_t>(geometry.Knots(1).Spans().size());
    const auto nw = static_cast<std::ptrdiff_t>(geometry.Knots(2).Spans().size());
    elements.resize(first + static_cast<std::size_t>(nu * nv * nw));
    const BezierExtractor extractor(geometry);
    parallelFor(nu * nv * nw, 64,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        for (std::ptrdiff_t e = begin; e < end; ++e)
        {
          const std::array<int, 3> spans{ static_cast<int>(e % nu), static_cast<int>(e / nu % nv),
            static_cast<int>(e / nu / nv) };
          elements[first + static_cast<std::size_t>(e)] =
            MakeElement(patch, number, spans, distance, extractor);
        }
      });
  }
  return elements;
}

std::vector<Contact> ContactsOf(const ModelElement& a, const ModelElement& b, double distance)
{
  std::optional<Contact> lattice;
  int expected = 0;
  if (const auto offset = LatticeOffset(a, b))
  {
    expected = 1;
    for (const int o : *offset)
    {
      expected *= o == 0 ? 2 : 1;
    }
    // An element has 8 corners in common with itself, and shares nothing across itself.
    lattice = expected < 8 ? LatticeContact(*offset) : std::nullopt;
    expected = expected == 8 || lattice ? expected : 0;
  }
  std::vector<Contact> contacts;
  if (CornersInCommon(a.Piece, b.Piece, distance) != expected)
  {
    contacts = FindContacts(a.Piece, b.Piece, distance);
  }
  if (lattice)
  {
    contacts.insert(contacts.begin(), *lattice);
  }
  return contacts;
}

}
