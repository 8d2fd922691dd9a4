// Search for parts of two surfaces that are near each other. It finds samples with the other surface's
// nearest points, and the locally nearest or deepest points between samples.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/collision/levels/cell_pairs.h"
#include "engine/collision/levels/surface_levels.h"
#include "engine/collision/proximity/net_motion.h"
#include "engine/collision/surfaces/pair_polish.h"

namespace spoonbill {

// The point of a cell nearest to a given point. The cell is treated as two triangles between its samples. `u`
// and `v` are local coordinates in the cell, from 0 to 1; `distance` is in metres.
struct NearestOnCell {
  double u, v, distance;
};
NearestOnCell nearest_on_cell(const Vector3& point, const PatchCorners& at);

// A point of one surface and the nearest point of the other.
struct NearPoint {
  int sample = -1;          // index in the grid of its own surface; -1 for a point between samples
  double u = 0.0, v = 0.0;  // parameters of the point on its own surface
  double other_u = 0.0, other_v = 0.0;
  Vector3 point_m = Vector3::Zero();
  Vector3 other_m = Vector3::Zero();  // nearest point of the other surface
  Vector3 normal = Vector3::UnitY();  // unit outward normal of the other surface
  double gap_m = 0.0;                 // distance along the normal; negative inside the other body
  // For a point between samples: how much smaller its gap is than those of the samples around it on both
  // surfaces.
  double lead_m = 0.0;
  int nearest_sample = -1;  // for a point between samples: index of the sample from which it was found
};

// Collects the points of one surface that are near another surface. Call the functions in the order of their
// declaration. Not thread-safe. Allocates only on construction. The grid must outlive the object.
class NearPoints {
 public:
  explicit NearPoints(const NestedGrid& nested, SkippedSamples skipped = {});

  // Sets whether the samples that the constructor was told to skip are skipped; at first they are.
  void set_skipping(bool is_skipping) { is_skipping_ = is_skipping; }
  bool is_skipping() const { return is_skipping_; }
  bool has_skipped() const { return !skipped_.empty(); }
  // Removes all points. Returns false if the surface has not moved since the last call.
  bool begin(const Surface& surface);

  // Finds the nearest points of the candidates of the last compute_nearest(), each from its last nearest
  // point. `other` must be the same surface as then; it may have moved and changed its shape.
  void follow(const SurfaceLevels& other);
  // Removes all candidates.
  void forget() { candidates_.clear(); }
  // Compares corners of a cell with `patch`, a cell of the other surface, and remembers the nearest point for
  // each corner. Must be called for all cells that may be within `margin_m` of the patch: a corner that is
  // shared by cells is compared only with one of them. Corners farther than the margin from the exact surface
  // over the patch may be left out, and samples that the constructor was told to skip are.
  void offer_corners(const LevelCell& cell, SurfaceLevels& other, const LevelCell& patch, double margin_m);
  // Compares the sample (i, j) of the finest grid with `patch`, a cell of the other surface with the given
  // corners, and remembers the nearest point. The other surface may be the same surface.
  void offer(int i, int j, const SurfaceLevels& other, const LevelCell& patch, const PatchCorners& corners);
  // Returns the distance within which a cell replaces the nearest point of a sample: the distance to the
  // nearest cell so far; infinite if the sample has been compared with no cell. A cell is treated as two
  // triangles.
  double offered_distance_m(int sample) const;
  // Replaces each sample's nearest point by the nearest point of the exact other surface. Removes samples
  // beyond the margin. Samples within `reach_m`, which is at least the margin, are candidates for follow(),
  // and so are samples up to twice as deep inside the other body. `outside` is -1 if the other surface's du x
  // dv points inward, else 1.
  void compute_nearest(const SurfaceLevels& other, double outside, double margin_m, double reach_m);
  // Adds the locally nearest points between samples, where the surfaces may be nearer to each other than at
  // any sample. `other` holds the points of the other surface, which may be this one.
  void add_between_samples(const NearPoints& other, double outside);
  // Returns the smallest gap of the samples at the corners of the grid cell that contains (u, v); infinite if
  // no corner is near the other surface.
  double smallest_gap_around(double u, double v) const;

  // Removes the points for which keep(point) returns false. `keep` may modify the point.
  template <class Keep>
  void keep_if(const Keep& keep) {
    std::size_t kept = 0;
    least_gap_m_ = std::numeric_limits<double>::infinity();
    for (NearPoint& near : near_) {
      if (!keep(near)) {
        if (near.sample >= 0) indexed_at_[near.sample] = 0;
        continue;
      }
      least_gap_m_ = near.gap_m < least_gap_m_ ? near.gap_m : least_gap_m_;
      if (near.sample >= 0) index_[near.sample] = static_cast<int>(kept);
      near_[kept++] = near;
    }
    near_.resize(kept);
  }

  SurfaceLevels& levels() { return levels_; }
  const SurfaceLevels& levels() const { return levels_; }
  const std::vector<NearPoint>& points() const { return near_; }
  double least_gap_m() const { return least_gap_m_; }  // infinite if no point is near the other surface
  // Returns true if a capacity was exceeded, so that points may be missing or may not be the nearest.
  bool overflow() const { return overflow_ || budget_.is_spent(); }
  // Returns the number of surface points evaluated since begin().
  int evaluations() const { return proximity_evaluation_limit - budget_.evaluations_left; }

