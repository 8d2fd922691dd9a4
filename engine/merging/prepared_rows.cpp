#include "engine/merging/prepared_rows.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/bridge.h"
#include "engine/merging/compatible.h"
#include "engine/merging/joint_edges.h"

namespace spoonbill {

namespace {

Result<Surface> cut_back(const Surface& patch, bool at_end, double parameter) {
  const double start = patch.v.domain_start(), end = patch.v.domain_end();
  if (!(parameter < 0.5 * (end - start))) {
    return Error{"the blend takes more than half of a patch; ask for a shorter one"};
  }
  return at_end ? part_of(patch, Direction::v, start, end - parameter)
                : part_of(patch, Direction::v, start + parameter, end);
}

Result<JointMeasure> measure(const Surface& before, const Surface& after, const JoinRequest& request) {
  const JointEdges edges = joint_edges(before, after);
  if (largest_gap_m(edges) <= request.tolerance_m) {
    return JointMeasure{false, largest_gap_m(edges), 0.0, stretch_at_edge(edges)};
  }
  const auto length = bridge_length(before, after, request.continuity, request.bridges_may_fold);
  if (!length) return length.error();
  return JointMeasure{true, length->chord_m, length->parameter, length->stretch_of_after};
}

// What is to be done at a joint, over all rows.
struct JointState {
  bool any_touching = false, any_apart = false, all_smooth = true, all_lead_on = true;
  double apart_m = 0.0;                                               // the largest gap
  double mean_gap_m = 0.0, advance_m = 0.0;                           // means
  double shortest_piece_m = std::numeric_limits<double>::infinity();  // beside the joint
  double speed_before = 0.0, speed_after = 0.0;                       // means
};

JointState state_of_joint(const std::vector<PreparedRow>& rows, std::size_t joint,
                          const JoinRequest& request) {
  JointState state;
  for (const PreparedRow& row : rows) {
    const JointEdges edges = joint_edges(row.patches[joint], row.patches[joint + 1]);
    const double gap_m = largest_gap_m(edges), share = 1.0 / static_cast<double>(rows.size());
    const bool touching = gap_m <= request.tolerance_m;
    state.any_touching = state.any_touching || touching;
    state.any_apart = state.any_apart || !touching;
    state.all_smooth = state.all_smooth && is_smooth(row.patches[joint], row.patches[joint + 1],
                                                     stretch_at_edge(edges), request.continuity);
    state.all_lead_on = state.all_lead_on && leads_on(edges, request.tolerance_m);
    state.apart_m = std::max(state.apart_m, gap_m);
    state.advance_m += share * mean_advance_m(edges);
    state.mean_gap_m += share * mean_gap_m(edges);
    const double before = mean_speed(edges.before), after = mean_speed(edges.after);
    state.shortest_piece_m =
        std::min({state.shortest_piece_m, piece_length_m(row.patches[joint], true, before),
                  piece_length_m(row.patches[joint + 1], false, after)});
    state.speed_before += share * before;
    state.speed_after += share * after;
  }
  return state;
}

// Where patches do not run straight on across a small gap, a bridge of its own length would be a step, or
// fold: they are blended over a polynomial piece, but over so many times the gap at least and at most. What
// is cut off for that stays below a share of a patch.
constexpr double least_of_gap = 10.0, most_of_gap = 40.0, most_cut_share = 0.25;
// Of the gap, how far back edges may lie that are not cut back.
constexpr double most_back_share = 0.5;

bool is_short_beside(const std::vector<PreparedRow>& rows, std::size_t joint, double cut_m) {
  return std::all_of(rows.begin(), rows.end(), [&](const PreparedRow& row) {
    const Surface &before = row.patches[joint], &after = row.patches[joint + 1];
    const JointEdges edges = joint_edges(before, after);
    const auto length_m = [](const Surface& patch, double speed) {
      return speed * (patch.v.domain_end() - patch.v.domain_start());
    };
    return cut_m <= most_cut_share * std::min(length_m(before, mean_speed(edges.before)),
                                              length_m(after, mean_speed(edges.after)));
  });
}

// How much of each patch a blend takes; none where nothing is to be blended.
Result<double> cut_for_blend_m(const std::vector<PreparedRow>& rows, std::size_t joint,
                               const JointState& state, const JoinRequest& request) {
  if (request.blend_m > 0.0) {
    const bool wanted = state.any_apart || !state.all_smooth;
    return wanted ? std::max(0.0, 0.5 * (request.blend_m - state.advance_m)) : 0.0;
  }
  if (!state.any_apart) return 0.0;
  if (state.any_touching) {
    return Error{
        "patches of the grid touch in one row of a joint and are apart in another; ask for a blend, or allow "
        "a larger tolerance"};
  }
  if (state.all_lead_on || request.bridges_may_fold) return 0.0;
  const double length_m =
      std::clamp(state.shortest_piece_m, least_of_gap * state.apart_m, most_of_gap * state.apart_m);
  const double cut_m = 0.5 * (length_m - state.advance_m);
  if (is_short_beside(rows, joint, cut_m)) return cut_m;
  if (state.advance_m < -most_back_share * state.mean_gap_m) {
    return Error{"the patches overlap by " + short_length_text(-state.advance_m) +
                 " where they are to be joined; move them apart, cut a piece off, or let them intersect"};
  }
  return 0.0;
}

// In all rows alike, so that they keep their joints at the same parameter.
Status cut_for_blend(std::vector<PreparedRow>& rows, std::size_t joint, const JoinRequest& request) {
  const JointState state = state_of_joint(rows, joint, request);
  const auto cut_m = cut_for_blend_m(rows, joint, state, request);
  if (!cut_m) return cut_m.error();
  for (PreparedRow& row : rows) {
    row.joints.push_back({});
    row.joints[joint].apart_m = state.apart_m;
    row.joints[joint].cut_back_m = cut_m.value();
    if (cut_m.value() == 0.0) continue;
    Surface &before = row.patches[joint], &after = row.patches[joint + 1];
    auto shorter = cut_back(before, true, cut_m.value() / state.speed_before);
    if (!shorter) return shorter.error();
    auto later = cut_back(after, false, cut_m.value() / state.speed_after);
    if (!later) return later.error();
    before = std::move(shorter).value();
    after = std::move(later).value();
  }
  return {};
}

// One measure for all rows: the mean, and of bridges the shortest, which folds in none of them.
Status measure_joint(std::vector<PreparedRow>& rows, std::size_t joint, const JoinRequest& request) {
  double stretch = 0.0, shortest = std::numeric_limits<double>::infinity();
  for (PreparedRow& row : rows) {
    const auto measured = measure(row.patches[joint], row.patches[joint + 1], request);
    if (!measured) return measured.error();
    JointMeasure& joint_of_row = row.joints[joint];
    joint_of_row.bridged = measured->bridged;
    joint_of_row.gap_m = measured->gap_m;
    stretch += measured->stretch_of_after / static_cast<double>(rows.size());
    shortest = std::min(shortest, measured->gap_parameter);
  }
  for (PreparedRow& row : rows) {
    row.joints[joint].gap_parameter = shortest;
    row.joints[joint].stretch_of_after = stretch;
  }
  return {};
}

Status share_domains(std::vector<std::vector<Surface>>& rows) {
  for (std::size_t row = 1; row < rows.size(); ++row) {
    for (std::size_t k = 0; k < rows[row].size(); ++k) {
      const KnotVector& first = rows[0][k].v;
      auto moved = with_domain(rows[row][k], Direction::v, first.domain_start(), first.domain_end());
      if (!moved) return moved.error();
      rows[row][k] = std::move(moved).value();
    }
  }
  return {};
}

}  // namespace

Result<std::vector<PreparedRow>> prepare_rows(std::vector<std::vector<Surface>> rows,
                                              const JoinRequest& request) {
  SPOONBILL_ASSERT(!rows.empty());
  SPOONBILL_ASSERT(std::all_of(rows.begin(), rows.end(),
                               [&](const auto& row) { return row.size() == rows.front().size(); }));
  if (Status status = share_domains(rows); !status) return status.error();
  std::vector<PreparedRow> prepared;
  for (std::vector<Surface>& row : rows) {
    const double done = static_cast<double>(prepared.size()), count = static_cast<double>(rows.size());
    JoinRequest of_row = request;
    of_row.progress = request.progress.part(done / count, (done + 1.0) / count);
    auto compatible = compatible_along_v(std::move(row), of_row);
    if (!compatible) return compatible.error();
    prepared.push_back({std::move(compatible->patches), {}, compatible->deviation_m});
  }
  const std::size_t patches = prepared.empty() ? 0 : prepared[0].patches.size();
  for (std::size_t joint = 0; joint + 1 < patches; ++joint) {
    if (Status status = cut_for_blend(prepared, joint, request); !status) return status.error();
    if (Status status = measure_joint(prepared, joint, request); !status) return status.error();
  }
  return prepared;
}

}  // namespace spoonbill
