// SPDX-License-Identifier: BSD-3-Clause
#include "MfemTopology.h"

#include "Interfaces.h"

#include <algorithm>

namespace hyperpatch::formats::mfem
{

/// The direction in which two corners differ, if it is one only.
std::optional<std::size_t> EdgeDirection(const std::array<int, 3>& a, const std::array<int, 3>& b)
{
  std::optional<std::size_t> direction;
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (a[d] != b[d])
    {
      if (direction)
      {
        return std::nullopt;
      }
      direction = d;
    }
  }
  return direction;
}

long long LatticeBudget::Take(const std::array<KnotVector, 3>& knots, std::size_t patch)
{
  // Every factor is less than the number of bytes, and so is every product that passes.
  long long count = 1;
  for (const KnotVector& k : knots)
  {
    count *= k.Size();
    if (static_cast<unsigned long long>(this->Total + count) > 4 * this->Bytes)
    {
      Topology::FailPatch(patch,
        "the lattices up to this patch have more control points than a file of this size can "
        "hold: the knot vectors are wrong or the file is cut short");
    }
  }
  this->Total += count;
  return count;
}

void Topology::Read()
{
  this->ReadHeader();
  this->In.Expect("dimension");
  this->Dimension = static_cast<int>(this->In.Integer("the dimension", 1, 3));
  this->ReadElements();
  this->ReadBoundary();
  if (this->IsNonConforming)
  {
    this->ReadHanging();
    this->ReadCoordinates();
    this->ReadEdges();
  }
  else
  {
    this->ReadEdges();
    this->In.Expect("vertices");
    this->Vertices = this->In.Integer("the number of vertices", 0, MaxInt);
  }
  this->CheckVertices();
  this->FindSides();
}

void Topology::ReadHeader()
{
  this->In.Expect("MFEM");
  const std::string_view kind = this->In.Next("the kind of mesh");
  if (kind != "NURBS")
  {
    this->In.Fail("this MFEM mesh is not a NURBS mesh: open it with a mesh reader");
  }
  std::string_view version = this->In.Next("\"mesh\"");
  this->IsNonConforming = version == "NC-patch";
  if (this->IsNonConforming)
  {
    this->In.Expect("mesh");
    version = "mesh";
  }
  if (version == "mesh")
  {
    version = this->In.Next("the version");
  }
  if (version != "v1.0" && (version != "v1.1" || this->IsNonConforming))
  {
    this->In.Fail("MFEM NURBS mesh version " + Quote(version) + " is not read: save it as v1.0");
  }
}

void Topology::ReadElements()
{
  const std::size_t vertices = this->NumberOfVertices();
  const long long elementType = 2 * this->Dimension - 1; // segment 1, square 3, cube 5
  this->In.Expect("elements");
  this->Elements.resize(this->In.Count("elements", 2 + vertices));
  for (Element& element : this->Elements)
  {
    element.Vertices.fill(-1);
    if (this->IsNonConforming)
    {
      this->In.Integer("an element's rank", 0, MaxInt);
    }
    this->In.Integer("an element's attribute", -MaxInt, MaxInt);
    this->In.Integer("an element's type (segment 1, square 3, cube 5)", elementType, elementType);
    if (this->IsNonConforming && this->In.Integer("an element's refinement", 0, MaxInt) != 0)
    {
      this->In.Fail("a patch that is refined in itself is not read: save the refined mesh");
    }
    for (std::size_t i = 0; i < vertices; ++i)
    {
      const int vertex = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
      const auto end = element.Vertices.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::find(element.Vertices.begin(), end, vertex) != end)
      {
        this->In.Fail("an element has vertex " + std::to_string(vertex) +
          " twice: give every corner of a patch its own vertex");
      }
      element.Vertices[i] = vertex;
    }
  }
  if (this->Elements.empty())
  {
    this->In.Fail("the mesh has no elements: there is nothing to read");
  }
}

void Topology::ReadBoundary()
{
  const std::size_t sideVertices = this->NumberOfVertices() / 2;
  this->In.Expect("boundary");
  this->BoundaryElements.resize(this->In.Count("boundary elements", 2 + sideVertices));
  for (auto& [attribute, key] : this->BoundaryElements)
  {
    attribute = static_cast<int>(this->In.Integer("a boundary attribute", -MaxInt, MaxInt));
    const long long type = std::max(0, 2 * this->Dimension - 3); // point 0, segment 1, square 3
    this->In.Integer("a boundary element's type (point 0, segment 1, square 3)", type, type);
    std::vector<int> ids(sideVertices);
    for (int& id : ids)
    {
      id = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    }
    key = KeyOf(ids);
  }
}

void Topology::ReadHanging()
{
  const std::size_t directions = this->Dimension == 3 ? 2 : 1;
  this->In.Expect("vertex_to_knotspan");
  this->Hanging.resize(this->In.Count("hanging vertices", 1 + 3 * directions));
  for (HangingVertex& hanging : this->Hanging)
  {
    hanging.Vertex = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    hanging.Spans.fill(0);
    hanging.Parent.fill(-1);
    for (std::size_t d = 0; d < directions; ++d)
    {
      hanging.Spans[d] = static_cast<int>(this->In.Integer("a number of knot spans", 0, MaxInt));
    }
    for (std::size_t i = 0; i < 2 * directions; ++i)
    {
      hanging.Parent[i] = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    }
  }
}

