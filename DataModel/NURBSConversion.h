// SPDX-License-Identifier: BSD-3-Clause
#ifndef NURBSConversion_h
#define NURBSConversion_h

#include "Aggregate.h"
#include "vtkNURBSDataModelModule.h" // for the export macro

#include <string>
#include <vector>

class vtkDataObject;
class vtkPartitionedDataSetCollection;

/// How spline models travel in VTK data objects. This is the only code that knows the array names.
///
/// A model is a vtkPartitionedDataSetCollection. Its partitioned dataset 0, named `Geometry`, has
/// one vtkStructuredGrid per patch (n x m x 1 for a surface, n x 1 x 1 for a curve) whose points
/// are the control points, projected, u fastest. Point data: `Weight` (1 component) where the patch
/// is rational, and one array per attribute in the geometry's basis. Every attribute that has a
/// basis of its own in some patch has a partitioned dataset of its name: its coefficients are point
/// data under that name, with its own `Weight`, and its points are the Greville points of its basis
/// mapped through the geometry, in single precision as a rule, so that it can be looked at in
/// place; they are never read.
///
/// Field data of every grid:
/// - `SplineLayout` (vtkIntArray, 18 values): version (1), role (0 geometry, 1 attribute), patch
///   id, lattice dimensions (3), degrees (3), rational (0 or 1), first span (3), spans of the whole
///   patch (3), domain faces (bit s is set where side s is a face of the patch and not a cut),
///   handedness of the whole patch relative to that of this part (1, -1 or 0), which affine maps
///   leave true.
/// - `Knots` (vtkDoubleArray): the three knot vectors one after the other, dimension + degree + 1
///   numbers each. A direction that is not there has degree 0, one point, two knots.
///
/// Field data of the collection: `Interfaces` (vtkIntArray, 10 components, as in
/// hyperpatch::Interface), `BoundaryNames` (vtkStringArray) and `BoundarySides` (vtkIntArray, 3
/// components: index of the boundary, patch id, side 0..5).
///
/// A grid's role is read from its layout, never from its place. An attribute grid belongs to the
/// geometry grid of the same patch id and first span. Null partitions are legal.
namespace hyperpatch
{

/// True if some leaf of the data is a control lattice, or all its cells are Bezier hexahedra: what
/// FromVTK() is for, though it may still refuse it. Costs nothing but a look at the leaves.
[[nodiscard]] VTKNURBSDATAMODEL_EXPORT bool IsSplineData(vtkDataObject* data);

/// What becomes of the parameter domains in FromVTK().
enum class Domains
{
  Kept,
  Normalised ///< all scaled to [0, 1], those of attributes that do not agree with the geometry's
             ///< too
};

/// The model in a data object. It shares arrays of doubles with the data, which must not be written
/// to while the model is there.
///
/// \param data a collection as above; any other composite of such grids; a bare vtkStructuredGrid
/// with the same field data; or a vtkUnstructuredGrid of VTK_BEZIER_HEXAHEDRON, with optional
/// `RationalWeights` (point data) and `HigherOrderDegrees` (cell data, 3 components), where every
/// cell becomes a patch of one element on [0, 1]^3: its Id is that of the cell array `PatchId` or
/// 0, its FirstSpan is {cell, 0, 0}, a face that two cells share is no domain face. Every numeric
/// point array of a geometry (or Bezier) grid is an attribute in the geometry's basis, except
/// weights and names that start with "vtk". nullptr and grids without points give no patches.
///
/// Geometries have 3 components.
///
/// \throws Error if the data is none of these, if an upstream filter has changed a lattice or
/// dropped its weights, and where the constructors of Spline and Aggregate throw.
[[nodiscard]] VTKNURBSDATAMODEL_EXPORT MultiPatch FromVTK(
  vtkDataObject* data, Domains domains = Domains::Kept);

/// Fills a collection with a model; FromVTK() gives the same model back, bit by bit, but for
/// geometries of 1 or 2 components, whose missing coordinates become 0.
///
/// \param model pass an rvalue where attributes are large: no more than one is there twice
/// \param attributeDatasets attributes that get a partitioned dataset even if no patch here needs
/// it: all pieces of a model must have the same list of datasets, OwnBasisAttributes() of the whole
/// \throws Error if an attribute is named Weight or begins with "vtk".
VTKNURBSDATAMODEL_EXPORT void ToVTK(MultiPatch model, vtkPartitionedDataSetCollection* output,
  const std::vector<std::string>& attributeDatasets = {});

/// Names of the attributes that have a basis of their own in some patch, ascending.
[[nodiscard]] VTKNURBSDATAMODEL_EXPORT std::vector<std::string> OwnBasisAttributes(
  const MultiPatch& model);

/// The part of a model that process `piece` of `numberOfPieces` works on. Whole patches are dealt
/// out where there are enough of them; otherwise patches are cut at knot spans. The union of all
/// pieces is the model, each has all interfaces and boundaries.
[[nodiscard]] VTKNURBSDATAMODEL_EXPORT MultiPatch ExtractPiece(
  const MultiPatch& model, int piece, int numberOfPieces);

}

#endif
