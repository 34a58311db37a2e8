// SPDX-License-Identifier: BSD-3-Clause
#include "TessellationWorker.h"

#include "BezierExtractor.h"
#include "Error.h"
#include "Evaluator.h"
#include "Operators.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace tessellation
{

Domain::Domain(std::vector<Spline> splines, const TessellationOptions& options)
  : Splines(std::move(splines))
{
  std::vector<const Spline*> all;
  for (const Spline& spline : this->Splines)
  {
    all.push_back(&spline);
  }
  for (int d = 0; d < 3; ++d)
  {
    this->Axes[static_cast<std::size_t>(d)] = MakeElementAxis(all, d);
  }
  for (std::size_t s = 0; s < this->Splines.size(); ++s)
  {
    const double tolerance = s == 0         ? options.Tolerance
      : options.AttributeTolerances.empty() ? 0.0
                                            : options.AttributeTolerances[s - 1];
    if (tolerance > 0.0 && std::isfinite(tolerance))
    {
      this->Fields.push_back({ s, s == 0 ? ChordBound::Norm::Vector : ChordBound::Norm::Components,
        tolerance, this->Splines[s].Coefficients().cwiseAbs().maxCoeff() });
      this->NumberOfBounds += s == 0 ? 1 : static_cast<std::size_t>(this->Splines[s].Components());
    }
  }
}

void Domain::Extract(const Measured& field, std::array<int, 3> cell, Eigen::MatrixXd& points) const
{
  const Spline& spline = this->Splines[field.Index];
  std::array<int, 3> spans{};
  std::array<double, 3> low{};
  std::array<double, 3> high{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto c = static_cast<std::size_t>(cell[d]);
    spans[d] = this->Axes[d].Spans[field.Index][c];
    low[d] = this->Axes[d].Breaks[c];
    high[d] = this->Axes[d].Breaks[c + 1];
  }
  BezierExtractor(spline).Extract(spans, low, high, points);
}

void Domain::BoundEdge(
  const Measured& field, const Eigen::MatrixXd& points, ChordBound& bound, EdgeBend* bends) const
{
  const bool rational = this->Splines[field.Index].IsRational();
  const std::array<int, 3> degrees{ static_cast<int>(points.cols()) - 1, 0, 0 };
  for (const ChordBound::Bound& b : bound(points, degrees, rational, field.Norm, Halvings[0]))
  {
    *bends++ = { b.Second[0] / (8.0 * field.Tolerance), b.Radius <= Coincident * field.Size };
  }
}

Eigen::Vector3i Domain::Element(std::array<int, 3> cell, std::array<int, 3> first) const
{
  Eigen::Vector3i element;
  for (std::size_t d = 0; d < 3; ++d)
  {
    element[static_cast<Eigen::Index>(d)] =
      first[d] + this->Axes[d].Spans[0][static_cast<std::size_t>(cell[d])];
  }
  return element;
}

void Check(const Patch& patch, int handedness, const TessellationOptions& options)
{
  CheckTolerances(patch, options.Tolerance, options.AttributeTolerances);
  if (options.MaximumSubdivision < 1)
  {
    throw Error("the maximum subdivision is " + std::to_string(options.MaximumSubdivision) +
      "; it must be at least 1");
  }
  if (handedness != 1 && handedness != -1)
  {
    throw Error("the handedness is " + std::to_string(handedness) + "; it must be 1 or -1");
  }
}

std::vector<int> DirectionsWithDegree(const Spline& geometry)
{
  std::vector<int> directions;
  for (int d = 0; d < 3; ++d)
  {
    if (geometry.Knots(d).Degree() > 0)
    {
      directions.push_back(d);
    }
  }
  return directions;
}

std::vector<Spline> SplinesOf(const Aggregate& body)
{
  std::vector<Spline> splines{ body.Geometry() };
  for (const Attribute& attribute : body.Attributes())
  {
    splines.push_back(attribute.Field);
  }
  return splines;
}

}

