// SPDX-License-Identifier: BSD-3-Clause
#ifndef Times_h
#define Times_h

#include <chrono>
#include <ctime>

/// Of all threads, in seconds.
inline double CPUTime()
{
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// In seconds, of a clock that never goes back.
inline double WallTime()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

#endif
