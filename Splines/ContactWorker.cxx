// SPDX-License-Identifier: BSD-3-Clause
#include "ContactWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Weights of the same face, from two files' worth of rounding.
constexpr double WeightTolerance = 1e-6;

/// A corner, edge or face of an element: directions that are fixed, at which end, and the others.
struct Feature
{
  std::array<int, 3> End{ -1, -1, -1 };
  std::vector<int> Free;
};

/// All features of so many dimensions.
std::vector<Feature> Features(std::size_t dimension)
{
  std::vector<Feature> all;
  for (int code = 0; code < 27; ++code)
  {
    Feature feature;
    feature.End = { code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1 };
    for (int d = 0; d < 3; ++d)
    {
      if (feature.End[static_cast<std::size_t>(d)] < 0)
      {
        feature.Free.push_back(d);
      }
    }
    if (feature.Free.size() == dimension)
    {
      all.push_back(feature);
    }
  }
  return all;
}

/// Index of the first control point of a feature.
Eigen::Index Begin(const BezierPiece& piece, const std::array<int, 3>& ends)
{
  Eigen::Index index = 0;
  for (int d = 0; d < 3; ++d)
  {
    index += std::max(0, ends[static_cast<std::size_t>(d)]) * piece.Degree(d) * piece.Stride(d);
  }
  return index;
}

double WeightAt(const BezierPiece& piece, Eigen::Index i)
{
  return piece.IsRational() ? piece.Points()(3, i) : 1.0;
}

/// Whether the control points of a feature do not depend on one of its free directions.
bool IsConstantAlong(
  const BezierPiece& piece, const Feature& feature, int direction, double distance)
{
  const Eigen::Index begin = Begin(piece, feature.End);
  const Eigen::Index step = piece.Stride(direction);
  Eigen::Index other = 0;
  int count = 0;
  for (const int d : feature.Free)
  {
    if (d != direction)
    {
      other = piece.Stride(d);
      count = piece.Degree(d);
    }
  }
  for (int j = 0; j <= count; ++j)
  {
    const auto first = piece.Projected().col(begin + j * other);
    for (int i = 1; i <= piece.Degree(direction); ++i)
    {
      if ((piece.Projected().col(begin + j * other + i * step) - first).norm() > distance)
      {
        return false;
      }
    }
  }
  return true;
}

bool IsCollapsed(const BezierPiece& piece, const Feature& feature, double distance)
{
  return std::any_of(feature.Free.begin(), feature.Free.end(),
    [&](int d) { return IsConstantAlong(piece, feature, d, distance); });
}

/// A correspondence of the free directions of two features of one dimension.
struct Orientation
{
  bool Swap;
  std::array<bool, 2> Flip;
};

/// The control points of a face, edge or corner, first free direction fastest.
struct FeatureLattice
{
  std::array<int, 2> Degrees{ 0, 0 };
  Eigen::Matrix4Xd Points; ///< homogeneous

  [[nodiscard]] Eigen::Index Index(int i, int j) const { return i + j * (this->Degrees[0] + 1); }

  void RaiseTo(const std::array<int, 2>& degrees)
  {
    for (std::size_t d = 0; d < 2; ++d)
    {
      while (this->Degrees[d] < degrees[d])
      {
        FeatureLattice raised{ this->Degrees, {} };
        const int n = ++raised.Degrees[d];
        raised.Points.resize(4, (raised.Degrees[0] + 1) * (raised.Degrees[1] + 1));
        for (int j = 0; j <= raised.Degrees[1]; ++j)
        {
          for (int i = 0; i <= raised.Degrees[0]; ++i)
          {
            const int k = d == 0 ? i : j;
            const auto at = [&](int l)
            {
              const int within = std::clamp(l, 0, n - 1);
              return this->Points.col(d == 0 ? this->Index(within, j) : this->Index(i, within));
            };
            raised.Points.col(raised.Index(i, j)) = (k * at(k - 1) + (n - k) * at(k)) / n;
          }
        }
        *this = std::move(raised);
      }
    }
  }
};

