// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_IntersectionTestWorker_h
#define hyperpatch_IntersectionTestWorker_h

#include "BezierPieceWorker.h"
#include "ContactWorker.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace hyperpatch
{

/// Internal to injectivity: proves that an element does not meet itself, or that two elements meet
/// only where their control points are the same, by halving until planes or cones tell.
///
/// *Self.* P(t) - P(t') = Jbar (t - t'), where column i of Jbar is in the convex cone of the
/// derivatives in direction i. Where no vectors of the three cones are linearly dependent, P is
/// injective on the box. Otherwise the box is halved; so are pairs of boxes.
///
/// *Pair.* A plane separates the hulls of the control points. Or, for pieces that share a corner,
/// edge or face f: every point of a is f(q) + s with s in the cone of the differences between the
/// control points of a and those of f, and the same for b; with t = s - s' a common point has
/// t = f(q') - f(q), which is impossible if t is 0 only together with s and s', and vectors of the
/// cones of t and of the tangents of f are never dependent.
///
/// *Boundary.* Where det J has one strict sign inside, an element is injective if its border is
/// (Kestelman; Ball): the same tests on the six faces.
///
/// Vectors that are zero because an edge is a single point, or at a border where det J is 0, are
/// left out of the cones: only the points of such an edge, which are one point, may coincide. What
/// lies within 1 / 1024 of an element of a face, edge or corner where det J is 0 is left out where
/// nothing else tells.
///
/// One object per thread.
class IntersectionTest
{
public:
  /// \param maxTests how many pieces and pairs may be looked at per call of the tests below
  explicit IntersectionTest(int maxTests)
    : MaxTests(maxTests)
  {
  }

  /// Called where halving comes to an end without a decision, with the two pieces; returns true to
  /// give up at once, because what it found there decides the whole.
  std::function<bool(const BezierPiece& a, const BezierPiece& b)> Doubt;

  /// What is known of an element.
  struct Subject
  {
    const BezierPiece& Piece;
    /// CollapsedEdges() of it.
    unsigned Collapsed = 0;
    /// det J has a strict sign in the open element, and is 0 to rounding where
    /// ElementValidity::Degenerate tells.
    bool HasOneSign = false;
    std::uint32_t Degenerate = 0;
  };

  /// \param contacts of the element with itself (collapsed sides, seams)
  [[nodiscard]] bool IsInjective(const Subject& element, const std::vector<Contact>& contacts);

  [[nodiscard]] bool MeetOnlyAtContacts(
    const Subject& a, const Subject& b, const std::vector<Contact>& contacts);

  /// Pieces and pairs that the last call has looked at.
  [[nodiscard]] int Tests() const { return this->Count; }

private:
  void Begin(const Subject& a, const Subject& b, const std::vector<Contact>& contacts);
  /// Notes a piece or pair that stays undecided and returns false; true where det J is 0.
  bool GiveUp(const BezierPiece& a, const BezierPiece& b);
  [[nodiscard]] bool IsOver() const;

  bool Self(const BezierPiece& piece);
  bool Border(const BezierPiece& element);
  bool Pair(const BezierPiece& a, const BezierPiece& b);

  [[nodiscard]] bool HasIndependentDerivatives(const BezierPiece& piece) const;

  int MaxTests;
  int Count = 0;
  int Failures = 0;
  bool Decided = false;
  const Subject* A = nullptr;
  const Subject* B = nullptr;
  const std::vector<Contact>* Contacts = nullptr;
};

}

#endif
