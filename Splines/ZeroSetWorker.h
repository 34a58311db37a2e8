// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSetWorker_h
#define hyperpatch_ZeroSetWorker_h

#include "BoxSpline.h"
#include "CellLines.h"
#include "FacetTriangulation.h"
#include "NumberingWorker.h"
#include "ZeroSet.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

/// The inside of ZeroSet, private to the files that hold it, in the order of the work:
/// ZeroSetSearch.cxx finds the boxes that hold the surface, with what ZeroSetProof.cxx proves of
/// them, ZeroSetNodes.cxx their corners, ZeroSetFaces.cxx where the surface crosses their faces and
/// edges, ZeroSetVertices.cxx its points on edges, ZeroSetSnap.cxx joins those near a node,
/// ZeroSetCurves.cxx finds its curves in faces, ZeroSetLoops.cxx joins these around each box,
/// ZeroSetFacets.cxx meshes it inside, ZeroSetSheets.cxx parts sheets that meet in an edge,
/// ZeroSetMesh.cxx joins the pieces. ZeroSetProbe.cxx finds its curvature, ZeroSetMeasure.cxx
/// errors. ZeroSetGroup.cxx does so with several at once, and lets them agree in between.

namespace hyperpatch
{

class ZeroSet::Worker
{
public:
  using Index = std::int64_t;

  Worker(std::shared_ptr<const PreparedAggregate> body, const ScalarField& field,
    ZeroSetOptions options);

  bool Extract();
  void SetLines(std::array<CellLines, 3> lines);
  bool Search();
  bool Refine();

  ZeroSetMesh Mesh;
  ZeroSetCertificate Certificate;
  std::vector<ParameterBox> UndecidedBoxes;

private:
  friend class ZeroSetGroup;

  /// Points per call of a field or evaluator.
  static constexpr Index Batch = 256;
  /// The share of a tolerance that is aimed at: it is measured at a few points of each cell only.
  static constexpr double Target = 0.85;
  /// The share up to which a measured error is taken.
  static constexpr double Accepted = 0.95;
  /// The error of a triangle whose edges have the chord error 1 (equilateral, on a sphere).
  static constexpr double InnerChord = 4.0 / 3.0;
  /// No more root cells per direction than this for each in the shortest one.
  static constexpr double LargestAspect = 64.0;
  /// How often it is worth while to halve the boxes in which a tolerance was missed.
  static constexpr int MostRefinements = 6;

  /// A place where lines of the three directions meet.
  using Node = std::array<int, 3>;
  /// A box between lines: a cube of `Size` lines in the directions that are there.
  struct Box
  {
    Node Low;
    int Size;
  };

  /// A leaf of the octree through which the surface may go.
  struct Leaf
  {
    Box At;
    bool IsCertified;
    int Height; ///< the direction in which the surface is a graph; -1: unknown
    bool Rises; ///< whether f grows in it
    /// Bits 2 d and 2 d + 1 of the faces, at its lower and upper line, on which f is 0 all over and
    /// that are to be drawn as pieces of the surface.
    unsigned Flat = 0;
  };

  /// Points of the surface and what the mesh wants to know about them.
  struct Samples
  {
    Eigen::Matrix3Xd Parameters, Points, Normals;
    Eigen::RowVectorXd Residuals; ///< |f|
    std::vector<Eigen::MatrixXd> Attributes;

    [[nodiscard]] Index Count() const { return this->Parameters.cols(); }
    void Resize(const Worker& worker, Index count);
  };

  /// Linear combinations of the samples at the corners of cells, whose errors are wanted.
  struct Middles
  {
    Eigen::Matrix3Xd Parameters, Points;
    std::vector<Eigen::MatrixXd> Attributes; ///< of no rows where they have no tolerance
    std::vector<int> Axes;   ///< to find the surface along; empty: along the steepest
    Eigen::Matrix3Xd Chords; ///< directions of cells whose error is across them in space, or zero

    void SetZero(const Worker& worker, Index count);
    void Add(Index to, double weight, const Samples& samples, Index from);
  };

  struct Error
  {
    double Distance = 0.0;
    double Attribute = 0.0; ///< by its tolerance
    double Aside = 0.0;     ///< how far from below the cell it was measured
  };

