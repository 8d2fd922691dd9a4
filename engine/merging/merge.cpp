#include "engine/merging/merge.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/bridge.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {
namespace {

struct PatchGrid {
  const std::vector<Surface>& patches;
  const Arrangement& arrangement;

  Surface at(int a, int b) const {
    const int cell = arrangement.cell(a, b);
    return orient(patches[arrangement.patches[cell]], arrangement.orientations[cell]);
  }
};

// Returns the side of the patch that the orientation turns into the side `in_grid`.
Side own_side(Side in_grid, const Orientation& orientation) {
  for (const Side side : all_sides) {
    if (turn_side(side, orientation).side == in_grid) return side;
  }
  return in_grid;
}

// Describes the joint between a cell and the next cell along a direction. The first cell follows the last.
MergedJoint describe(const PatchGrid& grid, int a, int b, Direction along, const Joint& joint) {
  const Arrangement& all = grid.arrangement;
  const int cell = all.cell(a, b);
  const int next =
      along == Direction::u ? all.cell((a + 1) % all.rows, b) : all.cell(a, (b + 1) % all.columns);
  const Side end = along == Direction::u ? Side::u_end : Side::v_end;
  return {{all.patches[cell], own_side(end, all.orientations[cell])},
          {all.patches[next], own_side(opposite(end), all.orientations[next])},
          along,
          joint};
}

// Joins every row along v. A grid of a single column is not changed, because it may still become periodic
// along v.
Result<std::vector<Joined>> join_along_v(const PatchGrid& grid, const JoinRequest& request) {
  std::vector<Joined> joined;
  if (grid.arrangement.columns == 1) {
    for (int a = 0; a < grid.arrangement.rows; ++a) joined.push_back({grid.at(a, 0), 0.0, {}});
    return joined;
  }
  std::vector<std::vector<Surface>> rows(static_cast<std::size_t>(grid.arrangement.rows));
  for (int a = 0; a < grid.arrangement.rows; ++a) {
    for (int b = 0; b < grid.arrangement.columns; ++b) rows[a].push_back(grid.at(a, b));
  }
  constexpr double prepared_fraction = 0.3;
  JoinRequest step = request;
  step.progress = request.progress.part(0.0, prepared_fraction);
  const auto prepared = prepare_rows(std::move(rows), step);
  if (!prepared) return prepared.error();
  const double each = (1.0 - prepared_fraction) / static_cast<double>(prepared->size());
  for (const PreparedRow& row : prepared.value()) {
    const double done = prepared_fraction + each * static_cast<double>(joined.size());
    step.progress = request.progress.part(done, done + each);
    auto result = join_prepared(row, step);
    if (!result) return result.error();
    joined.push_back(std::move(result).value());
  }
  return joined;
}

// Divides the unused tolerance and the rest of the progress among the steps of a merge.
class ToleranceSteps {
 public:
  ToleranceSteps(const JoinRequest& request, int steps) : request_(request), steps_(steps) {}

  JoinRequest next(double spent_m) {
    JoinRequest step = request_;
    step.spent_m += spent_m;
    const double left_m = std::max(0.0, step.tolerance_m - step.spent_m);
    step.spent_m += left_m * (steps_ - 1) / steps_;
    --steps_;
    const double end = steps_ == 0 ? 1.0 : done_ + (1.0 - done_) / (steps_ + 1);
    step.progress = request_.progress.part(done_, end);
    done_ = end;
    return step;
  }

