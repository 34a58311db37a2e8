// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_MfemTopology_h
#define hyperpatch_MfemTopology_h

#include "Scanner.h"

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace hyperpatch::formats::mfem
{

inline constexpr long long MaxInt = std::numeric_limits<int>::max();

/// Lattice corners of the vertices of a segment (first 2), quadrilateral (first 4), hexahedron.
inline constexpr std::array<std::array<int, 3>, 8> Corners{ { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 },
  { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 } } };

/// The vertex at the end of the edge from vertex 0 in each direction.
inline constexpr std::array<std::size_t, 3> AlongFrom0{ 1, 3, 4 };

/// MFEM's faces of a hexahedron: the side (0..5) and the vertices in the order that numbers its
/// control points, first vertex to second fastest.
struct LocalFace
{
  int Side;
  std::array<int, 4> Vertices;
};
inline constexpr std::array<LocalFace, 6> LocalFaces{ { { 4, { 3, 2, 1, 0 } },
  { 2, { 0, 1, 5, 4 } }, { 1, { 1, 2, 6, 5 } }, { 3, { 2, 3, 7, 6 } }, { 0, { 3, 0, 4, 7 } },
  { 5, { 4, 5, 6, 7 } } } };

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
  int From; ///< the vertex where the knot vector begins
};
using VertexPair = std::pair<int, int>;
/// A side 0..5 of a patch, and whether another patch has it too.
struct PatchSide
{
  std::size_t Patch;
  int Side;
  bool IsShared = false;
};

/// How many control points a file of so many bytes may ask for: nothing is taken on its word.
class LatticeBudget
{
public:
  explicit LatticeBudget(std::size_t bytes)
    : Bytes(bytes)
  {
  }
  /// The product of the sizes. \throws Error if all lattices so far are too large for the file
  long long Take(const std::array<KnotVector, 3>& knots, std::size_t patch);

private:
  std::size_t Bytes;
  long long Total = 0;
};

/// A vertex of smaller patches on a face of a larger one (an edge, in two dimensions), by the knot
/// spans before it from the first of the face's vertices towards the second and the last.
struct HangingVertex
{
  int Vertex;
  std::array<int, 2> Spans;
  std::array<int, 4> Parent; ///< vertices around the face, or 2 and -1
};

/// The direction in which two corners differ, if it is one only.
[[nodiscard]] std::optional<std::size_t> EdgeDirection(
  const std::array<int, 3>& a, const std::array<int, 3>& b);

/// The coarse mesh whose elements are the patches: the part of a file before the splines.
class Topology
{
public:
  explicit Topology(Scanner& in)
    : In(in)
  {
  }
  /// Up to the section "vertices" or, of a non-conforming mesh, "edges".
  void Read();

  [[nodiscard]] std::size_t NumberOfVertices() const { return std::size_t{ 1 } << this->Dimension; }
  /// Ids of the vertices of a side 0..5.
  [[nodiscard]] std::vector<int> SideVertices(std::size_t patch, int side) const;
  /// Position 0..7 of a vertex in a patch, -1 if it is not there.
  [[nodiscard]] int FindVertex(std::size_t patch, int vertex) const;
  [[nodiscard]] static SideKey KeyOf(const std::vector<int>& vertices);
  /// Interfaces and boundaries; warns of boundary elements that are no sides.
  void AppendTo(FileContents& contents) const;
  [[noreturn]] static void FailPatch(std::size_t patch, const std::string& message)
  {
    throw Error("patch " + std::to_string(patch) + ": " + message);
  }

  int Dimension = 0;
  std::vector<Element> Elements;
  std::vector<std::pair<VertexPair, Edge>> Edges;
  std::vector<HangingVertex> Hanging;
  long long Vertices = 0;

private:
  void ReadHeader();
  void ReadElements();
  void ReadBoundary();
  void ReadHanging();
  void ReadCoordinates();
  void ReadEdges();
  void CheckVertices() const;
  void FindSides();
  [[nodiscard]] Interface InterfaceOf(const PatchSide& one, std::size_t patch, int side) const;

  Scanner& In;
  bool IsNonConforming = false;
  std::vector<std::pair<int, SideKey>> BoundaryElements;
  std::map<SideKey, PatchSide> Sides; ///< the first patch of each
  std::vector<Interface> Interfaces;
};

}

#endif
