// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSJacobianBoundary.h"

#include "ArrayNames.h"
#include "Error.h"
#include "Evaluator.h"
#include "FieldNumbers.h"
#include "JacobianField.h"
#include "JacobianPieces.h"
#include "JacobianSign.h"
#include "JacobianTetrahedra.h"
#include "JacobianTree.h"
#include "KnotPlanes.h"
#include "NURBSMeshOutput.h"
#include "Operators.h"
#include "Tessellation.h"

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSJacobianBoundary);

namespace
{

/// Grid cells per span on knot planes, at first and at most.
constexpr int LeastSubdivision = 4;
constexpr int GreatestSubdivision = 256;

/// Segments that draw the edge of a cell.
constexpr int EdgeSegments = 4;

using Indices = std::array<int, 3>;

/// Begins of the blocks of knot spans between which the basis is only C0, and the end.
std::vector<int> SmoothRanges(const hyperpatch::KnotVector& knots)
{
  const std::vector<double> breaks = knots.Breaks();
  std::vector<int> begins{ 0 };
  for (const double crease : knots.Creases())
  {
    begins.push_back(
      static_cast<int>(std::lower_bound(breaks.begin(), breaks.end(), crease) - breaks.begin()));
  }
  begins.push_back(static_cast<int>(breaks.size()) - 1);
  return begins;
}

/// Calls body(block) for the blocks in which det J may vanish; large parts of the patch go at once.
template <class Body>
void ForFoldedBlocks(const hyperpatch::Spline& geometry,
  const std::array<std::vector<int>, 3>& ranges, const Indices& begin, const Indices& end,
  const Body& body)
{
  hyperpatch::ParameterBox box{};
  std::size_t widest = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const hyperpatch::KnotVector& knots = geometry.Knots()[d];
    const auto at = [&](int range)
    {
      const auto span = static_cast<std::size_t>(ranges[d][static_cast<std::size_t>(range)]);
      return span < knots.Spans().size() ? knots[knots.Spans()[span]] : knots.Last();
    };
    box.Low[d] = at(begin[d]);
    box.High[d] = at(end[d]);
    widest = end[d] - begin[d] > end[widest] - begin[widest] ? d : widest;
  }
  if (hyperpatch::JacobianSign(geometry, box) != 0)
  {
    return;
  }
  if (end[widest] - begin[widest] == 1)
  {
    body(begin);
    return;
  }
  Indices middle = end;
  middle[widest] = (begin[widest] + end[widest]) / 2;
  ForFoldedBlocks(geometry, ranges, begin, middle, body);
  Indices second = begin;
  second[widest] = middle[widest];
  ForFoldedBlocks(geometry, ranges, second, end, body);
}

/// The exact attributes of a patch at parameters.
std::vector<Eigen::MatrixXd> AttributesAt(
  const hyperpatch::Patch& patch, const Eigen::Matrix3Xd& parameters)
{
  std::vector<Eigen::MatrixXd> attributes;
  for (const hyperpatch::Attribute& attribute : patch.Body.Attributes())
  {
    attributes.emplace_back(attribute.Field.Components(), parameters.cols());
    hyperpatch::Evaluator(attribute.Field)
      .Evaluate(
        static_cast<std::size_t>(parameters.cols()), parameters.data(), attributes.back().data());
  }
  return attributes;
}

/// Whether linear interpolation along the edges of a mesh keeps to the tolerances of attributes.
bool KeepsTo(const std::vector<double>& tolerances, const hyperpatch::Patch& patch,
  const hyperpatch::JacobianCrease& mesh)
{
  if (std::all_of(tolerances.begin(), tolerances.end(), [](double t) { return t == 0.0; }))
  {
    return true;
  }
  const std::vector<Eigen::MatrixXd> values = AttributesAt(patch, mesh.Parameters);
  Eigen::Matrix3Xd middles(3, 3 * mesh.Triangles.cols());
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    for (Eigen::Index i = 0; i < 3; ++i)
    {
      middles.col(3 * t + i) = 0.5 *
        (mesh.Parameters.col(mesh.Triangles(i, t)) +
          mesh.Parameters.col(mesh.Triangles((i + 1) % 3, t)));
    }
  }
  const std::vector<Eigen::MatrixXd> exact = AttributesAt(patch, middles);
  for (std::size_t a = 0; a < tolerances.size(); ++a)
  {
    for (Eigen::Index e = 0; tolerances[a] > 0.0 && e < middles.cols(); ++e)
    {
      const auto mean = 0.5 *
        (values[a].col(mesh.Triangles(e % 3, e / 3)) +
          values[a].col(mesh.Triangles((e + 1) % 3, e / 3)));
      if ((mean - exact[a].col(e)).cwiseAbs().maxCoeff() > tolerances[a])
      {
        return false;
      }
    }
  }
  return true;
}

