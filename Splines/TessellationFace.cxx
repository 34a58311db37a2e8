// SPDX-License-Identifier: BSD-3-Clause
#include "TessellationWorker.h"

#include "Evaluator.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace hyperpatch::tessellation
{

namespace
{

/// Triangulates between two rows of points (along t, `near` on the right of `far`'s side: counter-
/// clockwise when `far` lies on the left of t) by merging their midpoints, which makes no triangle
/// wider than the larger step of the two.
template <typename Emit>
void MergeRows(const std::vector<std::pair<double, Id>>& near,
  const std::vector<std::pair<double, Id>>& far, const Emit& emit)
{
  std::size_t i = 0;
  std::size_t j = 0;
  while (i + 1 < near.size() || j + 1 < far.size())
  {
    const bool advance = j + 1 == far.size() ||
      (i + 1 < near.size() &&
        near[i].first + near[i + 1].first <= far[j].first + far[j + 1].first + Slack);
    if (advance)
    {
      emit(near[i].second, near[i + 1].second, far[j].second);
      ++i;
    }
    else
    {
      emit(near[i].second, far[j + 1].second, far[j].second);
      ++j;
    }
  }
}

}

Face::Face(std::vector<Spline> splines, int missing, double fixed, int element, double outward,
  int side, std::array<int, 3> firstSpan, const TessellationOptions& options)
  : D(std::move(splines), options)
  , Options(options)
  , A(missing == 0 ? 1 : 0)
  , B(missing == 2 ? 1 : 2)
  , Missing(static_cast<std::size_t>(missing))
  , Fixed(fixed)
  , Outward(outward)
  , Side(side)
  , FirstSpan(firstSpan)
  , Nu(D.Axes[A].Cells())
  , Nv(D.Axes[B].Cells())
{
  // The missing direction of the face has one span, which stands for this one of the volume.
  this->FirstSpan[this->Missing] = element;
}

SurfaceMesh Face::Tessellate()
{
  this->MeasureBends();
  this->LayOut();
  this->PlacePoints();
  this->Triangulate();
  if (this->Options.KnotLines)
  {
    this->DrawKnotLines();
  }
  this->EvaluatePoints();
  this->DropCollapsed();
  return std::move(this->Mesh);
}

void Face::PlacePoints()
{
  const ElementAxis& a = this->D.Axes[this->A];
  const ElementAxis& b = this->D.Axes[this->B];
  const auto place = [&](Id id, double u, double v)
  {
    this->Mesh.Parameters(static_cast<Eigen::Index>(this->A), id) = u;
    this->Mesh.Parameters(static_cast<Eigen::Index>(this->B), id) = v;
    this->Mesh.Parameters(static_cast<Eigen::Index>(this->Missing), id) = this->Fixed;
  };
  for (int j = 0; j <= this->Nv; ++j)
  {
    const double v = b.Breaks[static_cast<std::size_t>(j)];
    for (int i = 0; i <= this->Nu; ++i)
    {
      const double u = a.Breaks[static_cast<std::size_t>(i)];
      place(this->Corner(i, j), u, v);
      const std::size_t eu = i < this->Nu ? this->EdgeU(i, j) : 0;
      for (int k = 1; i < this->Nu && k < this->EdgeSegments[eu]; ++k)
      {
        place(this->FirstOnEdge[eu] + k - 1,
          a.At(i, static_cast<double>(k) / this->EdgeSegments[eu]), v);
      }
      const std::size_t ev = j < this->Nv ? this->EdgeV(i, j) : 0;
      for (int k = 1; j < this->Nv && k < this->EdgeSegments[ev]; ++k)
      {
        place(this->FirstOnEdge[ev] + k - 1, u,
          b.At(j, static_cast<double>(k) / this->EdgeSegments[ev]));
      }
    }
  }
  this->ForCells(
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      for (std::ptrdiff_t c = begin; c < end; ++c)
      {
        const auto& rows = this->Layouts[static_cast<std::size_t>(c)].Rows;
        Id id = this->FirstInside[static_cast<std::size_t>(c)];
        for (int q = 0; q < rows[1].Points; ++q)
        {
          for (int p = 0; p < rows[0].Points; ++p)
          {
            place(id++, a.At(static_cast<int>(c % this->Nu), rows[0].At(p)),
              b.At(static_cast<int>(c / this->Nu), rows[1].At(q)));
          }
        }
      }
    });
}

Id Face::OnEdge(int i, int j, std::size_t which, int k) const
{
  const std::size_t e = this->Edges(i, j)[which];
  const int di = which == 3 ? 1 : 0;
  const int dj = which == 1 ? 1 : 0;
  if (k == 0)
  {
    return this->Corner(i + di, j + dj);
  }
  if (k == this->EdgeSegments[e])
  {
    return which < 2 ? this->Corner(i + 1, j + dj) : this->Corner(i + di, j + 1);
  }
  return this->FirstOnEdge[e] + k - 1;
}

