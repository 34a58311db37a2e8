// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSetPartsWorker_h
#define hyperpatch_ZeroSetPartsWorker_h

#include "Aggregate.h"
#include "CellLines.h"
#include "ZeroSetContactsWorker.h"

#include <array>
#include <cstddef>
#include <vector>

/// Which parts of which patches a group of zero sets has on all ranks, and how they meet. Private
/// to ZeroSetGroup.

namespace hyperpatch
{

/// A patch, or a part of one, in which one zero set is wanted. All ranks know all of them.
struct ZeroSetPart
{
  int Value;      ///< only parts with the same value belong together
  int Patch;      ///< its id
  int Rank;       ///< who has it
  int Member;     ///< its number there
  int Whole = -1; ///< index of the patch
  /// The first knot spans in the patch: parts with the same parameters are elements, each a patch
  /// of its own here.
  std::array<int, 3> FirstSpan{};
  bool IsElement = false;
  std::array<bool, 6> IsDomainFace{};
  std::array<bool, 3> IsThere{};
  std::array<double, 3> First{}, Last{}; ///< of the parameters
  std::array<double, 3> Lengths{};       ///< through the middle, in space
  double LowValue, HighValue;            ///< of samples of the field
  std::array<double, 6> Bounds{};        ///< of samples: low corner, high corner
  struct Break
  {
    double At;
    bool IsCrease;
  };
  std::array<std::vector<Break>, 3> Breaks;
  /// The first and last line, counted in the lines of its whole class of directions.
  std::array<int, 3> FirstLine{}, LastLine{};
};

/// Nodes, edges and curves' ends, in lines of a part's classes of directions.
struct ZeroSetPlace
{
  std::array<int, 3> Low;
  int Axis; ///< 0..2: an edge, or 4 + that; 3: a node
  int Size; ///< of the edge

  [[nodiscard]] int Along() const { return this->Axis == 3 ? -1 : this->Axis % 4; }
};

/// How a part goes on in another one, or in itself, beyond one of its sides.
struct ZeroSetLink
{
  int Side;
  int Other, OtherSide;    ///< the part and its side
  int Line, OtherLine;     ///< of the sides
  std::array<int, 3> Axis; ///< the other's direction of each of ours; lines run the same way
  int Joint;               ///< the interface, or the plane in which a patch is cut
  int Number;              ///< the same for a link and its opposite
  bool IsFirst;            ///< of the two
};

class ZeroSetParts
{
public:
  /// All parts, as every rank has them in the same order, and the interfaces between their patches.
  /// Interfaces whose directions or orientations contradict the others are left out.
  void Set(std::vector<ZeroSetPart> parts, const std::vector<Interface>& interfaces,
    const std::vector<ZeroSetContact>& contacts);
  /// Sets IsElement. Whether any is one.
  static bool FindElements(std::vector<ZeroSetPart>& parts);

  [[nodiscard]] const std::vector<ZeroSetPart>& All() const { return this->P; }
  /// The ways on from a part, without those that were dropped.
  [[nodiscard]] const std::vector<ZeroSetLink>& Links(int part) const
  {
    return this->L[static_cast<std::size_t>(part)];
  }
  [[nodiscard]] int NumberOfLinks() const { return this->LinkCount; }
  /// Takes all links of an interface or cut away. Whether there were any.
  bool Drop(int joint);
  /// Whether the side is one of an interface or a cut, whatever has become of it.
  [[nodiscard]] bool IsListed(int part, int side) const
  {
    return this->Listed[static_cast<std::size_t>(part)][static_cast<std::size_t>(side)];
  }

  /// The lines of a part.
  [[nodiscard]] std::array<CellLines, 3> LinesOf(const ZeroSetPart& part) const;
  /// Where parameters are in the class of a direction, from 0 to 1, and back.
  [[nodiscard]] double ToClass(const ZeroSetPart& part, int direction, double parameter) const;
  [[nodiscard]] double FromClass(const ZeroSetPart& part, int direction, double t) const;
  [[nodiscard]] double ClassParameter(const ZeroSetPart& part, int direction, int line) const;

  /// The same place as seen from the other part. False if the link does not reach it.
  [[nodiscard]] bool Map(const ZeroSetLink& link, ZeroSetPlace& place) const;
  /// A place from wherever it can be seen, the given part first.
  struct Seen
  {
    int Part;
    ZeroSetPlace At;
  };
  void FindAll(int part, const ZeroSetPlace& place, std::vector<Seen>& all) const;

private:
  struct Whole
  {
    int Value, Patch;
    std::array<bool, 3> IsThere{};
    std::array<double, 3> First{}, Last{}, Lengths{};
    std::array<std::size_t, 3> Class{};
    std::array<bool, 3> Mirrored{};
    std::array<bool, 6> IsTaken{};
    std::vector<int> Parts;
  };
  struct Joint
  {
    int Patch1, Side1, Patch2, Side2; ///< indices of patches
    std::array<int, 3> Axis;
  };
  void FindPatches();
  void JoinDirections(
    const std::vector<Interface>& interfaces, const std::vector<ZeroSetContact>& contacts);
  void MakeLines();
  void FindLinks();
  void AddLinks(
    int part, int side, int other, int otherSide, const std::array<int, 3>& axis, int joint);
  [[nodiscard]] int LineOf(const ZeroSetPart& part, int side) const;

  std::vector<ZeroSetPart> P;
  std::vector<Whole> W;
  std::vector<Joint> Joints;
  std::vector<CellLines> Lines;             ///< per class, from 0 to 1
  std::vector<std::vector<double>> BreakAt; ///< per class
  std::vector<std::vector<ZeroSetLink>> L;
  std::vector<std::array<bool, 6>> Listed;
  int LinkCount = 0;
};

}

#endif
