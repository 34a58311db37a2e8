// SPDX-License-Identifier: BSD-3-Clause
#include "NumberBlock.h"

#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace hyperpatch
{

namespace
{

constexpr std::size_t LargePage = std::size_t{ 1 } << 21;
constexpr std::size_t CacheLine = 64;

}

NumberBlock::NumberBlock(std::size_t size)
  : Numbers(nullptr, Free{ size * sizeof(double) < LargePage ? CacheLine : LargePage })
{
  const std::size_t alignment = this->Numbers.get_deleter().Alignment;
  const std::size_t bytes = size * sizeof(double);
  this->Numbers.reset(static_cast<double*>(::operator new (bytes, std::align_val_t{ alignment })));
#ifdef __linux__
  if (alignment == LargePage)
  {
    // A wish: it works as well without.
    static_cast<void>(madvise(this->Data(), bytes, MADV_HUGEPAGE));
  }
#endif
}

void NumberBlock::Free::operator()(double* numbers) const
{
  ::operator delete (numbers, std::align_val_t{ this->Alignment });
}

}