/// Whether all control points agree, those of the lower degree raised to the higher one.
bool Agree(const BezierPiece& a, const Feature& fa, const BezierPiece& b, const Feature& fb,
  const Orientation& orientation, double distance)
{
  std::array<int, 2> na{ 0, 0 };
  std::array<int, 2> nb{ 0, 0 };
  std::array<Eigen::Index, 2> stepA{ 0, 0 };
  std::array<Eigen::Index, 2> stepB{ 0, 0 };
  const Eigen::Index beginA = Begin(a, fa.End);
  Eigen::Index beginB = Begin(b, fb.End);
  for (std::size_t i = 0; i < fa.Free.size(); ++i)
  {
    const int da = fa.Free[i];
    const int db = fb.Free[orientation.Swap ? 1 - i : i];
    na[i] = a.Degree(da);
    nb[i] = b.Degree(db);
    stepA[i] = a.Stride(da);
    stepB[i] = b.Stride(db);
    if (orientation.Flip[i])
    {
      beginB += nb[i] * stepB[i];
      stepB[i] = -stepB[i];
    }
  }
  // Ends first: they differ where the features do.
  const auto areNear = [&](Eigen::Index pa, Eigen::Index pb)
  { return (a.Projected().col(pa) - b.Projected().col(pb)).norm() <= distance; };
  if (!areNear(beginA, beginB) ||
    !areNear(
      beginA + na[0] * stepA[0] + na[1] * stepA[1], beginB + nb[0] * stepB[0] + nb[1] * stepB[1]))
  {
    return false;
  }
  const auto latticeOf = [](const BezierPiece& piece, Eigen::Index begin,
                           const std::array<Eigen::Index, 2>& step, const std::array<int, 2>& n)
  {
    FeatureLattice lattice{ n, Eigen::Matrix4Xd(4, (n[0] + 1) * (n[1] + 1)) };
    for (int j = 0; j <= n[1]; ++j)
    {
      for (int i = 0; i <= n[0]; ++i)
      {
        const Eigen::Index at = begin + i * step[0] + j * step[1];
        lattice.Points.col(lattice.Index(i, j)) << WeightAt(piece, at) * piece.Projected().col(at),
          WeightAt(piece, at);
      }
    }
    return lattice;
  };
  FeatureLattice ofA = latticeOf(a, beginA, stepA, na);
  FeatureLattice ofB = latticeOf(b, beginB, stepB, nb);
  ofA.RaiseTo(nb);
  ofB.RaiseTo(na);
  for (Eigen::Index i = 0; i < ofA.Points.cols(); ++i)
  {
    const double ratio =
      ofA.Points(3, i) * ofB.Points(3, 0) / (ofA.Points(3, 0) * ofB.Points(3, i));
    if (!((ofA.Points.col(i).hnormalized() - ofB.Points.col(i).hnormalized()).norm() <= distance) ||
      !(std::abs(ratio - 1.0) <= WeightTolerance))
    {
      return false;
    }
  }
  return true;
}

/// Kinds of the directions of an element at a feature, those of which the points around do not
/// depend collapsed.
std::array<Contact::Kind, 3> Kinds(
  const BezierPiece& element, const Feature& feature, double distance)
{
  std::array<Contact::Kind, 3> kinds{};
  std::vector<int> fixed;
  for (int d = 0; d < 3; ++d)
  {
    const int end = feature.End[static_cast<std::size_t>(d)];
    kinds[static_cast<std::size_t>(d)] = end < 0 ? Contact::Along
      : end == 0                                 ? Contact::First
                                                 : Contact::Last;
    if (end >= 0)
    {
      fixed.push_back(d);
    }
  }
  // The largest set of fixed directions that may be freed; one stays fixed.
  std::vector<int> best;
  for (unsigned mask = 1; mask < (1u << fixed.size()) - 1; ++mask)
  {
    Feature larger = feature;
    std::vector<int> freed;
    for (std::size_t i = 0; i < fixed.size(); ++i)
    {
      if (mask >> i & 1)
      {
        larger.End[static_cast<std::size_t>(fixed[i])] = -1;
        freed.push_back(fixed[i]);
      }
    }
    larger.Free.clear();
    for (int d = 0; d < 3; ++d)
    {
      if (larger.End[static_cast<std::size_t>(d)] < 0)
      {
        larger.Free.push_back(d);
      }
    }
    const bool same = larger.Free.size() < 3 &&
      std::all_of(freed.begin(), freed.end(),
        [&](int d) { return IsConstantAlong(element, larger, d, distance); });
    if (same && freed.size() > best.size())
    {
      best = freed;
    }
  }
  for (const int d : best)
  {
    kinds[static_cast<std::size_t>(d)] = Contact::Collapsed;
  }
  return kinds;
}

