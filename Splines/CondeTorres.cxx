// SPDX-License-Identifier: BSD-3-Clause
#include "CondeTorres.h"

#include "IntersectionTestWorker.h"
#include "Measures.h"
#include "ModelElementsWorker.h"
#include "OverlapsWorker.h"
#include "RoundingWorker.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>

namespace hyperpatch
{

namespace
{

/// Control points this close are one and the same, as a fraction of the diagonal.
constexpr double ContactTolerance = 1e-6;

bool IsUniformCubic(const KnotVector& knots)
{
  if (knots.Degree() != 3)
  {
    return false;
  }
  const std::vector<double>& k = knots.Knots();
  // The first and the last knot have no influence.
  const double step = (k[k.size() - 2] - k[1]) / static_cast<double>(k.size() - 3);
  for (std::size_t i = 2; i + 1 < k.size(); ++i)
  {
    if (std::abs(k[i] - k[i - 1] - step) > 1e-9 * step)
    {
      return false;
    }
  }
  return true;
}

CondeTorresForm FormOf(const Spline& geometry)
{
  const std::array<int, 3> p = geometry.Degrees();
  if (geometry.IsRational() || std::max({ p[0], p[1], p[2] }) > 3)
  {
    return CondeTorresForm::Bezier;
  }
  return std::all_of(geometry.Knots().begin(), geometry.Knots().end(), IsUniformCubic)
    ? CondeTorresForm::Uniform
    : CondeTorresForm::UniformElement;
}

/// Control points of a uniform cubic B-spline of one element from Bezier points of degree 1 to 3:
/// the inverse of b0 = (c0 + 4 c1 + c2) / 6, b1 = (2 c1 + c2) / 3 and their mirror images, after
/// degree elevation.
Eigen::MatrixXd UniformFromBezier(int degree)
{
  Eigen::Matrix4d uniform;
  uniform << 6, -7, 2, 0, 0, 2, -1, 0, 0, -1, 2, 0, 0, 2, -7, 6;
  Eigen::MatrixXd elevation(4, degree + 1);
  switch (degree)
  {
    case 1:
      elevation << 1, 0, 2.0 / 3, 1.0 / 3, 1.0 / 3, 2.0 / 3, 0, 1;
      break;
    case 2:
      elevation << 1, 0, 0, 1.0 / 3, 2.0 / 3, 0, 0, 2.0 / 3, 1.0 / 3, 0, 0, 1;
      break;
    default:
      elevation.setIdentity();
  }
  return uniform * elevation;
}

/// Applies a matrix to every row of points along a direction.
Eigen::Matrix3Xd Transformed(const Eigen::Matrix3Xd& points, std::array<int, 3>& sizes,
  int direction, const Eigen::MatrixXd& m)
{
  const auto d = static_cast<std::size_t>(direction);
  Eigen::Index stride = 1;
  for (std::size_t e = 0; e < d; ++e)
  {
    stride *= sizes[e];
  }
  const Eigen::Index n = sizes[d];
  Eigen::Matrix3Xd result(3, points.cols() / n * m.rows());
  for (Eigen::Index slab = 0; slab * stride * n < points.cols(); ++slab)
  {
    for (Eigen::Index i = 0; i < stride; ++i)
    {
      for (Eigen::Index r = 0; r < m.rows(); ++r)
      {
        auto target = result.col((slab * m.rows() + r) * stride + i);
        target.setZero();
        for (Eigen::Index c = 0; c < n; ++c)
        {
          target += m(r, c) * points.col((slab * n + c) * stride + i);
        }
      }
    }
  }
  sizes[d] = static_cast<int>(m.rows());
  return result;
}

/// A lattice of control points.
struct Lattice
{
  Eigen::Matrix3Xd Points;
  std::array<int, 3> Sizes;
};

/// What the paper's test looks at for an element.
Lattice LatticeOf(const ModelElement& element, const Spline& geometry, CondeTorresForm form)
{
  Lattice lattice{ element.Piece.Projected(), element.Piece.Degrees() };
  for (std::size_t d = 0; d < 3; ++d)
  {
    ++lattice.Sizes[d];
  }
  if (form == CondeTorresForm::UniformElement)
  {
    for (int d = 0; d < 3; ++d)
    {
      lattice.Points =
        Transformed(lattice.Points, lattice.Sizes, d, UniformFromBezier(element.Piece.Degree(d)));
    }
  }
  else if (form == CondeTorresForm::Uniform)
  {
    std::array<int, 3> first;
    for (int d = 0; d < 3; ++d)
    {
      first[static_cast<std::size_t>(d)] =
        geometry.Knots(d).FindSpan(element.Low[static_cast<std::size_t>(d)]) - 3;
    }
    const std::array<int, 3> n = geometry.Sizes();
    for (int i = 0; i < 64; ++i)
    {
      lattice.Points.col(i) = geometry.Coefficients().col(first[0] + i % 4 +
        n[0] * (first[1] + i / 4 % 4 + static_cast<Eigen::Index>(n[1]) * (first[2] + i / 16)));
    }
  }
  return lattice;
}

bool RowsAreOrdered(const Eigen::Matrix3Xd& points, const std::array<int, 3>& sizes)
{
  // What conversion between bases rounds is no turn.
  const double slack = 64 * rounding::U * points.cwiseAbs().maxCoeff();
  Eigen::Index stride = 1;
  for (const int n : sizes)
  {
    for (Eigen::Index i = 0; i < points.cols(); ++i)
    {
      if (i / stride % n != 0)
      {
        continue;
      }
      for (Eigen::Index c = 0; c < 3; ++c)
      {
        bool ascends = true;
        bool descends = true;
        for (Eigen::Index q = 1; q < n; ++q)
        {
          const double before = points(c, i + (q - 1) * stride);
          const double after = points(c, i + q * stride);
          ascends = ascends && before <= after + slack;
          descends = descends && before >= after - slack;
        }
        if (!ascends && !descends)
        {
          return false;
        }
      }
    }
    stride *= n;
  }
  return true;
}

/// The bilinear patches of a slice across a direction.
std::vector<BezierPiece> Skin(
  const Eigen::Matrix3Xd& points, const std::array<int, 3>& sizes, int direction, int slice)
{
  const std::array<Eigen::Index, 3> strides{ 1, sizes[0],
    static_cast<Eigen::Index>(sizes[0]) * sizes[1] };
  const auto d = static_cast<std::size_t>(direction);
  const std::size_t e = d == 0 ? 1 : 0;
  const std::size_t f = d == 2 ? 1 : 2;
  std::array<int, 3> degrees{ 1, 1, 1 };
  degrees[d] = 0;
  std::vector<BezierPiece> patches;
  for (int j = 0; j + 1 < sizes[f]; ++j)
  {
    for (int i = 0; i + 1 < sizes[e]; ++i)
    {
      const Eigen::Index at = slice * strides[d] + i * strides[e] + j * strides[f];
      Eigen::MatrixXd corners(3, 4);
      corners << points.col(at), points.col(at + strides[e]), points.col(at + strides[f]),
        points.col(at + strides[e] + strides[f]);
      patches.emplace_back(degrees, corners, 0.0);
    }
  }
  return patches;
}

/// Whether the test does not show that patches of two skins are disjoint.
bool SkinsMeet(const std::vector<BezierPiece>& a, const std::vector<BezierPiece>& b, int maxTests)
{
  IntersectionTest test(maxTests);
  for (const BezierPiece& pa : a)
  {
    for (const BezierPiece& pb : b)
    {
      if (!BoxesAreDisjoint(pa, pb) && !test.MeetOnlyAtContacts({ pa }, { pb }, {}))
      {
        return true;
      }
    }
  }
  return false;
}

bool ParallelSkinsMeet(
  const Eigen::Matrix3Xd& points, const std::array<int, 3>& sizes, int maxTests)
{
  for (int d = 0; d < 3; ++d)
  {
    std::vector<std::vector<BezierPiece>> skins;
    for (int slice = 0; slice < sizes[static_cast<std::size_t>(d)]; ++slice)
    {
      skins.push_back(Skin(points, sizes, d, slice));
      for (int other = 0; other < slice; ++other)
      {
        if (SkinsMeet(skins.back(), skins[static_cast<std::size_t>(other)], maxTests))
        {
          return true;
        }
      }
    }
  }
  return false;
}

/// How far apart two elements are in their patch: in total, and in one direction. Cells that are
/// not of one patch are far apart.
std::array<int, 2> ElementsBetween(const ModelElement& a, const ModelElement& b)
{
  std::array<int, 2> apart{ INT_MAX, INT_MAX };
  if (const auto offset = LatticeOffset(a, b))
  {
    const auto [u, v, w] = *offset;
    apart = { std::abs(u) + std::abs(v) + std::abs(w),
      std::max({ std::abs(u), std::abs(v), std::abs(w) }) };
  }
  return apart;
}

}

CondeTorresResult TestCondeTorresLattice(
  const Eigen::Matrix3Xd& points, std::array<int, 3> sizes, int maxTests)
{
  if (!RowsAreOrdered(points, sizes))
  {
    return CondeTorresResult::SpanNotOrdered;
  }
  return ParallelSkinsMeet(points, sizes, maxTests) ? CondeTorresResult::SkinsMeet
                                                    : CondeTorresResult::Passes;
}

CondeTorres TestCondeTorres(const MultiPatch& model, const ParallelFor& parallelFor, int maxTests)
{
  const Bounds bounds = ControlPointBounds(model);
  const double distance = ContactTolerance *
    std::hypot(bounds.High[0] - bounds.Low[0], bounds.High[1] - bounds.Low[1],
      bounds.High[2] - bounds.Low[2]);
  const std::vector<ModelElement> elements = MakeElements(model, distance, parallelFor);
  CondeTorres result;
  for (const Patch& patch : model.Patches)
  {
    result.Forms.push_back(FormOf(patch.Body.Geometry()));
  }

  // The elements by themselves.
  const auto n = static_cast<std::ptrdiff_t>(elements.size());
  result.Elements.resize(elements.size());
  std::vector<BezierPiece> lattices(elements.size());
  parallelFor(n, 16,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      for (std::ptrdiff_t i = begin; i < end; ++i)
      {
        const auto e = static_cast<std::size_t>(i);
        const std::size_t patch = elements[e].Patch;
        const Lattice lattice =
          LatticeOf(elements[e], model.Patches[patch].Body.Geometry(), result.Forms[patch]);
        result.Elements[e] = TestCondeTorresLattice(lattice.Points, lattice.Sizes, maxTests);
        // Only its hull is asked for.
        lattices[e] =
          BezierPiece({ lattice.Sizes[0] - 1, lattice.Sizes[1] - 1, lattice.Sizes[2] - 1 },
            lattice.Points, 0.0);
      }
    });