/// The knot span of a patch that holds a point.
Eigen::Vector3i SpanAt(const hyperpatch::Patch& patch, const Eigen::Vector3d& at)
{
  Eigen::Vector3i span;
  for (int d = 0; d < 3; ++d)
  {
    const hyperpatch::KnotVector& knots = patch.Body.Geometry().Knots(d);
    const std::vector<int>& spans = knots.Spans();
    span[d] = patch.FirstSpan[static_cast<std::size_t>(d)] +
      static_cast<int>(
        std::lower_bound(spans.begin(), spans.end(), knots.FindSpan(at[d])) - spans.begin());
  }
  return span;
}

/// Normals of vertices: those of their triangles, weighted by area.
Eigen::Matrix3Xd NormalsOf(const hyperpatch::JacobianTetrahedra& mesh)
{
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, mesh.Points.cols());
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    const Eigen::Vector3d a = mesh.Points.col(mesh.Triangles(0, t));
    const Eigen::Vector3d b = mesh.Points.col(mesh.Triangles(1, t));
    const Eigen::Vector3d c = mesh.Points.col(mesh.Triangles(2, t));
    for (Eigen::Index i = 0; i < 3; ++i)
    {
      normals.col(mesh.Triangles(i, t)) += (b - a).cross(c - a);
    }
  }
  for (Eigen::Index i = 0; i < normals.cols(); ++i)
  {
    normals.col(i) = normals.col(i).stableNormalized();
  }
  return normals;
}

/// The edges of the cells of a tree, mapped: every edge once per cell.
void AddCellEdges(
  const hyperpatch::Patch& patch, const hyperpatch::JacobianTree& tree, NURBSMeshOutput& mesh)
{
  const auto cells = static_cast<Eigen::Index>(tree.Queue().size());
  constexpr Eigen::Index PointsPerCell = 12 * (EdgeSegments + 1);
  Eigen::Matrix3Xd parameters(3, cells * PointsPerCell);
  NURBSMeshOutput::Cells segments(2, cells * 12 * EdgeSegments);
  Eigen::Matrix3Xi elements(3, segments.cols());
  Eigen::Index point = 0;
  Eigen::Index segment = 0;
  for (const int cell : tree.Queue())
  {
    const hyperpatch::ParameterBox& box = tree.Cells()[static_cast<std::size_t>(cell)].Box;
    const Eigen::Map<const Eigen::Vector3d> low(box.Low.data());
    const Eigen::Map<const Eigen::Vector3d> high(box.High.data());
    const Eigen::Vector3i element = SpanAt(patch, 0.5 * (low + high));
    for (int edge = 0; edge < 12; ++edge)
    {
      const int axis = edge / 4;
      for (int i = 0; i <= EdgeSegments; ++i, ++point)
      {
        Eigen::Vector3d at;
        at[axis] = low[axis] + (high[axis] - low[axis]) * i / EdgeSegments;
        at[(axis + 1) % 3] = (edge & 1 ? high : low)[(axis + 1) % 3];
        at[(axis + 2) % 3] = (edge & 2 ? high : low)[(axis + 2) % 3];
        parameters.col(point) = at;
        if (i > 0)
        {
          segments.col(segment) << point - 1, point;
          elements.col(segment++) = element;
        }
      }
    }
  }
  Eigen::Matrix3Xd points(3, parameters.cols());
  hyperpatch::Evaluator(patch.Body.Geometry())
    .Evaluate(static_cast<std::size_t>(parameters.cols()), parameters.data(), points.data());
  const Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, points.cols());
  mesh.AddPoints(patch, parameters, points, normals, AttributesAt(patch, parameters));
  mesh.AddCells(patch, segments, elements, { { vtkNURBSJacobianBoundary::CELLS } });
}

}

