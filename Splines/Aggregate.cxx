// SPDX-License-Identifier: BSD-3-Clause
#include "Aggregate.h"

#include "Error.h"

#include <cmath>
#include <set>
#include <utility>

namespace hyperpatch
{

Aggregate::Aggregate(Spline geometry, std::vector<Attribute> attributes)
  : G(std::move(geometry))
  , A(std::move(attributes))
{
  if (this->G.Components() > 3)
  {
    throw Error("a geometry has 1 to 3 coordinates, not " + std::to_string(this->G.Components()));
  }
  std::set<std::string> names;
  for (const Attribute& attribute : this->A)
  {
    if (attribute.Name.empty() || !names.insert(attribute.Name).second)
    {
      throw Error("attribute names must be unique and not empty: \"" + attribute.Name + "\"");
    }
    for (int d = 0; d < 3; ++d)
    {
      const KnotVector& g = this->G.Knots(d);
      const KnotVector& a = attribute.Field.Knots(d);
      const double tolerance = 1e-12 * (g.Last() - g.First());
      if (std::abs(g.First() - a.First()) > tolerance || std::abs(g.Last() - a.Last()) > tolerance)
      {
        throw Error("attribute \"" + attribute.Name + "\" has the domain [" +
          std::to_string(a.First()) + ", " + std::to_string(a.Last()) + "] in direction " +
          "uvw"[d] + " where the geometry has [" + std::to_string(g.First()) + ", " +
          std::to_string(g.Last()) + "]: use Normalise Domains of NURBS Refine");
      }
    }
  }
}

const Spline* Aggregate::FindAttribute(const std::string& name) const
{
  for (const Attribute& attribute : this->A)
  {
    if (attribute.Name == name)
    {
      return &attribute.Field;
    }
  }
  return nullptr;
}

}
