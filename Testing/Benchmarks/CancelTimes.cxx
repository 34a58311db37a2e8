// SPDX-License-Identifier: BSD-3-Clause
// How long a user who cancels a filter waits: another thread cancels at ten times of its run.
//
//   CancelTimes [spans [filter]]
//
// Waits are in wall time and in CPU time of all threads; on a machine that others use too, the
// larger of what one thread and all threads would need lies between.
#include "EveryFilterInput.h"
#include "Times.h"

#include "vtkNURBSMeshAlgorithm.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <thread>

namespace
{

vtkIdType OutputPoints(vtkAlgorithm* filter)
{
  return filter->GetOutputDataObject(0)->GetNumberOfElements(vtkDataObject::POINT);
}

/// The whole run, then cancelled ones. Each is that of a new filter, which keeps nothing.
template <typename Maker>
void Measure(const char* name, const Maker& make, const EveryFilterInput& input)
{
  const auto prepared = [&]
  {
    auto filter = vtkSmartPointer<vtkAlgorithm>::Take(make());
    input.Prepare(filter);
    if (auto mesh = vtkNURBSMeshAlgorithm::SafeDownCast(filter))
    {
      mesh->SetTolerance(1e-5);
    }
    else if (auto add = vtkNURBSAddAttribute::SafeDownCast(filter))
    {
      add->SetExpression("sin(x)*y+z");
    }
    return filter;
  };
  double whole = WallTime();
  {
    auto filter = prepared();
    whole = WallTime();
    filter->Update();
    whole = WallTime() - whole;
    std::printf(
      "%-28s %8.2f s %10lld points", name, whole, static_cast<long long>(OutputPoints(filter)));
  }
  double longest = 0.0;
  double longestCPU = 0.0;
  int at = 0;
  int ended = 0;
  int ignored = 0;
  for (int i = 0; i < 10; ++i)
  {
    auto filter = prepared();
    double begin = 0.0;
    double beginCPU = 0.0;
    std::atomic<bool> done{ false };
    bool cancelled = false;
    const double start = WallTime();
    std::thread user(
      [&]
      {
        while (!done && WallTime() < start + (i + 0.5) / 10.0 * whole)
        {
          std::this_thread::sleep_for(std::chrono::microseconds(200));
        }
        begin = WallTime();
        beginCPU = CPUTime();
        cancelled = !done;
        filter->SetAbortExecuteAndUpdateTime();
      });
    filter->Update();
    const double end = WallTime();
    const double endCPU = CPUTime();
    done = true;
    user.join();
    if (!cancelled)
    {
      ++ended;
      continue;
    }
    ignored += OutputPoints(filter) > 0 ? 1 : 0;
    longestCPU = std::max(longestCPU, endCPU - beginCPU);
    if (end - begin > longest)
    {
      longest = end - begin;
      at = i;
    }
  }
  std::printf("   longest wait %7.1f ms (CPU %7.1f ms) at %2d %%; %d had ended, %d went on\n",
    1e3 * longest, 1e3 * longestCPU, 10 * at + 5, ended, ignored);
  std::fflush(stdout);
}

}

int main(int argc, char** argv)
{
  const int spans = argc > 1 ? std::atoi(argv[1]) : 40;
  const EveryFilterInput input({ spans, 5 * spans, 3 * spans });
  ForEveryFilter(
    [&](const char* name, auto make)
    {
      if (argc < 3 || std::strcmp(argv[2], name) == 0)
      {
        Measure(name, make, input);
      }
    });
}
