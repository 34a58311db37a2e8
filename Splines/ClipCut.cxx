// SPDX-License-Identifier: BSD-3-Clause
// How the refined simplices of a clip are cut, and what becomes of them.
#include "ClipWorker.h"
#include "NumberingWorker.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace hyperpatch
{

bool ClipWorker::BeginCut()
{
  const int dimension = this->Simplices->Dimension();
  const auto& cells = this->Simplices->Cells();
  this->P.emplace(this->M.Body, this->M.Fields, dimension);
  // Cells that are not decided, and those around them: their corners may be moved.
  const auto nodes = static_cast<std::size_t>(this->Simplices->NumberOfNodes());
  std::vector<char> isNear(nodes, 0);
  for (const Cell& cell : cells)
  {
    for (int c = 0; c <= dimension && !this->IsDecided(cell.State); ++c)
    {
      isNear[Corner(cell, c)] = 1;
    }
  }
  this->IsCut.assign(cells.size(), 0);
  this->PointOfNode.assign(nodes, -1);
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    if (i % Step == 0 && this->M.Options.Abort())
    {
      return false;
    }
    for (int c = 0; c <= dimension; ++c)
    {
      this->IsCut[i] = this->IsCut[i] || isNear[Corner(cells[i], c)];
    }
    if (!this->IsCut[i])
    {
      continue;
    }
    SimplexCut::Cell piece{ {}, static_cast<std::int64_t>(i), 0 };
    for (int c = 0; c <= dimension; ++c)
    {
      const std::size_t node = Corner(cells[i], c);
      SimplexCut::Index& point = this->PointOfNode[node];
      if (point < 0)
      {
        const Eigen::Vector3d& u = this->Simplices->Parameter(static_cast<int>(node));
        unsigned fixed = this->IsShared[node] ? SimplexCut::Immovable : 0;
        for (int d = 0; d < 3 && fixed != SimplexCut::Immovable; ++d)
        {
          const std::vector<double>& creases = this->Creases[static_cast<std::size_t>(d)];
          fixed |= std::binary_search(creases.begin(), creases.end(), u[d]) ? 1u << d : 0;
        }
        unsigned on = 0;
        for (std::size_t k = 0; k < this->M.Fields.size(); ++k)
        {
          on |= this->HasBothSigns(k, static_cast<int>(node)) ? 1u << k : 0;
        }
        point = this->P->AddPoint(
          this->Simplices->At(static_cast<int>(node)), this->Points[node], on, fixed);
      }
      piece.Corners[static_cast<std::size_t>(c)] = point;
    }
    if (dimension == 3 && this->M.Options.Handedness < 0)
    {
      std::swap(piece.Corners[0], piece.Corners[1]);
    }
    this->P->AddCell(piece);
  }
  return true;
}

std::vector<double> ClipWorker::PieceErrors() const
{
  const int dimension = this->Simplices->Dimension();
  const auto& pieces = this->P->Cells();
  const auto& x = this->P->Points();
  Numbering numbers;
  std::vector<std::array<std::size_t, 2>> edges;
  std::vector<std::size_t> edgesOf;
  for (const SimplexCut::Cell& piece : pieces)
  {
    for (int e = 0; e < SimplexRefinement::NumberOfEdges(dimension); ++e)
    {
      const auto end = [&](int i)
      {
        return static_cast<std::size_t>(
          piece.Corners[static_cast<std::size_t>(SimplexRefinement::Edges[e][i])]);
      };
      const std::size_t a = std::min(end(0), end(1));
      const std::size_t b = std::max(end(0), end(1));
      const auto [number, isNew] =
        numbers.Number({ static_cast<int>(a), static_cast<int>(b), 0, 0 });
      if (isNew)
      {
        edges.push_back({ a, b });
      }
      edgesOf.push_back(static_cast<std::size_t>(number));
    }
  }
  std::vector<double> errors(edges.size());
  const auto m = static_cast<std::size_t>(this->M.Body->Geometry()->Spline().Components());
  this->M.Options.For(static_cast<std::ptrdiff_t>(edges.size()), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      const auto first = static_cast<std::size_t>(begin);
      const auto count = static_cast<std::size_t>(end - begin);
      std::vector<Eigen::Vector3d> middles;
      for (std::size_t i = first; i < first + count; ++i)
      {
        middles.push_back(
          hyperpatch::Middle(this->P->At(static_cast<SimplexCut::Index>(edges[i][0])),
            this->P->At(static_cast<SimplexCut::Index>(edges[i][1])))
            .Values);
      }
      std::vector<double> exact(m * count);
      this->M.Body->Geometry()->Evaluator().Evaluate(count, middles.front().data(), exact.data());
      for (std::size_t i = first; i < first + count; ++i)
      {
        Eigen::Vector3d miss = -0.5 * (x[edges[i][0]] + x[edges[i][1]]);
        for (std::size_t c = 0; c < m; ++c)
        {
          miss[static_cast<Eigen::Index>(c)] += exact[m * (i - first) + c];
        }
        errors[i] = miss.norm();
      }
    });
  std::vector<double> worst(this->Simplices->Cells().size(), 0.0);
  const auto count = static_cast<std::size_t>(SimplexRefinement::NumberOfEdges(dimension));
  for (std::size_t i = 0; i < edgesOf.size(); ++i)
  {
    double& own = worst[static_cast<std::size_t>(pieces[i / count].Origin)];
    own = std::max(own, errors[edgesOf[i]]);
  }
  return worst;
}

