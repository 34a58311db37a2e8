// SPDX-License-Identifier: BSD-3-Clause
#include "DegenerateSidesWorker.h"

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

namespace
{

/// The three sides or two that meet in an edge or corner, as bits.
unsigned EdgeSides(int direction, int ends)
{
  const int first = direction == 0 ? 1 : 0;
  const int second = direction == 2 ? 1 : 2;
  return SideBit(first, ends & 1) | SideBit(second, ends >> 1);
}

unsigned CornerSides(int corner)
{
  return SideBit(0, corner & 1) | SideBit(1, corner >> 1 & 1) | SideBit(2, corner >> 2);
}

bool Holds(unsigned all, unsigned part)
{
  return (all & part) == part;
}

}

bool DegenerateSides::IsZero(std::size_t i) const
{
  return std::abs(this->Values[i]) <= this->Error;
}

bool DegenerateSides::IsZeroWhere(unsigned sides) const
{
  for (std::size_t i = 0; i < this->Grid.Count(); ++i)
  {
    if (Holds(this->SidesOf(i), sides) && !this->IsZero(i))
    {
      return false;
    }
  }
  return true;
}

int DegenerateSides::ZeroLayers(int direction, int end) const
{
  const int size = this->Grid.Size[static_cast<std::size_t>(direction)];
  const std::size_t stride = this->Grid.Stride(direction);
  int layers = size;
  for (std::size_t i = 0; i < this->Grid.Count(); ++i)
  {
    if (!this->IsZero(i))
    {
      const int layer = static_cast<int>(i / stride % static_cast<std::size_t>(size));
      layers = std::min(layers, end == 0 ? layer : size - 1 - layer);
    }
  }
  return layers;
}

std::uint32_t DegenerateSides::Find(
  const TensorGrid& grid, const double* coefficients, double error)
{
  this->Grid = grid;
  this->Values = coefficients;
  this->Error = error;
  std::uint32_t bits = 0;
  this->Excused.clear();
  this->Layers.fill(0);
  bool any = false;
  for (int corner = 0; corner < 8; ++corner)
  {
    any = any || this->IsZero(this->Grid.Corner(corner));
  }
  if (!any)
  {
    return bits;
  }
  unsigned faces = 0;
  for (int side = 0; side < 6; ++side)
  {
    this->Layers[static_cast<std::size_t>(side)] = this->ZeroLayers(side / 2, side % 2);
    if (this->Layers[static_cast<std::size_t>(side)] > 0)
    {
      faces |= 1u << side;
      bits |= 1u << side;
    }
  }
  for (int edge = 0; edge < 12; ++edge)
  {
    const unsigned sides = EdgeSides(edge / 4, edge % 4);
    if (!(sides & faces) && this->IsZeroWhere(sides))
    {
      bits |= 1u << (6 + edge);
      this->Excused.push_back(sides);
    }
  }
  for (int corner = 0; corner < 8; ++corner)
  {
    const unsigned sides = CornerSides(corner);
    const bool isKnown = (sides & faces) ||
      std::any_of(this->Excused.begin(), this->Excused.end(),
        [sides](unsigned part) { return Holds(sides, part); });
    if (!isKnown && this->IsZero(this->Grid.Corner(corner)))
    {
      bits |= 1u << (18 + corner);
      this->Excused.push_back(sides);
    }
  }
  return bits;
}

unsigned DegenerateSides::SidesOf(std::size_t i) const
{
  unsigned sides = 0;
  for (int d = 0; d < 3; ++d)
  {
    const auto size = static_cast<std::size_t>(this->Grid.Size[static_cast<std::size_t>(d)]);
    const std::size_t index = i / this->Grid.Stride(d) % size;
    sides |= (index == 0 ? SideBit(d, 0) : 0u) | (index + 1 == size ? SideBit(d, 1) : 0u);
  }
  return sides;
}

bool DegenerateSides::IsExcused(unsigned boxSides, std::size_t i) const
{
  for (int side = 0; side < 6; ++side)
  {
    const int layers = this->Layers[static_cast<std::size_t>(side)];
    if (layers > 0 && (boxSides >> side & 1))
    {
      const int d = side / 2;
      const int size = this->Grid.Size[static_cast<std::size_t>(d)];
      const int layer = static_cast<int>(i / this->Grid.Stride(d) % static_cast<std::size_t>(size));
      if ((side % 2 == 0 ? layer : size - 1 - layer) < layers)
      {
        return true;
      }
    }
  }
  const unsigned sides = this->SidesOf(i) & boxSides;
  return std::any_of(this->Excused.begin(), this->Excused.end(),
    [sides](unsigned part) { return Holds(sides, part); });
}

}
