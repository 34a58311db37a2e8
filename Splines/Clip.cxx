// SPDX-License-Identifier: BSD-3-Clause
#include "Clip.h"

#include "ClipWorker.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hyperpatch
{

ClipWorker::ClipWorker(const Patch& patch, std::shared_ptr<const PreparedAggregate> body,
  std::vector<std::shared_ptr<const ScalarField>> fields, const ClipOptions& options)
  : P(patch)
  , Body(std::move(body))
  , Fields(std::move(fields))
  , Options(options)
{
  TessellationOptions grid;
  grid.Tolerance = options.Tolerance;
  grid.AttributeTolerances = options.AttributeTolerances;
  grid.For = options.For;
  this->Grid = options.Grid ? *options.Grid : MakeSolidGrid(patch, grid);
  const auto degrees = patch.Body.Geometry().Degrees();
  this->Mesh.emplace(
    this->Grid.Lines, std::array<bool, 3>{ degrees[0] > 0, degrees[1] > 0, degrees[2] > 0 });
  this->Values.resize(this->Fields.size());
  this->Attributes.resize(patch.Body.Attributes().size());
  const auto addCreases = [this](const Spline& spline)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const KnotVector& knots = spline.Knots()[d];
      std::vector<double>& all = this->Creases[d];
      all.insert(all.end(), { knots.First(), knots.Last() });
      const std::vector<double> creases = knots.Creases();
      all.insert(all.end(), creases.begin(), creases.end());
      std::sort(all.begin(), all.end());
    }
  };
  addCreases(patch.Body.Geometry());
  for (const Attribute& attribute : patch.Body.Attributes())
  {
    addCreases(attribute.Field);
  }
  this->IsNew.assign(this->Mesh->Cells().size(), 1);
  this->EvaluateNodes();
  Eigen::AlignedBox3d bounds;
  for (const Cell& cell : this->Mesh->Cells())
  {
    bounds.extend(this->Points[Corner(cell, 0)]);
  }
  this->DomainWidth = bounds.diagonal().norm();
}

void ClipWorker::EvaluateNodes()
{
  const std::size_t first = this->Points.size();
  const auto count = static_cast<std::size_t>(this->Mesh->NumberOfNodes());
  this->Points.resize(count, Eigen::Vector3d::Zero());
  for (auto& values : this->Values)
  {
    values.resize(count);
  }
  const auto& geometry = *this->Body->Geometry();
  const auto m = static_cast<std::size_t>(geometry.Spline().Components());
  const auto& attributes = this->Body->Attributes();
  for (std::size_t a = 0; a < attributes.size(); ++a)
  {
    this->Attributes[a].resize(
      count * static_cast<std::size_t>(attributes[a]->Spline().Components()));
  }
  this->Options.For(static_cast<std::ptrdiff_t>(count - first), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      const std::size_t b = first + static_cast<std::size_t>(begin);
      const auto n = static_cast<std::size_t>(end - begin);
      const double* u = this->Mesh->Parameter(static_cast<int>(b)).data();
      std::vector<double> x(m * n);
      geometry.Evaluator().Evaluate(n, u, x.data());
      for (std::size_t i = 0; i < n; ++i)
      {
        std::copy_n(&x[m * i], m, this->Points[b + i].data());
      }
      for (std::size_t k = 0; k < this->Fields.size(); ++k)
      {
        this->Fields[k]->Evaluate(n, u, &this->Values[k][b]);
      }
      for (std::size_t a = 0; a < attributes.size(); ++a)
      {
        const auto components = static_cast<std::size_t>(attributes[a]->Spline().Components());
        attributes[a]->Evaluator().Evaluate(n, u, &this->Attributes[a][components * b]);
      }
    });
  this->Lengths.resize(count);
  const auto& cells = this->Mesh->Cells();
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    for (int e = 0; e < SimplexRefinement::NumberOfEdges(this->Mesh->Dimension()) && this->IsNew[i];
         ++e)
    {
      this->Lengths[Middle(cells[i], e)] =
        (this->Points[End(cells[i], e, 0)] - this->Points[End(cells[i], e, 1)]).norm();
    }
  }
}

