// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ContactWorker_h
#define hyperpatch_ContactWorker_h

#include "BezierPieceWorker.h"

#include <array>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// Internal to the intersection tests: points of two elements a and b that are one and the same
/// because their control points are. Each direction of an element is either fixed at an end,
/// collapsed (all its points are the same one there), or runs along one of the other's.
struct Contact
{
  enum Kind
  {
    First,
    Last,
    Collapsed,
    Along
  };
  std::array<Kind, 3> KindA{ Along, Along, Along };
  std::array<Kind, 3> KindB{ Along, Along, Along };
  /// For directions of a that run along one of b: which, and its parameter is Sign * t + Shift.
  std::array<int, 3> Partner{ 0, 1, 2 };
  std::array<int, 3> Sign{ 1, 1, 1 };
  std::array<int, 3> Shift{ 0, 0, 0 };
};

/// What two pieces share by a contact: a corner, edge or face of both.
struct SharedFeature
{
  /// Ends at which the directions of the pieces are fixed; -1 where they are not.
  std::array<int, 3> EndA{ -1, -1, -1 };
  std::array<int, 3> EndB{ -1, -1, -1 };
  /// Directions of a along the feature.
  std::vector<int> Tangents;
  /// If the feature is only a part of that of a piece: directions in which a or b has to be halved
  /// first, -1 otherwise.
  int HalveA = -1;
  int HalveB = -1;
};

/// What two pieces share by a contact of their elements, if anything.
[[nodiscard]] std::optional<SharedFeature> FindSharedFeature(
  const Contact& contact, const BezierPiece& a, const BezierPiece& b);

/// The contact of parts of one spline: element b lies `offset` elements after a in each direction.
/// Elements further apart than neighbours have none, and {} is that of parts of one element.
[[nodiscard]] std::optional<Contact> LatticeContact(std::array<int, 3> offset);

/// Contacts of elements by their control points: faces, edges and corners whose control points and
/// (up to a factor) weights agree, raised to the same degrees. Points that belong to a face of
/// which they agree as well are not listed again. a and b may be the same element, whose collapsed
/// sides are contacts then. \param distance up to which control points are the same
[[nodiscard]] std::vector<Contact> FindContacts(
  const BezierPiece& a, const BezierPiece& b, double distance);

/// Bit 4 d + a + 2 b of the edges along direction d (at end a of the next and b of the last of the
/// other directions) that are a single point.
[[nodiscard]] unsigned CollapsedEdges(const BezierPiece& element, double distance);

}

#endif
