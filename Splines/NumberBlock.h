// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_NumberBlock_h
#define hyperpatch_NumberBlock_h

#include <cstddef>
#include <memory>

namespace hyperpatch
{

/// Memory for numbers, not initialised. A large block asks the system for large pages: the first
/// touch of each small one costs several times what is written to it.
class NumberBlock
{
public:
  explicit NumberBlock(std::size_t size);

  [[nodiscard]] double* Data() const { return this->Numbers.get(); }

private:
  struct Free
  {
    std::size_t Alignment;
    void operator()(double* numbers) const;
  };
  std::unique_ptr<double, Free> Numbers;
};

}

#endif
