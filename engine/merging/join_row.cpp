#include "engine/merging/join_row.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/bridge.h"
#include "engine/merging/compatible_patches.h"

namespace spoonbill {
namespace {

Result<Surface> cut_back(const Surface& patch, bool at_end, double parameter) {
  const double start = patch.v.domain_start(), end = patch.v.domain_end();
  if (!(parameter < 0.5 * (end - start))) {
    return Error(ErrorCode::out_of_range, "the blend takes more than half of a patch; choose a shorter blend",
                 "blend");
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

// State of one joint, combined over all rows.
struct JointState {
  bool any_touching = false, any_open = false, all_smooth = true, all_continue_ahead = true;
  double apart_m = 0.0;                      // largest gap in any row
  double mean_gap_m = 0.0, advance_m = 0.0;  // means of mean_gap_m() and mean_advance_m() over the rows
  // Length of the shortest polynomial piece beside the joint, in any row.
  double shortest_piece_m = std::numeric_limits<double>::infinity();
  double speed_before = 0.0, speed_after = 0.0;  // mean metres per unit of v on both sides of the joint
};

JointState joint_state(const std::vector<PreparedRow>& rows, std::size_t joint, const JoinRequest& request) {
  JointState state;
  for (const PreparedRow& row : rows) {
    const JointEdges edges = joint_edges(row.patches[joint], row.patches[joint + 1]);
    const double gap_m = largest_gap_m(edges), fraction = 1.0 / static_cast<double>(rows.size());
    const bool touching = gap_m <= request.tolerance_m;
    state.any_touching = state.any_touching || touching;
    state.any_open = state.any_open || !touching;
    state.all_smooth = state.all_smooth && is_smooth(row.patches[joint], row.patches[joint + 1],
                                                     stretch_at_edge(edges), request.continuity);
    state.all_continue_ahead = state.all_continue_ahead && continues_ahead(edges, request.tolerance_m);
    state.apart_m = std::max(state.apart_m, gap_m);
    state.advance_m += fraction * mean_advance_m(edges);
    state.mean_gap_m += fraction * mean_gap_m(edges);
    const double before = mean_speed(edges.before), after = mean_speed(edges.after);
    state.shortest_piece_m =
        std::min({state.shortest_piece_m, piece_length_m(row.patches[joint], true, before),
                  piece_length_m(row.patches[joint + 1], false, after)});
    state.speed_before += fraction * before;
    state.speed_after += fraction * after;
  }
  return state;
}

// Limits of blends at small gaps across which the patches do not continue straight ahead. A bridge as long as
// such a gap would make a step or a fold. A blend is as long as the shortest polynomial piece beside the
// joint, within two limits: least_gap_ratio times the gap and most_gap_ratio times the gap. No more than the
// fraction most_cut_fraction of a patch is cut off.
constexpr double least_gap_ratio = 10.0, most_gap_ratio = 40.0, most_cut_fraction = 0.25;
// Largest overlap of patches that are too short to be cut, as a fraction of the gap. It is bridged without
// cutting.
constexpr double most_back_fraction = 0.5;

bool is_short_cut(const std::vector<PreparedRow>& rows, std::size_t joint, double cut_m) {
  return std::all_of(rows.begin(), rows.end(), [&](const PreparedRow& row) {
    const Surface &before = row.patches[joint], &after = row.patches[joint + 1];
    const JointEdges edges = joint_edges(before, after);
    const auto length_m = [](const Surface& patch, double speed) { return speed * patch.v.domain_length(); };
    return cut_m <= most_cut_fraction * std::min(length_m(before, mean_speed(edges.before)),
                                                 length_m(after, mean_speed(edges.after)));
  });
}

// Returns the length to cut off each patch so that a blend or a bridge fits between them; 0 if nothing needs
// to be cut off.
Result<double> blend_cut_m(const std::vector<PreparedRow>& rows, std::size_t joint, const JointState& state,
                           const JoinRequest& request) {
  if (request.blend_m > 0.0) {
    const bool is_needed = state.any_open || !state.all_smooth;
    return is_needed ? std::max(0.0, 0.5 * (request.blend_m - state.advance_m)) : 0.0;
  }
  if (!state.any_open) return 0.0;
  if (state.any_touching) {
    return Error(
        ErrorCode::mismatch,
        "patches of the grid touch in one row of a joint and are apart in another; choose a blend, or allow "
        "a larger tolerance");
  }
  if (state.all_continue_ahead || request.bridges_may_fold) return 0.0;
  const double length_m =
      std::clamp(state.shortest_piece_m, least_gap_ratio * state.apart_m, most_gap_ratio * state.apart_m);
  const double cut_m = 0.5 * (length_m - state.advance_m);
  if (is_short_cut(rows, joint, cut_m)) return cut_m;
  if (state.advance_m < -most_back_fraction * state.mean_gap_m) {
    return Error(ErrorCode::mismatch,
                 "the patches overlap by " + short_length_text(-state.advance_m) +
                     " where they are to be joined; move them apart, cut a piece off, or let them intersect");
  }
  return 0.0;
}

// Cuts the patches of a joint by the same parameter length in all rows, so that the joints of all rows remain
// at the same parameter.
Status cut_for_blend(std::vector<PreparedRow>& rows, std::size_t joint, const JoinRequest& request) {
  const JointState state = joint_state(rows, joint, request);
  const auto cut_m = blend_cut_m(rows, joint, state, request);
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

// Measures a joint in each row, then sets the same values in all rows: the mean stretch and the length of the
// shortest bridge.
Status measure_joint(std::vector<PreparedRow>& rows, std::size_t joint, const JoinRequest& request) {
  double stretch = 0.0, shortest = std::numeric_limits<double>::infinity();
  for (PreparedRow& row : rows) {
    const auto measured = measure(row.patches[joint], row.patches[joint + 1], request);
    if (!measured) return measured.error();
    JointMeasure& row_joint = row.joints[joint];
    row_joint.bridged = measured->bridged;
    row_joint.gap_m = measured->gap_m;
    stretch += measured->stretch_of_after / static_cast<double>(rows.size());
    shortest = std::min(shortest, measured->gap_parameter);
  }
  for (PreparedRow& row : rows) {
    row.joints[joint].gap_parameter = shortest;
    row.joints[joint].stretch_of_after = stretch;
  }
  return {};
}

Status match_domains(std::vector<std::vector<Surface>>& rows) {
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
  if (Status status = match_domains(rows); !status) return status.error();
  std::vector<PreparedRow> prepared;
  for (std::vector<Surface>& row : rows) {
    const double done = static_cast<double>(prepared.size()), count = static_cast<double>(rows.size());
    JoinRequest row_request = request;
    row_request.progress = request.progress.part(done / count, (done + 1.0) / count);
    auto compatible = make_compatible(std::move(row), row_request);
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

namespace {

// Moves the patches of a row to their v domains in the merged surface.
Result<std::vector<Surface>> place_in_row(const PreparedRow& row) {
  std::vector<Surface> placed{row.patches[0]};
  double stretch = 1.0;
  for (std::size_t p = 1; p < row.patches.size(); ++p) {
    const JointMeasure& joint = row.joints[p - 1];
    const double gap = joint.bridged ? joint.gap_parameter * stretch : 0.0;
    stretch *= joint.stretch_of_after;
    const Surface& patch = row.patches[p];
    const double start = placed.back().v.domain_end() + gap;
    const double length = patch.v.domain_length();
    double end = start + stretch * length;
    // Parts of one patch must have bitwise equal knots. If an end differs from the patch's end only by
    // rounding, it is therefore set to the patch's end.
    if (std::abs(end - patch.v.domain_end()) <= same_knot_fraction * length) end = patch.v.domain_end();
    auto moved = with_domain(patch, Direction::v, start, end);
    if (!moved) return moved.error();
    placed.push_back(std::move(moved).value());
  }
  return placed;
}

// Returns the strips of a row: the patches with bridges inserted between them.
Result<std::vector<Surface>> add_bridges(const std::vector<Surface>& placed, const PreparedRow& row,
                                         int continuity) {
  std::vector<Surface> strips{placed[0]};
  for (std::size_t p = 1; p < placed.size(); ++p) {
    if (row.joints[p - 1].bridged) {
      auto strip = bridge(placed[p - 1], placed[p], continuity);
      if (!strip) return strip.error();
      strips.push_back(std::move(strip).value());
    }
    strips.push_back(placed[p]);
  }
  return strips;
}

// Joins strips that meet at their edges. At the joints, the knots have full multiplicity.
Result<Surface> concatenate(const std::vector<Surface>& strips) {
  const int degree = strips[0].v.degree(), rows = strips[0].net.rows;
  std::vector<double> knots = strips[0].v.knots();
  int columns = strips[0].net.columns;
  for (std::size_t s = 1; s < strips.size(); ++s) {
    const auto& more = strips[s].v.knots();
    knots.pop_back();
    knots.insert(knots.end(), more.begin() + degree + 1, more.end());
    columns += strips[s].net.columns - 1;
  }
  ControlNet net(rows, columns);
  int at = 0;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    for (int j = 0; j < strips[s].net.columns; ++j) {
      for (int i = 0; i < rows; ++i) {
        const Vector3 point = strips[s].net.point(i, j);
        const bool shared = s > 0 && j == 0;
        net.set_point(i, at + j, shared ? Vector3(0.5 * (net.point(i, at) + point)) : point);
      }
    }
    at += strips[s].net.columns - 1;
  }
  auto v = KnotVector::open(degree, std::move(knots));
  if (!v) return v.error();
  return make_surface(strips[0].u, std::move(v).value(), std::move(net));
}

// Reduces the multiplicity of the knot at each joint to what the continuity permits.
Result<KnotVector> smooth_knots(const KnotVector& knots, const std::vector<double>& joints, int continuity) {
  std::vector<double> fewer = knots.knots();
  for (const double joint : joints) {
    const auto [first, last] = std::equal_range(fewer.begin(), fewer.end(), joint);
    const auto remaining = std::min<std::ptrdiff_t>(last - first, knots.degree() - continuity);
    fewer.erase(first + remaining, last);
  }
  return KnotVector::open(knots.degree(), std::move(fewer));
}

// Samples the patch in every piece of the merged surface. The merged surface has more pieces along v than the
// patch.
PointGrid sample_patch(const Surface& patch, const KnotVector& merged_v, int in_piece) {
  const std::vector<double> all = nested_parameters(merged_v, in_piece, 0).parameters;
  const double start = patch.v.domain_start(), end = patch.v.domain_end();
  std::vector<double> along{start};
  along.insert(along.end(), std::upper_bound(all.begin(), all.end(), start),
               std::lower_bound(all.begin(), all.end(), end));
  along.push_back(end);
  return sample_grid_points(patch, nested_parameters(patch.u, in_piece, 0).parameters, std::move(along));
}

// Returns the largest deviation of the merged surface from a patch, refined around the worst sample. If a
// coarse set of samples shows only rounding errors, their result is returned.
double deviation_m_from(const Surface& merged, const Surface& patch) {
  constexpr int few = 3, many = 6;
  const double at_few = largest_deviation_m(merged, sample_patch(patch, merged.v, few));
  if (at_few <= rounding_m) return at_few;
  const PointGrid patch_samples = sample_patch(patch, merged.v, many);
  const PointGrid merged_samples = sample_grid_points(merged, patch_samples.u, patch_samples.v);
  double largest = -1.0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < patch_samples.points_m.size(); ++k) {
    const double distance = (patch_samples.points_m[k] - merged_samples.points_m[k]).norm();
    if (distance <= largest) continue;
    largest = distance;
    at = k;
  }
  const std::size_t i = at / patch_samples.v.size(), j = at % patch_samples.v.size();
  const auto distance = [&](double u, double v) {
    const double within = std::clamp(v, patch.v.domain_start(), patch.v.domain_end());
    return (position(merged, u, within) - position(patch, u, within)).norm();
  };
  const auto step_at = [](const std::vector<double>& values, std::size_t k) {
    return k + 1 < values.size() ? values[k + 1] - values[k] : values[k] - values[k - 1];
  };
  const double near = find_peak(distance, patch_samples.u[i], patch_samples.v[j], step_at(patch_samples.u, i),
                                step_at(patch_samples.v, j));
  return std::max({at_few, largest, near});
}

Result<double> measured_deviation_m(const Surface& merged, const std::vector<Surface>& placed,
                                    const Progress& progress) {
  double largest = 0.0;
  for (std::size_t p = 0; p < placed.size(); ++p) {
    if (!progress.report(static_cast<double>(p) / static_cast<double>(placed.size()))) {
      return Progress::stopped();
    }
    largest = std::max(largest, deviation_m_from(merged, placed[p]));
  }
  return largest;
}

// Returns the part of the tolerance that is available for fitting the joints, at least 5 % of the whole. At a
// joint that is not bridged, each edge moves by half the gap.
double tolerance_left_m(const PreparedRow& row, const JoinRequest& request) {
  double gap_m = 0.0;
  for (const JointMeasure& joint : row.joints) gap_m = std::max(gap_m, joint.bridged ? 0.0 : joint.gap_m);
  constexpr double least_fraction = 0.05;
  return std::max(request.tolerance_m - request.spent_m - row.deviation_m - 0.5 * gap_m,
                  least_fraction * request.tolerance_m);
}

Status check_count(const KnotVector& knots, int largest_count) {
  const int count = knots.control_point_count();
  if (count <= largest_count) return {};
  return Error(ErrorCode::too_many,
               "the patches of a row have " + std::to_string(count) + " control points together, more than " +
                   std::to_string(largest_count) + "; simplify them first, or merge fewer");
}

std::vector<Joint> describe_joints(const Surface& merged, const std::vector<Surface>& placed,
                                   const PreparedRow& row) {
  std::vector<Joint> joints;
  for (std::size_t p = 1; p < placed.size(); ++p) {
    const double start = placed[p - 1].v.domain_end(), end = placed[p].v.domain_start();
    const JointMeasure& joint = row.joints[p - 1];
    const double length_m = joint.bridged ? mean_length_m(merged, start, end) : 0.0;
    joints.push_back({joint.gap_m, joint.bridged, start, end, length_m, joint.apart_m, joint.cut_back_m});
  }
  return joints;
}

std::optional<Vector3> find_fold_in(const Surface& merged, const std::vector<Joint>& joints) {
  for (const Joint& joint : joints) {
    if (!joint.bridged) continue;
    if (auto fold = find_fold_between(merged, joint.blend_start, joint.blend_end)) return fold;
  }
  return find_fold(merged);
}

// Checks for folds that no patch has. Joins that are exact are not searched, because they fold only where the
// patches do.
Status check_folds(const Surface& merged, const std::vector<Surface>& placed,
                   const std::vector<Joint>& joints, double moved_m) {
  const bool bridged = std::any_of(joints.begin(), joints.end(), [](const Joint& j) { return j.bridged; });
  if (!bridged && moved_m <= rounding_m) return {};
  const auto fold = find_fold_in(merged, joints);
  if (!fold || std::any_of(placed.begin(), placed.end(), find_fold)) return {};
  return Error(ErrorCode::self_intersecting,
               "the merged surface folds over at " + position_text(*fold) +
                   ": the patches meet at too sharp an edge there, or coincide; join them C0, ask for a "
                   "blend, or cut a piece off");
}

// Fractions of the work that are done after preparing the patches and after approximating them, for the
// progress.
constexpr double prepared_fraction = 0.3, approximated_fraction = 0.6;

}  // namespace

Result<Joined> join_prepared(const PreparedRow& row, const JoinRequest& request) {
  SPOONBILL_ASSERT(row.joints.size() + 1 == row.patches.size());
  auto placed = place_in_row(row);
  if (!placed) return placed.error();
  auto strips = add_bridges(placed.value(), row, request.continuity);
  if (!strips) return strips.error();
  auto whole = concatenate(strips.value());
  if (!whole) return whole.error();
  std::vector<double> joints;
  for (std::size_t s = 1; s < strips->size(); ++s) joints.push_back(strips.value()[s - 1].v.domain_end());
  const auto knots = smooth_knots(whole->v, joints, request.continuity);
  if (!knots) return knots.error();
  if (Status status = check_count(knots.value(), request.largest_count); !status) return status.error();
  auto merged = approximated(whole.value(), Direction::v, knots.value(), tolerance_left_m(row, request),
                             request.largest_count, request.progress.part(0.0, approximated_fraction));
  if (!merged) return merged.error();
  const auto measured_m = measured_deviation_m(merged->surface, placed.value(),
                                               request.progress.part(approximated_fraction, 1.0));
  if (!measured_m) return measured_m.error();
  const double deviation_m = row.deviation_m + measured_m.value();
  std::vector<Joint> described = describe_joints(merged->surface, placed.value(), row);
  if (!request.bridges_may_fold) {
    Status sound = check_folds(merged->surface, placed.value(), described, merged->deviation_m);
    if (!sound) return sound.error();
  }
  return Joined{std::move(merged->surface), deviation_m, std::move(described)};
}

Result<Joined> join_row(std::vector<Surface> patches, const JoinRequest& request) {
  SPOONBILL_ASSERT(!patches.empty());
  JoinRequest preparing = request, joining = request;
  preparing.progress = request.progress.part(0.0, prepared_fraction);
  joining.progress = request.progress.part(prepared_fraction, 1.0);
  const auto rows = prepare_rows({std::move(patches)}, preparing);
  if (!rows) return rows.error();
  return join_prepared(rows.value()[0], joining);
}

}  // namespace spoonbill