  /// A piece of the surface's curve in a face of boxes, from vertex to vertex of its edges, with
  /// positive f on its left, seen from the end of the axis that is normal to the face.
  struct Curve
  {
    Index From, To;
    Index First = 0; ///< its inner points are the shared points First .. First + Count - 1
    Index Count = 0;
    int Normal;             ///< the axis
    bool IsOnCrease;        ///< the face is one of the domain or a crease
    bool HasFailed = false; ///< it could not be followed from end to end
    Error Measured{};       ///< of its chords
    int Line = 0;           ///< where the face crosses the axis
    int EdgeAxis = -1;      ///< of the edge of boxes that it is, where two creases meet
    unsigned Heights = 0;   ///< bits of the directions in which the surface is a graph beside it
    bool HasTwin = false;   ///< another with the same ends, in the plane of another crease
  };

  /// The curvature of the surface around a point, as a graph over the two other directions.
  struct Shape
  {
    int Axis = -1; ///< the direction of height
    int A = 0, B = 0;
    Eigen::Vector3d Centre;
    Eigen::Vector2d Slope;     ///< of the height
    Eigen::Matrix2d Bend;      ///< second derivatives of the height
    Eigen::Matrix2d Metric;    ///< edges of length 1 in it meet the tolerances
    Range Heights{ 0.0, 0.0 }; ///< in which the surface is a graph
  };

  /// The mesh of the surface in one leaf. It stays as it is while what is around it does.
  struct Facets
  {
    Samples Inner;
    std::vector<Index> Loops;    ///< the shared points around it, loop after loop
    std::uint64_t Signature = 0; ///< of what the loops are
    /// Corners: places in Loops from 0 up, inner points as -1 - i.
    std::vector<std::array<Index, 3>> Cells;
    double Error = 0.0;
    double AttributeError = 0.0;
    int Failed = 0;
    bool IsWithinTolerance = true;
  };

  /// What one thread needs again and again.
  struct Scratch
  {
    FacetTriangulation Triangulation;
    std::vector<Eigen::Vector2d> Polygon;
    std::vector<Eigen::Vector2d> Candidates;
    Eigen::Matrix3Xd Parameters;
    std::vector<int> Axes;
    std::vector<char> Projected;
    struct Step
    {
      const Curve* Along;
      bool Forward;
      bool Used;
    };
    std::vector<Step> Steps;
    std::vector<Step*> Path;
    /// Of MeasureFacets(), which measures triangles that it knows only once.
    struct Facet
    {
      FacetTriangulation::Triangle Corners;
      Error Worst;    ///< by its normals, then as measured too
      double Share;   ///< of what is allowed
      double Longest; ///< the square of its longest edge
      double Most;    ///< its height by its normals, where that is greatest
      double Middle;  ///< and in the middle
      bool IsDoubtful;
      bool IsMeasured;
    };
    struct
    {
      std::vector<Facet> Known;
      std::vector<std::size_t> All, Doubtful, Aside, Coloured;
      std::vector<Error> Measured;
      Middles Centres;
    } Measuring;
    std::vector<std::vector<Index>> Loops;
  };

  /// The number of root cells of a direction, about, for those of the shortest to be cubes.
  static double RootsFor(double length, double shortest);

  /// Calls body(begin, end) in parallel and stops early when aborted.
  bool Parallel(Index count, Index grain, const std::function<void(Index, Index)>& body) const;

  // Search: ZeroSetSearch.cxx
  bool SearchBoxes(std::vector<Box> open);
  void SearchRoots(const Node& low, const Node& high, std::vector<Box>& found) const;
  struct Visited;
  void Halve(const Box& box, std::vector<Box>& parts) const;
  void Visit(const Box& box, BoxSpline& f, Visited& visited) const;
  /// A direction in which the zero set is a graph, on the box and on its faces in creases.
  struct Height
  {
    int Axis = -1;
    bool Rises = true;      ///< f grows in it
    double Steepness = 0.0; ///< least slope in it by the greatest in any direction
  };
  /// Leaf::Flat, and in `touches` whether a zero face is on no side the end of negative f.
  [[nodiscard]] unsigned FindFlat(const Box& box, const BoxSpline& f, bool& touches) const;
  void VisitSampled(const Box& box, Visited& visited) const;
  [[nodiscard]] ParameterBox Parameters(const Box& box) const;
  [[nodiscard]] double Width(const Box& box) const;
  [[nodiscard]] bool IsTooLarge(const Box& box, const Height& height) const;
  /// Takes leaves away.
  /// \returns their halves
  std::vector<Box> TakeApart(const std::vector<char>& isTaken);

