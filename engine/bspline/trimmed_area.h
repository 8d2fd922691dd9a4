// The part of a surface's domain that its trim loops keep, made ready to be asked about points.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "engine/base/range.h"
#include "engine/base/result.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/trim_loop.h"

namespace spoonbill {

inline constexpr Range<int> trim_loop_count_range{0, 1000};

// Immutable once made; any thread may ask. Knows nothing of control points, so that it holds while the
// surface deforms. Of u and v it keeps the domains alone.
class TrimmedArea {
 public:
  // Without loops, all of any domain.
  TrimmedArea() = default;

  // Of loops of make_trim_loop. Refused: too many loops or chords, loops that cross each other, loops that do
  // not agree on what they keep, such as a hole that runs counter-clockwise, loops upon each other, and loops
  // that keep nothing.
  static Result<TrimmedArea> make(const KnotVector& along_u, const KnotVector& along_v,
                                  const std::vector<TrimLoop>& loops);

  bool is_whole() const { return edges_.empty(); }

  // Whether the surface is there: by how often the loops wind around the point. u, v are wrapped or clamped
  // into the domain; its ends belong to what lies beside them. On a loop the answer is either. Allocates
  // nothing.
  bool contains(double u, double v) const;

  // The share of the domain that is kept: above 0, at most 1.
  double kept_share() const { return kept_share_; }

  // Polygons within trim_chord_share of the loops, edge by edge, what is kept on the left. Across a seam they
  // continue outside the domain, and once more on its other side.
  struct Edge {
    Eigen::Vector2d from, to;
  };
  const std::vector<Edge>& edges() const { return edges_; }

 private:
  Status place(const std::vector<std::vector<Eigen::Vector2d>>& polygons);
  Status take_level(const std::vector<std::vector<Eigen::Vector2d>>& polygons);
  int level_of(const std::vector<Eigen::Vector2d>& polygon) const;
  std::map<int, int> windings_beside(const std::vector<Eigen::Vector2d>& polygon, double share) const;
  int winding(double u, double v) const;
  std::size_t column_of(double u) const;
  bool fill_columns(std::size_t columns);

  KnotVector along_u_, along_v_;
  std::vector<Edge> edges_;
  int level_ = 0;  // added to the winding number, so that 1 and more is kept
  double kept_share_ = 1.0;
  // The domain lies in equal columns of u. What may cross a vertical line in column c: column_edges_ from
  // column_starts_[c] to column_starts_[c + 1].
  std::vector<std::size_t> column_starts_, column_edges_;
};

}  // namespace spoonbill