void ClipWorker::Decide(Cell& cell, std::size_t field, BoxSpline& f) const
{
  const auto set = [&cell, field](Side side, Verdict verdict)
  {
    cell.State &= ~(15u << (4 * field));
    cell.State |= (static_cast<unsigned>(side) | static_cast<unsigned>(verdict) << 2)
      << (4 * field);
  };
  const int dimension = this->Mesh->Dimension();
  const std::vector<double>& values = this->Values[field];
  double low = values[Corner(cell, 0)];
  double high = low;
  const auto extend = [&](std::size_t node)
  {
    low = std::min(low, values[node]);
    high = std::max(high, values[node]);
  };
  ParameterBox box{};
  for (int c = 0; c <= dimension; ++c)
  {
    extend(Corner(cell, c));
    const Eigen::Vector3d& u = this->Mesh->Parameter(cell.Corners[static_cast<std::size_t>(c)]);
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double at = u[static_cast<Eigen::Index>(d)];
      box.Low[d] = c == 0 ? at : std::min(box.Low[d], at);
      box.High[d] = c == 0 ? at : std::max(box.High[d], at);
    }
  }
  const ScalarField& own = *this->Fields[field];
  if (!own.HasBounds())
  {
    for (int e = 0; e < SimplexRefinement::NumberOfEdges(dimension); ++e)
    {
      extend(Middle(cell, e));
    }
    const bool isNarrow = this->Width(cell) <= this->DomainWidth / SampledDivisions;
    set(isNarrow && (low > 0.0 || high < 0.0) ? (low > 0.0 ? Side::Outside : Side::Inside)
                                              : Side::Unknown,
      Verdict::Open);
    return;
  }
  const auto& knots = this->P.Body.Geometry().Knots();
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (knots[d].Degree() == 0)
    {
      box.Low[d] = knots[d].First();
      box.High[d] = knots[d].Last();
    }
  }
  constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };
  bool isZero = !own.Excludes(box);
  // What is one sheet in a box is one in its parts.
  Verdict verdict = VerdictOf(cell, field);
  if (isZero && verdict != Verdict::Sheet && own.Restrict(box, f))
  {
    isZero = f.Values(Everywhere).Contains(0.0);
    verdict = f.Vanishes(Everywhere) || f.IsLostInNoise() ? Verdict::Lost : Verdict::Open;
    for (int d = 0; d < 3 && verdict == Verdict::Open; ++d)
    {
      verdict = f.Derivative(d, Everywhere).Contains(0.0) ? verdict : Verdict::Sheet;
    }
  }
  set(isZero ? Side::Unknown : high > 0.0 ? Side::Outside : Side::Inside, verdict);
}

void ClipWorker::Decide()
{
  auto& cells = this->Mesh->Cells();
  this->Options.For(static_cast<std::ptrdiff_t>(cells.size()), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      BoxSpline f;
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      {
        for (std::size_t k = 0; k < this->Fields.size() && this->IsNew[i]; ++k)
        {
          if (SideOf(cells[i], k) == Side::Unknown)
          {
            this->Decide(cells[i], k, f);
          }
        }
      }
    });
  // What is certainly on the other side takes no part any more.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    for (std::size_t k = 0; k < this->Fields.size() && this->IsNew[i]; ++k)
    {
      this->Sampled +=
        !this->Fields[k]->HasBounds() && SideOf(cells[i], k) != Side::Unknown ? 1 : 0;
    }
    if (!this->IsDropped(cells[i], false))
    {
      cells[kept] = cells[i];
      this->IsNew[kept++] = this->IsNew[i];
    }
  }
  cells.resize(kept);
  this->IsNew.resize(kept);
}

bool ClipWorker::IsDropped(const Cell& cell, bool byCorners) const
{
  bool isInside = true;
  bool isOutside = false;
  for (std::size_t k = 0; k < this->Fields.size(); ++k)
  {
    const Side side = SideOf(cell, k);
    bool in = side == Side::Inside;
    bool out = side == Side::Outside;
    if (side == Side::Unknown && byCorners)
    {
      in = out = true;
      for (int c = 0; c <= this->Mesh->Dimension(); ++c)
      {
        const double value = this->Values[k][Corner(cell, c)];
        in = in && value <= 0.0;
        out = out && value > 0.0;
      }
    }
    isInside = isInside && in;
    isOutside = isOutside || out;
  }
  return this->Options.KeepInside ? isOutside : isInside;
}