bool AreEqual(const Contact& a, const Contact& b)
{
  return a.KindA == b.KindA && a.KindB == b.KindB && a.Partner == b.Partner && a.Sign == b.Sign &&
    a.Shift == b.Shift;
}

bool HasCollapsed(const std::array<Contact::Kind, 3>& kinds)
{
  return std::find(kinds.begin(), kinds.end(), Contact::Collapsed) != kinds.end();
}

/// Whether the points of `part` are points of the larger contact `whole` too, with the same
/// correspondence.
bool Contains(const Contact& whole, const Contact& part)
{
  if (HasCollapsed(part.KindA) || HasCollapsed(part.KindB))
  {
    return false;
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (whole.KindA[d] != Contact::Along)
    {
      if (whole.KindA[d] != part.KindA[d])
      {
        return false;
      }
      continue;
    }
    const auto e = static_cast<std::size_t>(whole.Partner[d]);
    if (part.KindA[d] == Contact::Along)
    {
      if (part.Partner[d] != whole.Partner[d] || part.Sign[d] != whole.Sign[d])
      {
        return false;
      }
    }
    else
    {
      const int end = part.KindA[d] == Contact::First ? 0 : 1;
      const int there = whole.Sign[d] * end + whole.Shift[d];
      if (part.KindB[e] != (there == 0 ? Contact::First : Contact::Last))
      {
        return false;
      }
    }
  }
  for (std::size_t e = 0; e < 3; ++e)
  {
    if (whole.KindB[e] != Contact::Along && whole.KindB[e] != part.KindB[e])
    {
      return false;
    }
  }
  return true;
}

bool IsIdentity(const Contact& contact)
{
  bool same = contact.KindA == contact.KindB && !HasCollapsed(contact.KindA);
  for (std::size_t d = 0; d < 3; ++d)
  {
    same = same &&
      (contact.KindA[d] != Contact::Along ||
        (contact.Partner[d] == static_cast<int>(d) && contact.Sign[d] > 0));
  }
  return same;
}

}

std::optional<SharedFeature> FindSharedFeature(
  const Contact& contact, const BezierPiece& a, const BezierPiece& b)
{
  SharedFeature feature;
  const auto fix = [](Contact::Kind kind, const BezierPiece& piece, int d, int& end)
  {
    end = kind == Contact::First ? 0 : 1;
    return kind == Contact::First ? piece.Low(d) == 0.0 : piece.High(d) == 1.0;
  };
  for (int d = 0; d < 3; ++d)
  {
    const auto i = static_cast<std::size_t>(d);
    if ((contact.KindA[i] == Contact::First || contact.KindA[i] == Contact::Last) &&
      !fix(contact.KindA[i], a, d, feature.EndA[i]))
    {
      return std::nullopt;
    }
    if ((contact.KindB[i] == Contact::First || contact.KindB[i] == Contact::Last) &&
      !fix(contact.KindB[i], b, d, feature.EndB[i]))
    {
      return std::nullopt;
    }
    if (contact.KindA[i] == Contact::Collapsed)
    {
      feature.EndA[i] = 0;
    }
    if (contact.KindB[i] == Contact::Collapsed)
    {
      feature.EndB[i] = 0;
    }
  }
  for (int d = 0; d < 3; ++d)
  {
    const auto i = static_cast<std::size_t>(d);
    if (contact.KindA[i] != Contact::Along)
    {
      continue;
    }
    const int e = contact.Partner[i];
    // Dyadic numbers: exact.
    const double first = contact.Sign[i] * a.Low(d) + contact.Shift[i];
    const double last = contact.Sign[i] * a.High(d) + contact.Shift[i];
    const double low = std::min(first, last);
    const double high = std::max(first, last);
    if (high < b.Low(e) || b.High(e) < low)
    {
      return std::nullopt;
    }
    if (low < high && b.Size(e) > 0.0 && (high == b.Low(e) || b.High(e) == low))
    {
      feature.EndB[static_cast<std::size_t>(e)] = high == b.Low(e) ? 0 : 1;
      feature.EndA[i] = (high == b.Low(e)) == (contact.Sign[i] > 0) ? 1 : 0;
    }
    else if (low == high || b.Size(e) == 0.0)
    {
      // A piece without extent along d: the other one may meet it at an end, or inside.
      const double at = low == high ? low : b.Low(e);
      if (low < high)
      {
        if (at != low && at != high)
        {
          feature.HalveA = d;
        }
        feature.EndA[i] = (at == low) == (contact.Sign[i] > 0) ? 0 : 1;
      }
      if (b.Size(e) > 0.0)
      {
        if (at != b.Low(e) && at != b.High(e))
        {
          feature.HalveB = e;
        }
        feature.EndB[static_cast<std::size_t>(e)] = at == b.Low(e) ? 0 : 1;
      }
    }
    else if (low == b.Low(e) && high == b.High(e))
    {
      feature.Tangents.push_back(d);
    }
    else if (high - low > b.Size(e))
    {
      feature.HalveA = d;
    }
    else
    {
      feature.HalveB = e;
    }
  }
  return feature;
}

