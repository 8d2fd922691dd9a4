// Trimmed areas: the part of a surface's domain that remains inside its trim loops, prepared for point
// queries, and the grid cells and triangles of that part. All functions are pure and may be called from any
// thread. Except for point queries, they are too slow for a tick.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

inline constexpr Range<int> trim_loop_count_range{0, 1000};

// The part of a surface's domain that remains inside its trim loops. Immutable once made; any thread may
// query it. It does not depend on control points and stays valid while the surface deforms.
class TrimmedArea {
 public:
  // Constructs the area of a surface without trims, which is the whole of any domain.
  TrimmedArea() = default;

  // Makes the area inside loops that make_trim_loop() returned. Refuses too many loops or chords, loops that
  // cross or coincide, loops that disagree on which part remains (such as a counter-clockwise hole), and
  // loops that leave no area.
  static Result<TrimmedArea> make(const KnotVector& along_u, const KnotVector& along_v,
                                  const std::vector<TrimLoop>& loops);

  bool is_whole() const { return edges_.empty(); }

  // Returns true if the point is in the remaining part, according to the loops' winding number. u, v are
  // wrapped or clamped into the domain. In an open direction, a point closer to an end than 2 *
  // trim_rounding_fraction times the length of the domain is moved inwards to that distance. On a loop the
  // result is undefined. Does not allocate.
  bool contains(double u, double v) const;

  // Returns the fraction of the domain's (u, v) area that remains, above 0 and at most 1.
  double remaining_fraction() const { return remaining_fraction_; }

  // An edge of a polygon that replaces a loop. The remaining part of the domain is on its left. The edge is
  // within trim_chord_fraction of the loop. A polygon that crosses a seam continues outside the domain; its
  // edges occur again, shifted by a period, on the other side.
  struct Edge {
    Eigen::Vector2d from, to;
  };
  const std::vector<Edge>& edges() const { return edges_; }

 private:
  Status add_edges(const std::vector<std::vector<Eigen::Vector2d>>& polygons);
  Status compute_level(const std::vector<std::vector<Eigen::Vector2d>>& polygons);
  int find_level(const std::vector<Eigen::Vector2d>& polygon) const;
  std::map<int, int> windings_beside(const std::vector<Eigen::Vector2d>& polygon, double offset) const;
  int winding(double u, double v) const;
  std::size_t find_column(double u) const;
  bool fill_columns(std::size_t columns);

  KnotVector along_u_, along_v_;
  std::vector<Edge> edges_;
  int level_ = 0;  // a point remains if its winding number plus level_ is above 0
  double remaining_fraction_ = 1.0;
  // Indices of the edges, listed for columns of equal width in u. The edges that may cross a vertical line in
  // column c are the entries column_starts_[c] to column_starts_[c + 1] - 1 of column_edges_.
  std::vector<std::size_t> column_starts_, column_edges_;
};

// The grid lines of one direction that bound its cells, including the ends of the domain. In a periodic
// direction the two ends are the same line of the surface, so the grid may omit the second one; its last
// cells then end at the first line.
class GridLines {
 public:
  // The parameters must include both ends of an open direction.
  explicit GridLines(const GridDirection& direction);

  int cells() const { return static_cast<int>(at_.size()) - 1; }
  int samples() const { return samples_; }
  double at(int line) const { return at_[static_cast<std::size_t>(line)]; }
  const std::vector<double>& all() const { return at_; }

  // Returns the nearest grid line if it is within a billionth of the domain, so that no sliver is cut off;
  // otherwise the parameter itself.
  double snap(double parameter) const;
  // Returns the index of the cell that contains a parameter; outside the domain, the nearest cell. A
  // parameter on a line belongs to the cell after the line.
  int find_cell(double parameter) const;
  // Returns the index of the line exactly at a parameter, or -1 if no line is there.
  int find_line(double parameter) const;
  // If the parameter is the end of the period and the grid has a single line at the seam, returns the start
  // of the period. Otherwise returns the parameter unchanged.
  double merge_seam(double parameter) const;

 private:
  std::vector<double> at_;
  int samples_ = 0;
  double snap_ = 0.0;
};

// Classification of the cells of a grid as inside a trimmed area, outside it, or cut by its boundary, with
// the parts of the boundary in each cut cell. Immutable once made; any thread may read it.
class TrimmedCells {
 public:
  // State of a cell: outside the area (away), cut by edges of the area, or entirely inside (kept).
  enum class State : std::uint8_t { away, cut, kept };

  TrimmedCells(const GridLines& u, const GridLines& v, const TrimmedArea& area);

  State state(int i, int j) const { return states_[index(i, j)]; }
  // Returns the parts of the area's edges that are inside a cut cell. They are in the order of the area's
  // edges. An edge along a grid line cuts no cell.
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

// A vertex between the grid's samples, interpolated bilinearly between the corners of its cell. A vertex on a
// side of the cell is therefore on the straight line between the side's ends, and neighbouring triangles meet
// without a gap.
struct CutVertex {
  double u = 0.0, v = 0.0;
  std::array<std::uint32_t, 4> corners{};  // samples of the grid, counter-clockwise from the lowest u and v
  std::array<double, 4> weights{};         // bilinear weights of the corners; their sum is 1
};

// Triangles of the part of a grid that is inside a trimmed area.
struct TrimmedGrid {
  // Vertices that are not samples of the grid. They are numbered after the samples.
  std::vector<CutVertex> vertices;
  // Vertex numbers of each triangle, counter-clockwise with u to the right and v up. No vertex is in the
  // interior of a triangle's side.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Divides the part of a grid inside a trimmed area into triangles. In the result, sample (i, j) of the grid
// has the number i * columns + j. A periodic direction may omit the second line at the seam; its last cells
// then end at the first line. The parameters must include both ends of an open direction.
TrimmedGrid trim_grid(const GridDirection& u, const GridDirection& v, const TrimmedArea& area);

// Returns the fraction of a surface's area in space that remains inside the trims. It is computed from
// triangles of 8 x 8 cells in each polynomial piece; the error shrinks with the square of the cell size.
double remaining_area_fraction(const Surface& surface, const TrimmedArea& area);

}  // namespace spoonbill
