// SPDX-License-Identifier: BSD-3-Clause
#include "IntersectionTestWorker.h"

#include "Cone.h"
#include "SharedFeatureTestWorker.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Pieces are not halved below this part of an element in any direction.
constexpr double LeastSize = 1.0 / 65536;
/// How near to where det J is 0 pieces of that size are left out.
constexpr double LeftOut = 64 * LeastSize;
/// Undecided places after which the rest is not looked at any more.
constexpr int MaxFailures = 8;

/// Whether a piece lies on a side of its element.
bool TouchesSide(const BezierPiece& piece, int direction, int end, double distance = 0.0)
{
  return end == 0 ? piece.Low(direction) <= distance : piece.High(direction) >= 1.0 - distance;
}

/// Whether a piece has one of these edges of its element, bits 4 d + a + 2 b, among its own.
bool TouchesEdge(const BezierPiece& piece, unsigned edges, double distance = 0.0)
{
  for (int edge = 0; edge < 12 && edges >> edge != 0; ++edge)
  {
    const int d = edge / 4;
    const int first = d == 0 ? 1 : 0;
    const int second = d == 2 ? 1 : 2;
    if ((edges >> edge & 1) && TouchesSide(piece, first, edge & 1, distance) &&
      TouchesSide(piece, second, edge >> 1 & 1, distance))
    {
      return true;
    }
  }
  return false;
}

/// Whether det J is 0 on a piece or near it, by the bits of ElementValidity::Degenerate.
bool TouchesDegenerate(const BezierPiece& piece, std::uint32_t bits, double distance)
{
  for (int side = 0; side < 6; ++side)
  {
    if ((bits >> side & 1) && TouchesSide(piece, side / 2, side % 2, distance))
    {
      return true;
    }
  }
  for (int corner = 0; corner < 8; ++corner)
  {
    if ((bits >> (18 + corner) & 1) && TouchesSide(piece, 0, corner & 1, distance) &&
      TouchesSide(piece, 1, corner >> 1 & 1, distance) &&
      TouchesSide(piece, 2, corner >> 2, distance))
    {
      return true;
    }
  }
  return TouchesEdge(piece, bits >> 6 & 0xfff, distance);
}

/// Whether derivatives of a piece may be zero somewhere: where an edge is one point, or det J is 0.
bool MayVanish(const BezierPiece& piece, const IntersectionTest::Subject& element)
{
  return TouchesEdge(piece, element.Collapsed) ||
    (element.HasOneSign && TouchesDegenerate(piece, element.Degenerate, 0.0));
}

/// Directions along which a piece has an extent.
std::vector<int> Extents(const BezierPiece& piece)
{
  std::vector<int> directions;
  for (int d = 0; d < 3; ++d)
  {
    if (piece.Degree(d) > 0)
    {
      directions.push_back(d);
    }
  }
  return directions;
}

/// The direction of those in which the piece may still be halved that `measure` is greatest for, or
/// -1.
template <class Measure>
int BestDirection(const BezierPiece& piece, const Measure& measure)
{
  int best = -1;
  double most = -1.0;
  for (const int d : Extents(piece))
  {
    const double value = piece.Size(d) > LeastSize ? measure(d) : -1.0;
    if (value > most)
    {
      most = value;
      best = d;
    }
  }
  return best;
}

}

void IntersectionTest::Begin(
  const Subject& a, const Subject& b, const std::vector<Contact>& contacts)
{
  this->Count = 0;
  this->Failures = 0;
  this->Decided = false;
  this->A = &a;
  this->B = &b;
  this->Contacts = &contacts;
}

bool IntersectionTest::GiveUp(const BezierPiece& a, const BezierPiece& b)
{
  if (this->A->HasOneSign && this->B->HasOneSign &&
    TouchesDegenerate(a, this->A->Degenerate, LeftOut) &&
    TouchesDegenerate(b, this->B->Degenerate, LeftOut))
  {
    return true;
  }
  ++this->Failures;
  this->Decided = this->Decided || (this->Doubt && this->Doubt(a, b));
  return false;
}

bool IntersectionTest::IsOver() const
{
  return this->Decided || this->Failures >= MaxFailures || this->Count >= this->MaxTests;
}

