// SPDX-License-Identifier: BSD-3-Clause
#include "SampleGrid.h"

#include "Error.h"

#include "vtkArrayDispatch.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSet.h"
#include "vtkImageData.h"
#include "vtkPoints.h"
#include "vtkRectilinearGrid.h"
#include "vtkStructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

using hyperpatch::KnotVector;
using hyperpatch::Spline;

namespace
{

struct CopyTuples
{
  template <typename Array>
  void operator()(Array* array, vtkIdType first, vtkIdType count, double* values) const
  {
    const vtkIdType m = array->GetNumberOfComponents();
    const auto range = vtk::DataArrayValueRange(array, first * m, (first + count) * m);
    std::transform(
      range.cbegin(), range.cend(), values, [](auto value) { return static_cast<double>(value); });
  }
};

void ReadTuples(vtkDataArray* array, vtkIdType first, vtkIdType count, double* values)
{
  if (!vtkArrayDispatch::Dispatch::Execute(array, CopyTuples(), first, count, values))
  {
    for (vtkIdType i = 0; i < count; ++i)
    {
      array->GetTuple(first + i, values + i * array->GetNumberOfComponents());
    }
  }
}

std::string PointText(vtkIdType point, const std::optional<std::array<int, 3>>& sizes)
{
  std::string text = "point " + std::to_string(point);
  if (sizes)
  {
    const auto [nu, nv, nw] = *sizes;
    text += " (" + std::to_string(point % nu) + ", " + std::to_string(point / nu % nv) + ", " +
      std::to_string(point / nu / nv) + ")";
  }
  return text;
}

/// Mean lengths of the chords between neighbours along one direction, summed up: parameters that
/// follow the points.
std::vector<double> ChordSites(
  const Eigen::MatrixXd& points, const std::array<int, 3>& sizes, std::size_t direction)
{
  Eigen::Index stride = 1;
  for (std::size_t d = 0; d < direction; ++d)
  {
    stride *= sizes[d];
  }
  const Eigen::Index size = sizes[direction];
  std::vector<double> lengths(static_cast<std::size_t>(size), 0.0);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    const Eigen::Index at = i / stride % size;
    if (at > 0)
    {
      lengths[static_cast<std::size_t>(at)] +=
        (points.col(i) - points.col(i - stride)).stableNorm();
    }
  }
  const double lines = static_cast<double>(points.cols() / size);
  for (std::size_t i = 1; i < lengths.size(); ++i)
  {
    if (!(lengths[i] > 0.0))
    {
      throw hyperpatch::Error("all points with index " + std::to_string(i - 1) + " and " +
        std::to_string(i) + " along direction " + std::to_string(direction) +
        " of the grid coincide: remove one layer of them, or take Uniform sample parameters");
    }
    lengths[i] = lengths[i - 1] + lengths[i] / lines;
  }
  return lengths;
}

/// The box between corners that belong to the ends of the sites.
template <typename Corner>
Spline Box(const std::array<std::vector<double>, 3>& sites, Corner&& corner)
{
  std::array<KnotVector, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (sites[d].size() > 1)
    {
      const double first = sites[d].front();
      const double last = sites[d].back();
      if (!(first < last))
      {
        throw hyperpatch::Error(
          "the coordinates along direction " + std::to_string(d) + " of the grid do not ascend");
      }
      knots[d] = KnotVector(1, { first, first, last, last });
    }
  }
  Eigen::MatrixXd points(3, knots[0].Size() * knots[1].Size() * knots[2].Size());
  Eigen::Index c = 0;
  for (int k = 0; k < knots[2].Size(); ++k)
  {
    for (int j = 0; j < knots[1].Size(); ++j)
    {
      for (int i = 0; i < knots[0].Size(); ++i)
      {
        points.col(c++) = corner(std::array<bool, 3>{ i > 0, j > 0, k > 0 });
      }
    }
  }
  return Spline(knots, std::move(points));
}

}

Eigen::MatrixXd ReadTuples(vtkDataArray* array)
{
  Eigen::MatrixXd samples(array->GetNumberOfComponents(), array->GetNumberOfTuples());
  ReadTuples(array, 0, samples.cols(), samples.data());
  return samples;
}

