// SPDX-License-Identifier: BSD-3-Clause
#ifndef ArrayNames_h
#define ArrayNames_h

#include <string>

/// The names of arrays in data objects. They are a file format: scripts and states rely on them.
namespace hyperpatch::names
{

///@{
/// Of models; NURBSConversion.h says what they hold.
inline constexpr const char* Geometry = "Geometry";
inline constexpr const char* Weight = "Weight";
inline constexpr const char* Layout = "SplineLayout";
inline constexpr const char* Knots = "Knots";
inline constexpr const char* Interfaces = "Interfaces";
inline constexpr const char* BoundaryNames = "BoundaryNames";
inline constexpr const char* BoundarySides = "BoundarySides";
///@}

///@{
/// Of VTK's Bezier cells.
inline constexpr const char* BezierWeight = "RationalWeights";
inline constexpr const char* BezierDegrees = "HigherOrderDegrees";
///@}

///@{
/// Of meshes that filters make. Points: unit normals; parameters in the knots of their patch.
/// Cells: the patch; the knot span cell of the patch, u fastest; the side of a patch, 0 to 5, or
/// -1; the number of the isovalue or of the plane; the part of a Jacobian boundary and its number.
inline constexpr const char* Normals = "Normals";
inline constexpr const char* ParametricCoordinates = "ParametricCoordinates";
inline constexpr const char* PatchId = "PatchId";
inline constexpr const char* ElementId = "ElementId";
inline constexpr const char* Side = "Side";
inline constexpr const char* ContourIndex = "ContourIndex";
inline constexpr const char* SliceIndex = "SliceIndex";
inline constexpr const char* Piece = "Piece";
inline constexpr const char* PieceId = "PieceId";
inline constexpr const char* JacobianDeterminant = "JacobianDeterminant";
///@}

///@{
/// Of field data that say what is certain of a result: one number each.
inline constexpr const char* CertifiedCells = "CertifiedCells";
inline constexpr const char* UndecidedCells = "UndecidedCells";
inline constexpr const char* UndecidedBoxes = "UndecidedBoxes"; ///< 7 numbers each
inline constexpr const char* LargestResidual = "LargestResidual";
inline constexpr const char* LargestError = "LargestError";
inline constexpr const char* ToleranceReached = "ToleranceReached";
inline constexpr const char* OpenEdgesOnBoundary = "OpenEdgesOnBoundary";
inline constexpr const char* OpenEdgesOnInterfaces = "OpenEdgesOnInterfaces";
inline constexpr const char* OpenEdgesInside = "OpenEdgesInside";
inline constexpr const char* OpenFacesOnInterfaces = "OpenFacesOnInterfaces";
inline constexpr const char* InvalidElements = "InvalidElements";
inline constexpr const char* UndecidedElements = "UndecidedElements";
///@}

/// Whether point arrays of this name, in a model, are fields of the user's.
[[nodiscard]] inline bool IsAttribute(const std::string& name)
{
  return !name.empty() && name != Weight && name != BezierWeight && name.compare(0, 3, "vtk") != 0;
}

}

#endif