bool IntersectionTest::IsInjective(const Subject& element, const std::vector<Contact>& contacts)
{
  std::vector<Contact> all = contacts;
  all.emplace_back();
  this->Begin(element, element, all);
  ++this->Count;
  if (this->HasIndependentDerivatives(element.Piece))
  {
    return true;
  }
  // Where sides are collapsed the border is none of a ball.
  if (element.HasOneSign && element.Collapsed == 0 && contacts.empty())
  {
    if (this->Border(element.Piece))
    {
      return true;
    }
    if (this->Decided)
    {
      return false;
    }
    this->Failures = 0;
  }
  return this->Self(element.Piece);
}

bool IntersectionTest::MeetOnlyAtContacts(
  const Subject& a, const Subject& b, const std::vector<Contact>& contacts)
{
  this->Begin(a, b, contacts);
  return this->Pair(a.Piece, b.Piece);
}

bool IntersectionTest::Self(const BezierPiece& piece)
{
  if (this->IsOver())
  {
    return false;
  }
  ++this->Count;
  if (this->HasIndependentDerivatives(piece))
  {
    return true;
  }
  const int d = BestDirection(piece, [&piece](int e) { return piece.Bend(e); });
  if (d < 0)
  {
    return this->GiveUp(piece, piece);
  }
  const std::array<BezierPiece, 2> halves = piece.Halves(d);
  // All three, so that a place of doubt shows, but not after one has decided.
  const bool first = this->Self(halves[0]);
  const bool second = this->Self(halves[1]);
  return this->Pair(halves[0], halves[1]) && first && second;
}

bool IntersectionTest::Border(const BezierPiece& element)
{
  std::vector<BezierPiece> faces;
  for (int side = 0; side < 6; ++side)
  {
    faces.push_back(element.AtEnd(side / 2, side % 2));
  }
  for (std::size_t i = 0; i < faces.size(); ++i)
  {
    if (!this->Self(faces[i]))
    {
      return false;
    }
    for (std::size_t j = 0; j < i; ++j)
    {
      if (!this->Pair(faces[i], faces[j]))
      {
        return false;
      }
    }
  }
  return true;
}

bool IntersectionTest::Pair(const BezierPiece& a, const BezierPiece& b)
{
  if (this->IsOver())
  {
    return false;
  }
  ++this->Count;
  if (AreSeparated(a, b))
  {
    return true;
  }
  const bool mayVanish = MayVanish(a, *this->A) || MayVanish(b, *this->B);
  int halveA = -1;
  int halveB = -1;
  for (const Contact& contact : *this->Contacts)
  {
    const std::optional<SharedFeature> feature = FindSharedFeature(contact, a, b);
    if (feature && feature->HalveA < 0 && feature->HalveB < 0)
    {
      if (MeetOnlyAt(*feature, a, b, mayVanish))
      {
        return true;
      }
    }
    else if (feature)
    {
      // Pieces that are too small already are left to the choice below.
      halveA = feature->HalveA >= 0 && a.Size(feature->HalveA) > LeastSize ? feature->HalveA : -1;
      halveB = feature->HalveB >= 0 && b.Size(feature->HalveB) > LeastSize ? feature->HalveB : -1;
    }
  }
  if (halveA < 0 && halveB < 0)
  {
    const int da = BestDirection(a, [&a](int d) { return a.Length(d); });
    const int db = BestDirection(b, [&b](int d) { return b.Length(d); });
    if (da >= 0 && (db < 0 || a.Length(da) >= b.Length(db)))
    {
      halveA = da;
    }
    else
    {
      halveB = db;
    }
  }
  if (halveA < 0 && halveB < 0)
  {
    return this->GiveUp(a, b);
  }
  if (halveA >= 0)
  {
    const std::array<BezierPiece, 2> halves = a.Halves(halveA);
    const bool first = this->Pair(halves[0], b);
    return this->Pair(halves[1], b) && first;
  }
  const std::array<BezierPiece, 2> halves = b.Halves(halveB);
  const bool first = this->Pair(a, halves[0]);
  return this->Pair(a, halves[1]) && first;
}

bool IntersectionTest::HasIndependentDerivatives(const BezierPiece& piece) const
{
  std::vector<Cone> cones;
  for (const int d : Extents(piece))
  {
    cones.push_back(DerivativeCone(piece.Points(), piece.Degrees(), d, piece.Error()));
    if (cones.back().ZeroVectors() > 0 && !MayVanish(piece, *this->A))
    {
      return false;
    }
  }
  return AreIndependent(cones);
}

}
