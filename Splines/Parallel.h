// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Parallel_h
#define hyperpatch_Parallel_h

#include <cstddef>
#include <functional>

namespace hyperpatch
{

/// Runs body(begin, end) over [0, count) in chunks of about `grain`, in any order, on any threads.
/// The kernel has no threads of its own: its callers hand it theirs (vtkSMPTools in the VTK layer).
using ParallelFor = std::function<void(std::ptrdiff_t count, std::ptrdiff_t grain,
  const std::function<void(std::ptrdiff_t begin, std::ptrdiff_t end)>& body)>;

/// The ParallelFor of those who have no threads.
inline void SerialFor(std::ptrdiff_t count, std::ptrdiff_t /*grain*/,
  const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body)
{
  if (count > 0)
  {
    body(0, count);
  }
}

}

#endif
