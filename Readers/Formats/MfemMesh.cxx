// SPDX-License-Identifier: BSD-3-Clause
#include "Interfaces.h"
#include "Scanner.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

// MFEM NURBS mesh v1.0 and v1.1: patches are the elements of a coarse mesh ("patch topology").
// Geometry comes per patch (keyword patches) or as one vector of global control points (keyword
// knotvectors): the coarse vertices, then the insides of edges, of faces (3D) and of patches.

namespace hyperpatch
{

namespace
{

using namespace formats;

constexpr long long MaxInt = std::numeric_limits<int>::max();

/// Lattice corners of the vertices of a segment (first 2), quadrilateral (first 4), hexahedron.
constexpr std::array<std::array<int, 3>, 8> Corners{ { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 },
  { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 } } };

/// The vertex at the end of the edge from vertex 0 in each direction.
constexpr std::array<std::size_t, 3> AlongFrom0{ 1, 3, 4 };

/// MFEM's faces of a hexahedron: the side (0..5) and the vertices in the order that numbers its
/// control points, first vertex to second fastest.
struct LocalFace
{
  int Side;
  std::array<int, 4> Vertices;
};
constexpr std::array<LocalFace, 6> LocalFaces{ { { 4, { 3, 2, 1, 0 } }, { 2, { 0, 1, 5, 4 } },
  { 1, { 1, 2, 6, 5 } }, { 3, { 2, 3, 7, 6 } }, { 0, { 3, 0, 4, 7 } }, { 5, { 4, 5, 6, 7 } } } };

/// A patch of the topology: ids of its 2, 4 or 8 vertices.
struct Element
{
  std::array<int, 8> Vertices;
};

/// Ids of the vertices of a side, ascending, filled up with -1.
using SideKey = std::array<int, 4>;
/// A knot vector's index and the way it runs along an edge.
struct Edge
{
  std::size_t Knots;
  int From;           ///< the vertex where the knot vector begins
  long long Dofs = 0; ///< the first of its inner control points, which run from lower to higher id
};
using VertexPair = std::pair<int, int>;
struct PatchSide
{
  std::size_t Patch;
  int Side;
  bool IsShared = false;
};

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

class MeshParser
{
public:
  explicit MeshParser(std::string_view text)
    : In(text)
    , Bytes(text.size())
  {
  }
  FileContents Parse();

private:
  void ReadHeader();
  void ReadTopology();
  void ReadPatches();
  void ReadDofs();
  /// v1.1 says how refinement places new knots: of no interest here.
  void SkipSpacing(const std::vector<KnotVector>& knots);
  void ReadNodesHeader(const std::vector<KnotVector>& knots);
  KnotVector ReadKnotVector(const std::string& where);
  void Append(std::size_t patch, std::array<KnotVector, 3> knots, const Eigen::MatrixXd& points,
    const Eigen::VectorXd& weights);
  /// The product of the sizes.
  long long LatticeSize(const std::array<KnotVector, 3>& knots, std::size_t patch);
  void FindSides();
  void AppendInterface(const PatchSide& one, std::size_t patch, int side);
  void AppendBoundaries();

  [[nodiscard]] int NumberOfVertices() const { return 1 << this->Dimension; }
  [[nodiscard]] SideKey KeyOf(const std::vector<int>& vertices) const;
  [[nodiscard]] std::vector<int> SideVertices(std::size_t patch, int side) const;
  /// Position 0..7 of a vertex in a patch, -1 if it is not there.
  [[nodiscard]] int FindVertex(std::size_t patch, int vertex) const;
  [[noreturn]] void FailPatch(std::size_t patch, const std::string& message) const
  {
    throw Error("patch " + std::to_string(patch) + ": " + message);
  }