void Face::Triangulate()
{
  this->ForCells(
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      std::vector<std::pair<double, Id>> near;
      std::vector<std::pair<double, Id>> far;
      for (std::ptrdiff_t n = begin; n < end; ++n)
      {
        const auto c = static_cast<std::size_t>(n);
        const int i = static_cast<int>(n % this->Nu);
        const int j = static_cast<int>(n / this->Nu);
        const ElementLayout& layout = this->Layouts[c];
        const Eigen::Vector3i element = this->D.Element(this->Triple(i, j), this->FirstSpan);
        const auto& rows = layout.Rows;
        const auto edges = this->Edges(i, j);
        Id id = this->FirstTriangle[c];
        const auto emit = [&](Id p, Id q, Id r)
        {
          this->Mesh.TriangleElements.col(id) = element;
          this->Mesh.Triangles.col(id) << p, (this->Outward > 0.0 ? q : r),
            (this->Outward > 0.0 ? r : q);
          ++id;
        };
        const auto flipped = [&](Id p, Id q, Id r) { emit(p, r, q); };
        const auto fillEdge = [&](std::size_t which, std::vector<std::pair<double, Id>>& row)
        {
          row.clear();
          const int segments = this->EdgeSegments[edges[which]];
          for (int k = 0; k <= segments; ++k)
          {
            row.emplace_back(static_cast<double>(k) / segments, this->OnEdge(i, j, which, k));
          }
        };
        if (layout.Kind < 2)
        {
          fillEdge(layout.Kind == 0 ? 0 : 2, near);
          fillEdge(layout.Kind == 0 ? 1 : 3, far);
          if (layout.Kind == 0)
          {
            MergeRows(near, far, emit);
          }
          else
          {
            MergeRows(near, far, flipped);
          }
          continue;
        }
        const int nu = rows[0].Points;
        const int nv = rows[1].Points;
        const auto inside = [&](int p, int q)
        { return this->FirstInside[c] + p + static_cast<Id>(nu) * q; };
        for (std::size_t which = 0; which < 4; ++which)
        {
          fillEdge(which, near);
          far.clear();
          const int size = which < 2 ? nu : nv;
          for (int k = 0; k < size; ++k)
          {
            far.emplace_back(rows[which / 2].At(k),
              which == 0     ? inside(k, 0)
                : which == 1 ? inside(k, nv - 1)
                : which == 2 ? inside(0, k)
                             : inside(nu - 1, k));
          }
          // The inside lies on the left of the lower and of the right edge.
          if (which == 0 || which == 3)
          {
            MergeRows(near, far, emit);
          }
          else
          {
            MergeRows(near, far, flipped);
          }
        }
        for (int q = 0; q + 1 < nv; ++q)
        {
          for (int p = 0; p + 1 < nu; ++p)
          {
            emit(inside(p, q), inside(p + 1, q), inside(p + 1, q + 1));
            emit(inside(p, q), inside(p + 1, q + 1), inside(p, q + 1));
          }
        }
      }
    });
}

void Face::DrawKnotLines()
{
  std::vector<std::array<Id, 2>> lines;
  std::vector<Eigen::Vector3i> elements;
  const auto draw = [&](int i, int j, std::size_t which)
  {
    const int segments = this->EdgeSegments[this->Edges(i, j)[which]];
    for (int k = 0; k < segments; ++k)
    {
      lines.push_back({ this->OnEdge(i, j, which, k), this->OnEdge(i, j, which, k + 1) });
      elements.push_back(this->D.Element(this->Triple(i, j), this->FirstSpan));
    }
  };
  for (int j = 0; j < this->Nv; ++j)
  {
    for (int i = 0; i < this->Nu; ++i)
    {
      if (this->D.Axes[this->B].IsKnot[static_cast<std::size_t>(j)])
      {
        draw(i, j, 0);
      }
      if (this->D.Axes[this->A].IsKnot[static_cast<std::size_t>(i)])
      {
        draw(i, j, 2);
      }
      if (j + 1 == this->Nv)
      {
        draw(i, j, 1);
      }
      if (i + 1 == this->Nu)
      {
        draw(i, j, 3);
      }
    }
  }
  const auto count = static_cast<Eigen::Index>(lines.size());
  this->Mesh.Lines.resize(2, count);
  this->Mesh.LineElements.resize(3, count);
  this->Mesh.LineSides.assign(lines.size(), this->Side);
  for (Eigen::Index l = 0; l < count; ++l)
  {
    this->Mesh.Lines.col(l) << lines[static_cast<std::size_t>(l)][0],
      lines[static_cast<std::size_t>(l)][1];
    this->Mesh.LineElements.col(l) = elements[static_cast<std::size_t>(l)];
  }
}

