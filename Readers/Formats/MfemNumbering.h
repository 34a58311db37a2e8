// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_MfemNumbering_h
#define hyperpatch_MfemNumbering_h

#include "MfemTopology.h"

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace hyperpatch::formats::mfem
{

/// MFEM's numbers of the control points of a mesh, which patches share: the coarse vertices, then
/// the insides of edges in the order of the file, of faces where they occur first, of patches.
///
/// In a non-conforming mesh the points inside edges and faces of larger patches are vertices of
/// smaller ones ("hanging"); of degree 1 there, they are all of them.
class Numbering
{
public:
  /// \throws Error if edges and knot vectors do not fit the patches, or hanging vertices do not fit
  /// the knot spans
  Numbering(
    const Topology& topology, const std::vector<KnotVector>& knotVectors, LatticeBudget& budget);

  [[nodiscard]] long long Count() const { return this->Total; }
  [[nodiscard]] const std::array<KnotVector, 3>& Lattice(std::size_t patch) const
  {
    return this->Lattices[patch];
  }
  /// The numbers of a patch's control points, u fastest.
  [[nodiscard]] std::vector<long long> NumbersOf(std::size_t patch) const;

private:
  /// The inner control points of an edge, from the lower vertex id to the higher, or of a face,
  /// from its first vertex to its second fastest: numbered from First on, or hanging vertices.
  struct Inside
  {
    long long First = 0;
    std::vector<int> Hanging;

    [[nodiscard]] long long Number(long long i) const
    {
      return this->Hanging.empty() ? this->First + i : this->Hanging[static_cast<std::size_t>(i)];
    }
  };
  struct NumberedEdge
  {
    Edge Of;
    Inside Points;
  };
  struct Face
  {
    std::array<int, 4> Vertices;
    Inside Points;
  };
  /// A face (or edge, with one row) whose knot spans end at vertices of smaller patches: vertices
  /// by numbers of spans, corners included.
  struct Parent
  {
    std::array<int, 4> Corners;
    std::array<int, 2> Spans;
    std::map<std::array<int, 2>, int> Vertices;
    std::set<int> Used; ///< of Vertices
  };
  /// A run of inner control points of a patch from one corner to the next: the direction it goes
  /// along, and the number of the lattice index i in it.
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

  void FindEdges(const std::vector<KnotVector>& knotVectors);
  void FindParents(const std::vector<KnotVector>& knotVectors);
  void HangOn(const VertexPair& ends, const std::vector<int>& vertices,
    const std::vector<KnotVector>& knotVectors);
  void FindLattices(const std::vector<KnotVector>& knotVectors, LatticeBudget& budget);
  void NumberEdges(const std::vector<KnotVector>& knotVectors);
  void NumberFaces();
  [[nodiscard]] std::vector<int> HangingInside(const Face& face) const;
  /// The edge between two vertices of a patch (positions 0..7).
  [[nodiscard]] const NumberedEdge& FindEdge(std::size_t patch, std::size_t i, std::size_t j) const;
  [[nodiscard]] Run MakeRun(std::size_t patch, int from, int to) const;

  const Topology& T;
  std::map<VertexPair, NumberedEdge> Edges;
  std::map<SideKey, Parent> Parents;
  std::map<SideKey, Face> Faces;
  std::vector<std::array<KnotVector, 3>> Lattices;
  std::vector<long long> InsideOfPatch;
  long long Total = 0;
};

}

#endif