hyperpatch::SampleReader MakeReader(vtkDataArray* array)
{
  return [array](Eigen::Index first, Eigen::Index count, double* samples)
  { ReadTuples(array, first, count, samples); };
}

void CheckSamples(vtkDataArray* array, const Eigen::MatrixXd& samples,
  const std::optional<std::array<int, 3>>& sizes)
{
  if (samples.allFinite())
  {
    return;
  }
  for (Eigen::Index i = 0; i < samples.cols(); ++i)
  {
    if (!samples.col(i).allFinite())
    {
      const char* name = array->GetName();
      throw hyperpatch::Error("the array " + std::string(name ? name : "without name") +
        " has a value that is not finite at " + PointText(i, sizes) +
        ": let Missing Samples leave such points out, or replace the value");
    }
  }
}

double SampleRange(const Eigen::MatrixXd& samples)
{
  double range = 0.0;
  for (Eigen::Index c = 0; c < samples.rows(); ++c)
  {
    double low = INFINITY;
    double high = -INFINITY;
    for (Eigen::Index i = 0; i < samples.cols(); ++i)
    {
      const double value = samples(c, i);
      if (std::isfinite(value))
      {
        low = std::min(low, value);
        high = std::max(high, value);
      }
    }
    range = std::hypot(range, high > low ? high - low : 0.0);
  }
  return range;
}

Spline IdentityBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  std::array<std::vector<double>, 3> sites;
  for (int d = 0; d < 3; ++d)
  {
    sites[static_cast<std::size_t>(d)] = { low[d] };
    if (low[d] < high[d])
    {
      sites[static_cast<std::size_t>(d)].push_back(high[d]);
    }
  }
  return Box(sites,
    [&low, &high](const std::array<bool, 3>& isHigh)
    {
      Eigen::Vector3d corner = low;
      for (int d = 0; d < 3; ++d)
      {
        corner[d] = isHigh[static_cast<std::size_t>(d)] ? high[d] : low[d];
      }
      return corner;
    });
}

std::optional<SampleGrid> SampleGrid::From(vtkDataSet* data, bool chords)
{
  SampleGrid grid;
  auto image = vtkImageData::SafeDownCast(data);
  auto rectilinear = vtkRectilinearGrid::SafeDownCast(data);
  auto structured = vtkStructuredGrid::SafeDownCast(data);
  if (image)
  {
    image->GetDimensions(grid.Sizes.data());
  }
  else if (rectilinear)
  {
    rectilinear->GetDimensions(grid.Sizes.data());
  }
  else if (structured)
  {
    structured->GetDimensions(grid.Sizes.data());
  }
  else
  {
    return std::nullopt;
  }

  Eigen::MatrixXd points;
  if (structured)
  {
    grid.Points = structured->GetPoints()->GetData();
    points = ReadTuples(grid.Points);
    CheckSamples(grid.Points, points, grid.Sizes);
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    std::vector<double>& sites = grid.Sites[d];
    if (grid.Sizes[d] == 1)
    {
      sites = { 0.5 };
    }
    else if (rectilinear)
    {
      vtkDataArray* coordinates = d == 0 ? rectilinear->GetXCoordinates()
        : d == 1                         ? rectilinear->GetYCoordinates()
                                         : rectilinear->GetZCoordinates();
      sites.resize(static_cast<std::size_t>(grid.Sizes[d]));
      ReadTuples(coordinates, 0, grid.Sizes[d], sites.data());
    }
    else if (structured && chords)
    {
      sites = ChordSites(points, grid.Sizes, d);
    }
    else
    {
      for (int i = 0; i < grid.Sizes[d]; ++i)
      {
        sites.push_back(i);
      }
    }
  }
  if (!structured)
  {
    // The corners are points of the grid.
    const auto [nu, nv, nw] = grid.Sizes;
    grid.Geometry = Box(grid.Sites,
      [data, nu = nu, nv = nv, nw = nw](const std::array<bool, 3>& high)
      {
        const vtkIdType i = high[0] ? nu - 1 : 0;
        const vtkIdType j = high[1] ? nv - 1 : 0;
        const vtkIdType k = high[2] ? nw - 1 : 0;
        Eigen::Vector3d corner;
        data->GetPoint(i + nu * (j + nv * k), corner.data());
        return corner;
      });
  }
  return grid;
}