using namespace tessellation;

namespace
{

/// The spline on a side; one without that direction as it is.
Spline OnSide(const Spline& spline, int side)
{
  return spline.Knots(side / 2).Size() == 1 ? spline : ExtractFace(spline, side);
}

std::vector<Spline> SplinesOnSide(const Aggregate& body, int side)
{
  std::vector<Spline> splines{ OnSide(body.Geometry(), side) };
  for (const Attribute& attribute : body.Attributes())
  {
    splines.push_back(OnSide(attribute.Field, side));
  }
  return splines;
}

template <typename Matrix>
void Append(Matrix& all, const Matrix& part)
{
  const Eigen::Index before = all.cols();
  all.conservativeResize(part.rows(), before + part.cols());
  all.rightCols(part.cols()) = part;
}

/// Appends a side's mesh to that of the patch.
void Append(SurfaceMesh& all, SurfaceMesh&& part)
{
  const Id offset = all.Points.cols();
  part.Triangles.array() += offset;
  part.Lines.array() += offset;
  Append(all.Parameters, part.Parameters);
  Append(all.Points, part.Points);
  Append(all.Normals, part.Normals);
  for (std::size_t a = 0; a < part.Attributes.size(); ++a)
  {
    Append(all.Attributes[a], part.Attributes[a]);
  }
  Append(all.Triangles, part.Triangles);
  Append(all.TriangleElements, part.TriangleElements);
  Append(all.Lines, part.Lines);
  Append(all.LineElements, part.LineElements);
  all.TriangleSides.insert(
    all.TriangleSides.end(), part.TriangleSides.begin(), part.TriangleSides.end());
  all.LineSides.insert(all.LineSides.end(), part.LineSides.begin(), part.LineSides.end());
  all.LimitReached = all.LimitReached || part.LimitReached;
}

SurfaceMesh TessellateCurve(const Patch& patch, int along, const TessellationOptions& options)
{
  const Aggregate& body = patch.Body;
  SurfaceMesh mesh;
  std::array<double, 3> fixed{};
  std::vector<Spline> splines = SplinesOf(body);
  for (int d = 0; d < 3; ++d)
  {
    fixed[static_cast<std::size_t>(d)] = body.Geometry().Knots(d).First();
    for (Spline& spline : splines)
    {
      spline = d == along ? spline : OnSide(spline, 2 * d);
    }
  }
  const Domain domain(std::move(splines), options);
  const ElementAxis& axis = domain.Axes[static_cast<std::size_t>(along)];
  std::vector<double> parameters{ axis.Breaks.front() };
  std::vector<Eigen::Vector3i> elements;
  ChordBound bound;
  Eigen::MatrixXd points;
  std::vector<EdgeBend> bends(domain.NumberOfBounds);
  for (int c = 0; c < axis.Cells(); ++c)
  {
    std::array<int, 3> cell{};
    cell[static_cast<std::size_t>(along)] = c;
    double most = 0.0;
    for (const Domain::Measured& field : domain.Fields)
    {
      domain.Extract(field, cell, points);
      std::fill(bends.begin(), bends.end(), EdgeBend{});
      domain.BoundEdge(field, points, bound, bends.data());
      for (const EdgeBend& bend : bends)
      {
        most = std::max(most, bend.UU);
      }
    }
    const int n = Count(std::sqrt(most), options.MaximumSubdivision, mesh.LimitReached);
    for (int k = 1; k <= n; ++k)
    {
      parameters.push_back(axis.At(c, static_cast<double>(k) / n));
      elements.push_back(domain.Element(cell, patch.FirstSpan));
    }
  }
  const auto count = static_cast<Eigen::Index>(parameters.size());
  mesh.Parameters.resize(3, count);
  mesh.Lines.resize(2, count - 1);
  mesh.LineElements.resize(3, count - 1);
  mesh.LineSides.assign(parameters.size() - 1, 4);
  mesh.Normals.setZero(3, count);
  mesh.Points.setZero(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    mesh.Parameters.col(i) = Eigen::Map<const Eigen::Vector3d>(fixed.data());
    mesh.Parameters(along, i) = parameters[static_cast<std::size_t>(i)];
    if (i > 0)
    {
      mesh.Lines.col(i - 1) << i - 1, i;
      mesh.LineElements.col(i - 1) = elements[static_cast<std::size_t>(i - 1)];
    }
  }
  for (std::size_t s = 0; s < domain.Splines.size(); ++s)
  {
    const Evaluator evaluator(domain.Splines[s]);
    Eigen::MatrixXd values(evaluator.Components(), count);
    evaluator.Evaluate(parameters.size(), mesh.Parameters.data(), values.data());
    if (s == 0)
    {
      mesh.Points.topRows(values.rows()) = values;
    }
    else
    {
      mesh.Attributes.push_back(std::move(values));
    }
  }
  return mesh;
}

}