  // Proof: ZeroSetProof.cxx
  [[nodiscard]] Part PartAt(std::size_t direction, bool high) const
  {
    return high != this->Lines[direction].IsMirrored() ? Part::High : Part::Low;
  }
  /// Calls visit(side) for the faces of a part of a box and for the edges of these.
  template <typename Visitor>
  void ForSides(const std::array<Part, 3>& part, Visitor&& visit) const;
  [[nodiscard]] bool IsGraph(const BoxSpline& f, const std::array<Part, 3>& part) const;
  /// Of f on a part of a box; none in directions in which it has no extent.
  [[nodiscard]] std::array<Range, 3> SlopesOf(
    const BoxSpline& f, const std::array<Part, 3>& part) const;
  /// Whether the zero set of f on a part, a graph, could be a tube that signs at the corners do not
  /// show.
  [[nodiscard]] bool CanHideNeck(
    const BoxSpline& f, const std::array<Part, 3>& part, const std::array<Range, 3>& slopes) const;
  [[nodiscard]] Height FindHeight(const Box& box, const BoxSpline& f) const;
  /// Of the parts of a box, those through which the zero set may pass and signs at the ends of
  /// edges do not show it.
  using UnseenSides = std::bitset<27>;
  [[nodiscard]] UnseenSides FindUnseen(const Box& box, BoxSpline& f) const;
  /// The leaves that touch a box.
  void FindBeside(const Box& box, const Numbering& leaves, std::vector<std::size_t>& beside) const;
  /// Halves certified leaves into which the zero set may bulge, unseen, from undecided ones, until
  /// they are no wider than the tolerance: then they are undecided, too.
  bool UncoverBulges();
  std::vector<Box> TakeBulges();

  // Nodes: ZeroSetNodes.cxx
  void CollectNodes();
  /// \returns its number, and whether it is new
  std::pair<Index, bool> AddNode(const Node& node);
  /// Corner 0..7 of a box, u fastest; directions that are not there have one end.
  [[nodiscard]] Node Corner(const Box& box, int corner) const
  {
    Node node = box.Low;
    for (const int d : this->Axes)
    {
      node[static_cast<std::size_t>(d)] += corner >> d & 1 ? box.Size : 0;
    }
    return node;
  }
  bool FindValues();
  /// The number of a node, -1 where none is.
  [[nodiscard]] Index Find(const Node& node) const
  {
    return this->Nodes.Find({ node[0], node[1], node[2], 0 });
  }
  [[nodiscard]] double ValueAt(int node) const
  {
    return this->NodeValues[static_cast<std::size_t>(node)];
  }
  /// An edge of boxes or a part of one, between two nodes.
  struct Edge
  {
    Node At; ///< its lower end
    int Size;
    int Axis;
    int Low, High; ///< its ends, as nodes
  };
  /// A face of boxes or a part of one, and the nodes at its corners, counter-clockwise from the
  /// lowest, seen from the end of the normal axis.
  struct Face
  {
    Node At;
    int Size;
    int Normal;
    std::array<int, 4> Corners;
  };
  /// Counter-clockwise from its lowest corner; the last two run backward.
  [[nodiscard]] static std::array<Edge, 4> EdgesOf(const Face& face);
  /// Calls visit(part) for the parts of a face, or an edge, in which no node lies.
  template <typename Visitor>
  void ForMinimalFaces(const Face& face, Visitor&& visit) const;
  template <typename Visitor>
  void ForMinimalEdges(const Edge& edge, bool forward, Visitor&& visit) const;
  /// A set of edges and faces of a box.
  using Sides = unsigned;
  static constexpr Sides AllSides = ~0u;
  /// \param b, c whether it is at the upper end of the directions that follow the axis
  static constexpr Sides EdgeBit(int axis, bool b, bool c)
  {
    return 1u << (4 * axis + (b ? 1 : 0) + (c ? 2 : 0));
  }
  static constexpr Sides FaceBit(int normal, bool high)
  {
    return 1u << (12 + 2 * normal + (high ? 1 : 0));
  }
  /// Those that a box has in common with one as large, so many sizes away.
  [[nodiscard]] static Sides CommonSides(const std::array<int, 3>& offset);
  bool FindDivided();