void Topology::ReadCoordinates()
{
  // Those of the control points come again with the nodes.
  this->In.Expect("coordinates");
  this->Vertices = static_cast<long long>(this->In.Count("vertices"));
  const long long rows = this->In.Integer("the dimension of the coordinates", 1, 3);
  for (long long i = 0; i < rows * this->Vertices; ++i)
  {
    this->In.Real("a coordinate");
  }
}

void Topology::ReadEdges()
{
  this->In.Expect("edges");
  this->Edges.resize(this->In.Count("edges", 3));
  for (auto& [ends, edge] : this->Edges)
  {
    edge.Knots = static_cast<std::size_t>(this->In.Integer("a knot vector's index", 0, MaxInt));
    const int a = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    const int b = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    ends = std::minmax(a, b);
    edge.From = a;
  }
}

void Topology::CheckVertices() const
{
  const auto isThere = [this](int vertex) { return vertex < this->Vertices; };
  const std::string range =
    " is not in 0.." + std::to_string(this->Vertices - 1) + ", the vertices that the mesh has";
  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    for (const int vertex : this->Elements[p].Vertices)
    {
      if (!isThere(vertex))
      {
        FailPatch(p, "vertex " + std::to_string(vertex) + range);
      }
    }
  }
  for (const HangingVertex& hanging : this->Hanging)
  {
    if (!isThere(hanging.Vertex))
    {
      throw Error("hanging vertex " + std::to_string(hanging.Vertex) + range);
    }
  }
}

SideKey Topology::KeyOf(const std::vector<int>& vertices)
{
  SideKey key;
  key.fill(-1);
  std::copy(vertices.begin(), vertices.end(), key.begin());
  // Insertion: GCC 12 warns of array bounds in std::sort of so few numbers.
  for (auto at = key.begin(); at != key.begin() + static_cast<std::ptrdiff_t>(vertices.size());
       ++at)
  {
    std::rotate(std::upper_bound(key.begin(), at, *at), at, at + 1);
  }
  return key;
}

std::vector<int> Topology::SideVertices(std::size_t patch, int side) const
{
  std::vector<int> vertices;
  for (std::size_t i = 0; i < this->NumberOfVertices(); ++i)
  {
    if (Corners[i][static_cast<std::size_t>(side / 2)] == side % 2)
    {
      vertices.push_back(this->Elements[patch].Vertices[i]);
    }
  }
  return vertices;
}

int Topology::FindVertex(std::size_t patch, int vertex) const
{
  const auto& v = this->Elements[patch].Vertices;
  const auto found = std::find(v.begin(), v.end(), vertex);
  return found == v.end() ? -1 : static_cast<int>(found - v.begin());
}

void Topology::FindSides()
{
  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    for (int side = 0; side < 2 * this->Dimension; ++side)
    {
      const auto [found, isNew] =
        this->Sides.emplace(KeyOf(this->SideVertices(p, side)), PatchSide{ p, side });
      if (isNew)
      {
        continue;
      }
      if (found->second.IsShared)
      {
        FailPatch(p,
          "its side " + std::to_string(side + 1) +
            " is shared by more than two patches: such a mesh has no order of control points");
      }
      found->second.IsShared = true;
      this->Interfaces.push_back(this->InterfaceOf(found->second, p, side));
    }
  }
  std::sort(this->Interfaces.begin(), this->Interfaces.end(),
    [](const Interface& a, const Interface& b) { return a.Values < b.Values; });
}

Interface Topology::InterfaceOf(const PatchSide& one, std::size_t patch, int side) const
{
  const auto corner = [this](std::size_t p, int vertex)
  {
    const auto& v = this->Elements[p].Vertices;
    return Corners[static_cast<std::size_t>(std::find(v.begin(), v.end(), vertex) - v.begin())];
  };
  std::array<int, 3> direction{ 0, 1, 2 };
  std::array<bool, 3> same{ true, true, true };
  const std::vector<int> vertices = this->SideVertices(one.Patch, one.Side);
  const auto origin1 = corner(one.Patch, vertices[0]);
  const auto origin2 = corner(patch, vertices[0]);
  for (const int vertex : vertices)
  {
    const auto end1 = corner(one.Patch, vertex);
    const auto d = EdgeDirection(origin1, end1);
    if (!d)
    {
      continue;
    }
    const auto end2 = corner(patch, vertex);
    const auto e = EdgeDirection(origin2, end2);
    if (!e)
    {
      FailPatch(patch,
        "its side " + std::to_string(side + 1) + " has the vertices of side " +
          std::to_string(one.Side + 1) + " of patch " + std::to_string(one.Patch) +
          " in an order that does not go around the same face");
    }
    direction[*d] = static_cast<int>(*e);
    same[*d] = end1[*d] == end2[*e];
  }
  return MakeInterface(
    static_cast<int>(one.Patch), one.Side, static_cast<int>(patch), side, direction, same);
}

void Topology::AppendTo(FileContents& contents) const
{
  contents.Model.Interfaces = this->Interfaces;
  std::map<int, std::vector<std::array<int, 2>>> boundaries;
  std::size_t unknown = 0;
  for (const auto& [attribute, key] : this->BoundaryElements)
  {
    const auto found = this->Sides.find(key);
    if (found == this->Sides.end())
    {
      ++unknown;
      continue;
    }
    boundaries[attribute].push_back({ static_cast<int>(found->second.Patch), found->second.Side });
  }
  for (auto& [attribute, sides] : boundaries)
  {
    contents.Model.Boundaries.push_back(
      { "boundary " + std::to_string(attribute), std::move(sides) });
  }
  if (unknown > 0)
  {
    contents.Warnings.push_back(
      Counted(unknown, "boundary element") + " skipped: not the side of a patch.");
  }
}

}
