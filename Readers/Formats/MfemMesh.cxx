// SPDX-License-Identifier: BSD-3-Clause
#include "MfemNumbering.h"
#include "MfemTopology.h"
#include "Scanner.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

// MFEM NURBS mesh v1.0, v1.1 and NC-patch: patches are the elements of a coarse mesh ("patch
// topology"). Geometry comes per patch (keyword patches) or as one vector of global control points
// (keyword knotvectors): the coarse vertices, then the insides of edges, of faces (3D) and of
// patches.

namespace hyperpatch
{

namespace
{

using namespace formats;

class MeshParser
{
public:
  explicit MeshParser(std::string_view text)
    : In(text)
    , Mesh(this->In)
    , Budget(text.size())
  {
  }
  FileContents Parse();

private:
  void ReadPatches();
  void ReadNodes();
  /// v1.1 says how refinement places new knots: of no interest here.
  void SkipSpacing(const std::vector<KnotVector>& knots);
  Eigen::VectorXd ReadWeights(long long count);
  void ReadNodesHeader(const std::vector<KnotVector>& knots);
  /// Columns are control points.
  Eigen::MatrixXd ReadCoordinates(long long count);
  KnotVector ReadKnotVector(const std::string& where);
  void Append(std::size_t patch, std::array<KnotVector, 3> knots, const Eigen::MatrixXd& points,
    const Eigen::VectorXd& weights);

  Scanner In;
  mfem::Topology Mesh;
  mfem::LatticeBudget Budget;
  FileContents Contents;
};

FileContents MeshParser::Parse()
{
  this->Mesh.Read();
  const std::string_view variant = this->In.Peek();
  if (variant == "patches")
  {
    this->ReadPatches();
  }
  else if (variant == "knotvectors")
  {
    this->ReadNodes();
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
  this->Mesh.AppendTo(this->Contents);
  WarnOfFields(this->Contents);
  return std::move(this->Contents);
}

KnotVector MeshParser::ReadKnotVector(const std::string& where)
{
  const long long degree = this->In.Integer("the degree of a knot vector", 1, MaxDegree);
  const long long size = this->In.Integer("the number of control points", 2, mfem::MaxInt);
  this->In.CheckRoom(size + degree + 1, "knots");
  std::vector<double> knots = this->In.Reals(static_cast<std::size_t>(size + degree + 1), "a knot");
  return WithContext([&] { return "line " + std::to_string(this->In.Line()) + ": " + where; },
    [&] { return KnotVector(static_cast<int>(degree), std::move(knots)); });
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
  for (std::size_t p = 0; p < this->Mesh.Elements.size(); ++p)
  {
    const std::string name = "patch " + std::to_string(p);
    std::array<KnotVector, 3> knots;
    this->In.Expect("knotvectors");
    this->In.Integer(
      "the number of knot vectors of a patch", this->Mesh.Dimension, this->Mesh.Dimension);
    for (std::size_t d = 0; d < static_cast<std::size_t>(this->Mesh.Dimension); ++d)
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
    const long long count = this->Budget.Take(knots, p);
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
    for (int d = 0; d < this->Mesh.Dimension; ++d)
    {
      this->In.Integer("a refinement factor", 0, mfem::MaxInt);
    }
  }
  if (this->In.Peek() == "knotvector_refinements")
  {
    this->In.Expect("knotvector_refinements");
    for (std::size_t k = 0; k < knots.size(); ++k)
    {
      for (std::size_t i = this->In.Count("refinement factors"); i > 0; --i)
      {
        this->In.Integer("a refinement factor", 0, mfem::MaxInt);
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
    this->In.Integer("a type of spacing", -mfem::MaxInt, mfem::MaxInt);
    std::size_t integers = this->In.Count("integer parameters");
    const std::size_t reals = this->In.Count("real parameters");
    for (; integers > 0; --integers)
    {
      this->In.Integer("an integer parameter", -mfem::MaxInt, mfem::MaxInt);
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

Eigen::VectorXd MeshParser::ReadWeights(long long count)
{
  const std::string_view keyword = this->In.Next("\"weights\"");
  if (keyword == "unitweights")
  {
    return Eigen::VectorXd();
  }
  if (keyword != "weights")
  {
    this->In.Fail("the section " + Quote(keyword) +
      " is not read: \"weights\" is expected after the knot vectors");
  }
  this->In.CheckRoom(count, "weights");
  Eigen::VectorXd weights(count);
  for (double& weight : weights)
  {
    weight = this->In.Real("a weight");
    if (!(weight > 0.0))
    {
      this->In.Fail("a weight is " + std::to_string(weight) + "; weights must be positive");
    }
  }
  return weights;
}

Eigen::MatrixXd MeshParser::ReadCoordinates(long long count)
{
  this->In.Expect("VDim:");
  const Eigen::Index rows = this->In.Integer("VDim", 1, 3);
  this->In.Expect("Ordering:");
  const bool byVector = this->In.Integer("Ordering", 0, 1) == 1;
  this->In.CheckRoom(count, "nodes", static_cast<std::size_t>(rows));
  Eigen::MatrixXd nodes(byVector ? rows : count, byVector ? count : rows);
  for (Eigen::Index i = 0; i < nodes.size(); ++i)
  {
    nodes.data()[i] = this->In.Real("a coordinate");
  }
  if (!byVector)
  {
    nodes.transposeInPlace();
  }
  return nodes;
}

void MeshParser::ReadNodes()
{
  this->In.Expect("knotvectors");
  std::vector<KnotVector> knotVectors(this->In.Count("knot vectors", 6));
  for (std::size_t k = 0; k < knotVectors.size(); ++k)
  {
    knotVectors[k] = this->ReadKnotVector("knot vector " + std::to_string(k));
  }
  this->SkipSpacing(knotVectors);
  const mfem::Numbering numbering(this->Mesh, knotVectors, this->Budget);
  Eigen::VectorXd weights = this->ReadWeights(numbering.Count());
  this->ReadNodesHeader(knotVectors);
  const Eigen::MatrixXd nodes = this->ReadCoordinates(numbering.Count());
  if (weights.size() == 0)
  {
    weights.setOnes(nodes.cols());
  }
  for (std::size_t p = 0; p < this->Mesh.Elements.size(); ++p)
  {
    const std::vector<long long> numbers = numbering.NumbersOf(p);
    this->Append(p, numbering.Lattice(p), nodes(Eigen::all, numbers), weights(numbers));
  }
}

}

FileContents ParseMfemMesh(std::string_view text)
{
  return MeshParser(text).Parse();
}

}
