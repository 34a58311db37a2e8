// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace hyperpatch
{

namespace
{

/// What two parameters must differ by to be told apart after a sum or product.
double Resolution(double a, double b)
{
  return std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
}

}

bool ZeroSet::Worker::FindVertices()
{
  const auto count = static_cast<Index>(this->Vertices.size());
  this->Shared.Resize(*this, count);
  return this->Parallel(count, Batch,
    [&](Index begin, Index end)
    {
      // Bracketed roots along edges, all of a batch in step: false position with Illinois' halved
      // weights, and a bisection wherever it does not halve the bracket in three steps.
      struct Bracket
      {
        Index Sample;
        int Axis;
        double Low, High, FLow, FHigh;
        double WeightLow, WeightHigh; ///< Illinois: of an end that stays
        double Width;
        int Side, Steps;
      };
      constexpr int Most = 4 * 64; // steps, should every bracket have to be bisected
      std::vector<Bracket> open;
      std::vector<double> parameters;
      std::vector<double> values;
      std::vector<Index> wanted;
      for (Index v = begin; v < end; ++v)
      {
        if (!this->TakeBefore(v))
        {
          wanted.push_back(v);
        }
      }
      Samples samples;
      samples.Resize(*this, static_cast<Index>(wanted.size()));
      for (Index i = 0; i < samples.Count(); ++i)
      {
        const auto v = static_cast<std::size_t>(wanted[static_cast<std::size_t>(i)]);
        const Vertex& vertex = this->Vertices[v];
        samples.Parameters.col(i) = this->ParameterOf(vertex.At);
        if (vertex.Axis > 3)
        {
          const int axis = vertex.Axis - 4;
          const int line = vertex.At[static_cast<std::size_t>(axis)];
          double& middle = samples.Parameters(axis, i);
          middle = 0.5 * (middle + this->Line(axis, line + vertex.Size));
        }
        if (vertex.Axis < 3)
        {
          const auto axis = static_cast<std::size_t>(vertex.Axis);
          double low = this->Line(vertex.Axis, vertex.At[axis]);
          double high = this->Line(vertex.Axis, vertex.At[axis] + vertex.Size);
          double fLow = vertex.FLow;
          double fHigh = vertex.FHigh;
          if (high < low)
          {
            std::swap(low, high);
            std::swap(fLow, fHigh);
          }
          open.push_back({ i, vertex.Axis, low, high, fLow, fHigh, 1.0, 1.0, high - low, 0, 0 });
        }
      }
      for (int iteration = 0; !open.empty(); ++iteration)
      {
        parameters.resize(3 * open.size());
        values.resize(open.size());
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket& o = open[b];
          const double low = o.WeightLow * o.FLow;
          const double high = o.WeightHigh * o.FHigh;
          double t = o.Low - low * (o.High - o.Low) / (high - low);
          if (o.Steps == 3)
          {
            o.Steps = 0;
            if (o.High - o.Low > 0.5 * o.Width)
            {
              t = 0.5 * (o.Low + o.High);
              o.WeightLow = o.WeightHigh = 1.0;
              o.Side = 0;
            }
            o.Width = o.High - o.Low;
          }
          ++o.Steps;
          // Never closer to an end than it matters: so a root beside an end closes the bracket.
          const double step = std::min(Resolution(o.Low, o.High), 0.5 * (o.High - o.Low));
          t = t > o.Low + step ? t : o.Low + step;
          t = t < o.High - step ? t : o.High - step;
          for (int d = 0; d < 3; ++d)
          {
            parameters[3 * b + static_cast<std::size_t>(d)] = samples.Parameters(d, o.Sample);
          }
          parameters[3 * b + static_cast<std::size_t>(o.Axis)] = t;
        }
        this->Field.Evaluate(open.size(), parameters.data(), values.data());
        std::size_t kept = 0;
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket o = open[b];
          const double t = parameters[3 * b + static_cast<std::size_t>(o.Axis)];
          const double f = values[b];
          if ((f >= 0.0) == (o.FHigh >= 0.0))
          {
            o.High = t;
            o.FHigh = f;
            o.WeightHigh = 1.0;
            o.WeightLow *= o.Side == 1 ? 0.5 : 1.0;
            o.Side = 1;
          }
          else
          {
            o.Low = t;
            o.FLow = f;
            o.WeightLow = 1.0;
            o.WeightHigh *= o.Side == -1 ? 0.5 : 1.0;
            o.Side = -1;
          }
          if (f == 0.0 || o.High - o.Low <= 2.0 * Resolution(o.Low, o.High) || iteration == Most ||
            !std::isfinite(f))
          {
            const bool low = std::abs(o.FLow) < std::abs(o.FHigh);
            samples.Parameters(o.Axis, o.Sample) = low ? o.Low : o.High;
          }
          else
          {
            open[kept++] = o;
          }
        }
        open.resize(kept);
      }
      this->Evaluate(samples, 0, samples.Count());
      for (Index i = 0; i < samples.Count(); ++i)
      {
        const Index v = wanted[static_cast<std::size_t>(i)];
        Vertex& vertex = this->Vertices[static_cast<std::size_t>(v)];
        if (vertex.Axis < 3)
        {
          const int line = vertex.At[static_cast<std::size_t>(vertex.Axis)];
          const double low = this->Line(vertex.Axis, line);
          const double high = this->Line(vertex.Axis, line + vertex.Size);
          vertex.Fraction = (samples.Parameters(vertex.Axis, i) - low) / (high - low);
        }
        vertex.IsZero = samples.Residuals[i] == 0.0;
        this->Copy(samples, i, this->Shared, v, 1);
      }
    });
}

bool ZeroSet::Worker::TakeBefore(Index v)
{
  Vertex& vertex = this->Vertices[static_cast<std::size_t>(v)];
  if (this->Before.Vertices.empty())
  {
    return false;
  }
  const auto node = static_cast<std::size_t>(vertex.Low);
  const Index before = node < this->Before.AtNode.size()
    ? this->Before.AtNode[node].Vertices[static_cast<std::size_t>(vertex.Axis)]
    : -1;
  if (before < 0)
  {
    return false;
  }
  const Vertex& same = this->Before.Vertices[static_cast<std::size_t>(before)];
  if (same.Size != vertex.Size || same.FLow != vertex.FLow || same.FHigh != vertex.FHigh)
  {
    return false;
  }
  vertex = same;
  this->Copy(this->Before.Shared, before, this->Shared, v, 1);
  return true;
}

}