double ClipWorker::Width(const Cell& cell) const
{
  Eigen::AlignedBox3d bounds;
  for (int c = 0; c <= this->Mesh->Dimension(); ++c)
  {
    bounds.extend(this->Points[Corner(cell, c)]);
  }
  return bounds.diagonal().norm();
}

unsigned char ClipWorker::LongestEdge(const Cell& cell) const
{
  int longest = 0;
  for (int e = 1; e < SimplexRefinement::NumberOfEdges(this->Mesh->Dimension()); ++e)
  {
    const double length = this->Lengths[Middle(cell, e)];
    const double best = this->Lengths[Middle(cell, longest)];
    longest =
      length > best || (length == best && Middle(cell, e) < Middle(cell, longest)) ? e : longest;
  }
  return static_cast<unsigned char>(1 << longest);
}

unsigned char ClipWorker::EdgesToHalve(const Cell& cell) const
{
  unsigned char bits = 0;
  const int edges = SimplexRefinement::NumberOfEdges(this->Mesh->Dimension());
  // Those that are wrong by themselves, or the worst.
  const auto add = [&bits, edges](const Error& error)
  {
    if (error.Largest <= Target)
    {
      return;
    }
    const double worst = *std::max_element(error.Edges.begin(), error.Edges.begin() + edges);
    for (int e = 0; e < edges; ++e)
    {
      const double own = error.Edges[static_cast<std::size_t>(e)];
      bits |= static_cast<unsigned char>(own >= std::min(Target, worst) ? 1 << e : 0);
    }
  };
  const bool isWide = this->Width(cell) > this->Options.Tolerance;
  for (std::size_t k = 0; k < this->Fields.size() && isWide; ++k)
  {
    if (SideOf(cell, k) != Side::Unknown)
    {
      continue;
    }
    const bool isUncertain = this->Fields[k]->HasBounds()
      ? VerdictOf(cell, k) == Verdict::Open
      : this->Width(cell) > this->DomainWidth / SampledDivisions;
    if (isUncertain)
    {
      return this->LongestEdge(cell);
    }
    Error error = this->CutError(cell, k);
    // All edges of a cell that is far from its tolerance; near it, the worst.
    const double worst = *std::max_element(error.Edges.begin(), error.Edges.begin() + edges);
    for (double& own : error.Edges)
    {
      own = own >= 0.5 * worst ? INFINITY : 0.0;
    }
    add(error);
  }
  if (!this->IsDropped(cell, true))
  {
    add(this->PositionError(cell));
    add(this->AttributeError(cell));
  }
  return bits;
}

void ClipWorker::Halve(const std::vector<unsigned char>& edges)
{
  const auto& cells = this->Mesh->Cells();
  std::vector<char> isHalved(static_cast<std::size_t>(this->Mesh->NumberOfNodes()), 0);
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    for (int e = 0; e < 6; ++e)
    {
      if (edges[i] >> e & 1)
      {
        isHalved[Middle(cells[i], e)] = 1;
      }
    }
  }
  this->Mesh->Refine(isHalved, this->Lengths, this->IsNew);
}

bool ClipWorker::Refine()
{
  const auto& cells = this->Mesh->Cells();
  std::vector<unsigned char> edges;
  while (!this->Options.Abort())
  {
    this->EvaluateNodes();
    this->Decide();
    edges.assign(cells.size(), 0);
    this->Options.For(static_cast<std::ptrdiff_t>(cells.size()), Grain,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
        {
          edges[i] = this->IsNew[i] ? this->EdgesToHalve(cells[i]) : 0;
        }
      });
    const bool isDone =
      std::all_of(edges.begin(), edges.end(), [](unsigned char bits) { return bits == 0; });
    this->WasCapped =
      !isDone && static_cast<double>(cells.size()) >= 0.25 * this->Options.MaximumCells;
    if (isDone || this->WasCapped)
    {
      return true;
    }
    this->Halve(edges);
  }
  return false;
}

