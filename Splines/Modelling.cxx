// SPDX-License-Identifier: BSD-3-Clause
#include "Modelling.h"

#include "AxisCrossing.h"
#include "Error.h"
#include "Interpolation.h"
#include "Motions.h"
#include "Operators.h"
#include "Reparametrise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

/// The directions that are there first, and three coordinates. Control points keep their order.
Aggregate CloseUp(const Aggregate& section)
{
  const Spline& old = section.Geometry();
  const int dimension = old.Dimension();
  if (dimension != 1 && dimension != 2)
  {
    throw Error("a section has one or two directions, not " + std::to_string(dimension) +
      ": give a curve or a surface");
  }
  std::array<std::size_t, 3> order{ 0, 1, 2 };
  std::stable_partition(
    order.begin(), order.end(), [&old](std::size_t d) { return old.Knots()[d].Degree() > 0; });
  const auto reorder = [&order](const Spline& spline)
  {
    const std::array<KnotVector, 3>& k = spline.Knots();
    return std::array<KnotVector, 3>{ k[order[0]], k[order[1]], k[order[2]] };
  };
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(3, old.NumberOfControlPoints());
  points.topRows(old.Components()) = old.Coefficients();
  std::vector<Attribute> attributes;
  for (const Attribute& attribute : section.Attributes())
  {
    const Spline& field = attribute.Field;
    attributes.push_back(
      { attribute.Name, Spline(reorder(field), field.Coefficients(), field.Weights()) });
  }
  return Aggregate(Spline(reorder(old), points, old.Weights()), std::move(attributes));
}

/// Geometry and attributes apart into splines that can be treated alike: first the geometry
/// together with the attributes in its basis, as further components, then each other attribute.
struct Bundle
{
  std::vector<std::string> Names; ///< those in the geometry's basis first
  std::vector<int> Components;    ///< of each attribute
  std::size_t Sharing = 0;
  std::vector<Spline> Splines;
};

/// \param names in the order that is wanted, the first `sharing` of them in the geometry's basis
Bundle Pack(const Aggregate& aggregate, const std::vector<std::string>& names, std::size_t sharing)
{
  Bundle bundle;
  bundle.Names = names;
  bundle.Sharing = sharing;
  const Spline& geometry = aggregate.Geometry();
  Eigen::MatrixXd rows = geometry.Coefficients();
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const Spline& field = *aggregate.FindAttribute(names[i]);
    bundle.Components.push_back(field.Components());
    if (i < sharing)
    {
      rows.conservativeResize(rows.rows() + field.Components(), Eigen::NoChange);
      rows.bottomRows(field.Components()) = field.Coefficients();
    }
  }
  bundle.Splines.emplace_back(geometry.Knots(), std::move(rows), geometry.Weights());
  for (std::size_t i = sharing; i < names.size(); ++i)
  {
    bundle.Splines.push_back(*aggregate.FindAttribute(names[i]));
  }
  return bundle;
}

Aggregate Unpack(const Bundle& bundle)
{
  const Spline& all = bundle.Splines[0];
  std::vector<Attribute> attributes;
  Eigen::Index row = 3;
  for (std::size_t i = 0; i < bundle.Names.size(); ++i)
  {
    if (i < bundle.Sharing)
    {
      attributes.push_back({ bundle.Names[i],
        Spline(
          all.Knots(), all.Coefficients().middleRows(row, bundle.Components[i]), all.Weights()) });
      row += bundle.Components[i];
    }
    else
    {
      attributes.push_back({ bundle.Names[i], bundle.Splines[i - bundle.Sharing + 1] });
    }
  }
  return Aggregate(
    Spline(all.Knots(), all.Coefficients().topRows(3), all.Weights()), std::move(attributes));
}

/// Names of the attributes that all sections have, those first that are in the basis of the
/// geometry in all of them, with their number.
std::pair<std::vector<std::string>, std::size_t> CommonAttributes(
  const std::vector<Aggregate>& sections)
{
  std::vector<std::string> names;
  for (const Attribute& attribute : sections[0].Attributes())
  {
    names.push_back(attribute.Name);
  }
  const auto shares = [&sections](const std::string& name)
  {
    return std::all_of(sections.begin(), sections.end(),
      [&name](const Aggregate& section)
      { return SharesBasis(section.Geometry(), *section.FindAttribute(name)); });
  };
  for (const Aggregate& section : sections)
  {
    for (const std::string& name : names)
    {
      if (!section.FindAttribute(name))
      {
        throw Error(
          "not all sections have the attribute \"" + name + "\": add it to all of them or to none");
      }
      const int expected = sections[0].FindAttribute(name)->Components();
      const int components = section.FindAttribute(name)->Components();
      if (components != expected)
      {
        throw Error("attribute \"" + name + "\" has " + std::to_string(expected) +
          " components in one section and " + std::to_string(components) +
          " in another: rename one of them");
      }
    }
    if (section.Attributes().size() != names.size())
    {
      throw Error("a section has attributes that the first one has not: add them to all of the "
                  "sections or to none");
    }
  }
  const auto other = std::stable_partition(names.begin(), names.end(), shares);
  const auto sharing = static_cast<std::size_t>(other - names.begin());
  return { std::move(names), sharing };
}

