// SPDX-License-Identifier: BSD-3-Clause
#ifndef SampleGrid_h
#define SampleGrid_h

#include "GridFit.h"
#include "Spline.h"

#include "vtkSmartPointer.h"

#include <Eigen/Core>

#include <array>
#include <optional>
#include <vector>

class vtkDataArray;
class vtkDataSet;

/// Samples of data sets, as the fitting functions of the kernel take them. Private to this module.

/// Tuples of an array as columns, whatever its type and layout.
[[nodiscard]] Eigen::MatrixXd ReadTuples(vtkDataArray* array);

/// The same, block by block, for hyperpatch::MeasureError.
[[nodiscard]] hyperpatch::SampleReader MakeReader(vtkDataArray* array);

/// \throws hyperpatch::Error if a sample is not finite, naming array and point (with its grid
/// indices, if `sizes` are given)
void CheckSamples(vtkDataArray* array, const Eigen::MatrixXd& samples,
  const std::optional<std::array<int, 3>>& sizes = std::nullopt);

/// Norm of the ranges of the components over what is finite: the range of a scalar, the diagonal of
/// positions. Relative errors refer to it.
[[nodiscard]] double SampleRange(const Eigen::MatrixXd& samples);

/// The box between two points, parametrised by its own coordinates; a direction in which it is flat
/// is not there.
[[nodiscard]] hyperpatch::Spline IdentityBox(
  const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// A data set whose points form a grid of parameters.
struct SampleGrid
{
  /// \param chords whether the points of a structured grid get parameters by the mean length of the
  /// chords along each direction (The NURBS Book, 9.2.5), or their indices
  /// \throws hyperpatch::Error if points coincide along a direction (chords) or one is not finite
  [[nodiscard]] static std::optional<SampleGrid> From(vtkDataSet* data, bool chords);

  std::array<int, 3> Sizes{ 1, 1, 1 };
  /// Parameters of the points per direction: coordinates of a rectilinear grid, indices of an
  /// image. 0.5 for a direction with one point.
  std::array<std::vector<double>, 3> Sites;
  /// The map of an image or rectilinear grid, of degree 1 and exact.
  std::optional<hyperpatch::Spline> Geometry;
  /// The points of a structured grid, to be fitted.
  vtkSmartPointer<vtkDataArray> Points;
};

#endif
