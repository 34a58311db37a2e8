// SPDX-License-Identifier: BSD-3-Clause
#include "GlobalInjectivity.h"

#include "DoublePointWorker.h"
#include "Error.h"
#include "IntersectionTestWorker.h"
#include "Measures.h"
#include "ModelElementsWorker.h"
#include "OverlapsWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <utility>

namespace hyperpatch
{

namespace
{

DoublePoint MakeWitness(const ModelElement& a, const ModelElement& b, const SameImage& same)
{
  return { { a.PatchId, b.PatchId }, { a.ToPatch(same.A), b.ToPatch(same.B) },
    { same.Point[0], same.Point[1], same.Point[2] } };
}

/// Two points with one image next to the common face of neighbours of different handedness.
std::optional<SameImage> FindAcrossFace(
  const ModelElement& a, const ModelElement& b, std::size_t direction)
{
  for (const double distance : { 0.1, 0.03, 0.01, 0.003, 0.001 })
  {
    std::array<double, 3> start{ 0.5, 0.5, 0.5 };
    std::array<double, 3> guess = start;
    start[direction] = 1.0 - distance;
    guess[direction] =
      distance * (a.High[direction] - a.Low[direction]) / (b.High[direction] - b.Low[direction]);
    if (auto same = FindSameImage(a.Piece, start, b.Piece, guess, false))
    {
      return same;
    }
  }
  return std::nullopt;
}

/// Where det J has both signs in a patch, which is not injective then: an injective map of a
/// connected domain has one local degree.
class Folds
{
public:
  Folds(
    const std::vector<ModelElement>& elements, const std::vector<const ElementValidity*>& validity)
    : Elements(elements)
    , Validity(validity)
  {
    std::map<std::tuple<int, int, int, int>, std::size_t> places;
    std::map<std::size_t, std::array<bool, 2>> signs;
    for (std::size_t e = 0; e < elements.size(); ++e)
    {
      const ElementValidity& element = *validity[e];
      if (element.Positive && element.Negative)
      {
        this->Inside.push_back(e);
      }
      std::array<bool, 2>& has = signs[elements[e].Patch];
      has[0] = has[0] || element.Positive;
      has[1] = has[1] || element.Negative;
      this->Any = this->Any || (has[0] && has[1]);
      const auto& [u, v, w] = elements[e].Span;
      places[{ elements[e].PatchId, u, v, w }] = e;
    }
    // Neighbours may be of two parts of a patch.
    for (const auto& [place, a] : places)
    {
      const auto [patch, u, v, w] = place;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const auto next = places.find({ patch, u + (d == 0), v + (d == 1), w + (d == 2) });
        if (next != places.end() && validity[a]->Sign * validity[next->second]->Sign < 0 &&
          LatticeOffset(elements[a], elements[next->second]))
        {
          this->Between.push_back({ a, next->second, d });
        }
      }
    }
    this->Any = this->Any || !this->Inside.empty() || !this->Between.empty();
  }

  [[nodiscard]] bool AreThere() const { return this->Any; }

  /// Two points with one image, if they are found.
  [[nodiscard]] std::optional<DoublePoint> FindDoublePoint() const
  {
    int left = Attempts;
    for (std::size_t i = 0; i < this->Inside.size() && left > 0; ++i, --left)
    {
      const std::size_t e = this->Inside[i];
      const ModelElement& element = this->Elements[e];
      if (const auto same =
            FindSameImageAtFold(element.Piece, element.FromPatch(*this->Validity[e]->Positive),
              element.FromPatch(*this->Validity[e]->Negative)))
      {
        return MakeWitness(element, element, *same);
      }
    }
    for (std::size_t i = 0; i < this->Between.size() && left > 0; ++i, --left)
    {
      const auto& [a, b, direction] = this->Between[i];
      if (const auto same = FindAcrossFace(this->Elements[a], this->Elements[b], direction))
      {
        return MakeWitness(this->Elements[a], this->Elements[b], *same);
      }
    }
    return std::nullopt;
  }

private:
  /// One will do, and where many fail the rest is not likely to help.
  static constexpr int Attempts = 100;

  const std::vector<ModelElement>& Elements;
  const std::vector<const ElementValidity*>& Validity;
  std::vector<std::size_t> Inside;
  /// Elements, and the direction from the first to the second.
  std::vector<std::array<std::size_t, 3>> Between;
  bool Any = false;
};

/// What was known before about pairs of elements of which neither has changed.
class Knowledge
{
public:
  explicit Knowledge(const KnownInjectivity* known)
    : Known(known)
  {
  }