 private:
  // Sample that may be near the other surface, and the parameters of its last nearest point.
  struct Candidate {
    int sample;
    double other_u, other_v;
  };
  // Sample whose nearest point follow() has found.
  struct FollowedSample {
    double height_m;  // distance of the sample in front of the nearest point, along du x dv
    bool is_nearest;  // false once a nearer cell has been found
  };

  void add_sample(const NearPoint& near);
  bool is_followed(int index) const { return index < static_cast<int>(followed_.size()); }
  // Replaces the other surface's point by the nearest one, and the normal by the unit vector along du x dv.
  // The gap becomes the distance. Returns the distance in front of the nearest point, along du x dv.
  double find_nearest(const SurfaceLevels& other, NearPoint& near);
  // Calls visit(sample) for the samples around a sample, and for this one.
  template <class Visit>
  void visit_around(int sample, const Visit& visit) const {
    // Beside a sample that is skipped, there may be one that is not.
    const int reach = skipped_.empty() || !is_skipping_ ? 1 : 2;
    const Grid& grid = levels_.nested().grid;
    const int row = sample / grid.columns(), column = sample % grid.columns();
    for (int i = std::max(0, row - reach); i <= std::min(row + reach, grid.rows() - 1); ++i) {
      for (int j = std::max(0, column - reach); j <= std::min(column + reach, grid.columns() - 1); ++j) {
        visit(i * grid.columns() + j);
      }
    }
  }
  bool is_local_deepest(const NearPoint& near) const;
  // Returns the largest distance of a sample of the grid from the samples around it, m.
  double find_spacing_m(int sample);

  SurfaceLevels levels_;
  SkippedSamples skipped_;
  bool is_skipping_ = true;
  std::vector<int> index_;                 // for each sample, its index in near_
  std::vector<std::uint32_t> indexed_at_;  // value of generation_ when each entry of index_ was set
  std::vector<NearPoint> near_;
  std::vector<Candidate> candidates_;
  std::vector<FollowedSample> followed_;  // for the first points of near_
  std::uint32_t generation_ = 0;
  PolishBudget budget_{0};  // surface points that may still be evaluated until the next begin()
  double least_gap_m_ = 0.0;
  bool overflow_ = false;
};

// Proximity search of two surfaces. Searches cells up to twice the margin, so that while the surfaces move
// slowly, the samples found are only followed, and cells are searched again once the surfaces may have moved
// by the margin. Not thread-safe. Allocates only on construction. The grids must outlive the search.
class SurfaceProximity {
 public:
  SurfaceProximity(const NestedGrid& first, const NestedGrid& second, SkippedSamples first_skipped = {},
                   SkippedSamples second_skipped = {});
  SurfaceProximity(const SurfaceProximity&) = delete;
  SurfaceProximity& operator=(const SurfaceProximity&) = delete;

  // Finds all points within `margin_m` of the other surface, and samples that have sunk deeper into the other
  // body: down to two margins, or four while the surfaces move slowly. A sample in a groove narrower than two
  // margins may be found on the farther wall only, until cells are searched again. The surfaces must have the
  // grids' knots and bound bodies. On the first surface, du x dv must point outward. `second_outside` is 1 if
  // it points outward on the second surface too, and -1 if it points inward, as on a mirrored surface. The
  // motion of the surfaces is measured relative to `frame`, which should be the pose of one of them if it is
  // rigid.
  void find(const Surface& first, const Surface& second, double margin_m, double second_outside = 1.0,
            const Pose& frame = {});

  // Sets for each surface whether the samples that the constructor was told to skip are skipped. At first
  // they are. Forgets what was found if this changes.
  void set_skipping(bool first, bool second);
  // Forgets what earlier calls of find() have found. Must be called before surfaces jump or are replaced.
  void forget();

  // Removes the first surface's points for which `keep_first` returns false, and the second surface's points
  // for which `keep_second` returns false. Both functions may modify the point.
  template <class KeepFirst, class KeepSecond>
  void keep_if(const KeepFirst& keep_first, const KeepSecond& keep_second) {
    first_.keep_if(keep_first);
    second_.keep_if(keep_second);
  }

  // Points that the last find() found: first_points() returns the points of the first surface near the
  // second, second_points() those of the second surface near the first.
  const std::vector<NearPoint>& first_points() const { return first_.points(); }
  const std::vector<NearPoint>& second_points() const { return second_.points(); }
  double least_gap_m() const;  // infinite if no points are near each other
  // Returns true if a capacity was exceeded, so that points may be missing. Fewer control points or a smaller
  // margin help.
  bool overflow() const { return missing_cells_ || first_.overflow() || second_.overflow(); }
  // first_evaluations() returns the number of surface points that the last find() evaluated for
  // first_points(), second_evaluations() the number for second_points().
  int first_evaluations() const { return first_.evaluations(); }
  int second_evaluations() const { return second_.evaluations(); }
  // Returns how many calls of find() have searched cells.
  int cell_searches() const { return cell_searches_; }

 private:
  // Compares cells within `reach_m` of each other. A fresh search follows no candidates.
  void search_cells(double reach_m, bool is_fresh);

  NearPoints first_, second_;
  int least_followed_;
  CellPairs cells_;
  NetMotion first_motion_, second_motion_;  // since the last search of cells
  double searched_m_ = -1.0;                // reach of the last search of cells; -1 before the first
  int finds_ = 0;                           // number of calls of find() since the last search of cells
  int cell_searches_ = 0;
  bool missing_cells_ = false;
  bool is_crowded_ = false;  // whether a search of twice the margin has exceeded a capacity
};

}  // namespace spoonbill