 private:
  JoinRequest request_;
  int steps_;
  double done_ = 0.0;
};

Result<Approximation> close_without_folds(const Surface& surface, Direction direction,
                                          const JoinRequest& request) {
  auto closed = close_around(surface, direction, request.continuity, request.tolerance_m - request.spent_m,
                             request.progress);
  if (!closed || closed->deviation_m <= rounding_m) return closed;
  const auto fold_m = find_fold(closed->surface);
  if (!fold_m || find_fold(surface)) return closed;
  return Error(ErrorCode::self_intersecting, "the surface would fold over at " + position_text(*fold_m));
}

// Makes the direction periodic if the patches form a ring along it.
Status close_ring(const PatchGrid& grid, Direction direction, ToleranceSteps& steps, Merged& merged) {
  const Arrangement& all = grid.arrangement;
  const bool along_u = direction == Direction::u;
  const std::vector<EdgeMatch>& matches = along_u ? all.closing_u : all.closing_v;
  if (matches.empty()) return {};
  const JoinRequest step = steps.next(merged.deviation_m);
  auto closed = close_without_folds(merged.surface, direction, step);
  if (!step.progress.report(1.0)) return Progress::stopped();
  if (!closed) {
    for (const EdgeMatch& match : matches) {
      merged.left_open.push_back({match.a, match.b, closed.error().message});
    }
    return {};
  }
  merged.surface = std::move(closed->surface);
  merged.deviation_m += closed->deviation_m;
  Joint joint;
  for (const EdgeMatch& match : matches) joint.gap_m = std::max(joint.gap_m, match.gap_m);
  joint.apart_m = joint.gap_m;
  joint.blend_start = joint.blend_end = knots_along(merged.surface, direction).domain_end();
  for (int k = 0; k < static_cast<int>(matches.size()); ++k) {
    merged.joints.push_back(
        describe(grid, along_u ? all.rows - 1 : k, along_u ? k : all.columns - 1, direction, joint));
    merged.joints.back().closes = true;
  }
  return {};
}

Result<Merged> join_grid(const PatchGrid& grid, const JoinRequest& request, ToleranceSteps& steps) {
  const Arrangement& all = grid.arrangement;
  auto rows = join_along_v(grid, all.columns > 1 ? steps.next(0.0) : request);
  if (!rows) return rows.error();
  Merged merged;
  std::vector<Surface> strips;
  for (std::size_t a = 0; a < rows->size(); ++a) {
    Joined& row = rows.value()[a];
    merged.deviation_m = std::max(merged.deviation_m, row.deviation_m);
    for (std::size_t b = 0; b < row.joints.size(); ++b) {
      merged.joints.push_back(
          describe(grid, static_cast<int>(a), static_cast<int>(b), Direction::v, row.joints[b]));
    }
    strips.push_back(exchanged(row.surface));
  }
  if (strips.size() == 1) {
    merged.surface = std::move(rows.value()[0].surface);
    return merged;
  }
  auto whole = join_row(std::move(strips), steps.next(merged.deviation_m));
  if (!whole) return whole.error();
  merged.deviation_m += whole->deviation_m;
  for (std::size_t a = 0; a < whole->joints.size(); ++a) {
    for (int b = 0; b < all.columns; ++b) {
      merged.joints.push_back(describe(grid, static_cast<int>(a), b, Direction::u, whole->joints[a]));
    }
  }
  merged.surface = exchanged(whole->surface);
  return merged;
}

Result<Merged> merge_grid(const PatchGrid& grid, const JoinRequest& request) {
  const Arrangement& all = grid.arrangement;
  int count = 0;
  for (const bool step : {all.columns > 1, all.rows > 1, !all.closing_u.empty(), !all.closing_v.empty()}) {
    count += step ? 1 : 0;
  }
  ToleranceSteps steps(request, count);
  auto merged = join_grid(grid, request, steps);
  if (!merged) return merged;
  for (const Direction direction : {Direction::u, Direction::v}) {
    if (Status status = close_ring(grid, direction, steps, merged.value()); !status) return status.error();
  }
  return merged;
}

// Largest ratio of the radii of two openings that are cut for a bridge. With a larger ratio, the bridge would
// have a step.
constexpr double wider = 1.25;

// Cuts the poles of a pair of ends open. Ends that are rings are not changed.
Status open_poles(std::vector<Surface>& patches, const PatchEdge& a, const PatchEdge& b) {
  const auto open = [&](const PatchEdge& end, double wide_enough_m) -> Result<Surface> {
    const Surface& patch = patches[end.patch];
    if (!is_pole(patch, end.side)) return patch;
    return open_pole(patch, end.side, wide_enough_m);
  };
  constexpr double any = std::numeric_limits<double>::infinity();
  auto first = open(a, any), second = open(b, any);
  if (!first && !second) return first.error();
  const double first_radius_m = first ? tube_end(first.value(), a.side).radius_m : any;
  const double second_radius_m = second ? tube_end(second.value(), b.side).radius_m : any;
  if (first_radius_m > wider * second_radius_m) first = open(a, wider * second_radius_m);
  if (second_radius_m > wider * first_radius_m) second = open(b, wider * first_radius_m);
  if (!first) return first.error().in("patch " + std::to_string(a.patch + 1));
  if (!second) return second.error().in("patch " + std::to_string(b.patch + 1));
  patches[a.patch] = std::move(first).value();
  patches[b.patch] = std::move(second).value();
  return {};
}

// Returns the chosen edges or, if no edge was chosen and all patches are tubes, the nearest ends of the
// tubes. Otherwise returns nothing, and edges are matched automatically.
std::vector<ChosenEdges> edges_to_join(const std::vector<Surface>& patches, const MergeRequest& request) {
  std::vector<ChosenEdges> pairs = request.chosen;
  if (!pairs.empty() || !std::all_of(patches.begin(), patches.end(), is_tube)) return pairs;
  for (const auto& [a, b] : find_nearest_ends(patches)) pairs.push_back({a, b});
  return pairs;
}

// If exactly two ends in a row of tubes are still free and touch each other, adds a match between them.
void add_closing_ends(const std::vector<Surface>& tubes, double touching_m, std::vector<EdgeMatch>& matches) {
  std::vector<PatchEdge> free;
  for (int p = 0; p < static_cast<int>(tubes.size()); ++p) {
    const auto [first, last] = tube_sides(tubes[p]);
    for (const PatchEdge end : {PatchEdge{p, first}, PatchEdge{p, last}}) {
      const bool is_used = std::any_of(matches.begin(), matches.end(), [&](const EdgeMatch& match) {
        return match.a == end || match.b == end;
      });
      if (!is_used && is_joinable(tubes[p], end.side)) free.push_back(end);
    }
  }
  if (free.size() != 2 || free[0].patch == free[1].patch) return;
  const auto match = match_edges(tubes, free[0], free[1]);
  if (match && match->gap_m <= touching_m) matches.push_back(match.value());
}

Result<std::vector<EdgeMatch>> find_matches(std::vector<Surface>& patches, const MergeRequest& request) {
  const std::vector<ChosenEdges> pairs = edges_to_join(patches, request);
  if (pairs.empty()) return find_edge_matches(patches, request.join.tolerance_m);
  for (const ChosenEdges& edges : pairs) {
    if (Status status = open_poles(patches, edges.a, edges.b); !status) return status.error();
  }
  std::vector<EdgeMatch> matches;
  for (const ChosenEdges& edges : pairs) {
    auto match = match_edges(patches, edges.a, edges.b, edges.reversed);
    if (!match) return match.error();
    matches.push_back(match.value());
  }
  if (request.chosen.empty()) add_closing_ends(patches, request.join.tolerance_m, matches);
  return matches;
}

// Returns true if both surfaces coincide in any of their orientations. Periodic surfaces must have the same
// seam.
bool are_same(const Surface& a, const Surface& b, double tolerance_m) {
  constexpr int steps = 5;
  const auto is_near = [&](const Surface& other) {
    const std::vector<double> u = uniform_parameters(a.u, steps), v = uniform_parameters(a.v, steps);
    const std::vector<double> other_u = uniform_parameters(other.u, steps);
    const std::vector<double> other_v = uniform_parameters(other.v, steps);
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        if ((position(a, u[i], v[j]) - position(other, other_u[i], other_v[j])).norm() > tolerance_m) {
          return false;
        }
      }
    }
    return true;
  };
  for (int k = 0; k < 8; ++k) {
    if (is_near(orient(b, {(k & 1) != 0, (k & 2) != 0, (k & 4) != 0}))) return true;
  }
  return false;
}