  // Faces: ZeroSetFaces.cxx
  /// Vertices and their curves, which are only chords yet.
  bool TraceFaces();
  bool TraceAll();
  void FindEdgeCurves();
  [[nodiscard]] Face FaceOf(std::size_t leaf, int normal, bool isUpper) const;
  /// A face of a leaf, or a part of one, in which no node lies.
  struct LeafFace
  {
    Face At;
    unsigned Divided; ///< bits of EdgesOf() it on which nodes may lie
    int Leaf;
    bool IsUpper;
  };
  struct Traced;
  /// Adds those in which the surface may be.
  void FindFaces(std::size_t leaf, std::vector<LeafFace>& faces) const;
  /// The surface in a face.
  void TraceFace(const LeafFace& leafFace, Traced& traced) const;
  /// The same of a leaf that is an edge.
  void TraceEdge(std::size_t leaf);
  /// Whether f is 0 on a face of a leaf and positive inside, by its corners.
  [[nodiscard]] bool IsFlat(const Leaf& leaf, int normal, bool high) const;
  /// Whether a leaf draws the face on which f is 0: where signs at corners do not show it.
  [[nodiscard]] bool IsDrawn(const Leaf& leaf, int normal, bool high) const;
  void TraceFlat(const Face& face);
  /// What a vertex is known by, before it has a number: the nodes at the ends of its edge.
  struct VertexPlace
  {
    int Low, High;
    int Axis; ///< Vertex::Axis

    [[nodiscard]] Index Key() const { return 8 * static_cast<Index>(this->Low) + this->Axis; }
  };
  /// Of an edge in which no node lies and at whose ends f has different signs.
  [[nodiscard]] VertexPlace VertexOn(const Edge& edge) const;
  [[nodiscard]] static VertexPlace VertexAt(int node) { return { node, node, 3 }; }
  Index AddVertex(const VertexPlace& place);
  /// Whether a line is a side beyond which the model goes on.
  [[nodiscard]] bool GoesOn(int direction, int line) const;

  // Vertices: ZeroSetVertices.cxx
  bool FindVertices();
  /// A vertex from the round before. \returns false where it had no such vertex
  bool TakeBefore(Index v);

  // Snap: ZeroSetSnap.cxx
  /// Joins vertices that lie close together around a node, and the curves that become one by that.
  void Snap();
  /// \returns for each vertex the one that it becomes
  [[nodiscard]] std::vector<Index> JoinVertices() const;
  /// No more vertices than that are around a node: on its edges, and itself.
  static constexpr std::size_t MostAround = 7;
  /// Joins those that curves between them connect, if all that becomes one point by that is a disc:
  /// two sheets stay two, and a neck stays open.
  /// \param links the ends of these curves
  /// \returns for each vertex the one that it becomes
  [[nodiscard]] std::vector<Index> JoinAround(const Node& node, const std::vector<Index>& vertices,
    const std::vector<std::array<Index, 2>>& links) const;
  /// Sets CurveOf.
  void JoinCurves(const std::vector<Index>& vertexOf);
  /// Parts vertices again where all of the surface between curves that became one would be lost.
  /// \returns whether there are any
  bool PartLost(std::vector<Index>& vertexOf) const;

  // Curves: ZeroSetCurves.cxx
  /// Snap() and FindCurves().
  bool FollowCurves();
  bool FindCurves();
  /// Per curve, the same one of the round before, or -1.
  [[nodiscard]] std::vector<Index> FindKept() const;
  void Bend(Index begin, Index end, const std::vector<Index>& kept, Samples& found);
  /// Moves points along one axis each onto f = 0; `projected`: where that worked.
  /// \param within no further, where f does not turn back between
  void Project(Eigen::Matrix3Xd& parameters, const std::vector<int>& axes,
    const std::optional<Range>& within, std::vector<char>& projected) const;

  // Loops: ZeroSetLoops.cxx
  void FindFlatLoops(const Leaf& leaf, std::vector<std::vector<Index>>& loops) const;
  /// False where a curve around it could not be followed.
  bool FindLoops(std::size_t leaf, Scratch& scratch) const;

  // Facets: ZeroSetFacets.cxx
  bool Fill();
  void FillLeaf(std::size_t number, Scratch& scratch, Facets& facets) const;
  [[nodiscard]] std::uint64_t SignatureOf(const std::vector<std::vector<Index>>& loops) const;
  /// Adds the mesh of a loop that begins at that place of Facets::Loops.
  void Add(const Facets& piece, Index begin, Facets& facets) const;
  void FillLoop(
    const Leaf& leaf, const std::vector<Index>& loop, Scratch& scratch, Facets& facets) const;
  bool FillSheet(
    const Leaf& leaf, const std::vector<Index>& loop, Scratch& scratch, Facets& facets) const;
  /// How much is done to meet the tolerances: nothing; points added as long as not most triangles
  /// miss them; points added. What gives up makes no cells.
  enum Effort
  {
    JustOnce,
    UntilMostMiss,
    Full
  };
  /// One try of it.
  /// \param density multiplies the metric
  /// \returns the largest error by its tolerance (about the mean one where it was given up), or -1
  /// where the loop is no simple polygon
  double FillSheet(const Shape& shape, double turn, double density, Effort effort,
    const Eigen::Vector3d& width, const std::vector<Index>& loop, Scratch& scratch,
    Facets& facets) const;
  void FillPolygon(
    const std::vector<Index>& loop, std::vector<FacetTriangulation::Triangle>& triangles) const;

