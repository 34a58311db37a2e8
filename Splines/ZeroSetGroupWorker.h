// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSetGroupWorker_h
#define hyperpatch_ZeroSetGroupWorker_h

#include "ZeroSetGroup.h"
#include "ZeroSetPartsWorker.h"
#include "ZeroSetWorker.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>
#include <vector>

/// The inside of ZeroSetGroup: ZeroSetGroup.cxx finds what meets and leads through the work,
/// ZeroSetExchange.cxx lets the parts agree on what they have in common.

namespace hyperpatch
{

/// Reads numbers one after the other.
class ZeroSetRecord
{
public:
  explicit ZeroSetRecord(const std::vector<double>& numbers)
    : N(numbers)
  {
  }
  [[nodiscard]] bool IsAtEnd() const { return this->At >= this->N.size(); }
  double Number() { return this->N[this->At++]; }
  int Integer() { return static_cast<int>(this->Number()); }
  template <std::size_t Size>
  std::array<double, Size> Numbers()
  {
    std::array<double, Size> numbers{};
    std::copy_n(this->N.begin() + static_cast<std::ptrdiff_t>(this->At), Size, numbers.begin());
    this->At += Size;
    return numbers;
  }
  [[nodiscard]] std::size_t Position() const { return this->At; }
  void Skip(std::size_t count) { this->At += count; }

private:
  const std::vector<double>& N;
  std::size_t At = 0;
};

template <class Numbers>
void Append(std::vector<double>& records, const Numbers& numbers)
{
  for (const auto number : numbers)
  {
    records.push_back(static_cast<double>(number));
  }
}

class ZeroSetGroup::Worker
{
public:
  using Index = std::int64_t;
  using Engine = ZeroSet::Worker;

  Worker(const std::vector<Member>& members, std::vector<Interface> interfaces, Ranks ranks,
    ParallelFor parallelFor);
  bool Extract(const std::function<void(double, double)>& stage);

  [[nodiscard]] std::vector<double> Gathered(const std::vector<double>& records) const
  {
    return this->OfAll.All(records);
  }

  std::vector<std::unique_ptr<ZeroSet>> ZeroSets;

private:
  enum class Outcome
  {
    Finished,
    Aborted,
    Disagreed ///< interfaces were dropped: begin again
  };

  bool Any(bool value) const
  {
    const std::vector<double> all = this->OfAll.All({ value ? 1.0 : 0.0 });
    return std::find(all.begin(), all.end(), 1.0) != all.end();
  }
  /// False if aborted on any rank.
  bool ForAll(const std::function<bool(Engine&)>& work);
  void FindParts();
  /// Sides of parts that are the same: of elements, or of all.
  [[nodiscard]] std::vector<ZeroSetContact> FindAllContacts(
    const std::vector<ZeroSetPart>& parts, bool ofAll);
  void SetSides();
  void CompareSides();
  Outcome Draw(const std::function<void(double, double)>& stage);
  Outcome Finish();
  /// Takes the interfaces away on which a rank has found that both sides differ.
  bool DropDisagreed();
  void ExchangeNodes();
  void ExchangeValues();
  void ExchangeVertices();
  void ExchangeCurves();
  /// A curve is known by a part, the normal of its plane (3 if it is an edge), and its ends.
  using CurveKey = std::array<int, 10>;
  /// A curve as one of the parts around it knows it.
  struct SeenCurve
  {
    CurveKey Key;
    bool Turned;             ///< runs from the second of the ends in the key to the first
    std::array<int, 3> Axis; ///< the direction there of each of ours
    int Joint;               ///< that leads there, or -1
  };
  struct FoundCurve
  {
    bool HasFailed;
    double Error;
    Index Count;
    const double* Points; ///< 6 x Count: parameters in the classes of directions, and the point
  };
  /// A curve from wherever it can be seen, its own part first.
  void FindCurve(
    std::size_t member, const Engine::Curve& curve, std::vector<SeenCurve>& seen) const;
  /// Those that more than one part can see.
  void ForSharedCurves(std::size_t member,
    const std::function<void(Engine::Curve&, const std::vector<SeenCurve>&)>& visit);
  void TakeCurves(std::size_t member, const std::map<CurveKey, FoundCurve>& found);
  void CountTouches();
  void CountOpenEdges();

  [[nodiscard]] Engine& At(std::size_t member) const { return *this->ZeroSets[member]->W; }
  [[nodiscard]] int PartOf(std::size_t member) const { return this->Parts[member]; }
  [[nodiscard]] const ZeroSetPart& Part(std::size_t member) const
  {
    return this->Topology.All()[static_cast<std::size_t>(this->Parts[member])];
  }
  /// Local lines to those of all, and back.
  [[nodiscard]] ZeroSetPlace ToAll(
    std::size_t member, const Engine::Node& low, int axis, int size) const;
  [[nodiscard]] Engine::Node ToOwn(std::size_t member, const std::array<int, 3>& low) const;
  /// Whether any link reaches the place.
  [[nodiscard]] bool IsShared(int part, const ZeroSetPlace& place) const;
  void Disagree(int part, const ZeroSetPlace& place);
  /// A point taken from another side: what it is here. False if it is no point of the surface here.
  bool Take(std::size_t member, Engine::Samples& samples, Index i, const Eigen::Vector3d& place);

  std::vector<Member> Members;
  std::vector<Interface> Interfaces;
  Ranks OfAll;
  ParallelFor For;
  ZeroSetParts Topology;
  std::vector<int> Parts; ///< per member
  std::set<int> Disagreed;
  double Distance = 0.0;         ///< between two sides that count as one
  std::map<int, double> Differs; ///< the same for the field of each value
};

}

#endif
