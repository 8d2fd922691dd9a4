// Which cells of a grid a trimmed area keeps, and the parts of its edges in those that they cross.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/bspline/grid.h"
#include "engine/bspline/trimmed_area.h"

namespace spoonbill {

// The lines of one direction of a grid that bound its cells, the ends of the domain among them: where a
// periodic direction leaves the seam's second line out, its last cells end at the first line.
class GridLines {
 public:
  // The parameters must include both ends of an open direction.
  explicit GridLines(const GridDirection& direction);

  int cells() const { return static_cast<int>(at_.size()) - 1; }
  int samples() const { return samples_; }
  double at(int line) const { return at_[static_cast<std::size_t>(line)]; }
  const std::vector<double>& all() const { return at_; }

  // Onto a line that is nearer than a billionth of the domain, so that no sliver is cut off.
  double snapped(double parameter) const;
  int cell_of(double parameter) const;  // clamped; of a line, the cell after it
  int line_at(double parameter) const;  // the line that stands there; -1: none
  // The same number on both sides of a seam that is left out.
  double joined(double parameter) const;

 private:
  std::vector<double> at_;
  int samples_ = 0;
  double snap_ = 0.0;
};

// Immutable once made; any thread may read it.
class TrimmedCells {
 public:
  enum class State : std::uint8_t { away, cut, kept };

  TrimmedCells(const GridLines& u, const GridLines& v, const TrimmedArea& area);

  State state(int i, int j) const { return states_[index(i, j)]; }
  // Those in a cut cell. What lies along a grid line cuts no cell.
  std::span<const TrimmedArea::Edge> edges(int i, int j) const {
    const std::size_t cell = index(i, j);
    return std::span(edges_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
  }

 private:
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(j);
  }

  int columns_ = 0;
  std::vector<State> states_;
  std::vector<std::size_t> starts_;
  std::vector<TrimmedArea::Edge> edges_;
};

}  // namespace spoonbill