Status check_different(const std::vector<Surface>& patches, double tolerance_m) {
  for (std::size_t b = 1; b < patches.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (!are_same(patches[a], patches[b], tolerance_m)) continue;
      return Error(ErrorCode::duplicate,
                   "patches " + std::to_string(a + 1) + " and " + std::to_string(b + 1) +
                       " are the same surface at the same position; name only one, or move one away");
    }
  }
  return {};
}

Status check_named_once(const std::vector<ChosenEdges>& chosen) {
  std::vector<PatchEdge> named;
  for (const ChosenEdges& edges : chosen) {
    for (const PatchEdge& edge : {edges.a, edges.b}) {
      if (std::find(named.begin(), named.end(), edge) != named.end()) {
        return Error(
            ErrorCode::duplicate,
            edge_name(edge) + " is named in two pairs of edges but can be joined only once; leave one out");
      }
      named.push_back(edge);
    }
  }
  return {};
}

// Fails if a pair of edges that the user chose would stay open. Pairs that were matched automatically touch
// and may stay open.
Status check_left_open(const Arrangement& arrangement, const std::vector<ChosenEdges>& chosen) {
  if (arrangement.left_open.empty() || chosen.empty()) return {};
  const EdgeMatch& match = arrangement.left_open.front();
  return Error(
      ErrorCode::inconsistent,
      edge_name(match.a) + " and " + edge_name(match.b) +
          " cannot be joined, as the other pairs of edges place these patches elsewhere; omit this pair, "
          "and if the patches form a ring, close the merged surface with `spoonbill change`");
}