Eigen::Vector3d Face::Cross(const double* derivatives) const
{
  const auto m = static_cast<std::size_t>(this->D.Splines[0].Components());
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  std::copy_n(derivatives + this->A * m, m, a.data());
  std::copy_n(derivatives + this->B * m, m, b.data());
  return a.cross(b);
}

Eigen::Vector3d Face::LimitNormal(
  const Evaluator& evaluator, const Eigen::Vector3d& parameters, double small) const
{
  double value[3];
  double derivatives[9];
  for (double inside : { 1e-6, 1e-3, 0.5 })
  {
    Eigen::Vector3d moved = parameters;
    for (std::size_t d : { this->A, this->B })
    {
      const ElementAxis& axis = this->D.Axes[d];
      double& u = moved[static_cast<Eigen::Index>(d)];
      u += inside * (axis.At(axis.Find(u), 0.5) - u);
    }
    evaluator.EvaluateWithDerivatives(1, moved.data(), value, derivatives);
    const Eigen::Vector3d normal = this->Cross(derivatives);
    if (normal.norm() > small)
    {
      return normal.normalized();
    }
  }
  return Eigen::Vector3d::UnitZ();
}

void Face::EvaluatePoints()
{
  SurfaceMesh& mesh = this->Mesh;
  const Eigen::Index count = mesh.Parameters.cols();
  const Spline& geometry = this->D.Splines[0];
  const auto m = static_cast<std::size_t>(geometry.Components());
  mesh.Points.setZero(3, count);
  mesh.Normals.resize(3, count);
  const Evaluator evaluator(geometry);
  const auto length = [&](std::size_t d)
  { return this->D.Axes[d].Breaks.back() - this->D.Axes[d].Breaks.front(); };
  const double size =
    (geometry.Coefficients().rowwise().maxCoeff() - geometry.Coefficients().rowwise().minCoeff())
      .norm();
  const double small = 1e-10 * size * size / (length(this->A) * length(this->B));
  // Blocks of points that stay in the cache.
  constexpr std::ptrdiff_t Block = 128;
  this->Options.For(count, 4 * Block,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      std::vector<double> values(m * Block);
      std::vector<double> derivatives(3 * m * Block);
      for (std::ptrdiff_t first = begin; first < end; first += Block)
      {
        const std::ptrdiff_t size1 = std::min(Block, end - first);
        evaluator.EvaluateWithDerivatives(static_cast<std::size_t>(size1),
          mesh.Parameters.col(first).data(), values.data(), derivatives.data());
        for (std::ptrdiff_t q = 0; q < size1; ++q)
        {
          const auto Q = static_cast<std::size_t>(q);
          std::copy_n(values.data() + m * Q, m, mesh.Points.col(first + q).data());
          Eigen::Vector3d normal = this->Cross(derivatives.data() + 3 * m * Q);
          normal = normal.norm() > small
            ? normal.normalized()
            : this->LimitNormal(evaluator, mesh.Parameters.col(first + q), small);
          mesh.Normals.col(first + q) = this->Outward * normal;
        }
      }
    });
  for (std::size_t s = 1; s < this->D.Splines.size(); ++s)
  {
    const Evaluator attribute(this->D.Splines[s]);
    Eigen::MatrixXd& values = mesh.Attributes.emplace_back(attribute.Components(), count);
    this->Options.For(count, 4 * Block,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        attribute.Evaluate(static_cast<std::size_t>(end - begin), mesh.Parameters.col(begin).data(),
          values.col(begin).data());
      });
  }
}

void Face::DropCollapsed()
{
  SurfaceMesh& mesh = this->Mesh;
  const double small = Coincident * this->D.Fields[0].Size;
  const auto coincide = [&](Id p, Id q)
  { return (mesh.Points.col(p) - mesh.Points.col(q)).norm() <= small; };
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    const Id p = mesh.Triangles(0, t);
    const Id q = mesh.Triangles(1, t);
    const Id r = mesh.Triangles(2, t);
    if (!coincide(p, q) && !coincide(q, r) && !coincide(r, p))
    {
      mesh.Triangles.col(kept) << p, q, r;
      mesh.TriangleElements.col(kept) = mesh.TriangleElements.col(t).eval();
      ++kept;
    }
  }
  mesh.Triangles.conservativeResize(3, kept);
  mesh.TriangleElements.conservativeResize(3, kept);
  mesh.TriangleSides.resize(static_cast<std::size_t>(kept));
  kept = 0;
  for (Eigen::Index l = 0; l < mesh.Lines.cols(); ++l)
  {
    if (!coincide(mesh.Lines(0, l), mesh.Lines(1, l)))
    {
      mesh.Lines.col(kept) = mesh.Lines.col(l).eval();
      mesh.LineElements.col(kept) = mesh.LineElements.col(l).eval();
      ++kept;
    }
  }
  mesh.Lines.conservativeResize(2, kept);
  mesh.LineElements.conservativeResize(3, kept);
  mesh.LineSides.resize(static_cast<std::size_t>(kept));
}

}