  Scanner In;
  std::size_t Bytes;
  int Dimension = 0;
  std::vector<Element> Elements;
  std::vector<std::pair<int, SideKey>> BoundaryElements;
  std::vector<std::pair<VertexPair, Edge>> EdgeList;
  long long Vertices = 0;
  long long ControlPoints = 0;
  std::map<SideKey, PatchSide> Sides; ///< the first patch of each
  FileContents Contents;
};

FileContents MeshParser::Parse()
{
  this->ReadHeader();
  this->ReadTopology();
  this->FindSides();
  const std::string_view variant = this->In.Peek();
  if (variant == "patches")
  {
    this->ReadPatches();
  }
  else if (variant == "knotvectors")
  {
    this->ReadDofs();
  }
  else
  {
    this->In.Next("\"patches\" or \"knotvectors\"");
    this->In.Fail(Quote(variant) + " where \"patches\" or \"knotvectors\" is expected");
  }
  if (!this->In.AtEnd())
  {
    const std::string_view token = this->In.Next("the end");
    this->In.Fail(Quote(token) + " after the last control point: the counts do not fit the mesh");
  }
  this->AppendBoundaries();
  WarnOfFields(this->Contents);
  return std::move(this->Contents);
}

void MeshParser::ReadHeader()
{
  this->In.Expect("MFEM");
  const std::string_view kind = this->In.Next("the kind of mesh");
  if (kind != "NURBS")
  {
    this->In.Fail("this MFEM mesh is not a NURBS mesh: open it with a mesh reader");
  }
  std::string_view version = this->In.Next("\"mesh\"");
  if (version == "NC-patch")
  {
    this->In.Fail("a non-conforming NURBS mesh (NC-patch) is not read: refine it to a conforming "
                  "one and save that as MFEM NURBS mesh v1.0");
  }
  if (version == "mesh")
  {
    version = this->In.Next("the version");
  }
  if (version != "v1.0" && version != "v1.1")
  {
    this->In.Fail(
      "MFEM NURBS mesh version " + Quote(version) + " is not read: save it as v1.0 or v1.1");
  }
}

void MeshParser::ReadTopology()
{
  this->In.Expect("dimension");
  this->Dimension = static_cast<int>(this->In.Integer("the dimension", 1, 3));
  const auto vertices = static_cast<std::size_t>(this->NumberOfVertices());
  const long long elementType = 2 * this->Dimension - 1; // segment 1, square 3, cube 5

  this->In.Expect("elements");
  this->Elements.resize(this->In.Count("elements", 2 + vertices));
  for (Element& element : this->Elements)
  {
    element.Vertices.fill(-1);
    this->In.Integer("an element's attribute", -MaxInt, MaxInt);
    this->In.Integer("an element's type (segment 1, square 3, cube 5)", elementType, elementType);
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

  this->In.Expect("boundary");
  const std::size_t sideVertices = vertices / 2;
  this->BoundaryElements.resize(this->In.Count("boundary elements", 2 + sideVertices));
  for (auto& [attribute, key] : this->BoundaryElements)
  {
    attribute = static_cast<int>(this->In.Integer("a boundary attribute", -MaxInt, MaxInt));
    const long long type = std::max(0LL, elementType - 2); // point 0, segment 1, square 3
    this->In.Integer("a boundary element's type (point 0, segment 1, square 3)", type, type);
    std::vector<int> ids(sideVertices);
    for (int& id : ids)
    {
      id = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    }
    key = this->KeyOf(ids);
  }

  this->In.Expect("edges");
  this->EdgeList.resize(this->In.Count("edges", 3));
  for (auto& [ends, edge] : this->EdgeList)
  {
    edge.Knots = static_cast<std::size_t>(this->In.Integer("a knot vector's index", 0, MaxInt));
    const int a = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    const int b = static_cast<int>(this->In.Integer("a vertex", 0, MaxInt));
    ends = std::minmax(a, b);
    edge.From = a;
  }

  this->In.Expect("vertices");
  this->Vertices = this->In.Integer("the number of vertices", 0, MaxInt);
  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    for (const int vertex : this->Elements[p].Vertices)
    {
      if (vertex >= this->Vertices)
      {
        this->FailPatch(p,
          "vertex " + std::to_string(vertex) + " is not in 0.." +
            std::to_string(this->Vertices - 1) + ", the vertices that the mesh has");
      }
    }
  }
}

KnotVector MeshParser::ReadKnotVector(const std::string& where)
{
  const long long degree = this->In.Integer("the degree of a knot vector", 1, MaxDegree);
  const long long size = this->In.Integer("the number of control points", 2, MaxInt);
  this->In.CheckRoom(size + degree + 1, "knots");
  std::vector<double> knots = this->In.Reals(static_cast<std::size_t>(size + degree + 1), "a knot");
  return WithContext([&] { return "line " + std::to_string(this->In.Line()) + ": " + where; },
    [&] { return KnotVector(static_cast<int>(degree), std::move(knots)); });
}

long long MeshParser::LatticeSize(const std::array<KnotVector, 3>& knots, std::size_t patch)
{
  // Every factor is less than the number of bytes, and so is every product that passes.
  long long count = 1;
  for (const KnotVector& k : knots)
  {
    count *= k.Size();
    if (static_cast<unsigned long long>(this->ControlPoints + count) > 4 * this->Bytes)
    {
      this->FailPatch(patch,
        "the lattices up to this patch have more control points than a file "
        "of this size can hold: the knot vectors are wrong or the file is cut "
        "short");
    }
  }
  this->ControlPoints += count;
  return count;
}

void MeshParser::Append(std::size_t patch, std::array<KnotVector, 3> knots,
  const Eigen::MatrixXd& points, const Eigen::VectorXd& weights)
{
  // The format always has weights; without any that differs from 1 the patch is polynomial.
  const bool rational = (weights.array() != 1.0).any();
  WithContext([&] { return "patch " + std::to_string(patch); },
    [&]
    {
      AppendPatch(this->Contents, static_cast<int>(patch),
        Spline(std::move(knots), points, rational ? weights : Eigen::VectorXd()));
    });
}

void MeshParser::ReadPatches()
{
  this->In.Expect("patches");
  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    const std::string name = "patch " + std::to_string(p);
    std::array<KnotVector, 3> knots;
    this->In.Expect("knotvectors");
    this->In.Integer("the number of knot vectors of a patch", this->Dimension, this->Dimension);
    for (std::size_t d = 0; d < static_cast<std::size_t>(this->Dimension); ++d)
    {
      knots[d] = this->ReadKnotVector(name + ", direction " + "uvw"[d]);
    }
    this->In.Expect("dimension");
    const Eigen::Index rows = this->In.Integer("the dimension of the control points", 1, 3) + 1;
    const std::string_view keyword = this->In.Next("\"controlpoints\"");
    const bool cartesian = keyword == "controlpoints_cartesian";
    if (!cartesian && keyword != "controlpoints" && keyword != "controlpoints_homogeneous")
    {
      this->In.Fail(Quote(keyword) +
        " where \"controlpoints\", \"controlpoints_homogeneous\" or "
        "\"controlpoints_cartesian\" is expected");
    }
    const long long count = this->LatticeSize(knots, p);
    this->In.CheckRoom(count, "control points", static_cast<std::size_t>(rows));
    Eigen::MatrixXd points(rows, count);
    for (Eigen::Index i = 0; i < points.size(); ++i)
    {
      points.data()[i] = this->In.Real("a coordinate");
    }
    Eigen::VectorXd weights = points.row(rows - 1).transpose();
    if (!cartesian)
    {
      points = WithContext(
        [&] { return name; }, [&] { return SplineFromHomogeneous(knots, points).Coefficients(); });
    }
    else
    {
      points.conservativeResize(rows - 1, Eigen::NoChange);
    }
    this->Append(p, std::move(knots), points, weights);
  }
}

