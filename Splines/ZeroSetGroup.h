// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSetGroup_h
#define hyperpatch_ZeroSetGroup_h

#include "Aggregate.h"
#include "Parallel.h"
#include "Prepared.h"
#include "ZeroSet.h"

#include <functional>
#include <memory>
#include <vector>

namespace hyperpatch
{

/// The zero sets of a field that goes on from patch to patch, as one surface without cracks.
///
/// Patches meet at interfaces (of any of the 8 orientations, also with themselves: the seam of a
/// pipe), parts of a patch where it is cut. What meets gets the same lines on both sides of the
/// common face (the union of all breaks; equally many root boxes), and all know where another
/// halved a box. One side's values at nodes, points on edges and points of curves are then taken by
/// all: points on interfaces occur once per side with the same bits in their coordinates, each with
/// the parameters, normal and attributes of its side.
///
/// That is only done where position and field agree on both sides to AgreementTolerance, of the
/// extent of the model and of the range of the field: at a grid of samples of each common face, and
/// at every point of the surface on it. An interface on which they do not, or whose orientation
/// contradicts that of others (as on a one-sided ring of patches), is left open, and the open edges
/// are counted.
///
/// Where no interfaces are known, and for elements (parts of a patch that all have the same
/// parameters, as Bezier cells), sides that coincide are found.
///
/// The patches may be spread over ranks, each of which has a group of its own part.
class ZeroSetGroup
{
public:
  struct Member
  {
    const Patch* On;
    std::shared_ptr<const PreparedAggregate> Body; ///< of that patch
    const ScalarField* Field;
    int Value = 0; ///< members with the same value belong together, one of each patch or part
    /// Those of a zero set alone; `For` is chosen by the group.
    ZeroSetOptions Options;
  };

  /// The records of all ranks, one after the other; all ranks must call it.
  using Gather = std::function<std::vector<double>(const std::vector<double>& records)>;
  struct Ranks
  {
    int Own = 0;
    Gather All = [](const std::vector<double>& records) { return records; };
  };

  /// Bounds gaps of conforming interfaces; see above.
  static constexpr double AgreementTolerance = 1e-6;

  /// Keeps references to the patches and fields, which must outlive it.
  /// \param members on this rank
  /// \param interfaces between patches, on any rank and perhaps on several
  ZeroSetGroup(const std::vector<Member>& members, std::vector<Interface> interfaces, Ranks ranks,
    ParallelFor parallelFor = SerialFor);
  ZeroSetGroup(const std::vector<Member>& members, std::vector<Interface> interfaces);
  ~ZeroSetGroup();

  /// All ranks must call it. False if aborted.
  /// \param stage (begin, end), called before each step with the part of all work that it is
  bool Extract(const std::function<void(double begin, double end)>& stage = [](double, double) {});

  /// Of one of the members here, in the order in which they were given.
  [[nodiscard]] const ZeroSetMesh& Mesh(std::size_t member) const;
  /// The same to keep: the group has it no more.
  [[nodiscard]] ZeroSetMesh TakeMesh(std::size_t member);
  [[nodiscard]] const std::vector<ParameterBox>& UndecidedBoxes(std::size_t member) const;
  /// Of all members here together.
  [[nodiscard]] ZeroSetCertificate Certificate() const;
  /// Of all members on all ranks; all ranks must ask.
  [[nodiscard]] ZeroSetCertificate TotalCertificate() const;

private:
  class Worker;
  std::unique_ptr<Worker> W;
};

}

#endif
