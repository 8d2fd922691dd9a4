#include "engine/merging/join_row.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/bridge.h"
#include "engine/merging/fold_search.h"
#include "engine/merging/joint_edges.h"

namespace spoonbill {

namespace {

// The patches over the domains they get in the merged surface.
Result<std::vector<Surface>> placed_in_row(const PreparedRow& row) {
  std::vector<Surface> placed{row.patches[0]};
  double stretch = 1.0;
  for (std::size_t p = 1; p < row.patches.size(); ++p) {
    const JointMeasure& joint = row.joints[p - 1];
    const double gap = joint.bridged ? joint.gap_parameter * stretch : 0.0;
    stretch *= joint.stretch_of_after;
    const Surface& patch = row.patches[p];
    const double start = placed.back().v.domain_end() + gap;
    const double length = patch.v.domain_end() - patch.v.domain_start();
    double end = start + stretch * length;
    // What was split keeps its knots to the last bit.
    if (std::abs(end - patch.v.domain_end()) <= same_knot_fraction * length) end = patch.v.domain_end();
    auto moved = with_domain(patch, Direction::v, start, end);
    if (!moved) return moved.error();
    placed.push_back(std::move(moved).value());
  }
  return placed;
}

// With the bridges between them, edge to edge.
Result<std::vector<Surface>> with_bridges(const std::vector<Surface>& placed, const PreparedRow& row,
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

// Continuous as strips that meet at their edges are: the joint's knot stands as often as the degree.
Result<Surface> concatenated(const std::vector<Surface>& strips) {
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

// With each joint's knot as often as the continuity allows.
Result<KnotVector> smoothed_knots(const KnotVector& knots, const std::vector<double>& joints,
                                  int continuity) {
  std::vector<double> fewer = knots.knots();
  for (const double joint : joints) {
    const auto [first, last] = std::equal_range(fewer.begin(), fewer.end(), joint);
    const auto kept = std::min<std::ptrdiff_t>(last - first, knots.degree() - continuity);
    fewer.erase(first + kept, last);
  }
  return KnotVector::open(knots.degree(), std::move(fewer));
}

constexpr double rounding_m = 1e-12;

// In every piece of the merged surface, which has more of them along v than the patch.
PointGrid samples_of(const Surface& patch, const KnotVector& merged_v, int in_piece) {
  const std::vector<double> all = nested_parameters(merged_v, in_piece, 0).parameters;
  const double start = patch.v.domain_start(), end = patch.v.domain_end();
  std::vector<double> along{start};
  along.insert(along.end(), std::upper_bound(all.begin(), all.end(), start),
               std::lower_bound(all.begin(), all.end(), end));
  along.push_back(end);
  return sample_grid_points(patch, nested_parameters(patch.u, in_piece, 0).parameters, std::move(along));
}

// About the worst sample too, unless few tell that there is nothing but rounding.
double deviation_from_m(const Surface& merged, const Surface& patch) {
  constexpr int few = 3, many = 6;
  const double at_few = largest_deviation_m(merged, samples_of(patch, merged.v, few));
  if (at_few <= rounding_m) return at_few;
  const PointGrid of_patch = samples_of(patch, merged.v, many);
  const PointGrid of_merged = sample_grid_points(merged, of_patch.u, of_patch.v);
  double largest = -1.0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < of_patch.points_m.size(); ++k) {
    const double apart = (of_patch.points_m[k] - of_merged.points_m[k]).norm();
    if (apart <= largest) continue;
    largest = apart;
    at = k;
  }
  const std::size_t i = at / of_patch.v.size(), j = at % of_patch.v.size();
  const auto apart = [&](double u, double v) {
    const double within = std::clamp(v, patch.v.domain_start(), patch.v.domain_end());
    return (position(merged, u, within) - position(patch, u, within)).norm();
  };
  const auto step = [](const std::vector<double>& of, std::size_t k) {
    return k + 1 < of.size() ? of[k + 1] - of[k] : of[k] - of[k - 1];
  };
  const double near =
      find_peak(apart, of_patch.u[i], of_patch.v[j], step(of_patch.u, i), step(of_patch.v, j));
  return std::max({at_few, largest, near});
}

Result<double> measured_deviation_m(const Surface& merged, const std::vector<Surface>& placed,
                                    const Progress& progress) {
  double largest = 0.0;
  for (std::size_t p = 0; p < placed.size(); ++p) {
    if (!progress.report(static_cast<double>(p) / static_cast<double>(placed.size()))) {
      return Progress::stopped();
    }
    largest = std::max(largest, deviation_from_m(merged, placed[p]));
  }
  return largest;
}

// What fitting the joints may leave: edges that touch are brought together half way each.
double tolerance_left_m(const PreparedRow& row, const JoinRequest& request) {
  double gap_m = 0.0;
  for (const JointMeasure& joint : row.joints) gap_m = std::max(gap_m, joint.bridged ? 0.0 : joint.gap_m);
  constexpr double least_share = 0.05;
  return std::max(request.tolerance_m - request.spent_m - row.deviation_m - 0.5 * gap_m,
                  least_share * request.tolerance_m);
}

Status check_count(const KnotVector& knots, int largest_count) {
  const int count = knots.control_point_count();
  if (count <= largest_count) return {};
  return Error{"the patches of a row have " + std::to_string(count) + " control points together, more than " +
               std::to_string(largest_count) + "; simplify them first, or merge fewer"};
}

std::vector<Joint> described_joints(const Surface& merged, const std::vector<Surface>& placed,
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

std::optional<Vector3> place_of_fold_in(const Surface& merged, const std::vector<Joint>& joints) {
  for (const Joint& joint : joints) {
    if (!joint.bridged) continue;
    if (auto place = place_of_fold_between(merged, joint.blend_start, joint.blend_end)) return place;
  }
  return place_of_fold(merged);
}

// What was joined exactly folds where its patches do alone.
Status check_folds(const Surface& merged, const std::vector<Surface>& placed,
                   const std::vector<Joint>& joints, double moved_m) {
  const bool bridged = std::any_of(joints.begin(), joints.end(), [](const Joint& j) { return j.bridged; });
  if (!bridged && moved_m <= rounding_m) return {};
  const auto place = place_of_fold_in(merged, joints);
  if (!place || std::any_of(placed.begin(), placed.end(), place_of_fold)) return {};
  return Error{"the merged surface folds over at " + position_text(*place) +
               ": the patches meet at too sharp an edge there, or lie on each other; join them C0, ask for a "
               "blend, or cut a piece off"};
}

// Of the work.
constexpr double prepared_share = 0.3, approximated_share = 0.6;

}  // namespace

Result<Joined> join_prepared(const PreparedRow& row, const JoinRequest& request) {
  SPOONBILL_ASSERT(row.joints.size() + 1 == row.patches.size());
  auto placed = placed_in_row(row);
  if (!placed) return placed.error();
  auto strips = with_bridges(placed.value(), row, request.continuity);
  if (!strips) return strips.error();
  auto whole = concatenated(strips.value());
  if (!whole) return whole.error();
  std::vector<double> joints;
  for (std::size_t s = 1; s < strips->size(); ++s) joints.push_back(strips.value()[s - 1].v.domain_end());
  const auto knots = smoothed_knots(whole->v, joints, request.continuity);
  if (!knots) return knots.error();
  if (Status status = check_count(knots.value(), request.largest_count); !status) return status.error();
  auto merged = approximated(whole.value(), Direction::v, knots.value(), tolerance_left_m(row, request),
                             request.largest_count, request.progress.part(0.0, approximated_share));
  if (!merged) return merged.error();
  const auto measured_m =
      measured_deviation_m(merged->surface, placed.value(), request.progress.part(approximated_share, 1.0));
  if (!measured_m) return measured_m.error();
  const double deviation_m = row.deviation_m + measured_m.value();
  std::vector<Joint> described = described_joints(merged->surface, placed.value(), row);
  if (!request.bridges_may_fold) {
    Status sound = check_folds(merged->surface, placed.value(), described, merged->deviation_m);
    if (!sound) return sound.error();
  }
  return Joined{std::move(merged->surface), deviation_m, std::move(described)};
}

Result<Joined> join_row(std::vector<Surface> patches, const JoinRequest& request) {
  SPOONBILL_ASSERT(!patches.empty());
  JoinRequest preparing = request, joining = request;
  preparing.progress = request.progress.part(0.0, prepared_share);
  joining.progress = request.progress.part(prepared_share, 1.0);
  const auto rows = prepare_rows({std::move(patches)}, preparing);
  if (!rows) return rows.error();
  return join_prepared(rows.value()[0], joining);
}

}  // namespace spoonbill