/// Splines of one basis as the control points of a curve of their control points: columns of all
/// homogeneous coordinates.
Eigen::MatrixXd Stack(const std::vector<Spline>& splines)
{
  Eigen::MatrixXd columns;
  for (std::size_t i = 0; i < splines.size(); ++i)
  {
    const Eigen::MatrixXd all = splines[i].Homogeneous();
    columns.conservativeResize(all.size(), static_cast<Eigen::Index>(splines.size()));
    columns.col(static_cast<Eigen::Index>(i)) =
      Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
  }
  return columns;
}

/// Which direction is new after those of a section.
int NewDirection(const Aggregate& section)
{
  return section.Geometry().Dimension();
}

}

Aggregate Sweep(const Aggregate& section, const Spline& motion)
{
  if (motion.Dimension() != 1 || motion.Components() != 12 || motion.Knots(0).Degree() == 0)
  {
    throw Error("a motion is a curve of 12 components in the first direction");
  }
  const Aggregate closed = CloseUp(section);
  const int direction = NewDirection(closed);
  const KnotVector& along = motion.Knots(0);
  const Spline& geometry = closed.Geometry();
  const Eigen::Index count = geometry.NumberOfControlPoints();
  std::array<KnotVector, 3> knots = geometry.Knots();
  knots[static_cast<std::size_t>(direction)] = along;

  const bool rational = geometry.IsRational() || motion.IsRational();
  Eigen::MatrixXd points(3, count * along.Size());
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(rational ? points.cols() : 0);
  for (int j = 0; j < along.Size(); ++j)
  {
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> map(motion.Coefficients().col(j).data());
    points.middleCols(j * count, count) =
      (map.leftCols<3>() * geometry.Coefficients()).colwise() + map.col(3);
    if (geometry.IsRational())
    {
      weights.segment(j * count, count) = geometry.Weights();
    }
    if (motion.IsRational())
    {
      weights.segment(j * count, count) *= motion.Weights()[j];
    }
  }
  std::vector<Attribute> attributes;
  for (const Attribute& attribute : closed.Attributes())
  {
    // Constant: the same coefficients again and again, or (own basis) nothing to do.
    attributes.push_back({ attribute.Name,
      SharesBasis(geometry, attribute.Field)
        ? Spline(knots, attribute.Field.Coefficients().replicate(1, along.Size()), weights)
        : attribute.Field });
  }
  return Aggregate(Spline(knots, points, weights), std::move(attributes));
}

Aggregate Extrude(const Aggregate& section, const Eigen::Vector3d& vector)
{
  return Sweep(section, Translation(vector));
}

Aggregate Revolve(
  const Aggregate& section, const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle)
{
  const Spline motion = Rotation(point, axis, angle);
  const Aggregate closed = CloseUp(section);
  if (const auto at = FindAxisCrossing(closed.Geometry(), point, axis))
  {
    throw Error("the section crosses the axis of revolution, at (" + std::to_string((*at)[0]) +
      ", " + std::to_string((*at)[1]) + ", " + std::to_string((*at)[2]) +
      "): the solid would overlap itself. Move the axis, or cut the section there");
  }
  return Sweep(closed, motion);
}

Aggregate Rule(const Aggregate& first, const Aggregate& second)
{
  return Loft({ first, second }, 1);
}