bool ClipWorker::Cut()
{
  const int dimension = this->Mesh->Dimension();
  this->Pieces.emplace(this->Body, this->Fields, dimension);
  std::vector<SimplexCut::Index> pointOf(static_cast<std::size_t>(this->Mesh->NumberOfNodes()), -1);
  const auto& cells = this->Mesh->Cells();
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    SimplexCut::Cell piece{ {}, static_cast<std::int64_t>(i), 0 };
    for (int c = 0; c <= dimension; ++c)
    {
      const std::size_t node = Corner(cells[i], c);
      SimplexCut::Index& point = pointOf[node];
      if (point < 0)
      {
        const Eigen::Vector3d& u = this->Mesh->Parameter(static_cast<int>(node));
        unsigned fixed = 0;
        for (int d = 0; d < 3; ++d)
        {
          const std::vector<double>& creases = this->Creases[static_cast<std::size_t>(d)];
          fixed |= std::binary_search(creases.begin(), creases.end(), u[d]) ? 1u << d : 0;
        }
        point = this->Pieces->AddPoint(u, this->Points[node], 0, fixed);
      }
      piece.Corners[static_cast<std::size_t>(c)] = point;
    }
    if (dimension == 3 && this->Options.Handedness < 0)
    {
      std::swap(piece.Corners[0], piece.Corners[1]);
    }
    this->Pieces->AddCell(piece);
  }
  for (std::size_t k = 0; k < this->Fields.size(); ++k)
  {
    if (!this->Pieces->Cut(
          static_cast<int>(k), !this->Options.KeepInside, this->Options.For, this->Options.Abort))
    {
      return false;
    }
  }
  return true;
}

bool ClipWorker::HalveBadCuts()
{
  const auto volume = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c, const Eigen::Vector3d& d)
  { return (b - a).cross(c - a).dot(d - a); };
  const auto& x = this->Pieces->Points();
  const auto& cells = this->Mesh->Cells();
  std::vector<char> isBad(cells.size(), 0);
  for (const Facet& facet : this->CutFacets())
  {
    isBad[facet.Cell] = isBad[facet.Cell] || facet.Error > this->Options.Tolerance;
  }
  for (const SimplexCut::Cell& piece : this->Pieces->Cells())
  {
    const auto i = static_cast<std::size_t>(piece.Origin);
    const auto at = [&](std::size_t c) -> const Eigen::Vector3d&
    { return x[static_cast<std::size_t>(piece.Corners[c])]; };
    const auto corner = [&](int c) -> const Eigen::Vector3d&
    { return this->Points[Corner(cells[i], c)]; };
    isBad[i] = isBad[i] ||
      (this->Mesh->Dimension() == 3 && volume(at(0), at(1), at(2), at(3)) <= 0.0 &&
        this->Options.Handedness * volume(corner(0), corner(1), corner(2), corner(3)) > 0.0);
  }
  std::vector<unsigned char> edges(cells.size(), 0);
  bool any = false;
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    if (isBad[i] && this->Width(cells[i]) > this->Options.Tolerance)
    {
      edges[i] = this->LongestEdge(cells[i]);
      any = true;
    }
  }
  if (any)
  {
    this->Halve(edges);
  }
  return any;
}

bool ClipWorker::Run()
{
  constexpr int MostRounds = 12;
  for (int round = 0;; ++round)
  {
    if (!this->Refine() || !this->Cut())
    {
      return false;
    }
    if (round == MostRounds || this->WasCapped || !this->HalveBadCuts())
    {
      return true;
    }
  }
}