bool ClipWorker::MarkBadCuts()
{
  const auto& cells = this->Simplices->Cells();
  std::vector<char> isWrong(cells.size(), 0);
  std::vector<char> isTurned(cells.size(), 0);
  const std::vector<double> errors = this->PieceErrors();
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    isWrong[i] = errors[i] > CutTarget * this->M.Options.Tolerance;
  }
  for (const Facet& facet : this->CutFacets())
  {
    isWrong[facet.Cell] =
      isWrong[facet.Cell] || facet.Error > CutTarget * this->M.Options.Tolerance;
  }
  for (const SimplexCut::Cell& piece : this->P->Cells())
  {
    if (this->Simplices->Dimension() < 3)
    {
      break;
    }
    const auto i = static_cast<std::size_t>(piece.Origin);
    const auto at = [&](int c) -> const Eigen::Vector3d& {
      return this->P
        ->Points()[static_cast<std::size_t>(piece.Corners[static_cast<std::size_t>(c)])];
    };
    isTurned[i] =
      isTurned[i] || (SixVolumes(at) <= 0.0 && !this->Vanishes(at) && this->IsRegular(cells[i]));
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    if (isTurned[i] || (isWrong[i] && this->Width(cells[i]) > this->M.Options.Tolerance))
    {
      this->MarkEdges(
        cells[i], isTurned[i] ? this->MostBentEdge(cells[i]) : this->LongestEdge(cells[i]));
    }
  }
  return !this->M.Options.Abort();
}

void ClipWorker::Certify(ZeroSetCertificate& certificate) const
{
  const double tolerance = this->M.Options.Tolerance;
  const auto& cells = this->Simplices->Cells();
  std::mutex mutex;
  this->M.Options.For(static_cast<std::ptrdiff_t>(cells.size()), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      ZeroSetCertificate own;
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      {
        const Cell& cell = cells[i];
        bool isUndecided = false;
        bool isCertified = false;
        for (std::size_t k = 0; k < this->M.Fields.size(); ++k)
        {
          if (SideOf(cell.State, k) == Side::Unknown)
          {
            (VerdictOf(cell.State, k) == Verdict::Sheet ? isCertified : isUndecided) = true;
          }
        }
        const bool hasJump = !this->IsDroppedByCorners(cell) && this->Jump(cell) > 1.0;
        isUndecided = isUndecided || hasJump;
        own.UndecidedCells += isUndecided ? 1 : 0;
        own.CertifiedCells += isCertified && !isUndecided ? 1 : 0;
        if (this->IsDroppedByCorners(cell))
        {
          continue;
        }
        const Bound bound = this->BoundError(cell);
        const bool isMeasured = !bound.IsCertain && cell.Middles[0] >= 0;
        own.LargestError = std::max(own.LargestError,
          tolerance * (isMeasured ? this->PositionError(cell).Largest : bound.Position));
        own.LargestAttributeError = std::max(own.LargestAttributeError,
          hasJump        ? 0.0
            : isMeasured ? this->AttributeError(cell).Largest
                         : bound.Attribute);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      certificate.Add(own);
    });
  for (const Facet& facet : this->CutFacets())
  {
    certificate.LargestError = std::max(certificate.LargestError, facet.Error);
  }
  for (const double error : this->PieceErrors())
  {
    certificate.LargestError = std::max(certificate.LargestError, error);
  }
  certificate.UndecidedCells += this->Sampled;
  certificate.LargestResidual = this->P->LargestResidual();
  certificate.ToleranceReached = !this->IsCapped && certificate.LargestError <= tolerance &&
    certificate.LargestAttributeError <= 1.0;
}

