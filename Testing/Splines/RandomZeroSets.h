// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_RandomZeroSets_h
#define hyperpatch_testing_RandomZeroSets_h

#include "Aggregate.h"
#include "Evaluator.h"
#include "QuadricField.h"
#include "ZeroSet.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace models
{

using namespace hyperpatch;

/// A zero-set problem that a seed makes: degrees 1 to 9, 1 to 6 spans, uniform, non-uniform,
/// repeated and unclamped knots, rational or not; an isosurface of an attribute with its own basis
/// or that of the geometry, a plane or a sphere; through a straight or a bent geometry of either
/// handedness, whose Jacobian determinant has one sign but for a fold at the edge of the domain in
/// one of a thousand.
class RandomZeroSet
{
public:
  enum class Kind
  {
    Generic,  ///< continuous coefficients: nothing happens that has probability 0
    Integers, ///< zeros lie on nodes, knot planes and faces of the domain
    Plateaus  ///< f is constant in places, sometimes 0
  };

  RandomZeroSet(Kind kind, unsigned seed)
    : Random(seed + 1000003u * static_cast<unsigned>(kind))
  {
    std::ostringstream text;
    // Cheap first: most models are small.
    const bool large = this->Chance(0.1);
    const std::array<KnotVector, 3> own = this->Knots(3, large ? 3 : 2, nullptr);
    Spline geometry = this->Geometry(own);
    std::vector<Attribute> attributes;
    const double choice = this->Number(0.0, 1.0);
    this->OfAttribute = kind != Kind::Generic || choice < 0.8;
    const bool sharesBasis = this->Chance(0.25);
    const std::array<KnotVector, 3> knots = sharesBasis ? own : this->Knots(9, large ? 6 : 3, &own);
    Eigen::VectorXd weights = sharesBasis ? geometry.Weights() : Eigen::VectorXd();
    const Eigen::Index n =
      static_cast<Eigen::Index>(knots[0].Size()) * knots[1].Size() * knots[2].Size();
    if (!sharesBasis && this->Chance(0.4))
    {
      weights.resize(n);
      for (double& w : weights)
      {
        w = this->Number(0.5, 2.0);
      }
    }
    Eigen::MatrixXd coefficients(this->OfAttribute && this->Chance(0.1) ? 2 : 1, n);
    const bool isMagnitude = coefficients.rows() == 2;
    for (double& c : coefficients.reshaped())
    {
      c = kind == Kind::Generic ? this->Number(-1.0, 1.0) : std::floor(this->Number(-2.0, 3.0));
    }
    if (kind == Kind::Plateaus)
    {
      // A block of equal coefficients, as large as a support here and there.
      std::array<int, 3> low{};
      std::array<int, 3> high{};
      for (std::size_t d = 0; d < 3; ++d)
      {
        low[d] = this->Whole(0, knots[d].Size() - 1);
        high[d] = this->Whole(low[d], knots[d].Size() - 1);
      }
      const int plateau = this->Whole(0, 1);
      for (Eigen::Index i = 0; i < n; ++i)
      {
        const std::array<Eigen::Index, 3> at{ i % knots[0].Size(),
          i / knots[0].Size() % knots[1].Size(),
          i / (knots[0].Size() * static_cast<Eigen::Index>(knots[1].Size())) };
        bool isInside = true;
        for (std::size_t d = 0; d < 3; ++d)
        {
          isInside = isInside && at[d] >= low[d] && at[d] <= high[d];
        }
        if (isInside)
        {
          coefficients.col(i).setConstant(plateau);
        }
      }
    }
    attributes.push_back({ "A", Spline(knots, coefficients, weights) });
    this->Body = std::make_unique<const Aggregate>(std::move(geometry), std::move(attributes));

    const auto points = this->Body->Geometry().Coefficients();
    const Eigen::Vector3d lower = points.rowwise().minCoeff();
    const Eigen::Vector3d upper = points.rowwise().maxCoeff();
    this->Diagonal = (upper - lower).norm();
    this->Reach = std::max(this->Diagonal, points.colwise().norm().maxCoeff());
    if (this->OfAttribute)
    {
      const double value =
        kind == Kind::Generic ? this->Number(-0.3, 0.3) : static_cast<double>(this->Whole(0, 1));
      this->Q = isMagnitude
        ? MagnitudeEquals(this->Function(), kind == Kind::Generic ? std::abs(value) + 0.3 : 1.0)
        : ComponentEquals(this->Function(), 0, value);
    }
    else
    {
      const Eigen::Vector3d centre = lower +
        Eigen::Vector3d(this->Number(0.2, 0.8), this->Number(0.2, 0.8), this->Number(0.2, 0.8))
          .cwiseProduct(upper - lower);
      if (choice < 0.9)
      {
        const Eigen::VectorXd normal = this->Vector().normalized();
        this->Q = { Eigen::MatrixXd(), normal, 0.0, centre };
      }
      else
      {
        const double radius = this->Number(0.1, 0.4) * this->Diagonal;
        this->Q = { Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), -radius * radius,
          centre };
      }
    }
    for (Eigen::Index i = 0; i < this->Function().NumberOfControlPoints(); ++i)
    {
      this->Scale =
        std::max(this->Scale, this->Q.Terms(this->Function().Coefficients().col(i).data()));
    }

    const double precision = this->Number(0.0, 1.0);
    this->Options.Tolerance = this->Diagonal *
      (kind != Kind::Generic          ? std::pow(10.0, this->Number(-1.5, -1.0))
          : precision < 0.1 && !large ? std::pow(10.0, this->Number(-3.0, -2.0))
                                      : std::pow(10.0, this->Number(-2.0, -1.0)));
    this->Options.AttributeTolerances = { this->Chance(0.3) ? this->Number(0.02, 0.1) : 0.0 };
    this->Options.Handedness = this->IsLeftHanded ? -1 : 1;

    text << (this->OfAttribute ? isMagnitude ? "magnitude" : "component"
        : choice < 0.9         ? "plane"
                               : "sphere");
    for (const Spline* s : { &this->Body->Geometry(), &this->Body->Attributes()[0].Field })
    {
      text << (s == &this->Body->Geometry() ? "; geometry" : "; attribute")
           << (s->IsRational() ? " rational" : "");
      for (int d = 0; d < 3; ++d)
      {
        text << " p" << s->Knots(d).Degree() << "[";
        for (const double k : s->Knots(d).Knots())
        {
          text << " " << k;
        }
        text << " ]";
      }
    }
    text << "; tolerance " << this->Options.Tolerance / this->Diagonal << ", "
         << this->Options.AttributeTolerances[0] << (this->IsLeftHanded ? "; left-handed" : "");
    this->Description = text.str();
  }

  /// What f is a function of: the attribute or the geometry.
  [[nodiscard]] const Spline& Function() const
  {
    return this->OfAttribute ? this->Body->Attributes()[0].Field : this->Body->Geometry();
  }
  [[nodiscard]] bool IsOnCrease(const Eigen::Vector3d& u) const
  {
    bool isOnCrease = false;
    for (const Spline* s : { &this->Body->Geometry(), &this->Function() })
    {
      for (int d = 0; d < 3; ++d)
      {
        const std::vector<double> creases = s->Knots(d).Creases();
        isOnCrease = isOnCrease || std::find(creases.begin(), creases.end(), u[d]) != creases.end();
      }
    }
    return isOnCrease;
  }

  std::unique_ptr<const Aggregate> Body;
  bool OfAttribute = true;
  Quadric Q; ///< of Function()
  ZeroSetOptions Options;
  double Diagonal = 0.0; ///< of the control points
  double Reach = 0.0;    ///< the larger of that and their largest distance from the origin
  double Scale = 0.0;    ///< the largest magnitude of terms of Q at a coefficient
  bool IsLeftHanded = false;
  std::string Description;

private:
  double Number(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(this->Random);
  }
  int Whole(int low, int high)
  {
    return std::uniform_int_distribution<int>(low, high)(this->Random);
  }
  bool Chance(double p) { return this->Number(0.0, 1.0) < p; }
  Eigen::Vector3d Vector()
  {
    return { this->Number(-1.0, 1.0), this->Number(-1.0, 1.0), this->Number(-1.0, 1.0) };
  }

  /// \param domain of which it is to be, or nullptr
  std::array<KnotVector, 3> Knots(
    int mostDegree, int mostSpans, const std::array<KnotVector, 3>* domain)
  {
    std::array<KnotVector, 3> knots;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double low = domain ? (*domain)[d].First()
        : this->Chance(0.3)     ? this->Number(-4.0, 4.0)
                                : 0.0;
      const double high =
        domain ? (*domain)[d].Last() : low + (this->Chance(0.3) ? this->Number(0.5, 5.0) : 1.0);
      const double choice = this->Number(0.0, 1.0);
      const int degree = std::min(mostDegree,
        choice < 0.15     ? 1
          : choice < 0.5  ? 2
          : choice < 0.85 ? 3
                          : this->Whole(4, 9));
      const int spans = this->Whole(1, degree > 4 ? std::min(2, mostSpans) : mostSpans);
      const bool isUniform = this->Chance(0.3);
      const bool isClamped = !this->Chance(0.25);
      const bool repeats = this->Chance(0.3);
      const auto step = [&] { return isUniform ? 1.0 : this->Number(0.2, 1.0); };
      std::vector<double> list;
      double at = 0.0;
      for (int i = 0; i < degree; ++i)
      {
        list.push_back(at);
        at += isClamped ? 0.0 : step();
      }
      for (int s = 0; s <= spans; ++s)
      {
        const bool isInner = s > 0 && s < spans;
        list.insert(list.end(),
          static_cast<std::size_t>(isInner && repeats ? this->Whole(1, degree) : 1), at);
        at += s < spans ? step() : 0.0;
      }
      for (int i = 0; i < degree; ++i)
      {
        at += isClamped ? 0.0 : step();
        list.push_back(at);
      }
      const double first = list[static_cast<std::size_t>(degree)];
      const double last = list[list.size() - 1 - static_cast<std::size_t>(degree)];
      for (double& k : list)
      {
        k = k == first ? low : k == last ? high : low + (high - low) * (k - first) / (last - first);
      }
      knots[d] = KnotVector(degree, list);
    }
    return knots;
  }

  Spline Geometry(const std::array<KnotVector, 3>& knots)
  {
    const std::array<Eigen::Index, 3> n{ knots[0].Size(), knots[1].Size(), knots[2].Size() };
    Eigen::MatrixXd points(3, n[0] * n[1] * n[2]);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
    {
      points.col(i) << knots[0].Greville(static_cast<int>(i % n[0])),
        knots[1].Greville(static_cast<int>(i / n[0] % n[1])),
        knots[2].Greville(static_cast<int>(i / (n[0] * n[1])));
    }
    const bool isCurved = this->Chance(0.7);
    if (isCurved)
    {
      // Random shifts, scaled so that each coefficient of a partial derivative is that of the
      // identity and less than 0.9 of it more (in the 1-norm): columns of J are dominated by their
      // diagonals, so det J > 0.
      Eigen::MatrixXd shifts(3, points.cols());
      for (Eigen::Index i = 0; i < points.cols(); ++i)
      {
        shifts.col(i) = this->Vector();
      }
      double most = 0.0;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const Eigen::Index stride = d == 0 ? 1 : d == 1 ? n[0] : n[0] * n[1];
        for (Eigen::Index i = 0; i < points.cols(); ++i)
        {
          const auto at = static_cast<int>(i / stride % n[d]);
          const int p = knots[d].Degree();
          if (at > 0 && knots[d][at + p] > knots[d][at])
          {
            most = std::max(most,
              p * (shifts.col(i) - shifts.col(i - stride)).lpNorm<1>() /
                (knots[d][at + p] - knots[d][at]));
          }
        }
      }
      points += this->Number(0.3, 0.9) / most * shifts;
    }
    Eigen::VectorXd weights;
    if (this->Chance(0.4))
    {
      // A projective map around the centre, with a positive denominator, keeps what is valid valid.
      const Eigen::Vector3d lower = points.rowwise().minCoeff();
      const Eigen::Vector3d size = points.rowwise().maxCoeff() - lower;
      const Eigen::Vector3d slope = 0.3 * this->Vector().cwiseQuotient(size);
      points.colwise() -= Eigen::Vector3d(lower + 0.5 * size);
      weights = Eigen::VectorXd::Ones(points.cols()) + points.transpose() * slope;
      points = points * weights.cwiseInverse().asDiagonal();
    }
    if (this->Chance(0.3))
    {
      const Eigen::Matrix3d turn = Eigen::HouseholderQR<Eigen::Matrix3d>(
        Eigen::Matrix3d(Eigen::Matrix3d::NullaryExpr([this] { return this->Number(-1.0, 1.0); })))
                                     .householderQ();
      points = turn * points;
      this->IsLeftHanded = turn.determinant() < 0.0;
    }
    return Spline(knots, points, weights);
  }

  std::mt19937 Random;
};

}

#endif
