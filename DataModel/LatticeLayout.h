// SPDX-License-Identifier: BSD-3-Clause
#ifndef LatticeLayout_h
#define LatticeLayout_h

#include "vtkType.h"

#include <array>
#include <cstddef>

namespace hyperpatch
{

/// The integers of SplineLayout, in this order. Private to the two directions of the conversion.
struct LatticeLayout
{
  static constexpr int CurrentVersion = 1;
  static constexpr int Size = 18;
  enum RoleType
  {
    Geometry = 0,
    Attribute = 1
  };

  int Version = CurrentVersion;
  int Role = Geometry;
  int PatchId = 0;
  std::array<int, 3> Dimensions{ 1, 1, 1 };
  std::array<int, 3> Degrees{ 0, 0, 0 };
  int Rational = 0;
  std::array<int, 3> FirstSpan{ 0, 0, 0 };
  std::array<int, 3> WholeSpans{ 0, 0, 0 };
  int DomainFaces = 0;
  int RelativeHandedness = 1;

  [[nodiscard]] std::array<int, Size> Pack() const
  {
    return { this->Version, this->Role, this->PatchId, this->Dimensions[0], this->Dimensions[1],
      this->Dimensions[2], this->Degrees[0], this->Degrees[1], this->Degrees[2], this->Rational,
      this->FirstSpan[0], this->FirstSpan[1], this->FirstSpan[2], this->WholeSpans[0],
      this->WholeSpans[1], this->WholeSpans[2], this->DomainFaces, this->RelativeHandedness };
  }

  [[nodiscard]] static LatticeLayout Unpack(const std::array<int, Size>& v)
  {
    return { v[0], v[1], v[2], { v[3], v[4], v[5] }, { v[6], v[7], v[8] }, v[9],
      { v[10], v[11], v[12] }, { v[13], v[14], v[15] }, v[16], v[17] };
  }

  [[nodiscard]] vtkIdType NumberOfKnots() const
  {
    vtkIdType count = 0;
    for (std::size_t d = 0; d < 3; ++d)
    {
      count += this->Dimensions[d] + this->Degrees[d] + 1;
    }
    return count;
  }
};

}

#endif