  // Pairs within a patch: 1. boxes.
  Eigen::Matrix3Xd low(3, n);
  Eigen::Matrix3Xd high(3, n);
  std::map<int, std::size_t> sizes;
  for (std::ptrdiff_t i = 0; i < n; ++i)
  {
    const auto e = static_cast<std::size_t>(i);
    low.col(i) = lattices[e].BoxLow();
    high.col(i) = lattices[e].BoxHigh();
    result.Pairs.ByBoxes += sizes[elements[e].PatchId]++;
  }
  std::vector<std::array<int, 2>> pairs = FindOverlaps(low, high);
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                [&elements](const std::array<int, 2>& pair)
                {
                  return elements[static_cast<std::size_t>(pair[0])].PatchId !=
                    elements[static_cast<std::size_t>(pair[1])].PatchId;
                }),
    pairs.end());
  result.Pairs.ByBoxes -= pairs.size();

  // 2. hulls, 3. borders.
  const std::vector<CondeTorresResult> own = result.Elements;
  std::mutex mutex;
  parallelFor(static_cast<std::ptrdiff_t>(pairs.size()), 64,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      IntersectionTest test(maxTests);
      CondeTorresPairs found;
      std::vector<std::array<int, 2>> meeting;
      for (std::ptrdiff_t i = begin; i < end; ++i)
      {
        const auto a = static_cast<std::size_t>(pairs[static_cast<std::size_t>(i)][0]);
        const auto b = static_cast<std::size_t>(pairs[static_cast<std::size_t>(i)][1]);
        const auto [inTotal, inOneDirection] = ElementsBetween(elements[a], elements[b]);
        // Neighbours that share control points, or would if the knots were uniform.
        const int reach = result.Forms[elements[a].Patch] == CondeTorresForm::Bezier ? 1 : 3;
        const bool sharePoints = inOneDirection <= reach;
        if (inTotal == 1)
        {
          ++found.Contiguous;
        }
        else if (own[a] != CondeTorresResult::Passes && own[b] != CondeTorresResult::Passes)
        {
          ++found.Failed;
        }
        else if (!sharePoints && HullsAreDisjoint(lattices[a], lattices[b], 50))
        {
          ++found.ByHulls;
        }
        else if (AreSeparated(elements[a].Piece, elements[b].Piece) ||
          test.MeetOnlyAtContacts({ elements[a].Piece, elements[a].Collapsed },
            { elements[b].Piece, elements[b].Collapsed },
            ContactsOf(elements[a], elements[b], distance)))
        {
          ++found.ByBorders;
        }
        else
        {
          ++found.Meeting;
          meeting.push_back(pairs[static_cast<std::size_t>(i)]);
        }
      }
      const std::lock_guard<std::mutex> lock(mutex);
      result.Pairs.Contiguous += found.Contiguous;
      result.Pairs.Failed += found.Failed;
      result.Pairs.ByHulls += found.ByHulls;
      result.Pairs.ByBorders += found.ByBorders;
      result.Pairs.Meeting += found.Meeting;
      for (const std::array<int, 2>& pair : meeting)
      {
        for (const int e : pair)
        {
          CondeTorresResult& element = result.Elements[static_cast<std::size_t>(e)];
          element =
            element == CondeTorresResult::Passes ? CondeTorresResult::MeetsElement : element;
        }
      }
    });
  return result;
}

}
