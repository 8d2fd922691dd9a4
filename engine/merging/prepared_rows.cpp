#include "engine/merging/prepared_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/bridge.h"
#include "engine/merging/compatible.h"

namespace spoonbill {

namespace {

constexpr int samples_across = 64;

// At the end of one patch and the start of the next, at the same parameters across.
struct EdgePoints {
  std::vector<SurfacePoint> before, after;
};

EdgePoints edge_points(const Surface& before, const Surface& after) {
  EdgePoints points;
  for (const double u : uniform_parameters_without_seam(before.u, samples_across)) {
    points.before.push_back(evaluate(before, u, before.v.domain_end()));
    points.after.push_back(evaluate(after, u, after.v.domain_start()));
  }
  if (!before.u.is_periodic()) {
    points.before.push_back(evaluate(before, before.u.domain_end(), before.v.domain_end()));
    points.after.push_back(evaluate(after, after.u.domain_end(), after.v.domain_start()));
  }
  return points;
}

double largest_gap_m(const EdgePoints& points) {
  double largest = 0.0;
  for (std::size_t k = 0; k < points.before.size(); ++k) {
    largest = std::max(largest, (points.before[k].position_m - points.after[k].position_m).norm());
  }
  return largest;
}

// The stretch s with the least sum of |before' - after' / s|^2, up to its scale; exact where the derivatives
// differ by one factor. By the lengths alone where they point elsewhere.
double stretch_at_edge(const EdgePoints& points) {
  double along = 0.0, squared = 0.0, length_before = 0.0, length_after = 0.0;
  for (std::size_t k = 0; k < points.before.size(); ++k) {
    along += points.before[k].dv.dot(points.after[k].dv);
    squared += points.before[k].dv.squaredNorm();
    length_before += points.before[k].dv.norm();
    length_after += points.after[k].dv.norm();
  }
  if (!(length_before > 0.0) || !(length_after > 0.0)) return 1.0;
  const double by_length = length_after / length_before, exact = along / squared;
  return exact > 0.5 * by_length ? exact : by_length;
}

// Whether derivatives up to the second agree so far that no blend is needed.
bool is_smooth(const EdgePoints& points, double stretch, int continuity) {
  for (std::size_t k = 0; k < points.before.size(); ++k) {
    const SurfacePoint &a = points.before[k], &b = points.after[k];
    const double speed = a.dv.norm();
    if (continuity >= 1 && (a.dv - b.dv / stretch).norm() > 1e-6 * speed) return false;
    const double bend = std::max(a.dvv.norm(), speed);
    if (continuity >= 2 && (a.dvv - b.dvv / (stretch * stretch)).norm() > 1e-6 * bend) return false;
  }
  return true;
}

double mean_speed(const std::vector<SurfacePoint>& points) {
  double sum = 0.0;
  for (const SurfacePoint& point : points) sum += point.dv.norm() / static_cast<double>(points.size());
  return sum;
}

Result<Surface> cut_back(const Surface& patch, bool at_end, double parameter) {
  const double start = patch.v.domain_start(), end = patch.v.domain_end();
  if (!(parameter < 0.5 * (end - start))) {
    return Error{"the blend takes more than half of a patch; ask for a shorter one"};
  }
  return at_end ? part_of(patch, Direction::v, start, end - parameter)
                : part_of(patch, Direction::v, start + parameter, end);
}

Result<JointMeasure> measure(const Surface& before, const Surface& after, const JoinRequest& request) {
  const EdgePoints points = edge_points(before, after);
  if (largest_gap_m(points) <= request.tolerance_m) {
    return JointMeasure{false, largest_gap_m(points), 0.0, stretch_at_edge(points)};
  }
  const auto length = bridge_length(before, after, request.continuity, request.bridges_may_fold);
  if (!length) return length.error();
  return JointMeasure{true, length->chord_m, length->parameter, length->stretch_of_after};
}

// What is to be done at a joint, over all rows.
struct JointState {
  bool any_touching = false, any_apart = false, all_smooth = true;
  double speed_before = 0.0, speed_after = 0.0;  // means
};

JointState state_of_joint(const std::vector<PreparedRow>& rows, std::size_t joint,
                          const JoinRequest& request) {
  JointState state;
  for (const PreparedRow& row : rows) {
    const EdgePoints points = edge_points(row.patches[joint], row.patches[joint + 1]);
    const bool touching = largest_gap_m(points) <= request.tolerance_m;
    state.any_touching = state.any_touching || touching;
    state.any_apart = state.any_apart || !touching;
    state.all_smooth = state.all_smooth && is_smooth(points, stretch_at_edge(points), request.continuity);
    state.speed_before += mean_speed(points.before) / static_cast<double>(rows.size());
    state.speed_after += mean_speed(points.after) / static_cast<double>(rows.size());
  }
  return state;
}

// In all rows alike, so that they keep their joints at the same parameter.
Status cut_for_blend(std::vector<PreparedRow>& rows, std::size_t joint, const JoinRequest& request) {
  const JointState state = state_of_joint(rows, joint, request);
  if (state.any_touching && state.any_apart && !(request.blend_m > 0.0)) {
    return Error{
        "patches of the grid touch in one row of a joint and are apart in another; ask for a blend, or allow "
        "a larger tolerance"};
  }
  const bool wanted = state.any_touching && (state.any_apart || !state.all_smooth);
  if (!(request.blend_m > 0.0) || !wanted) return {};
  for (PreparedRow& row : rows) {
    Surface &before = row.patches[joint], &after = row.patches[joint + 1];
    auto shorter = cut_back(before, true, 0.5 * request.blend_m / state.speed_before);
    if (!shorter) return shorter.error();
    auto later = cut_back(after, false, 0.5 * request.blend_m / state.speed_after);
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
    row.joints.push_back(measured.value());
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
  if (Status status = share_domains(rows); !status) return status.error();
  std::vector<PreparedRow> prepared;
  for (std::vector<Surface>& row : rows) {
    auto compatible = compatible_along_v(std::move(row), request);
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