ClipMesh ClipWorker::Assemble()
{
  const int dimension = this->Mesh->Dimension();
  const auto n = static_cast<std::size_t>(dimension) + 1;
  const auto& points = this->Pieces->Points();
  const auto& parameters = this->Pieces->Parameters();
  ClipMesh mesh;
  ZeroSetCertificate& certificate = mesh.Certificate;
  for (const Cell& cell : this->Mesh->Cells())
  {
    bool isUndecided = false;
    bool isCertified = false;
    for (std::size_t k = 0; k < this->Fields.size(); ++k)
    {
      if (SideOf(cell, k) == Side::Unknown)
      {
        (VerdictOf(cell, k) == Verdict::Sheet ? isCertified : isUndecided) = true;
      }
    }
    certificate.UndecidedCells += isUndecided ? 1 : 0;
    certificate.CertifiedCells += isCertified && !isUndecided ? 1 : 0;
    if (!this->IsDropped(cell, true))
    {
      certificate.LargestError = std::max(
        certificate.LargestError, this->PositionError(cell).Largest * this->Options.Tolerance);
      certificate.LargestAttributeError =
        std::max(certificate.LargestAttributeError, this->AttributeError(cell).Largest);
    }
  }

  certificate.UndecidedCells += this->Sampled;

  // Cells that vanish in space, where an edge of the patch is collapsed, are left out.
  std::vector<SimplexCut::Cell> cells;
  for (const SimplexCut::Cell& cell : this->Pieces->Cells())
  {
    bool vanishes = !this->Options.KeepInside && cell.Outside == 0;
    for (std::size_t i = 0; i < n; ++i)
    {
      for (std::size_t j = i + 1; j < n && !vanishes; ++j)
      {
        vanishes = (points[static_cast<std::size_t>(cell.Corners[i])] -
                     points[static_cast<std::size_t>(cell.Corners[j])])
                     .norm() <= 1e-14 * this->DomainWidth;
      }
    }
    if (!vanishes)
    {
      cells.push_back(cell);
    }
  }
  std::vector<std::int64_t> numberOf(points.size(), -1);
  std::vector<std::size_t> used;
  mesh.Cells.resize(dimension + 1, static_cast<Eigen::Index>(cells.size()));
  mesh.Elements.resize(3, mesh.Cells.cols());
  const std::array<std::size_t, 3> layers{ this->Grid.Spans[0].size(), this->Grid.Spans[1].size(),
    this->Grid.Spans[2].size() };
  for (std::size_t c = 0; c < cells.size(); ++c)
  {
    const auto at = static_cast<Eigen::Index>(c);
    for (std::size_t i = 0; i < n; ++i)
    {
      const auto point = static_cast<std::size_t>(cells[c].Corners[i]);
      if (numberOf[point] < 0)
      {
        numberOf[point] = static_cast<std::int64_t>(used.size());
        used.push_back(point);
      }
      mesh.Cells(static_cast<Eigen::Index>(i), at) = numberOf[point];
    }
    const auto root =
      static_cast<std::size_t>(this->Mesh->Cells()[static_cast<std::size_t>(cells[c].Origin)].Root);
    mesh.Elements.col(at) << this->Grid.Spans[0][root % layers[0]],
      this->Grid.Spans[1][root / layers[0] % layers[1]],
      this->Grid.Spans[2][root / (layers[0] * layers[1])];
  }

  const auto count = static_cast<Eigen::Index>(used.size());
  mesh.Parameters.resize(3, count);
  mesh.Points.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    mesh.Parameters.col(i) = parameters[used[static_cast<std::size_t>(i)]];
    mesh.Points.col(i) = points[used[static_cast<std::size_t>(i)]];
  }
  for (const auto& attribute : this->Body->Attributes())
  {
    Eigen::MatrixXd& values = mesh.Attributes.emplace_back(attribute->Spline().Components(), count);
    this->Options.For(count, Grain,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        attribute->Evaluator().Evaluate(static_cast<std::size_t>(end - begin),
          mesh.Parameters.col(begin).data(), values.col(begin).data());
      });
  }
  for (const Facet& facet : this->CutFacets())
  {
    certificate.LargestError = std::max(certificate.LargestError, facet.Error);
  }
  certificate.LargestResidual = this->Pieces->LargestResidual();
  certificate.ToleranceReached = !this->WasCapped && !this->Grid.LimitReached &&
    certificate.LargestError <= this->Options.Tolerance && certificate.LargestAttributeError <= 1.0;
  return mesh;
}

ClipMesh Clip(const Patch& patch, std::shared_ptr<const PreparedAggregate> body,
  const std::vector<std::shared_ptr<const ScalarField>>& fields, const ClipOptions& options)
{
  ClipWorker worker(patch, std::move(body), fields, options);
  return worker.Run() ? worker.Assemble() : ClipMesh{};
}

}
