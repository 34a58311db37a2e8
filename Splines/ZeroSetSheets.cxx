// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <map>

namespace hyperpatch
{

std::vector<ZeroSet::Worker::Index> ZeroSet::Worker::PartSheets(std::vector<CrowdedEdge> edges)
{
  if (edges.empty())
  {
    return {};
  }
  // Two sheets may join the same points where a curve between them has a corner, or where they lie
  // flat in the face between their leaves.
  std::map<std::array<Index, 2>, CrowdedEdge*> crowded;
  for (CrowdedEdge& edge : edges)
  {
    crowded[edge.Ends] = &edge;
  }
  const auto find = [&crowded](Index a, Index b)
  {
    const auto found = crowded.find({ std::min(a, b), std::max(a, b) });
    return found != crowded.end() ? found->second : nullptr;
  };

  Scratch scratch;
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    Facets& piece = this->Pieces[leaf];
    if (this->Leaves[leaf].Height < 0)
    {
      continue;
    }
    for (std::size_t c = 0; c < piece.Cells.size(); ++c)
    {
      for (std::size_t k = 0; k < 3; ++k)
      {
        const Index from = piece.Cells[c][k];
        const Index to = piece.Cells[c][(k + 1) % 3];
        if (from < 0 || to < 0)
        {
          continue;
        }
        const Index a = piece.Loops[static_cast<std::size_t>(from)];
        const Index b = piece.Loops[static_cast<std::size_t>(to)];
        CrowdedEdge* const edge = find(a, b);
        if (edge && edge->Sheets > 1 && this->SplitEdge(leaf, c, k, 1.0 / edge->Sheets, scratch))
        {
          --edge->Sheets;
        }
      }
    }
  }

  const auto isCrowded = [&find](Index a, Index b)
  {
    const CrowdedEdge* edge = find(a, b);
    return edge && edge->Sheets > 1;
  };
  // Where that is not possible, triangles back to back, which enclose nothing, go with the edges
  // that only they have.
  std::map<std::array<Index, 3>, std::array<std::size_t, 2>> facing; // leaf and cell
  std::vector<std::array<std::size_t, 2>> dropped;
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    const Facets& piece = this->Pieces[leaf];
    for (std::size_t c = 0; c < piece.Cells.size(); ++c)
    {
      if (*std::min_element(piece.Cells[c].begin(), piece.Cells[c].end()) < 0)
      {
        continue;
      }
      std::array<Index, 3> corners{};
      for (std::size_t k = 0; k < 3; ++k)
      {
        corners[k] = piece.Loops[static_cast<std::size_t>(piece.Cells[c][k])];
      }
      if (!isCrowded(corners[0], corners[1]) && !isCrowded(corners[1], corners[2]) &&
        !isCrowded(corners[2], corners[0]))
      {
        continue;
      }
      // The least first, so that what turns the other way has the others swapped.
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      const auto back = facing.find({ corners[0], corners[2], corners[1] });
      if (back == facing.end())
      {
        facing.insert({ corners, { leaf, c } });
        continue;
      }
      dropped.insert(dropped.end(), { back->second, { leaf, c } });
      facing.erase(back);
      for (std::size_t k = 0; k < 3; ++k)
      {
        CrowdedEdge* const edge = find(corners[k], corners[(k + 1) % 3]);
        if (edge)
        {
          --edge->Sheets;
        }
      }
    }
  }
  std::sort(dropped.rbegin(), dropped.rend());
  for (const auto& [leaf, c] : dropped)
  {
    auto& cells = this->Pieces[leaf].Cells;
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(c));
  }
  std::vector<Index> left;
  for (const CrowdedEdge& edge : edges)
  {
    if (edge.Sheets > 1)
    {
      left.insert(left.end(), edge.Ends.begin(), edge.Ends.end());
    }
  }
  return left;
}

bool ZeroSet::Worker::SplitEdge(
  std::size_t leaf, std::size_t cell, std::size_t side, double place, Scratch& scratch)
{
  Facets& piece = this->Pieces[leaf];
  const Index from = piece.Cells[cell][side];
  const Index to = piece.Cells[cell][(side + 1) % 3];
  // The triangle on the other side, if it is one of this leaf.
  std::size_t other = 0;
  std::size_t otherSide = 3;
  for (std::size_t c = 0; c < piece.Cells.size() && otherSide == 3; ++c)
  {
    for (std::size_t k = 0; k < 3; ++k)
    {
      if (piece.Cells[c][k] == to && piece.Cells[c][(k + 1) % 3] == from)
      {
        other = c;
        otherSide = k;
      }
    }
  }
  if (otherSide == 3)
  {
    return false;
  }
  const Index a = std::min(from, to); // of which neither side makes a difference
  const Index b = std::max(from, to);
  Eigen::Matrix3Xd parameters =
    (1.0 - place) * this->Shared.Parameters.col(piece.Loops[static_cast<std::size_t>(a)]) +
    place * this->Shared.Parameters.col(piece.Loops[static_cast<std::size_t>(b)]);
  this->Project(parameters, { this->Leaves[leaf].Height }, std::nullopt, scratch.Projected);
  if (scratch.Projected[0] == 0)
  {
    return false;
  }
  const Index inner = piece.Inner.Count();
  piece.Inner.Resize(*this, inner + 1);
  piece.Inner.Parameters.col(inner) = parameters;
  this->Evaluate(piece.Inner, inner, inner + 1);

  const Index apex = piece.Cells[cell][(side + 2) % 3];
  const Index otherApex = piece.Cells[other][(otherSide + 2) % 3];
  const Index middle = -1 - inner;
  const std::array<std::array<Index, 3>, 4> parts{ { { from, middle, apex }, { middle, to, apex },
    { to, middle, otherApex }, { middle, from, otherApex } } };
  piece.Cells[cell] = parts[0];
  piece.Cells[other] = parts[2];
  piece.Cells.insert(piece.Cells.end(), { parts[1], parts[3] });

  // What the new triangles are off by.
  std::vector<Index> loop;
  std::vector<Index> innerOf;
  std::vector<FacetTriangulation::Triangle> triangles(parts.size());
  for (const bool isInner : { false, true })
  {
    for (std::size_t t = 0; t < parts.size(); ++t)
    {
      for (std::size_t k = 0; k < 3; ++k)
      {
        const Index corner = parts[t][k];
        if ((corner < 0) == isInner)
        {
          triangles[t][k] = static_cast<int>(loop.size() + innerOf.size());
          isInner ? innerOf.push_back(-1 - corner)
                  : loop.push_back(piece.Loops[static_cast<std::size_t>(corner)]);
        }
      }
    }
  }
  const double distance = piece.Error;
  const double attribute = piece.AttributeError;
  std::vector<std::pair<int, double>> missing;
  scratch.Measuring.Known.clear();
  const double worst = this->MeasureFacets(
    triangles, static_cast<int>(loop.size()), loop, innerOf, true, scratch, piece, missing);
  piece.Error = std::max(piece.Error, distance);
  piece.AttributeError = std::max(piece.AttributeError, attribute);
  piece.IsWithinTolerance = piece.IsWithinTolerance && worst <= 1.0;
  return true;
}

}