  /// The item with these elements, or nullptr; a double point is looked for anew.
  [[nodiscard]] const InjectivityItem* Find(int a, int b) const
  {
    if (!this->Known || this->Known->Changed[static_cast<std::size_t>(a)] ||
      this->Known->Changed[static_cast<std::size_t>(b)])
    {
      return nullptr;
    }
    const std::vector<InjectivityItem>& items = this->Known->Result->Items;
    const auto comesBefore = [](const InjectivityItem& item, const std::array<int, 2>& pair)
    { return std::make_pair(item.A, item.B) < std::make_pair(pair[0], pair[1]); };
    const auto it =
      std::lower_bound(items.begin(), items.end(), std::array<int, 2>{ a, b }, comesBefore);
    const bool found = it != items.end() && it->A == a && it->B == b && it->Verdict >= 0;
    return found ? &*it : nullptr;
  }

private:
  const KnownInjectivity* Known;
};

/// Whether a point of an element is further inside it than a distance, along its derivatives.
bool IsInside(const ModelElement& element, const std::array<double, 3>& parameters, double distance)
{
  const Eigen::Matrix3d j = EvaluateElement(element.Piece, parameters).J;
  for (int d = 0; d < 3; ++d)
  {
    const double t = parameters[static_cast<std::size_t>(d)];
    if (!(std::min(t, 1.0 - t) * j.col(d).norm() > distance))
    {
      return false;
    }
  }
  return true;
}

/// Tests elements and pairs, and collects what they tell.
class Work
{
public:
  Work(const std::vector<ModelElement>& elements,
    const std::vector<const ElementValidity*>& validity, const InjectivityOptions& options,
    double distance)
    : Elements(elements)
    , Validity(validity)
    , Options(options)
    , Distance(distance)
  {
  }

  void Test(IntersectionTest& test, InjectivityItem& item)
  {
    const ModelElement& a = this->Elements[static_cast<std::size_t>(item.A)];
    const ModelElement& b = this->Elements[static_cast<std::size_t>(item.B)];
    const bool areOne = item.A == item.B;
    std::optional<SameImage> same;
    test.Doubt = [&](const BezierPiece& pieceA, const BezierPiece& pieceB)
    {
      if (&pieceA != &pieceB)
      {
        same = this->FindSame(a, pieceA.Centre(), b, pieceB.Centre());
      }
      return same.has_value();
    };
    const std::vector<Contact> contacts = ContactsOf(a, b, this->Distance);
    const IntersectionTest::Subject subjectA = this->SubjectOf(item.A);
    const bool certified = areOne
      ? test.IsInjective(subjectA, contacts)
      : test.MeetOnlyAtContacts(subjectA, this->SubjectOf(item.B), contacts);
    item.Verdict = certified ? 1 : same ? -1 : 0;
    this->Boxes += test.Tests();
    if (same)
    {
      // The same one in any order of the work.
      const std::lock_guard<std::mutex> lock(this->Mutex);
      const std::array<int, 2> pair{ item.A, item.B };
      if (!this->Witness || pair < this->WitnessPair)
      {
        this->Witness = MakeWitness(a, b, *same);
        this->WitnessPair = pair;
      }
    }
  }