  // Sheets: ZeroSetSheets.cxx
  /// An edge of more than two triangles: inside several leaves, or inside one and around others.
  struct CrowdedEdge
  {
    std::array<Index, 2> Ends; ///< shared points
    int Sheets;                ///< that have it
  };
  /// Gives sheets a point of their own on such an edge, so that they stay surfaces.
  /// \returns the ends of edges where that was not possible
  std::vector<Index> PartSheets(std::vector<CrowdedEdge> edges);
  /// \returns false where no triangle of the leaf is on the other side, or no point is found
  bool SplitEdge(
    std::size_t leaf, std::size_t cell, std::size_t side, double place, Scratch& scratch);

  // Mesh: ZeroSetMesh.cxx
  bool Assemble();
  /// Make the cells of the mesh and its points.
  bool MeshPieces();
  bool MeshCurves();
  bool TakePoints(Samples&& points);
  /// Counts and lists a box as undecided.
  void AddUndecided(const ParameterBox& box);
  /// Shared points at which the border of the surface meets itself.
  [[nodiscard]] std::vector<Index> FindCrossings() const;
  /// The edges of cells that no other cell has on its other side, as they turn.
  /// \returns those that more than two cells have
  std::vector<CrowdedEdge> FindOpenEdges();
  /// Bits of the sides of the domain (0..5) that an edge of shared points lies in.
  [[nodiscard]] unsigned SidesOf(const std::array<Index, 2>& edge) const;
  void MendNormals();

  // Samples: ZeroSetSamples.cxx, ZeroSetProbe.cxx, ZeroSetMeasure.cxx
  void Evaluate(Samples& samples, Index begin, Index end) const;
  /// \param derivatives of the geometry, 3 m
  [[nodiscard]] Eigen::Matrix3d Jacobian(const double* derivatives) const;
  [[nodiscard]] Eigen::Vector3d Normal(
    const double* derivatives, const Eigen::Vector3d& gradient) const;
  void Copy(const Samples& from, Index first, Samples& to, Index at, Index count) const;
  [[nodiscard]] std::optional<Shape> Probe(
    const Eigen::Vector3d& start, const Eigen::Vector3d& width, int axis) const;
  /// Sets Curve::Measured, and in `errors` what it is of what is aimed at: of curve k the
  /// `counts[k]` samples from `firsts[k]` on; `places` are where on each chord it is measured.
  void MeasureCurves(Index begin, const std::vector<std::size_t>& which,
    const std::vector<Index>& firsts, const std::vector<Index>& counts, const Samples& samples,
    const std::vector<int>& axisOf, const std::vector<double>& places, std::vector<double>& errors);
  /// Of triangles whose first `boundary` points are those of the loop and the others inner ones.
  /// Those in Scratch::Measuring.Known are not measured again.
  /// \param isFinal whether they are also measured if the normals tell that some miss a tolerance
  /// \param missing triangles that miss a tolerance, and by which factor
  /// \returns the largest error by its tolerance
  double MeasureFacets(const std::vector<FacetTriangulation::Triangle>& triangles, int boundary,
    const std::vector<Index>& loop, const std::vector<Index>& innerOf, bool isFinal,
    Scratch& scratch, Facets& facets, std::vector<std::pair<int, double>>& missing) const;
  /// How far the cubic on a chord leaves it that rises by these two, times its length, from its
  /// ends.
  [[nodiscard]] static double HermiteHeight(double from, double to)
  {
    return std::max({ std::abs(0.125 * (from + to)), std::abs(9.0 * from + 3.0 * to) / 64.0,
      std::abs(3.0 * from + 9.0 * to) / 64.0 });
  }
  /// Of linear cells, at points inside them, whose parameters become those of the points of the
  /// surface below where these are somewhere else: then, another time is more exact.
  void Measure(Middles& middles, std::vector<Error>& errors) const;