void CheckTolerances(
  const Patch& patch, double tolerance, const std::vector<double>& attributeTolerances)
{
  const Aggregate& body = patch.Body;
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
  {
    throw Error("the tolerance is " + std::to_string(tolerance) + "; it must be a positive length");
  }
  if (!attributeTolerances.empty() && attributeTolerances.size() != body.Attributes().size())
  {
    throw Error(std::to_string(attributeTolerances.size()) + " attribute tolerances for " +
      std::to_string(body.Attributes().size()) + " attributes; give one for each, or none");
  }
  for (std::size_t i = 0; i < attributeTolerances.size(); ++i)
  {
    if (!(attributeTolerances[i] >= 0.0))
    {
      throw Error("the tolerance of attribute \"" + body.Attributes()[i].Name + "\" is " +
        std::to_string(attributeTolerances[i]) + "; it must be positive, or 0 for off");
    }
  }
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& k = body.Geometry().Knots(d);
    if (k.Degree() == 0 && k.Spans().size() > 1)
    {
      throw Error(std::string("the geometry has degree 0 and ") + std::to_string(k.Spans().size()) +
        " spans in direction " + "uvw"[d] + ": it jumps there and has no surface");
    }
  }
}

SurfaceMesh TessellateBoundary(
  const Patch& patch, int handedness, const TessellationOptions& options)
{
  Check(patch, handedness, options);
  const Spline& geometry = patch.Body.Geometry();
  const std::vector<int> directions = DirectionsWithDegree(geometry);
  if (directions.size() == 1)
  {
    return TessellateCurve(patch, directions[0], options);
  }
  if (directions.size() == 2)
  {
    const int missing = 3 - directions[0] - directions[1];
    return Face(SplinesOnSide(patch.Body, 2 * missing), missing, geometry.Knots(missing).First(),
      patch.FirstSpan[static_cast<std::size_t>(missing)], 1.0, 4, patch.FirstSpan, options)
      .Tessellate();
  }
  SurfaceMesh mesh;
  for (const Attribute& attribute : patch.Body.Attributes())
  {
    mesh.Attributes.emplace_back(attribute.Field.Components(), 0);
  }
  for (int side = 0; directions.size() == 3 && side < NumberOfSides; ++side)
  {
    if (!patch.IsDomainFace[static_cast<std::size_t>(side)])
    {
      continue;
    }
    const int d = side / 2;
    const bool last = side % 2 == 1;
    const KnotVector& k = geometry.Knots(d);
    // P_v x P_w and P_u x P_v point along u and w, P_u x P_w against v.
    const double outward = (last ? 1.0 : -1.0) * (d == 1 ? -1.0 : 1.0) * handedness;
    const int element = patch.FirstSpan[static_cast<std::size_t>(d)] +
      (last ? static_cast<int>(k.Spans().size()) - 1 : 0);
    Append(mesh,
      Face(SplinesOnSide(patch.Body, side), d, last ? k.Last() : k.First(), element, outward, side,
        patch.FirstSpan, options)
        .Tessellate());
  }
  return mesh;
}

}