void vtkNURBSJacobianBoundary::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Method: " << this->Method << "\n";
  os << indent << "Faces: " << (this->Faces ? "on" : "off") << "\n";
  os << indent << "KnotPlanes: " << (this->KnotPlanes ? "on" : "off") << "\n";
  os << indent << "Sheet: " << (this->Sheet ? "on" : "off") << "\n";
  os << indent << "IntervalsFrom: " << this->IntervalsFrom << "\n";
  os << indent << "MinimumWidth: " << this->MinimumWidth << "\n";
  os << indent << "MaximumCells: " << this->MaximumCells << "\n";
  os << indent << "CrackRepair: " << this->CrackRepair << "\n";
  os << indent << "ShowCells: " << (this->ShowCells ? "on" : "off") << "\n";
}

std::vector<vtkNURBSJacobianBoundary::PreparedPatch> vtkNURBSJacobianBoundary::SmoothBlocks(
  const hyperpatch::MultiPatch& model)
{
  std::vector<PreparedPatch> parts;
  for (const PreparedPatch& prepared : this->Prepare(model))
  {
    const hyperpatch::Spline& geometry = prepared.Patch->Body.Geometry();
    if (geometry.Dimension() < 3)
    {
      continue;
    }
    std::array<std::vector<int>, 3> ranges;
    Indices end{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      ranges[d] = SmoothRanges(geometry.Knots()[d]);
      end[d] = static_cast<int>(ranges[d].size()) - 1;
    }
    // Parts of the patch have its handedness; told once, it is not computed for each of them.
    hyperpatch::Patch known = *prepared.Patch;
    known.WholeHandedness = prepared.Handedness;
    const bool isOne = end == Indices{ 1, 1, 1 };
    ForFoldedBlocks(geometry, ranges, { 0, 0, 0 }, end,
      [&](const Indices& block)
      {
        PreparedPatch part = prepared;
        if (!isOne)
        {
          Indices first{};
          Indices last{};
          for (std::size_t d = 0; d < 3; ++d)
          {
            first[d] = ranges[d][static_cast<std::size_t>(block[d])];
            last[d] = ranges[d][static_cast<std::size_t>(block[d]) + 1];
          }
          part.Patch = std::make_shared<const hyperpatch::Patch>(
            hyperpatch::RestrictPatch(known, first, last));
          part.Body = std::make_shared<const hyperpatch::PreparedAggregate>(part.Patch->Body);
        }
        parts.push_back(std::move(part));
      });
  }
  return parts;
}

void vtkNURBSJacobianBoundary::DrawFaces(
  const hyperpatch::MultiPatch& model, const AbsoluteTolerances& tolerances, NURBSMeshOutput& mesh)
{
  for (const PreparedPatch& prepared : this->Prepare(model))
  {
    const hyperpatch::Patch& patch = *prepared.Patch;
    if (patch.Body.Geometry().Dimension() < 3)
    {
      continue;
    }
    hyperpatch::TessellationOptions options;
    options.Tolerance = tolerances.Position;
    options.AttributeTolerances = tolerances.Of(patch);
    options.For = this->KernelParallelFor();
    hyperpatch::SurfaceMesh faces =
      hyperpatch::TessellateBoundary(patch, prepared.Handedness, options);
    this->ReportProgress(0.0);
    mesh.AddPoints(patch, std::move(faces.Parameters), std::move(faces.Points),
      std::move(faces.Normals), std::move(faces.Attributes));
    mesh.AddCells(patch, std::move(faces.Triangles), std::move(faces.TriangleElements),
      { std::move(faces.TriangleSides) });
    this->ReportProgress(0.0);
  }
}