Error cannot_close(const OpenEdges& edges) {
  return Error(ErrorCode::mismatch, edge_name(edges.a) + " and " + edge_name(edges.b) +
                                        " cannot be joined to close the surface: " + edges.reason);
}

constexpr int most_patches = 64;

}  // namespace

Status check_merge(const std::vector<Surface>& patches, const MergeRequest& request) {
  const int count = static_cast<int>(patches.size());
  if (count == 0) return Error(ErrorCode::missing, "there is no patch to merge; name at least one");
  if (count > most_patches) {
    return Error(ErrorCode::too_many, std::to_string(count) + " patches are more than the " +
                                          std::to_string(most_patches) +
                                          " that can be merged at once; merge some of them first");
  }
  for (const ChosenEdges& edges : request.chosen) {
    for (const PatchEdge& edge : {edges.a, edges.b}) {
      const std::string name = "patch " + std::to_string(edge.patch + 1);
      if (edge.patch < 0 || edge.patch >= count)
        return Error(ErrorCode::unknown, name + " of a chosen edge does not exist");
      if (knots_along(patches[edge.patch], across(edge.side)).is_periodic()) {
        return Error(ErrorCode::mismatch, name + " has no edge at its " + side_name(edge.side) +
                                              ": it is closed in this direction; choose another side");
      }
    }
  }
  return check_named_once(request.chosen);
}

Result<Merged> merge(const std::vector<Surface>& patches, const MergeRequest& request) {
  SPOONBILL_ASSERT(request.join.tolerance_m >= 0.0 && request.join.blend_m >= 0.0);
  if (Status status = check_merge(patches, request); !status) return status.error();
  if (patches.size() == 1) return Merged{patches[0], 0.0, {}};
  if (!request.join.progress.report(0.0)) return Progress::stopped();
  if (Status status = check_different(patches, request.join.tolerance_m); !status) return status.error();
  std::vector<Surface> ready = patches;
  const auto matches = find_matches(ready, request);
  if (!matches) return matches.error();
  if (!request.join.progress.report(0.0)) return Progress::stopped();
  const auto arrangement = arrange(ready, matches.value());
  if (!arrangement) return arrangement.error();
  if (Status status = check_left_open(arrangement.value(), request.chosen); !status) return status.error();
  JoinRequest join = request.join;
  join.bridges_may_fold = std::any_of(request.chosen.begin(), request.chosen.end(),
                                      [](const ChosenEdges& edges) { return edges.reversed.has_value(); });
  auto merged = merge_grid({ready, arrangement.value()}, join);
  if (!merged) return merged;
  if (!request.chosen.empty() && !merged->left_open.empty()) return cannot_close(merged->left_open.front());
  for (const EdgeMatch& match : arrangement->left_open) {
    merged->left_open.push_back({match.a, match.b, "their patches are elsewhere in the grid"});
  }
  if (merged->deviation_m > join.tolerance_m - join.spent_m + rounding_m) {
    return Error(ErrorCode::not_converged,
                 "the patches can be merged within " + short_length_text(merged->deviation_m + join.spent_m) +
                     "; allow a larger tolerance than " + short_length_text(join.tolerance_m),
                 "tolerance");
  }
  return merged;
}

}  // namespace spoonbill
