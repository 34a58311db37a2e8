// SPDX-License-Identifier: BSD-3-Clause
#ifndef AttributeSampler_h
#define AttributeSampler_h

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <string>

class vtkDataArray;
class vtkDataObject;

/// Where the values of a new attribute come from, as a function of points. Private to this module.
class AttributeSampler
{
public:
  virtual ~AttributeSampler() = default;

  /// Values (m x N) at points with positions and parameters (3 x N each); NaN where there is none.
  /// \param check called now and then; leaves by an exception
  [[nodiscard]] virtual Eigen::MatrixXd Sample(const Eigen::Matrix3Xd& positions,
    const Eigen::Matrix3Xd& parameters, const std::function<void()>& check) = 0;

  /// \param expression of x, y, z, coords, u, v, w; see vtkExprTkFunctionParser
  /// \throws hyperpatch::Error with the parser's message if it does not parse
  [[nodiscard]] static std::unique_ptr<AttributeSampler> FromExpression(
    const std::string& expression);

  /// \param data of which the point array is probed; see vtkProbeFilter
  /// \throws hyperpatch::Error as FindPointArray, or if the data are no mesh
  [[nodiscard]] static std::unique_ptr<AttributeSampler> FromData(
    vtkDataObject* data, const std::string& array);
};

/// The numeric point array of a data set, or of the leaves of a composite one, that has this name;
/// if the name is empty, the only one there is.
/// \throws hyperpatch::Error that lists the arrays if there is not exactly one
[[nodiscard]] vtkDataArray* FindPointArray(vtkDataObject* data, const std::string& name);

#endif
