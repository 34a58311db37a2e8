// SPDX-License-Identifier: BSD-3-Clause
#ifndef NURBSMeshOutput_h
#define NURBSMeshOutput_h

#include "Aggregate.h"
#include "Parallel.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

class vtkPointSet;

/// Collects the meshes of patches and writes them into one vtkPolyData or vtkUnstructuredGrid with
/// the arrays that vtkNURBSMeshAlgorithm promises. Private to this module.
class NURBSMeshOutput
{
public:
  using Cells = Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic>;

  /// \param components of every attribute of the output
  /// \param labels names of integer cell arrays beside PatchId and ElementId
  NURBSMeshOutput(std::map<std::string, int> components, std::vector<std::string> labels);

  /// Adds points.
  /// \param normals one per point, or none at all: then the output has no array of normals
  /// \param attributes in the order of the patch's
  void AddPoints(const hyperpatch::Patch& patch, Eigen::Matrix3Xd parameters,
    Eigen::Matrix3Xd points, Eigen::Matrix3Xd normals, std::vector<Eigen::MatrixXd> attributes);

  /// Adds cells of one kind, over the points added last: 1 row vertices, 2 segments, 3 triangles, 4
  /// tetrahedra, 8 hexahedra. \param elements 3 x cells, knot spans counted in the whole patch
  /// \param labels one vector per label, of one value or one per cell
  void AddCells(const hyperpatch::Patch& patch, Cells cells, Eigen::Matrix3Xi elements,
    std::vector<std::vector<int>> labels);

  /// How often points were added.
  [[nodiscard]] std::size_t NumberOfBlocks() const { return this->Points.size(); }
  /// Makes one of points with the same coordinates and first label of their cells, which then have
  /// one value each: with the mean of their normals, otherwise like the first of them. Cells that
  /// lose a corner are left out. \param begin only points that were added after so many blocks
  /// \param check called now and then; leaves by an exception
  void MergePoints(std::size_t begin, const std::function<void()>& check);

  /// \param output an empty vtkPolyData (no hexahedra) or vtkUnstructuredGrid
  void Fill(vtkPointSet* output, const hyperpatch::ParallelFor& parallelFor) const;

private:
  struct PointBlock
  {
    Eigen::Matrix3Xd Parameters, Points, Normals;
    /// One for each of Components; of no points where the patch does not have it.
    std::vector<Eigen::MatrixXd> Attributes;
  };
  struct CellBlock
  {
    Cells Indices; ///< into all points
    Eigen::Matrix3Xi Elements;
    std::array<std::int64_t, 3> Spans; ///< of the whole patch
    int PatchId;
    std::vector<std::vector<int>> Labels;
    std::size_t Points; ///< the block of its points
  };

  void FillPoints(vtkPointSet* output, const hyperpatch::ParallelFor& parallelFor) const;
  void FillCells(vtkPointSet* output, const hyperpatch::ParallelFor& parallelFor) const;

  std::map<std::string, int> Components;
  std::vector<std::string> Labels;
  std::vector<PointBlock> Points;
  std::vector<CellBlock> Blocks;
  std::int64_t LastOffset = 0;
  std::int64_t NumberOfPoints = 0;
};

#endif