  /// Whether attributes have tolerances to meet.
  [[nodiscard]] bool HasAttributes() const
  {
    return std::any_of(this->Options.AttributeTolerances.begin(),
      this->Options.AttributeTolerances.end(), [](double t) { return t > 0.0; });
  }
  [[nodiscard]] double Line(int direction, int line) const
  {
    return this->Lines[static_cast<std::size_t>(direction)].Parameter(line);
  }
  [[nodiscard]] Eigen::Vector3d ParameterOf(const Node& node) const
  {
    return { this->Line(0, node[0]), this->Line(1, node[1]), this->Line(2, node[2]) };
  }

  std::shared_ptr<const PreparedAggregate> Prepared;
  const Aggregate& Body;
  const ScalarField& Field;
  ZeroSetOptions Options;
  const Evaluator& Geometry;
  std::vector<const Evaluator*> Attributes;
  std::vector<int> Axes; ///< the directions that are there
  std::array<std::vector<double>, 3> BreakAt;
  std::array<std::vector<bool>, 3> IsCreaseAt;
  std::array<double, 3> Lengths{};  ///< of the lines through the middle of the domain, in space
  std::array<bool, 6> GoesBeyond{}; ///< per side, whether the model goes on beyond it
  std::array<CellLines, 3> Lines;
  bool AreLinesTurned = false; ///< against parameters: mirrored in one direction, or in three
  Eigen::Vector3d Scale;       ///< of parameters: 1 is the width of a root cell
  Eigen::Vector3d Low, High;   ///< the domain
  double DomainWidth = 0.0;    ///< the longest of Lengths

  std::vector<Box> Undecided;
  bool WasCapped = false;
  std::vector<Leaf> Leaves;
  std::vector<Sides> Divided;                ///< of leaves, those on which nodes may lie
  std::vector<Box> Halved;                   ///< boxes
  Numbering HalvedKeys;                      ///< lower node and size
  Numbering Nodes;                           ///< corners of boxes
  std::vector<std::array<int, 8>> CornersOf; ///< of leaves, as nodes
  std::vector<Node> NodeAt;
  std::vector<double> NodeValues;
  double LargestValue = 0.0;
  struct Vertex
  {
    Node At;
    int Low;  ///< this node, as a number
    int Axis; ///< 3: the node itself; 4 + axis: the middle of an edge that may be a curve
    int Size;
    double FLow, FHigh;
    double Fraction = 0.0; ///< where on the edge, from line to line
    bool IsZero = false;   ///< whether f is 0 there
  };
  std::vector<Vertex> Vertices; ///< the first shared points
  /// Vertices by Vertex::Axis, faces by normal (flat ones by 3 + normal) of which a node is the
  /// lowest; -1: none.
  struct Uppers
  {
    std::array<int, 7> Vertices{ -1, -1, -1, -1, -1, -1, -1 };
    std::array<int, 6> Faces{ -1, -1, -1, -1, -1, -1 };
  };
  std::vector<Uppers> AtNode;
  std::vector<Curve> Curves;
  std::vector<std::array<Index, 2>> CurvesOfFace; ///< first and count
  /// Of each leaf, up to the next one's first: 2 face, + 1 where it is an upper one.
  std::vector<Index> FacesOfLeaf, FirstFace;
  /// What some faces have in them.
  struct Traced
  {
    std::vector<Curve> Curves;         ///< from key to key of their vertices
    std::vector<Index> Counts;         ///< of curves, per face
    std::vector<VertexPlace> Vertices; ///< of the curves, some of them several times
    /// Where the walk around a face meets the surface.
    struct Crossing
    {
      Index Key; ///< of the vertex
      bool ToNegative;
      std::size_t Corner; ///< the number of nodes that the walk met before
    };
    std::vector<Crossing> Crossings; ///< scratch, as is Around
    std::vector<int> Around;
  };
  std::vector<Index> CurveOf; ///< the first of the curves with the same ends; -1: no length
  Samples Shared;
  /// All that, of the round of refinement before: most of it stays as it is.
  struct Round
  {
    std::vector<Vertex> Vertices;
    std::vector<Uppers> AtNode;
    std::vector<Curve> Curves;
    std::vector<std::array<Index, 2>> CurvesOfFace;
    std::vector<Index> CurveOf;
    Samples Shared;
  };
  Round Before;
  std::vector<Facets> Pieces;                  ///< per leaf
  ZeroSetCertificate Taken;                    ///< errors of points that were taken from neighbors
  std::vector<std::array<Index, 2>> OpenEdges; ///< of shared points, as they turn
};

}

#endif
