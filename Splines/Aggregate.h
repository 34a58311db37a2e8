// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Aggregate_h
#define hyperpatch_Aggregate_h

#include "Spline.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace hyperpatch
{

/// A named field over the parameter domain of a geometry, with a basis of its own.
struct Attribute
{
  std::string Name;
  Spline Field;
};

/// The six sides of a patch, numbered from 0: u = first, u = last, v = first, ... w = last. (G+Smo
/// and GeoPDEs count the same sides from 1.)
inline constexpr int NumberOfSides = 6;

/// An aggregate (Martin & Cohen 2001, section 2.2): a geometry and any number of attributes, each
/// with its own degrees, knots, lattice and weights; they share only the parameter domain.
class Aggregate
{
public:
  /// \throws Error if a domain of an attribute differs from that of the geometry by more than
  /// 1e-12 of its length, if a name is empty or occurs twice, or if the geometry has not 1 to 3
  /// components.
  explicit Aggregate(Spline geometry, std::vector<Attribute> attributes = {});

  [[nodiscard]] const Spline& Geometry() const { return this->G; }
  [[nodiscard]] const std::vector<Attribute>& Attributes() const& { return this->A; }
  /// Of an aggregate that is needed no more.
  [[nodiscard]] std::vector<Attribute> Attributes() && { return std::move(this->A); }
  /// The attribute of that name, or nullptr.
  [[nodiscard]] const Spline* FindAttribute(const std::string& name) const;

private:
  Spline G;
  std::vector<Attribute> A;
};

/// One patch of a model. When the patch is split, this is the part on a block of knot spans.
struct Patch
{
  int Id = 0;
  Aggregate Body;
  /// Index of the first knot span (non-empty, counted from 0) of this part in the whole patch.
  std::array<int, 3> FirstSpan{ 0, 0, 0 };
  /// Numbers of knot spans of the whole patch; all 0 when this is the whole patch.
  std::array<int, 3> WholeSpans{ 0, 0, 0 };
  /// Which sides are faces of the whole patch rather than cuts.
  std::array<bool, 6> IsDomainFace{ true, true, true, true, true, true };
  /// Handedness() of the whole patch, where a part of it might differ; 0 when this is the whole
  /// patch.
  int WholeHandedness = 0;
};

/// Two patch sides that coincide, in G+Smo's ten integers: `Values` = patch 1, side 1, patch 2,
/// side 2 (sides 1..6), direction map (3), orientation (3).
struct Interface
{
  std::array<int, 10> Values;
};

/// A named set of patch sides; sides are 0..5.
struct Boundary
{
  std::string Name;
  std::vector<std::array<int, 2>> Sides; ///< (patch id, side)
};

/// A model: patches and their topology. What readers give and what the data model carries.
struct MultiPatch
{
  std::vector<Patch> Patches;
  std::vector<Interface> Interfaces;
  std::vector<Boundary> Boundaries;
};

}

#endif