void MeshParser::SkipSpacing(const std::vector<KnotVector>& knots)
{
  if (this->In.Peek() == "refinements")
  {
    this->In.Expect("refinements");
    for (int d = 0; d < this->Dimension; ++d)
    {
      this->In.Integer("a refinement factor", 0, MaxInt);
    }
  }
  if (this->In.Peek() == "knotvector_refinements")
  {
    this->In.Expect("knotvector_refinements");
    for (std::size_t k = 0; k < knots.size(); ++k)
    {
      for (std::size_t i = this->In.Count("refinement factors"); i > 0; --i)
      {
        this->In.Integer("a refinement factor", 0, MaxInt);
      }
    }
  }
  if (this->In.Peek() != "spacing")
  {
    return;
  }
  this->In.Expect("spacing");
  for (std::size_t n = this->In.Count("spacings", 4); n > 0; --n)
  {
    this->In.Integer("a knot vector's index", 0, static_cast<long long>(knots.size()) - 1);
    this->In.Integer("a type of spacing", -MaxInt, MaxInt);
    std::size_t integers = this->In.Count("integer parameters");
    const std::size_t reals = this->In.Count("real parameters");
    for (; integers > 0; --integers)
    {
      this->In.Integer("an integer parameter", -MaxInt, MaxInt);
    }
    this->In.CheckRoom(static_cast<long long>(reals), "real parameters");
    (void)this->In.Reals(reals, "a real parameter");
  }
}

