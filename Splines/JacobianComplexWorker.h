// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianComplexWorker_h
#define hyperpatch_JacobianComplexWorker_h

#include "JacobianTetrahedra.h"
#include "JacobianTree.h"

#include <array>
#include <cstdint>
#include <vector>

namespace hyperpatch
{

/// The tetrahedra of MarchTetrahedra(), before det J is known at their vertices. Private to it.
struct JacobianComplex
{
  using Index = std::int64_t;

  struct Tetrahedron
  {
    std::array<Index, 4> Vertices; ///< positively oriented in the parameter domain
    int Cell;
  };

  /// A vertex whose position and J are interpolated from those of a larger cell's face.
  struct Hanging
  {
    Index Vertex;
    std::array<Index, 3> From;
    std::array<double, 3> Weights;
  };

  std::vector<std::array<double, 3>> Parameters; ///< of the vertices
  std::vector<Hanging> Interpolated;
  std::vector<Tetrahedron> Tetrahedra;
  std::int64_t RepairedCells = 0;
};

[[nodiscard]] JacobianComplex MakeComplex(const JacobianTree& tree, CrackRepair repair);

}

#endif