void vtkNURBSJacobianBoundary::DrawKnotPlanes(const hyperpatch::MultiPatch& model,
  const AbsoluteTolerances& tolerances, NURBSMeshOutput& mesh, vtkFieldData* fieldData)
{
  std::vector<KnotPlane> planes = FindKnotPlanes(
    model, [this](const std::vector<double>& records) { return this->AllGather(records); });
  // One subdivision for all: planes go on from patch part to patch part.
  double error = 0.0;
  bool isReached = true;
  for (int subdivision = LeastSubdivision;; subdivision *= 2)
  {
    this->ParallelFor(static_cast<vtkIdType>(planes.size()), 1,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        {
          // Undecided cells are wide as they are to ZeroSet.
          planes[i].Mesh = hyperpatch::ExtractJacobianCrease(planes[i].Below, planes[i].Above,
            planes[i].Direction, subdivision, 16.0 * tolerances.Position);
        }
      });
    error = 0.0;
    isReached = true;
    for (const KnotPlane& plane : planes)
    {
      error = std::max(error, plane.Mesh.LargestError);
      isReached = isReached && plane.Mesh.LargestError <= tolerances.Position &&
        !plane.Mesh.HasWideUndecidedCells &&
        KeepsTo(tolerances.Of(*plane.Patch), *plane.Patch, plane.Mesh);
    }
    isReached = !this->AnyRank(!isReached);
    if (isReached || subdivision >= GreatestSubdivision)
    {
      break;
    }
  }
  std::int64_t undecided = 0;
  for (const KnotPlane& plane : planes)
  {
    const auto handedness = std::find_if(this->Prepare(model).begin(), this->Prepare(model).end(),
      [&plane](const PreparedPatch& prepared) {
        return prepared.Patch.get() == plane.Patch;
      })->Handedness;
    undecided += plane.Mesh.UndecidedCells;
    hyperpatch::JacobianCrease crease = plane.Mesh;
    if (handedness < 0)
    {
      crease.Normals = -crease.Normals;
      crease.Triangles.row(1).swap(crease.Triangles.row(2));
    }
    mesh.AddPoints(*plane.Patch, crease.Parameters, crease.Points, crease.Normals,
      AttributesAt(*plane.Patch, crease.Parameters));
    mesh.AddCells(*plane.Patch, crease.Triangles,
      crease.Elements.colwise() + Eigen::Vector3i(plane.FirstSpan.data()), { { KNOT_PLANE } });
  }
  // The field data are those of all processes.
  const std::vector<double> all = this->AllGather({ error, static_cast<double>(undecided) });
  undecided = 0;
  for (std::size_t r = 0; r < all.size(); r += 2)
  {
    error = std::max(error, all[r]);
    undecided += static_cast<std::int64_t>(all[r + 1]);
  }
  vtkDataArray* cells = FieldNumbers::Named(fieldData, hyperpatch::names::UndecidedCells, 0.0);
  cells->SetComponent(0, 0, cells->GetComponent(0, 0) + static_cast<double>(undecided));
  vtkDataArray* largest = FieldNumbers::Named(fieldData, hyperpatch::names::LargestError, 0.0);
  largest->SetComponent(0, 0, std::max(largest->GetComponent(0, 0), error));
  if (!isReached)
  {
    FieldNumbers::Named(fieldData, hyperpatch::names::ToleranceReached, 0.0)
      ->SetComponent(0, 0, 0.0);
    vtkWarningMacro("the limit of refinement was reached on knot planes: the measured error is "
      << error << " where " << tolerances.Position << " was asked for, with " << undecided
      << " cells in which a change of sign could neither be seen nor excluded");
  }
}

