#include "engine/merging/merge.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "engine/bspline/reparameterise.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {

namespace {

struct Grid {
  const std::vector<Surface>& patches;
  const Arrangement& arrangement;

  Surface at(int a, int b) const {
    const int cell = arrangement.cell(a, b);
    return oriented(patches[arrangement.patches[cell]], arrangement.orientations[cell]);
  }
};

// The mean over the rows, so that all of them keep their joints at the same parameter.
void share_measures(std::vector<PreparedRow>& rows) {
  const double count = static_cast<double>(rows.size());
  for (std::size_t j = 0; j < rows[0].joints.size(); ++j) {
    double gap = 0.0, stretch = 0.0;
    bool bridged = false;
    for (const PreparedRow& row : rows) {
      bridged = bridged || row.joints[j].bridged;
      gap += row.joints[j].gap_parameter / count;
      stretch += row.joints[j].stretch_of_after / count;
    }
    for (PreparedRow& row : rows) {
      row.joints[j].bridged = bridged;
      row.joints[j].gap_parameter = gap;
      row.joints[j].stretch_of_after = stretch;
    }
  }
}

// The side that a patch turns to its neighbour in the grid.
Side own_side(Side in_grid, const Orientation& orientation) {
  for (const Side side : all_sides) {
    if (turned(side, orientation).side == in_grid) return side;
  }
  return in_grid;
}

MergedJoint described(const Grid& grid, int a, int b, Direction along, const Joint& joint) {
  const Arrangement& all = grid.arrangement;
  const int cell = all.cell(a, b);
  const int next = along == Direction::u ? all.cell(a + 1, b) : all.cell(a, b + 1);
  const Side end = along == Direction::u ? Side::u_end : Side::v_end;
  return {{all.patches[cell], own_side(end, all.orientations[cell])},
          {all.patches[next], own_side(opposite(end), all.orientations[next])},
          along,
          joint};
}

// Every row along v is joined; what results lies one after the other along u.
Result<std::vector<Joined>> joined_along_v(const Grid& grid, const JoinRequest& request) {
  std::vector<PreparedRow> rows;
  for (int a = 0; a < grid.arrangement.rows; ++a) {
    std::vector<Surface> patches;
    for (int b = 0; b < grid.arrangement.columns; ++b) patches.push_back(grid.at(a, b));
    auto row = prepare_row(std::move(patches), request);
    if (!row) return row.error();
    rows.push_back(std::move(row).value());
  }
  share_measures(rows);
  std::vector<Joined> joined;
  for (const PreparedRow& row : rows) {
    auto result = join_prepared(row, request);
    if (!result) return result.error();
    joined.push_back(std::move(result).value());
  }
  return joined;
}

Result<Merged> merge_grid(const Grid& grid, const JoinRequest& request) {
  auto rows = joined_along_v(grid, request);
  if (!rows) return rows.error();
  Merged merged;
  std::vector<Surface> strips;
  for (std::size_t a = 0; a < rows->size(); ++a) {
    Joined& row = rows.value()[a];
    merged.deviation_m = std::max(merged.deviation_m, row.deviation_m);
    for (std::size_t b = 0; b < row.joints.size(); ++b) {
      merged.joints.push_back(
          described(grid, static_cast<int>(a), static_cast<int>(b), Direction::v, row.joints[b]));
    }
    strips.push_back(exchanged(row.surface));
  }
  if (strips.size() == 1) {
    merged.surface = std::move(rows.value()[0].surface);
    return merged;
  }
  auto whole = join_row(std::move(strips), request);
  if (!whole) return whole.error();
  merged.deviation_m += whole->deviation_m;
  for (std::size_t a = 0; a < whole->joints.size(); ++a) {
    merged.joints.push_back(described(grid, static_cast<int>(a), 0, Direction::u, whole->joints[a]));
  }
  merged.surface = exchanged(whole->surface);
  return merged;
}

// The wider of two tubes is opened no wider than a little beyond the other, so that the bridge has no step.
constexpr double wider = 1.25;

// Opens both poles of a pair; a ring stays as it is.
Status open_poles(std::vector<Surface>& patches, const PatchEdge& a, const PatchEdge& b) {
  const auto opened = [&](const PatchEdge& end, double wide_enough_m) -> Result<Surface> {
    const Surface& patch = patches[end.patch];
    if (!is_pole(patch, end.side)) return patch;
    return opened_pole(patch, end.side, wide_enough_m);
  };
  constexpr double any = std::numeric_limits<double>::infinity();
  auto first = opened(a, any), second = opened(b, any);
  if (!first && !second) return first.error();
  const double of_first = first ? tube_end(first.value(), a.side).radius_m : any;
  const double of_second = second ? tube_end(second.value(), b.side).radius_m : any;
  if (of_first > wider * of_second) first = opened(a, wider * of_second);
  if (of_second > wider * of_first) second = opened(b, wider * of_first);
  if (!first) return Error{"patch " + std::to_string(a.patch + 1) + ": " + first.error().message};
  if (!second) return Error{"patch " + std::to_string(b.patch + 1) + ": " + second.error().message};
  patches[a.patch] = std::move(first).value();
  patches[b.patch] = std::move(second).value();
  return {};
}

// The edges to join: those chosen, the nearest ends of tubes, or none, which lets them be found.
std::vector<ChosenEdges> wanted_edges(const std::vector<Surface>& patches, const MergeRequest& request) {
  std::vector<ChosenEdges> wanted = request.chosen;
  if (!wanted.empty() || !std::all_of(patches.begin(), patches.end(), is_tube)) return wanted;
  for (const auto& [a, b] : nearest_ends(patches)) wanted.push_back({a, b});
  return wanted;
}

Result<std::vector<EdgeMatch>> matches_for(std::vector<Surface>& patches, const MergeRequest& request) {
  const std::vector<ChosenEdges> wanted = wanted_edges(patches, request);
  if (wanted.empty()) return matches_of(patches, request.join.tolerance_m);
  for (const ChosenEdges& edges : wanted) {
    if (Status status = open_poles(patches, edges.a, edges.b); !status) return status.error();
  }
  std::vector<EdgeMatch> matches;
  for (const ChosenEdges& edges : wanted) {
    auto match = match_edges(patches, edges.a, edges.b, edges.reversed);
    if (!match) return match.error();
    matches.push_back(match.value());
  }
  return matches;
}

Status check(const std::vector<Surface>& patches, const MergeRequest& request) {
  const int count = static_cast<int>(patches.size());
  if (count == 0) return Error{"there is no patch to merge; name at least one"};
  for (const ChosenEdges& edges : request.chosen) {
    for (const PatchEdge& edge : {edges.a, edges.b}) {
      const std::string name = "patch " + std::to_string(edge.patch + 1);
      if (edge.patch < 0 || edge.patch >= count) return Error{name + " of a chosen edge does not exist"};
      if (knots_along(patches[edge.patch], across(edge.side)).is_periodic()) {
        return Error{name + " has no edge at its " + side_name(edge.side) +
                     ": it is closed around there; choose another"};
      }
    }
  }
  return {};
}

}  // namespace

Result<Merged> merge(const std::vector<Surface>& patches, const MergeRequest& request) {
  if (Status status = check(patches, request); !status) return status.error();
  if (patches.size() == 1) return Merged{patches[0], 0.0, {}};
  std::vector<Surface> ready = patches;
  const auto matches = matches_for(ready, request);
  if (!matches) return matches.error();
  const auto arrangement = arrange(ready, matches.value());
  if (!arrangement) return arrangement.error();
  return merge_grid({ready, arrangement.value()}, request.join);
}

}  // namespace spoonbill
