// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_TensorGridWorker_h
#define hyperpatch_TensorGridWorker_h

#include <array>
#include <cstddef>

namespace hyperpatch
{

/// Internal: the layout of the coefficients of a tensor-product polynomial, u fastest.
struct TensorGrid
{
  std::array<int, 3> Size{ 1, 1, 1 };

  [[nodiscard]] std::size_t Count() const
  {
    return this->Stride(2) * static_cast<std::size_t>(this->Size[2]);
  }
  [[nodiscard]] std::size_t Stride(int direction) const
  {
    return static_cast<std::size_t>(direction > 0 ? this->Size[0] : 1) *
      static_cast<std::size_t>(direction > 1 ? this->Size[1] : 1);
  }
  /// Index of a corner; bits 0..2 of `corner` choose the ends.
  [[nodiscard]] std::size_t Corner(int corner) const
  {
    std::size_t index = 0;
    for (int d = 0; d < 3; ++d)
    {
      index += (corner >> d & 1) *
        static_cast<std::size_t>(this->Size[static_cast<std::size_t>(d)] - 1) * this->Stride(d);
    }
    return index;
  }
};

}

#endif
