// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_Weld_h
#define hyperpatch_testing_Weld_h

#include "ZeroSet.h"

#include <Eigen/Geometry>

#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace models
{

/// Meshes welded where coordinates have the same bits.
struct Welded
{
  long Open = 0;  ///< edges without a partner of the opposite direction
  long Twice = 0; ///< edges used more than once in a direction
  long Euler = 0; ///< vertices - edges + triangles
  double Area = 0.0;
  std::set<std::array<double, 3>> Points;
  Eigen::AlignedBox3d OpenBox;
};

inline Welded Weld(const std::vector<hyperpatch::ZeroSetMesh>& meshes)
{
  Welded welded;
  std::map<std::array<double, 3>, long> numbers;
  std::map<std::pair<long, long>, int> edges;
  std::vector<Eigen::Vector3d> at;
  std::set<long> used;
  long triangles = 0;
  for (const hyperpatch::ZeroSetMesh& mesh : meshes)
  {
    for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
    {
      std::array<long, 3> corner{};
      std::array<Eigen::Vector3d, 3> x;
      for (std::size_t k = 0; k < 3; ++k)
      {
        x[k] = mesh.Points.col(mesh.Cells(static_cast<Eigen::Index>(k), c));
        const auto [found, isNew] =
          numbers.try_emplace({ x[k][0], x[k][1], x[k][2] }, static_cast<long>(numbers.size()));
        corner[k] = found->second;
        if (isNew)
        {
          at.push_back(x[k]);
        }
      }
      welded.Area += 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).norm();
      ++triangles;
      for (std::size_t k = 0; k < 3; ++k)
      {
        used.insert(corner[k]);
        ++edges[{ corner[k], corner[(k + 1) % 3] }];
      }
    }
  }
  long undirected = 0;
  for (const auto& [edge, count] : edges)
  {
    const auto partner = edges.find({ edge.second, edge.first });
    welded.Twice += count > 1 ? 1 : 0;
    if (partner == edges.end())
    {
      ++welded.Open;
      welded.OpenBox.extend(at[static_cast<std::size_t>(edge.first)]);
      welded.OpenBox.extend(at[static_cast<std::size_t>(edge.second)]);
    }
    undirected += edge.first < edge.second || partner == edges.end() ? 1 : 0;
  }
  welded.Euler = static_cast<long>(used.size()) - undirected + triangles;
  for (const auto& entry : numbers)
  {
    welded.Points.insert(entry.first);
  }
  return welded;
}

}

#endif