void MeshParser::ReadNodesHeader(const std::vector<KnotVector>& knots)
{
  this->In.Expect("FiniteElementSpace");
  this->In.Expect("FiniteElementCollection:");
  const std::string_view collection = this->In.Next("the finite element collection");
  if (collection.substr(0, 5) != "NURBS")
  {
    this->In.Fail("the nodes are of kind " + Quote(collection) +
      ", not NURBS: save the mesh with its NURBS nodes");
  }
  // "NURBS" alone leaves the degree to the knot vectors.
  for (const KnotVector& k : knots)
  {
    if (collection.size() > 5 && collection != "NURBS" + std::to_string(k.Degree()))
    {
      this->In.Fail("the nodes are " + Quote(collection) + " but a knot vector has degree " +
        std::to_string(k.Degree()) + ": both must be the same space");
    }
  }
}

void MeshParser::ReadDofs()
{
  const auto dimension = static_cast<std::size_t>(this->Dimension);
  this->In.Expect("knotvectors");
  std::vector<KnotVector> knotVectors(this->In.Count("knot vectors", 6));
  for (std::size_t k = 0; k < knotVectors.size(); ++k)
  {
    knotVectors[k] = this->ReadKnotVector("knot vector " + std::to_string(k));
  }
  this->SkipSpacing(knotVectors);

  long long dofs = this->Vertices;
  std::map<VertexPair, Edge> edges;
  for (auto& [ends, edge] : this->EdgeList)
  {
    const std::string name =
      "edge " + std::to_string(ends.first) + " - " + std::to_string(ends.second);
    if (edge.Knots >= knotVectors.size())
    {
      throw Error(name + " has knot vector " + std::to_string(edge.Knots) +
        ", but there are only " + std::to_string(knotVectors.size()));
    }
    edge.Dofs = dofs;
    // In 1D edges are the patches, whose inside is numbered below.
    dofs += dimension == 1 ? 0 : knotVectors[edge.Knots].Size() - 2;
    if (!edges.emplace(ends, edge).second)
    {
      throw Error(name + " is listed twice");
    }
  }

  // An edge of a patch between two of its vertices (positions 0..7).
  const auto findEdge = [&](std::size_t p, std::size_t i, std::size_t j) -> const Edge&
  {
    const auto& v = this->Elements[p].Vertices;
    const auto found = edges.find(std::minmax(v[i], v[j]));
    if (found == edges.end())
    {
      this->FailPatch(p,
        "its edge " + std::to_string(v[i]) + " - " + std::to_string(v[j]) +
          " is not in the section edges");
    }
    return found->second;
  };

  std::vector<std::array<KnotVector, 3>> lattices(this->Elements.size());
  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    for (std::size_t d = 0; d < dimension; ++d)
    {
      const Edge& edge = findEdge(p, 0, AlongFrom0[d]);
      lattices[p][d] = knotVectors[edge.Knots];
      if (edge.From != this->Elements[p].Vertices[0])
      {
        std::vector<double> reversed = lattices[p][d].Knots();
        const double sum = reversed.front() + reversed.back();
        std::reverse(reversed.begin(), reversed.end());
        std::transform(reversed.begin(), reversed.end(), reversed.begin(),
          [sum](double knot) { return sum - knot; });
        lattices[p][d] = KnotVector(lattices[p][d].Degree(), std::move(reversed));
      }
    }
    this->LatticeSize(lattices[p], p);
  }

  // Faces are numbered where they occur first, in that patch's order.
  struct Face
  {
    std::array<int, 4> Vertices;
    long long Dofs;
  };
  std::map<SideKey, Face> faces;
  std::vector<long long> inside(this->Elements.size());
  if (dimension == 3)
  {
    for (std::size_t p = 0; p < this->Elements.size(); ++p)
    {
      for (const LocalFace& local : LocalFaces)
      {
        Face face{ {}, dofs };
        for (std::size_t i = 0; i < 4; ++i)
        {
          face.Vertices[i] =
            this->Elements[p].Vertices[static_cast<std::size_t>(local.Vertices[i])];
        }
        const auto key = this->KeyOf({ face.Vertices.begin(), face.Vertices.end() });
        if (faces.emplace(key, face).second)
        {
          long long size = 1;
          for (int d = 0; d < 3; ++d)
          {
            size *= d == local.Side / 2 ? 1 : lattices[p][static_cast<std::size_t>(d)].Size() - 2;
          }
          dofs += size;
        }
      }
    }
  }
  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    inside[p] = dofs;
    long long size = 1;
    for (std::size_t d = 0; d < dimension; ++d)
    {
      size *= lattices[p][d].Size() - 2;
    }
    dofs += size;
  }

  const std::string_view keyword = this->In.Next("\"weights\"");
  Eigen::VectorXd weights;
  if (keyword == "weights")
  {
    this->In.CheckRoom(dofs, "weights");
    weights.resize(dofs);
    for (double& weight : weights)
    {
      weight = this->In.Real("a weight");
      if (!(weight > 0.0))
      {
        this->In.Fail("a weight is " + std::to_string(weight) + "; weights must be positive");
      }
    }
  }
  else if (keyword != "unitweights")
  {
    this->In.Fail("the section " + Quote(keyword) +
      " is not read: \"weights\" is expected after "
      "the knot vectors");
  }
  this->ReadNodesHeader(knotVectors);
  this->In.Expect("VDim:");
  const Eigen::Index rows = this->In.Integer("VDim", 1, 3);
  this->In.Expect("Ordering:");
  const bool byVector = this->In.Integer("Ordering", 0, 1) == 1;
  this->In.CheckRoom(dofs, "nodes", static_cast<std::size_t>(rows));
  if (weights.size() == 0)
  {
    weights.setOnes(dofs);
  }
  Eigen::MatrixXd nodes(byVector ? rows : dofs, byVector ? dofs : rows);
  for (Eigen::Index i = 0; i < nodes.size(); ++i)
  {
    nodes.data()[i] = this->In.Real("a coordinate");
  }
  if (!byVector)
  {
    nodes.transposeInPlace();
  }

  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    const auto& v = this->Elements[p].Vertices;
    const std::array<int, 3> size{ lattices[p][0].Size(), lattices[p][1].Size(),
      lattices[p][2].Size() };

    // A run of inner control points from vertex `from` to `to` (positions 0..7): the direction it
    // goes along, and the number of the lattice index i in it.
    struct Run
    {
      std::size_t Direction;
      bool Forward;
      long long Length;
      [[nodiscard]] long long Number(const std::array<int, 3>& index) const
      {
        const int i = index[this->Direction];
        return this->Forward ? i - 1 : this->Length - i;
      }
    };
    const auto makeRun = [&](int from, int to)
    {
      const auto& a = Corners[static_cast<std::size_t>(from)];
      const auto& b = Corners[static_cast<std::size_t>(to)];
      const std::size_t d = *EdgeDirection(a, b);
      return Run{ d, a[d] == 0, size[d] - 2 };
    };
    struct EdgeRun
    {
      Run Along;
      long long Dofs;
    };
    struct FaceRun
    {
      Run Fast;
      Run Slow;
      long long Dofs;
    };
    // By the position of an edge's or face's corner: ends 0, 1 where fixed, and its directions.
    std::map<std::array<int, 3>, EdgeRun> edgeRuns;
    std::map<int, FaceRun> faceRuns;
    for (int i = 0; i < this->NumberOfVertices(); ++i)
    {
      for (int j = i + 1; j < this->NumberOfVertices(); ++j)
      {
        std::array<int, 3> key = Corners[static_cast<std::size_t>(i)];
        const auto d = EdgeDirection(key, Corners[static_cast<std::size_t>(j)]);
        if (!d)
        {
          continue;
        }
        key[*d] = -1;
        const Edge& edge = findEdge(p, static_cast<std::size_t>(i), static_cast<std::size_t>(j));
        const bool ascends = v[static_cast<std::size_t>(i)] < v[static_cast<std::size_t>(j)];
        const Run run = ascends ? makeRun(i, j) : makeRun(j, i);
        if (edge.Knots != findEdge(p, 0, AlongFrom0[*d]).Knots)
        {
          this->FailPatch(p,
            std::string("its edges in direction ") + "uvw"[*d] +
              " have different knot vectors: opposite edges need the same one");
        }
        edgeRuns.emplace(key, EdgeRun{ run, edge.Dofs });
      }
    }
    if (dimension == 3)
    {
      for (int side = 0; side < NumberOfSides; ++side)
      {
        const Face& face = faces.at(this->KeyOf(this->SideVertices(p, side)));
        const int origin = this->FindVertex(p, face.Vertices[0]);
        const Run fast = makeRun(origin, this->FindVertex(p, face.Vertices[1]));
        const Run slow = makeRun(origin, this->FindVertex(p, face.Vertices[3]));
        faceRuns.emplace(side, FaceRun{ fast, slow, face.Dofs });
      }
    }

    Eigen::MatrixXd points(rows, static_cast<Eigen::Index>(size[0]) * size[1] * size[2]);
    Eigen::VectorXd pointWeights(points.cols());
    Eigen::Index to = 0;
    std::array<int, 3> index{};
    for (index[2] = 0; index[2] < size[2]; ++index[2])
    {
      for (index[1] = 0; index[1] < size[1]; ++index[1])
      {
        for (index[0] = 0; index[0] < size[0]; ++index[0], ++to)
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
          long long dof = 0;
          if (free == dimension)
          {
            dof = inside[p] + index[0] - 1;
            dof += dimension > 1 ? (size[0] - 2LL) * (index[1] - 1) : 0;
            dof += dimension > 2 ? (size[0] - 2LL) * (size[1] - 2) * (index[2] - 1) : 0;
          }
          else if (free == 0)
          {
            const auto found = std::find(Corners.begin(), Corners.end(), corner);
            dof = v[static_cast<std::size_t>(found - Corners.begin())];
          }
          else if (free == 1)
          {
            const EdgeRun& run = edgeRuns.at(corner);
            dof = run.Dofs + run.Along.Number(index);
          }
          else
          {
            const FaceRun& run = faceRuns.at(side);
            dof = run.Dofs + run.Fast.Number(index) + run.Fast.Length * run.Slow.Number(index);
          }
          points.col(to) = nodes.col(dof);
          pointWeights[to] = weights[dof];
        }
      }
    }
    this->Append(p, std::move(lattices[p]), points, pointWeights);
  }
}

