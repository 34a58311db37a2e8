// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

using namespace hyperpatch;

namespace
{

Spline Field(double first, double last)
{
  return Spline({ KnotVector::Uniform(2, 5, first, last), KnotVector::Uniform(1, 2),
                  KnotVector::Uniform(3, 4) },
    Eigen::MatrixXd::Ones(2, 40));
}

std::string Message(const Spline& geometry, const std::vector<Attribute>& attributes)
{
  try
  {
    const Aggregate aggregate(geometry, attributes);
    return "";
  }
  catch (const Error& error)
  {
    return error.what();
  }
}

}

TEST(Aggregate, FindsAttributesThatHaveTheirOwnBasis)
{
  const Aggregate aggregate(
    models::QuarterTube(), { { "stress", Field(0, 1) }, { "density", Field(0, 1) } });
  ASSERT_NE(aggregate.FindAttribute("density"), nullptr);
  EXPECT_EQ(aggregate.FindAttribute("density"), &aggregate.Attributes()[1].Field);
  EXPECT_EQ(aggregate.FindAttribute("Density"), nullptr);
}

TEST(Aggregate, DomainsMustAgreeToATrillionth)
{
  const Spline tube = models::QuarterTube();
  EXPECT_EQ(Message(tube, { { "a", Field(0, 1 + 5e-13) } }), "");
  const std::string message = Message(tube, { { "a", Field(0, 1 + 2e-12) } });
  EXPECT_NE(message.find("\"a\""), std::string::npos) << message;
  EXPECT_NE(message.find("Normalise Domains"), std::string::npos) << message;
  EXPECT_NE(Message(tube, { { "a", Field(-1, 1) } }), "");
}

TEST(Aggregate, NamesMustBeUniqueAndNotEmpty)
{
  const Spline tube = models::QuarterTube();
  EXPECT_NE(
    Message(tube, { { "a", Field(0, 1) }, { "a", Field(0, 1) } }).find("\"a\""), std::string::npos);
  EXPECT_NE(Message(tube, { { "", Field(0, 1) } }), "");
}

TEST(Aggregate, GeometryHasAtMostThreeCoordinates)
{
  const Spline tube = models::QuarterTube();
  const Spline field(tube.Knots(), Eigen::MatrixXd::Zero(4, 12));
  EXPECT_NE(Message(field, {}).find("not 4"), std::string::npos);
}