Aggregate Loft(const std::vector<Aggregate>& sections, int degree)
{
  if (sections.size() < 2)
  {
    throw Error("a loft needs two sections at least, there are " + std::to_string(sections.size()));
  }
  if (degree < 1)
  {
    throw Error("a loft has degree 1 at least, not " + std::to_string(degree));
  }
  std::vector<Aggregate> closed;
  for (const Aggregate& section : sections)
  {
    closed.push_back(CloseUp(section));
    if (NewDirection(closed.back()) != NewDirection(closed.front()))
    {
      throw Error("sections are curves or surfaces, not some of both");
    }
  }
  const auto [names, sharing] = CommonAttributes(closed);
  std::vector<Bundle> bundles;
  for (const Aggregate& section : closed)
  {
    bundles.push_back(Pack(section, names, sharing));
  }
  Bundle result = bundles[0];
  std::vector<double> sites;
  const int direction = NewDirection(closed[0]);
  const int p = std::min(degree, static_cast<int>(sections.size()) - 1);
  for (std::size_t part = 0; part < result.Splines.size(); ++part)
  {
    std::vector<Spline> row;
    for (const Bundle& bundle : bundles)
    {
      row.push_back(bundle.Splines[part]);
    }
    const std::string what =
      part == 0 ? "geometry" : "attribute \"" + names[sharing + part - 1] + "\"";
    try
    {
      row = MakeCompatible(row);
    }
    catch (const Error& error)
    {
      throw Error("the sections do not fit together, " + what + ": " + error.what());
    }
    if (part == 0)
    {
      Eigen::MatrixXd shapes(
        3 * row[0].NumberOfControlPoints(), static_cast<Eigen::Index>(row.size()));
      for (std::size_t i = 0; i < row.size(); ++i)
      {
        const Eigen::MatrixXd points = row[i].Coefficients().topRows(3);
        shapes.col(static_cast<Eigen::Index>(i)) =
          Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
        if (i > 0 &&
          shapes.col(static_cast<Eigen::Index>(i)) == shapes.col(static_cast<Eigen::Index>(i) - 1))
        {
          throw Error("sections " + std::to_string(i - 1) + " and " + std::to_string(i) +
            " coincide: take one of them away");
        }
      }
      sites = ChordParameters(shapes);
    }
    const Spline curve = InterpolateCurve(p, sites, Stack(row));
    std::array<KnotVector, 3> knots = row[0].Knots();
    knots[static_cast<std::size_t>(direction)] = curve.Knots(0);
    const Eigen::Index components = row[0].Components() + (row[0].IsRational() ? 1 : 0);
    const Eigen::Map<const Eigen::MatrixXd> points(
      curve.Coefficients().data(), components, curve.Coefficients().size() / components);
    if (row[0].IsRational() && !(points.row(components - 1).minCoeff() > 0.0))
    {
      throw Error("the weights of the sections differ so much that some between them would not be "
                  "positive, " +
        what + ": take a lower degree or more sections");
    }
    result.Splines[part] =
      row[0].IsRational() ? Spline::FromHomogeneous(knots, points) : Spline(knots, points);
  }
  return Unpack(result);
}

MultiPatch ForEachSection(
  const MultiPatch& sections, const std::function<Aggregate(const Aggregate&)>& operation)
{
  MultiPatch result = sections;
  for (Patch& patch : result.Patches)
  {
    const Spline& geometry = patch.Body.Geometry();
    const int dimension = geometry.Dimension();
    if (dimension < 3 && geometry.Knots(dimension).Degree() > 0)
    {
      result.Interfaces.clear();
      result.Boundaries.clear();
    }
    try
    {
      patch.Body = operation(patch.Body);
    }
    catch (const Error& error)
    {
      throw result.Patches.size() == 1
        ? error
        : Error("patch " + std::to_string(patch.Id) + ": " + error.what());
    }
  }
  return result;
}

MultiPatch LoftModels(const std::vector<MultiPatch>& models, int degree)
{
  if (models.empty())
  {
    return {};
  }
  if (models.size() == 1)
  {
    std::vector<Aggregate> sections;
    for (const Patch& patch : models[0].Patches)
    {
      sections.push_back(patch.Body);
    }
    MultiPatch result;
    result.Patches.push_back({ 0, Loft(sections, degree) });
    return result;
  }
  for (std::size_t i = 1; i < models.size(); ++i)
  {
    if (models[i].Patches.size() != models[0].Patches.size())
    {
      throw Error("the first model has " + std::to_string(models[0].Patches.size()) +
        " patches where another has " + std::to_string(models[i].Patches.size()) +
        ": sections correspond patch by patch");
    }
  }
  std::size_t next = 0;
  return ForEachSection(models[0],
    [&](const Aggregate&)
    {
      std::vector<Aggregate> sections;
      for (const MultiPatch& model : models)
      {
        sections.push_back(model.Patches[next].Body);
      }
      ++next;
      return Loft(sections, degree);
    });
}

}