SideKey MeshParser::KeyOf(const std::vector<int>& vertices) const
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

std::vector<int> MeshParser::SideVertices(std::size_t patch, int side) const
{
  std::vector<int> vertices;
  for (std::size_t i = 0; i < static_cast<std::size_t>(this->NumberOfVertices()); ++i)
  {
    if (Corners[i][static_cast<std::size_t>(side / 2)] == side % 2)
    {
      vertices.push_back(this->Elements[patch].Vertices[i]);
    }
  }
  return vertices;
}

int MeshParser::FindVertex(std::size_t patch, int vertex) const
{
  const auto& v = this->Elements[patch].Vertices;
  const auto found = std::find(v.begin(), v.end(), vertex);
  return found == v.end() ? -1 : static_cast<int>(found - v.begin());
}

void MeshParser::FindSides()
{
  for (std::size_t p = 0; p < this->Elements.size(); ++p)
  {
    for (int side = 0; side < 2 * this->Dimension; ++side)
    {
      const auto [found, isNew] =
        this->Sides.emplace(this->KeyOf(this->SideVertices(p, side)), PatchSide{ p, side });
      if (isNew)
      {
        continue;
      }
      if (found->second.IsShared)
      {
        this->FailPatch(p,
          "its side " + std::to_string(side + 1) +
            " is shared by more than two patches: such a mesh has no order of control points");
      }
      found->second.IsShared = true;
      this->AppendInterface(found->second, p, side);
    }
  }
  auto& interfaces = this->Contents.Model.Interfaces;
  std::sort(interfaces.begin(), interfaces.end(),
    [](const Interface& a, const Interface& b) { return a.Values < b.Values; });
}

void MeshParser::AppendInterface(const PatchSide& one, std::size_t patch, int side)
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
      this->FailPatch(patch,
        "its side " + std::to_string(side + 1) + " has the vertices of side " +
          std::to_string(one.Side + 1) + " of patch " + std::to_string(one.Patch) +
          " in an order that does not go around the same face");
    }
    direction[*d] = static_cast<int>(*e);
    same[*d] = end1[*d] == end2[*e];
  }
  this->Contents.Model.Interfaces.push_back(MakeInterface(
    static_cast<int>(one.Patch), one.Side, static_cast<int>(patch), side, direction, same));
}

void MeshParser::AppendBoundaries()
{
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
    this->Contents.Model.Boundaries.push_back(
      { "boundary " + std::to_string(attribute), std::move(sides) });
  }
  if (unknown > 0)
  {
    this->Contents.Warnings.push_back(
      Counted(unknown, "boundary element") + " skipped: not the side of a patch.");
  }
}

}

FileContents ParseMfemMesh(std::string_view text)
{
  return MeshParser(text).Parse();
}

}