bool ClipWorker::Assemble()
{
  const int dimension = this->Simplices->Dimension();
  const auto n = static_cast<std::size_t>(dimension) + 1;
  this->Certify(this->Result.Certificate);

  // Points of pieces, then nodes of the cells besides.
  const auto& points = this->P->Points();
  const auto cutPoints = static_cast<std::int64_t>(points.size());
  const auto pointAt = [&](std::int64_t i) -> const Eigen::Vector3d&
  {
    return i < cutPoints ? points[static_cast<std::size_t>(i)]
                         : this->Points[static_cast<std::size_t>(i - cutPoints)];
  };
  std::vector<SimplexCut::Cell> cells;
  const auto add = [&](const SimplexCut::Cell& cell)
  {
    const auto at = [&](int c) -> const Eigen::Vector3d&
    { return pointAt(cell.Corners[static_cast<std::size_t>(c)]); };
    if (!this->Vanishes(at))
    {
      cells.push_back(cell);
      // Of folds it has to be.
      const bool isTurnedOver = dimension == 3 && SixVolumes(at) <= 0.0 &&
        !this->IsFolded(this->Simplices->Cells()[static_cast<std::size_t>(cell.Origin)]);
      this->Result.Certificate.UndecidedCells += isTurnedOver ? 1 : 0;
    }
  };
  for (const SimplexCut::Cell& piece : this->P->Cells())
  {
    if (this->M.Options.KeepInside || piece.Outside != 0)
    {
      add(piece);
    }
  }
  for (std::size_t i = 0; i < this->Simplices->Cells().size(); ++i)
  {
    if (i % Step == 0 && this->M.Options.Abort())
    {
      return false;
    }
    if (this->IsCut[i])
    {
      continue;
    }
    SimplexCut::Cell cell{ {}, static_cast<std::int64_t>(i), 0 };
    for (std::size_t c = 0; c < n; ++c)
    {
      const std::size_t node = Corner(this->Simplices->Cells()[i], static_cast<int>(c));
      const SimplexCut::Index point = this->PointOfNode[node];
      cell.Corners[c] = point >= 0 ? point : cutPoints + static_cast<std::int64_t>(node);
    }
    if (dimension == 3 && this->M.Options.Handedness < 0)
    {
      std::swap(cell.Corners[0], cell.Corners[1]);
    }
    add(cell);
  }

  ClipMesh& mesh = this->Result;
  const auto& axes = this->B->Axes();
  const std::array<int, 2> size{ axes[0].Cells(), axes[1].Cells() };
  std::vector<std::int64_t> numberOf(points.size() + this->Points.size(), -1);
  std::vector<std::int64_t> used;
  mesh.Cells.resize(dimension + 1, static_cast<Eigen::Index>(cells.size()));
  mesh.Elements.resize(3, mesh.Cells.cols());
  for (std::size_t c = 0; c < cells.size(); ++c)
  {
    if (c % Step == 0 && this->M.Options.Abort())
    {
      return false;
    }
    const auto at = static_cast<Eigen::Index>(c);
    for (std::size_t i = 0; i < n; ++i)
    {
      std::int64_t& number = numberOf[static_cast<std::size_t>(cells[c].Corners[i])];
      if (number < 0)
      {
        number = static_cast<std::int64_t>(used.size());
        used.push_back(cells[c].Corners[i]);
      }
      mesh.Cells(static_cast<Eigen::Index>(i), at) = number;
    }
    const int root = this->Simplices->Cells()[static_cast<std::size_t>(cells[c].Origin)].Root;
    const std::array<int, 3> element{ root % size[0], root / size[0] % size[1],
      root / (size[0] * size[1]) };
    for (std::size_t d = 0; d < 3; ++d)
    {
      mesh.Elements(static_cast<Eigen::Index>(d), at) =
        axes[d].Spans[0][static_cast<std::size_t>(element[d])];
    }
  }
  const auto count = static_cast<Eigen::Index>(used.size());
  mesh.Parameters.resize(3, count);
  mesh.Points.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    if (i % static_cast<Eigen::Index>(Step) == 0 && this->M.Options.Abort())
    {
      return false;
    }
    const std::int64_t point = used[static_cast<std::size_t>(i)];
    mesh.Points.col(i) = pointAt(point);
    mesh.Parameters.col(i) = point < cutPoints
      ? this->P->Parameters()[static_cast<std::size_t>(point)]
      : this->Simplices->Parameter(static_cast<int>(point - cutPoints));
  }
  for (const auto& attribute : this->M.Body->Attributes())
  {
    Eigen::MatrixXd& values = mesh.Attributes.emplace_back(attribute->Spline().Components(), count);
    this->M.Options.For(count, Grain,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        attribute->Evaluator().Evaluate(static_cast<std::size_t>(end - begin),
          mesh.Parameters.col(begin).data(), values.col(begin).data());
      });
  }
  return true;
}

