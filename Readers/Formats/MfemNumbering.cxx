// SPDX-License-Identifier: BSD-3-Clause
#include "MfemNumbering.h"

#include <algorithm>
#include <cstdlib>

namespace hyperpatch::formats::mfem
{

namespace
{

std::string NameOf(const VertexPair& ends)
{
  return "edge " + std::to_string(ends.first) + " - " + std::to_string(ends.second);
}

/// The same knots seen from the other end, within their own domain.
KnotVector Reversed(const KnotVector& knots)
{
  std::vector<double> reversed = knots.Knots();
  const double sum = reversed.front() + reversed.back();
  std::reverse(reversed.begin(), reversed.end());
  std::transform(
    reversed.begin(), reversed.end(), reversed.begin(), [sum](double knot) { return sum - knot; });
  return KnotVector(knots.Degree(), std::move(reversed));
}

}

Numbering::Numbering(
  const Topology& topology, const std::vector<KnotVector>& knotVectors, LatticeBudget& budget)
  : T(topology)
{
  this->FindEdges(knotVectors);
  this->FindLattices(knotVectors, budget);
  this->FindParents(knotVectors);
  this->NumberEdges(knotVectors);
  if (this->T.Dimension == 3)
  {
    this->NumberFaces();
  }
  for (const std::array<KnotVector, 3>& lattice : this->Lattices)
  {
    this->InsideOfPatch.push_back(this->Total);
    long long size = 1;
    for (int d = 0; d < this->T.Dimension; ++d)
    {
      size *= lattice[static_cast<std::size_t>(d)].Size() - 2;
    }
    this->Total += size;
  }
}

void Numbering::FindEdges(const std::vector<KnotVector>& knotVectors)
{
  for (const auto& [ends, edge] : this->T.Edges)
  {
    if (edge.Knots >= knotVectors.size())
    {
      throw Error(NameOf(ends) + " has knot vector " + std::to_string(edge.Knots) +
        ", but there are only " + std::to_string(knotVectors.size()));
    }
    if (!this->Edges.emplace(ends, NumberedEdge{ edge, {} }).second)
    {
      throw Error(NameOf(ends) + " is listed twice");
    }
  }
}

const Numbering::NumberedEdge& Numbering::FindEdge(
  std::size_t patch, std::size_t i, std::size_t j) const
{
  const auto& v = this->T.Elements[patch].Vertices;
  const auto found = this->Edges.find(std::minmax(v[i], v[j]));
  if (found == this->Edges.end())
  {
    Topology::FailPatch(patch,
      "its edge " + std::to_string(v[i]) + " - " + std::to_string(v[j]) +
        " is not in the section edges");
  }
  return found->second;
}

void Numbering::FindLattices(const std::vector<KnotVector>& knotVectors, LatticeBudget& budget)
{
  this->Lattices.resize(this->T.Elements.size());
  for (std::size_t p = 0; p < this->T.Elements.size(); ++p)
  {
    for (std::size_t d = 0; d < static_cast<std::size_t>(this->T.Dimension); ++d)
    {
      const Edge& edge = this->FindEdge(p, 0, AlongFrom0[d]).Of;
      const KnotVector& knots = knotVectors[edge.Knots];
      this->Lattices[p][d] = edge.From == this->T.Elements[p].Vertices[0] ? knots : Reversed(knots);
    }
    budget.Take(this->Lattices[p], p);
  }
}

void Numbering::FindParents(const std::vector<KnotVector>& knotVectors)
{
  for (const HangingVertex& hanging : this->T.Hanging)
  {
    const bool isEdge = hanging.Parent[2] < 0;
    const auto spansOf = [&](int a, int b)
    {
      const auto found = this->Edges.find(std::minmax(a, b));
      if (found == this->Edges.end())
      {
        throw Error("vertex " + std::to_string(hanging.Vertex) + " hangs on " +
          NameOf(std::minmax(a, b)) + ", which is not in the section edges");
      }
      return static_cast<int>(knotVectors[found->second.Of.Knots].Spans().size());
    };
    const std::array<int, 4>& v = hanging.Parent;
    const SideKey key = Topology::KeyOf(
      isEdge ? std::vector<int>{ v[0], v[1] } : std::vector<int>{ v[0], v[1], v[2], v[3] });
    const auto [found, isNew] =
      this->Parents.emplace(key, Parent{ v, {}, {}, { v.begin(), v.end() } });
    Parent& parent = found->second;
    if (isNew)
    {
      parent.Spans = { spansOf(v[0], v[1]), isEdge ? 0 : spansOf(v[0], v[3]) };
      const auto [m, n] = parent.Spans;
      parent.Vertices = { { { 0, 0 }, v[0] }, { { m, 0 }, v[1] } };
      if (!isEdge)
      {
        parent.Vertices.insert({ { { m, n }, v[2] }, { { 0, n }, v[3] } });
      }
    }
    if (parent.Corners != v || hanging.Spans[0] > parent.Spans[0] ||
      hanging.Spans[1] > parent.Spans[1] ||
      !parent.Vertices.emplace(hanging.Spans, hanging.Vertex).second ||
      !parent.Used.insert(hanging.Vertex).second)
    {
      throw Error("vertex " + std::to_string(hanging.Vertex) + " hangs behind " +
        std::to_string(hanging.Spans[0]) + " and " + std::to_string(hanging.Spans[1]) +
        " knot spans: that place or the vertex is taken, or it is not on its face");
    }
  }
  for (const auto& [key, parent] : this->Parents)
  {
    // Its edges, each along one of the two directions.
    const bool isEdge = parent.Corners[2] < 0;
    const auto& c = parent.Corners;
    const auto inside = [&spans = parent.Spans, &vertices = parent.Vertices](
                          std::size_t direction, int across)
    {
      std::vector<int> ascending;
      for (const auto& [at, vertex] : vertices)
      {
        if (at[1 - direction] == across && 0 < at[direction] && at[direction] < spans[direction])
        {
          ascending.push_back(vertex);
        }
      }
      return ascending;
    };
    this->HangOn({ c[0], c[1] }, inside(0, 0), knotVectors);
    if (!isEdge)
    {
      this->HangOn({ c[3], c[2] }, inside(0, parent.Spans[1]), knotVectors);
      this->HangOn({ c[0], c[3] }, inside(1, 0), knotVectors);
      this->HangOn({ c[1], c[2] }, inside(1, parent.Spans[0]), knotVectors);
    }
  }
}

void Numbering::HangOn(const VertexPair& ends, const std::vector<int>& vertices,
  const std::vector<KnotVector>& knotVectors)
{
  if (vertices.empty())
  {
    return;
  }
  const VertexPair key = std::minmax(ends.first, ends.second);
  const auto found = this->Edges.find(key);
  if (found == this->Edges.end())
  {
    throw Error(NameOf(key) + " has hanging vertices but is not in the section edges");
  }
  NumberedEdge& edge = found->second;
  const KnotVector& knots = knotVectors[edge.Of.Knots];
  if (knots.Degree() != 1)
  {
    throw Error(NameOf(key) + " has hanging vertices and degree " + std::to_string(knots.Degree()) +
      ": non-conforming meshes are read where the degree is 1; save a conforming one");
  }
  if (static_cast<int>(vertices.size()) != knots.Size() - 2)
  {
    throw Error(NameOf(key) + " has " + Counted(vertices.size(), "hanging vertex") + " for " +
      std::to_string(knots.Size() - 2) + " control points inside");
  }
  edge.Points.Hanging = vertices;
  if (ends != key)
  {
    std::reverse(edge.Points.Hanging.begin(), edge.Points.Hanging.end());
  }
}

void Numbering::NumberEdges(const std::vector<KnotVector>& knotVectors)
{
  this->Total = this->T.Vertices;
  for (const auto& [ends, listed] : this->T.Edges)
  {
    NumberedEdge& edge = this->Edges.at(ends);
    edge.Points.First = this->Total;
    // In 1D edges are the patches, whose inside is numbered below.
    const bool isNumbered = this->T.Dimension > 1 && edge.Points.Hanging.empty();
    this->Total += isNumbered ? knotVectors[listed.Knots].Size() - 2 : 0;
  }
}

std::vector<int> Numbering::HangingInside(const Face& face) const
{
  const auto found =
    this->Parents.find(Topology::KeyOf({ face.Vertices.begin(), face.Vertices.end() }));
  if (found == this->Parents.end())
  {
    return {};
  }
  const Parent& parent = found->second;
  const auto count = std::count_if(parent.Vertices.begin(), parent.Vertices.end(),
    [&spans = parent.Spans](const auto& entry)
    {
      const auto [i, j] = entry.first;
      return 0 < i && i < spans[0] && 0 < j && j < spans[1];
    });
  const long long places = (parent.Spans[0] - 1LL) * (parent.Spans[1] - 1LL);
  if (count > 0 && count != places)
  {
    throw Error("the face at vertex " + std::to_string(face.Vertices[0]) + " has " +
      std::to_string(count) + " hanging vertices inside where " + std::to_string(places) +
      " knot spans meet");
  }
  // From the face's first vertex towards its second and its last, in the parent's knot spans.
  const auto placeOf = [&parent](int vertex)
  {
    return std::find_if(parent.Vertices.begin(), parent.Vertices.end(),
      [vertex](const auto& entry) { return entry.second == vertex; })
      ->first;
  };
  const std::array<int, 2> origin = placeOf(face.Vertices[0]);
  const std::array<int, 2> fast = placeOf(face.Vertices[1]);
  const std::array<int, 2> slow = placeOf(face.Vertices[3]);
  const auto fail = [&face]()
  {
    throw Error("the face at vertex " + std::to_string(face.Vertices[0]) +
      " has its vertices in another order than the vertices that hang on it");
  };
  const bool isFirst = fast[1] == origin[1];
  if ((isFirst ? slow[0] != origin[0] : fast[0] != origin[0] || slow[1] != origin[1]) ||
    fast == origin || slow == origin)
  {
    fail();
  }
  const int m = std::abs(fast[0] - origin[0]) + std::abs(fast[1] - origin[1]);
  const int n = std::abs(slow[0] - origin[0]) + std::abs(slow[1] - origin[1]);
  std::vector<int> inside;
  for (int j = 1; j < n && count > 0; ++j)
  {
    for (int i = 1; i < m; ++i)
    {
      std::array<int, 2> at = origin;
      for (std::size_t d = 0; d < 2; ++d)
      {
        at[d] += (fast[d] - origin[d]) / m * i + (slow[d] - origin[d]) / n * j;
      }
      const auto vertex = parent.Vertices.find(at);
      if (vertex == parent.Vertices.end())
      {
        fail();
      }
      inside.push_back(vertex->second);
    }
  }
  return inside;
}

void Numbering::NumberFaces()
{
  for (std::size_t p = 0; p < this->T.Elements.size(); ++p)
  {
    for (const LocalFace& local : LocalFaces)
    {
      Face face{};
      for (std::size_t i = 0; i < 4; ++i)
      {
        face.Vertices[i] =
          this->T.Elements[p].Vertices[static_cast<std::size_t>(local.Vertices[i])];
      }
      const SideKey key = Topology::KeyOf({ face.Vertices.begin(), face.Vertices.end() });
      const auto [found, isNew] = this->Faces.emplace(key, face);
      if (!isNew)
      {
        continue;
      }
      Inside& points = found->second.Points;
      points = { this->Total, this->HangingInside(face) };
      long long size = 1;
      for (int d = 0; d < 3; ++d)
      {
        size *= d == local.Side / 2 ? 1 : this->Lattices[p][static_cast<std::size_t>(d)].Size() - 2;
      }
      this->Total += points.Hanging.empty() ? size : 0;
    }
  }
}

Numbering::Run Numbering::MakeRun(std::size_t patch, int from, int to) const
{
  const auto& a = Corners[static_cast<std::size_t>(from)];
  const auto& b = Corners[static_cast<std::size_t>(to)];
  const std::size_t d = *EdgeDirection(a, b);
  return Run{ d, a[d] == 0, this->Lattices[patch][d].Size() - 2 };
}

std::vector<long long> Numbering::NumbersOf(std::size_t patch) const
{
  const auto& v = this->T.Elements[patch].Vertices;
  const auto dimension = static_cast<std::size_t>(this->T.Dimension);
  const std::array<KnotVector, 3>& lattice = this->Lattices[patch];
  const std::array<int, 3> size{ lattice[0].Size(), lattice[1].Size(), lattice[2].Size() };

  struct EdgeRun
  {
    Run Along;
    const Inside* Points;
  };
  struct FaceRun
  {
    Run Fast;
    Run Slow;
    const Inside* Points;
  };
  // By the position of an edge's or face's corner: ends 0, 1 where fixed, and its directions.
  std::map<std::array<int, 3>, EdgeRun> edgeRuns;
  std::map<int, FaceRun> faceRuns;
  const auto vertices = static_cast<int>(this->T.NumberOfVertices());
  for (int i = 0; i < vertices; ++i)
  {
    for (int j = i + 1; j < vertices; ++j)
    {
      std::array<int, 3> key = Corners[static_cast<std::size_t>(i)];
      const auto d = EdgeDirection(key, Corners[static_cast<std::size_t>(j)]);
      if (!d)
      {
        continue;
      }
      key[*d] = -1;
      const NumberedEdge& edge =
        this->FindEdge(patch, static_cast<std::size_t>(i), static_cast<std::size_t>(j));
      const bool ascends = v[static_cast<std::size_t>(i)] < v[static_cast<std::size_t>(j)];
      if (edge.Of.Knots != this->FindEdge(patch, 0, AlongFrom0[*d]).Of.Knots)
      {
        Topology::FailPatch(patch,
          std::string("its edges in direction ") + "uvw"[*d] +
            " have different knot vectors: opposite edges need the same one");
      }
      const Run run = ascends ? this->MakeRun(patch, i, j) : this->MakeRun(patch, j, i);
      edgeRuns.emplace(key, EdgeRun{ run, &edge.Points });
    }
  }
  if (dimension == 3)
  {
    for (int side = 0; side < NumberOfSides; ++side)
    {
      const Face& face = this->Faces.at(Topology::KeyOf(this->T.SideVertices(patch, side)));
      const int origin = this->T.FindVertex(patch, face.Vertices[0]);
      const Run fast = this->MakeRun(patch, origin, this->T.FindVertex(patch, face.Vertices[1]));
      const Run slow = this->MakeRun(patch, origin, this->T.FindVertex(patch, face.Vertices[3]));
      faceRuns.emplace(side, FaceRun{ fast, slow, &face.Points });
    }
  }

  std::vector<long long> numbers;
  numbers.reserve(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
    static_cast<std::size_t>(size[2]));
  std::array<int, 3> index{};
  for (index[2] = 0; index[2] < size[2]; ++index[2])
  {
    for (index[1] = 0; index[1] < size[1]; ++index[1])
    {
      for (index[0] = 0; index[0] < size[0]; ++index[0])
      {
        std::array<int, 3> corner{};
        std::size_t free = 0;
        int side = 0;
        for (std::size_t d = 0; d < dimension; ++d)
        {
          const bool first = index[d] == 0;
          const bool last = index[d] == size[d] - 1;
          corner[d] = first ? 0 : last ? 1 : -1;
          free += first || last ? 0 : 1;
          side = first || last ? 2 * static_cast<int>(d) + (last ? 1 : 0) : side;
        }
        if (free == dimension)
        {
          numbers.push_back(this->InsideOfPatch[patch] + index[0] - 1 +
            (dimension > 1 ? (size[0] - 2LL) * (index[1] - 1) : 0) +
            (dimension > 2 ? (size[0] - 2LL) * (size[1] - 2) * (index[2] - 1) : 0));
        }
        else if (free == 0)
        {
          const auto found = std::find(Corners.begin(), Corners.end(), corner);
          numbers.push_back(v[static_cast<std::size_t>(found - Corners.begin())]);
        }
        else if (free == 1)
        {
          const EdgeRun& run = edgeRuns.at(corner);
          numbers.push_back(run.Points->Number(run.Along.Number(index)));
        }
        else
        {
          const FaceRun& run = faceRuns.at(side);
          numbers.push_back(
            run.Points->Number(run.Fast.Number(index) + run.Fast.Length * run.Slow.Number(index)));
        }
      }
    }
  }
  return numbers;
}

}