void vtkNURBSJacobianBoundary::DrawTetrahedra(
  const std::vector<PreparedPatch>& blocks, NURBSMeshOutput& mesh, vtkFieldData* fieldData)
{
  std::int64_t cells = 0;
  hyperpatch::JacobianTetrahedra total;
  vtkNew<vtkDoubleArray> widths;
  widths->SetName("IntervalWidth");
  vtkNew<vtkIdTypeArray> queue;
  queue->SetName("CellsInQueue");
  double progress = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    const hyperpatch::Patch& patch = *blocks[b].Patch;
    hyperpatch::JacobianTreeOptions options;
    options.Bound = static_cast<hyperpatch::JacobianBound>(this->IntervalsFrom);
    options.MinimumWidth = this->MinimumWidth;
    options.MaximumCells = static_cast<std::size_t>(this->MaximumCells);
    options.Abort = [&](std::size_t count)
    {
      // The queue may shrink again.
      const double part = std::min(1.0, static_cast<double>(count) / this->MaximumCells);
      progress =
        std::max(progress, (static_cast<double>(b) + part) / static_cast<double>(blocks.size()));
      this->ReportProgress(progress);
      return false;
    };
    const hyperpatch::JacobianTree tree(patch.Body.Geometry(), options);
    for (const hyperpatch::JacobianTree::Step& step : tree.Steps())
    {
      widths->InsertNextValue(step.Width);
      queue->InsertNextValue(static_cast<vtkIdType>(step.Cells));
    }
    hyperpatch::JacobianTetrahedra sheet = hyperpatch::MarchTetrahedra(
      patch.Body.Geometry(), tree, static_cast<hyperpatch::CrackRepair>(this->CrackRepair));
    cells += static_cast<std::int64_t>(tree.Queue().size());
    total.Tetrahedra += sheet.Tetrahedra;
    total.RepairedCells += sheet.RepairedCells;
    total.OpenEdges += sheet.OpenEdges;
    if (blocks[b].Handedness < 0)
    {
      sheet.Triangles.row(1).swap(sheet.Triangles.row(2));
    }
    Eigen::Matrix3Xi elements(3, sheet.Triangles.cols());
    for (Eigen::Index t = 0; t < sheet.Triangles.cols(); ++t)
    {
      elements.col(t) = SpanAt(patch,
        (sheet.Parameters.col(sheet.Triangles(0, t)) + sheet.Parameters.col(sheet.Triangles(1, t)) +
          sheet.Parameters.col(sheet.Triangles(2, t))) /
          3.0);
    }
    mesh.AddPoints(patch, sheet.Parameters, sheet.Points, NormalsOf(sheet),
      AttributesAt(patch, sheet.Parameters));
    mesh.AddCells(patch, sheet.Triangles, elements, { { SHEET } });
    if (this->ShowCells)
    {
      AddCellEdges(patch, tree, mesh);
    }
  }
  FieldNumbers::AddCount(fieldData, "Cells", cells);
  FieldNumbers::AddCount(fieldData, "Tetrahedra", total.Tetrahedra);
  FieldNumbers::AddCount(fieldData, "RepairedCells", total.RepairedCells);
  FieldNumbers::AddCount(fieldData, "OpenEdges", total.OpenEdges);
  fieldData->AddArray(widths);
  fieldData->AddArray(queue);
}

void vtkNURBSJacobianBoundary::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  const bool isPaper = this->Method == JOY_DUCHAINEAU;
  const auto isPart = [](const hyperpatch::Patch& patch) { return patch.WholeSpans[0] > 0; };
  if (isPaper && this->AnyRank(std::any_of(model.Patches.begin(), model.Patches.end(), isPart)))
  {
    throw hyperpatch::Error("a patch is split over several processes, which the method of Joy & "
                            "Duchaineau cannot draw: choose the method Certified, or one process");
  }
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  NURBSMeshOutput mesh(tolerances.Components, { hyperpatch::names::Piece });
  const auto leftOut = std::count_if(model.Patches.begin(), model.Patches.end(),
    [](const hyperpatch::Patch& patch) { return patch.Body.Geometry().Dimension() < 3; });
  if (leftOut > 0)
  {
    vtkWarningMacro(<< leftOut << " patches are curves or surfaces and have no Jacobian boundary");
  }
  if (this->Faces)
  {
    this->SetProgressRange(0.0, 0.2);
    this->DrawFaces(model, tolerances, mesh);
  }
  const std::vector<PreparedPatch> blocks =
    this->Sheet ? this->SmoothBlocks(model) : std::vector<PreparedPatch>();
  this->SetProgressRange(0.2, 0.7);
  vtkFieldData* fieldData = output->GetFieldData();
  if (isPaper)
  {
    this->DrawTetrahedra(blocks, mesh, fieldData);
  }
  else
  {
    std::vector<Task> tasks;
    for (const PreparedPatch& block : blocks)
    {
      auto field = std::make_shared<hyperpatch::JacobianField>(block.Body->Geometry());
      tasks.push_back({ block, std::move(field), SHEET });
    }
    this->ReportProgress(0.0);
    this->Draw(tasks, tolerances, mesh, fieldData);
  }
  if (this->KnotPlanes)
  {
    this->SetProgressRange(0.7, 0.8);
    this->DrawKnotPlanes(model, tolerances, mesh, fieldData);
  }
  auto* result = vtkPolyData::SafeDownCast(output);
  mesh.Fill(result, this->KernelParallelFor());
  const auto check = [this] { this->ReportProgress(0.0); };
  this->SetProgressRange(0.85, 1.0);
  JacobianPieces::RemoveSheetsInFaces(model, result, check);
  this->SetProgressRange(0.9, 1.0);
  JacobianPieces::AddDeterminant(model, result, check);
  this->SetProgressRange(0.95, 1.0);
  JacobianPieces::AddIds(
    model, result, [this](const std::vector<double>& records) { return this->AllGather(records); },
    check);
}

VTK_ABI_NAMESPACE_END