std::vector<ClipWorker::Facet> ClipWorker::CutFacets() const
{
  // The facets of one cell alone that lie on a zero set, but for those in a side of the patch.
  const int dimension = this->Simplices->Dimension();
  const int m = this->M.Body->Geometry()->Spline().Components();
  struct Corners
  {
    std::array<int, 3> Points; ///< -1 where there are fewer
    std::size_t Field;
    int Cells;
  };
  std::vector<Corners> corners;
  std::vector<Facet> facets;
  Numbering numbers;
  for (const SimplexCut::Cell& cell : this->P->Cells())
  {
    if (!this->M.Options.KeepInside && cell.Outside == 0)
    {
      continue;
    }
    for (int left = 0; left <= dimension && dimension > 1; ++left)
    {
      unsigned on = ~0u;
      std::array<int, 3> points{ -1, -1, -1 };
      std::size_t used = 0;
      for (int c = 0; c <= dimension; ++c)
      {
        const SimplexCut::Index point = cell.Corners[static_cast<std::size_t>(c)];
        if (c != left)
        {
          on &= this->P->On()[static_cast<std::size_t>(point)];
          points[used++] = static_cast<int>(point);
        }
      }
      if (on == 0)
      {
        continue;
      }
      std::sort(points.begin(), points.end());
      const auto [number, isNew] = numbers.Number({ points[0], points[1], points[2], 0 });
      if (isNew)
      {
        facets.push_back({ 0.0, static_cast<std::size_t>(cell.Origin) });
        corners.push_back({ points, 0, 0 });
        while (!(on >> corners.back().Field & 1))
        {
          ++corners.back().Field;
        }
      }
      ++corners[static_cast<std::size_t>(number)].Cells;
    }
  }
  // Those that are not there come first.
  const auto point = [&corners, dimension](std::size_t f, int i)
  {
    return static_cast<std::size_t>(corners[f].Points[static_cast<std::size_t>(3 - dimension + i)]);
  };
  this->M.Options.For(static_cast<std::ptrdiff_t>(facets.size()), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      Eigen::MatrixXd derivatives(m, 3);
      Eigen::VectorXd exact(m);
      for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f)
      {
        std::array<FreeParameters, 3> places;
        for (int i = 0; i < dimension; ++i)
        {
          places[static_cast<std::size_t>(i)] =
            this->P->At(static_cast<SimplexCut::Index>(point(f, i)));
        }
        std::array<FreeParameters, 3> filled = places;
        FillFree(filled.data(), dimension);
        Eigen::AlignedBox3d box;
        for (std::size_t i = 0; i < static_cast<std::size_t>(dimension); ++i)
        {
          box.extend(filled[i].Values);
        }
        bool isInSide = false;
        for (std::size_t d = 0; d < 3; ++d)
        {
          const auto at = static_cast<Eigen::Index>(d);
          isInSide = isInSide ||
            (this->M.On->Body.Geometry().Knots()[d].Degree() > 0 &&
              box.min()[at] == box.max()[at] &&
              (box.min()[at] == this->Lines[d].front() || box.min()[at] == this->Lines[d].back()));
        }
        if (corners[f].Cells > 1 || isInSide)
        {
          continue;
        }
        // In the middle, and in those of the edges.
        for (int left = -1; left < (dimension == 3 ? 3 : 0); ++left)
        {
          Eigen::Vector3d x = Eigen::Vector3d::Zero();
          const double share = 1.0 / (left < 0 ? dimension : dimension - 1);
          std::array<double, 3> shares{};
          for (int i = 0; i < dimension; ++i)
          {
            shares[static_cast<std::size_t>(i)] = i == left ? 0.0 : share;
            x += i == left ? 0.0 * x : share * this->P->Points()[point(f, i)];
          }
          const Eigen::Vector3d u = Between(places.data(), shares.data(), dimension).Values;
          double value = 0.0;
          Eigen::Vector3d gradient;
          this->M.Fields[corners[f].Field]->EvaluateWithGradient(
            1, u.data(), &value, gradient.data());
          this->M.Body->Geometry()->Evaluator().EvaluateWithDerivatives(
            1, u.data(), exact.data(), derivatives.data());
          const Eigen::VectorXd physical =
            derivatives.transpose().completeOrthogonalDecomposition().solve(gradient);
          double miss = value;
          for (int c = 0; c < m; ++c)
          {
            miss -= physical[c] * (exact[c] - x[c]);
          }
          const double slope = physical.norm();
          facets[f].Error = std::max(facets[f].Error, slope > 0.0 ? std::abs(miss) / slope : 0.0);
        }
      }
    });
  return facets;
}

}