std::optional<Contact> LatticeContact(std::array<int, 3> offset)
{
  Contact contact;
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (std::abs(offset[d]) > 1)
    {
      return std::nullopt;
    }
    contact.Shift[d] = -offset[d];
  }
  return contact;
}

std::vector<Contact> FindContacts(const BezierPiece& a, const BezierPiece& b, double distance)
{
  std::vector<Contact> contacts;
  if ((a.BoxLow().array() > b.BoxHigh().array() + distance).any() ||
    (b.BoxLow().array() > a.BoxHigh().array() + distance).any())
  {
    return contacts;
  }
  // Faces, edges and corners have points in common only if corners have.
  bool any = false;
  for (int i = 0; i < 64 && !any; ++i)
  {
    any =
      (a.Projected().col(a.Corner(i % 8)) - b.Projected().col(b.Corner(i / 8))).norm() <= distance;
  }
  for (int dimension = 2; any && dimension >= 0; --dimension)
  {
    static const std::array<std::vector<Feature>, 3> all{ Features(0), Features(1), Features(2) };
    const std::vector<Feature>& features = all[static_cast<std::size_t>(dimension)];
    const int orientations = dimension == 2 ? 8 : dimension == 1 ? 2 : 1;
    for (const Feature& fa : features)
    {
      for (const Feature& fb : features)
      {
        for (int o = 0; o < orientations; ++o)
        {
          const Orientation orientation{ (o & 4) != 0, { (o & 1) != 0, (o & 2) != 0 } };
          // What is collapsed is listed as the lower feature that it is.
          if (!Agree(a, fa, b, fb, orientation, distance) || IsCollapsed(a, fa, distance) ||
            IsCollapsed(b, fb, distance))
          {
            continue;
          }
          Contact contact;
          contact.KindA = Kinds(a, fa, distance);
          contact.KindB = Kinds(b, fb, distance);
          contact.Partner = { -1, -1, -1 };
          for (std::size_t i = 0; i < fa.Free.size(); ++i)
          {
            const auto d = static_cast<std::size_t>(fa.Free[i]);
            contact.Partner[d] = fb.Free[orientation.Swap ? 1 - i : i];
            contact.Sign[d] = orientation.Flip[i] ? -1 : 1;
            contact.Shift[d] = orientation.Flip[i] ? 1 : 0;
          }
          const bool isOfItself = &a == &b && IsIdentity(contact);
          const bool isKnown = std::any_of(contacts.begin(), contacts.end(),
            [&contact](const Contact& other)
            { return AreEqual(other, contact) || Contains(other, contact); });
          if (!isOfItself && !isKnown)
          {
            contacts.push_back(contact);
          }
        }
      }
    }
  }
  return contacts;
}

unsigned CollapsedEdges(const BezierPiece& element, double distance)
{
  unsigned bits = 0;
  for (int edge = 0; edge < 12; ++edge)
  {
    const int d = edge / 4;
    const int first = d == 0 ? 1 : 0;
    const int second = d == 2 ? 1 : 2;
    Feature feature;
    feature.Free = { d };
    feature.End[static_cast<std::size_t>(first)] = edge & 1;
    feature.End[static_cast<std::size_t>(second)] = edge >> 1 & 1;
    if (IsConstantAlong(element, feature, d, distance))
    {
      bits |= 1u << edge;
    }
  }
  return bits;
}

}