  std::atomic<std::int64_t> Boxes{ 0 };
  std::optional<DoublePoint> Witness;

private:
  /// Two points with one image near two places where pieces could not be told apart, or from one of
  /// these on inwards.
  [[nodiscard]] std::optional<SameImage> FindSame(const ModelElement& a,
    const std::array<double, 3>& atA, const ModelElement& b, const std::array<double, 3>& atB) const
  {
    for (const double inwards : { 0.0, 1e-4, 1e-3, 1e-2, 1e-1 })
    {
      for (const bool swapped : { false, true })
      {
        std::array<double, 3> start = swapped ? atB : atA;
        for (double& t : start)
        {
          t += inwards * (0.5 - t);
        }
        auto same = swapped ? FindSameImage(b.Piece, start, a.Piece, atA, &a == &b)
                            : FindSameImage(a.Piece, start, b.Piece, atB, &a == &b);
        if (same && swapped)
        {
          std::swap(same->A, same->B);
        }
        // Patches of which the control points differ that much may overlap that much.
        if (same &&
          (LatticeOffset(a, b) ||
            (IsInside(a, same->A, this->Distance) && IsInside(b, same->B, this->Distance))))
        {
          return same;
        }
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] IntersectionTest::Subject SubjectOf(int number) const
  {
    const auto i = static_cast<std::size_t>(number);
    const ModelElement& element = this->Elements[i];
    return { element.Piece, element.Collapsed, this->Validity[i]->Sign != 0,
      this->Validity[i]->Degenerate };
  }

  const std::vector<ModelElement>& Elements;
  const std::vector<const ElementValidity*>& Validity;
  InjectivityOptions Options;
  double Distance;
  std::mutex Mutex;
  std::array<int, 2> WitnessPair{};
};

/// All elements, and all pairs whose bounds overlap, of this share; ascending.
std::vector<InjectivityItem> MakeItems(
  const std::vector<ModelElement>& elements, const InjectivityOptions& options, std::size_t& pairs)
{
  const auto n = static_cast<Eigen::Index>(elements.size());
  Eigen::Matrix3Xd low(3, n);
  Eigen::Matrix3Xd high(3, n);
  std::vector<InjectivityItem> items;
  // Whichever pairs there are, one stays with its share.
  const auto isMine = [&options](int a, int b)
  {
    return (static_cast<std::size_t>(a) * 31 + static_cast<std::size_t>(b)) % options.Shares ==
      options.Share;
  };
  for (int e = 0; e < n; ++e)
  {
    low.col(e) = elements[static_cast<std::size_t>(e)].Piece.BoxLow();
    high.col(e) = elements[static_cast<std::size_t>(e)].Piece.BoxHigh();
    if (isMine(e, e))
    {
      items.push_back({ e, e, 0 });
    }
  }
  const std::vector<std::array<int, 2>> overlaps = FindOverlaps(low, high);
  pairs = overlaps.size();
  for (const auto& [a, b] : overlaps)
  {
    if (isMine(a, b))
    {
      items.push_back({ a, b, 0 });
    }
  }
  std::sort(items.begin(), items.end(),
    [](const InjectivityItem& a, const InjectivityItem& b)
    { return std::make_pair(a.A, a.B) < std::make_pair(b.A, b.B); });
  return items;
}

}

Injectivity TestInjectivity(const MultiPatch& model, const std::vector<PatchValidity>& validity,
  const InjectivityOptions& options, const ParallelFor& parallelFor, const KnownInjectivity* known)
{
  if (options.MaxTests < 1 || !(options.ContactTolerance >= 0.0) || options.Shares < 1 ||
    options.Share >= options.Shares)
  {
    throw Error("injectivity needs at least 1 test per pair, a contact tolerance that is not "
                "negative, and a share of those there are");
  }
  const Bounds bounds = ControlPointBounds(model);
  const double distance = options.ContactTolerance *
    std::hypot(bounds.High[0] - bounds.Low[0], bounds.High[1] - bounds.Low[1],
      bounds.High[2] - bounds.Low[2]);
  const std::vector<ModelElement> elements = MakeElements(model, distance, parallelFor);
  std::vector<const ElementValidity*> byElement;
  for (const PatchValidity& patch : validity)
  {
    for (const ElementValidity& element : patch.Elements)
    {
      byElement.push_back(&element);
    }
  }
  if (byElement.size() != elements.size() || (known && known->Changed.size() != elements.size()))
  {
    throw Error("the model has " + std::to_string(elements.size()) +
      " elements, but other numbers of verdicts were given");
  }

  Injectivity result;
  result.Elements = elements.size();
  for (const ModelElement& element : elements)
  {
    result.CollapsedElements += element.Collapsed != 0;
  }
  const Folds folds(elements, byElement);
  if (folds.AreThere())
  {
    result.Verdict = -1;
    result.Witness = folds.FindDoublePoint();
    return result;
  }

  result.Items = MakeItems(elements, options, result.Pairs);
  const Knowledge knowledge(known);
  std::vector<InjectivityItem*> unknown;
  for (InjectivityItem& item : result.Items)
  {
    if (const InjectivityItem* before = knowledge.Find(item.A, item.B))
    {
      item.Verdict = before->Verdict;
    }
    else
    {
      unknown.push_back(&item);
    }
  }
  result.Tested = unknown.size();
  Work work(elements, byElement, options, distance);
  parallelFor(static_cast<std::ptrdiff_t>(unknown.size()), 32,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      IntersectionTest test(options.MaxTests);
      for (std::ptrdiff_t i = begin; i < end; ++i)
      {
        work.Test(test, *unknown[static_cast<std::size_t>(i)]);
      }
    });
  result.Boxes = work.Boxes;
  result.Witness = work.Witness;
  for (const InjectivityItem& item : result.Items)
  {
    result.UndecidedElements += item.Verdict == 0 && item.A == item.B;
    result.UndecidedPairs += item.Verdict == 0 && item.A != item.B;
    result.Verdict = std::min(result.Verdict, item.Verdict);
  }
  return result;
}

}
