#include "engine/merging/join_row.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/bspline/grid.h"
#include "engine/bspline/grid_fit.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/bridge.h"
#include "engine/merging/compatible.h"
#include "engine/merging/edge_match.h"

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
  const auto length = bridge_length(before, after, request.continuity);
  if (!length) return length.error();
  return JointMeasure{true, length->chord_m, length->parameter, length->stretch_of_after};
}

Status cut_for_blend(Surface& before, Surface& after, const JointMeasure& joint, const JoinRequest& request) {
  const EdgePoints points = edge_points(before, after);
  if (joint.bridged || is_smooth(points, joint.stretch_of_after, request.continuity)) return {};
  auto shorter = cut_back(before, true, 0.5 * request.blend_m / mean_speed(points.before));
  if (!shorter) return shorter.error();
  auto later = cut_back(after, false, 0.5 * request.blend_m / mean_speed(points.after));
  if (!later) return later.error();
  before = std::move(shorter).value();
  after = std::move(later).value();
  return {};
}

// The patches over the domains they get in the merged surface.
Result<std::vector<Surface>> placed_in_row(const PreparedRow& row) {
  std::vector<Surface> placed{row.patches[0]};
  double stretch = 1.0;
  for (std::size_t p = 1; p < row.patches.size(); ++p) {
    const JointMeasure& joint = row.joints[p - 1];
    const double gap = joint.bridged ? joint.gap_parameter * stretch : 0.0;
    stretch *= joint.stretch_of_after;
    const Surface& patch = row.patches[p];
    double start = placed.back().v.domain_end() + gap;
    const double length = patch.v.domain_end() - patch.v.domain_start();
    double end = start + stretch * length;
    // What was split keeps its knots to the last bit.
    if (std::abs(start - patch.v.domain_start()) <= same_knot_share * length) {
      start = placed.back().v.domain_end();
    }
    if (std::abs(end - patch.v.domain_end()) <= same_knot_share * length) end = patch.v.domain_end();
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

double mean_length_m(const Surface& surface, double start, double end) {
  double sum = 0.0;
  constexpr int chords = 32, lines = 16;
  for (const double u : uniform_parameters_without_seam(surface.u, lines)) {
    Vector3 last = position(surface, u, start);
    for (int k = 1; k <= chords; ++k) {
      const Vector3 next = position(surface, u, start + (end - start) * k / chords);
      sum += (next - last).norm() / lines;
      last = next;
    }
  }
  return sum;
}

double measured_deviation_m(const Surface& merged, const std::vector<Surface>& placed) {
  double largest = 0.0;
  for (const Surface& patch : placed) {
    const PointGrid points = point_grid(patch, nested_parameters(patch.u, 3, 0).parameters,
                                        nested_parameters(patch.v, 4, 0).parameters);
    largest = std::max(largest, largest_deviation_m(merged, points));
  }
  return largest;
}

std::vector<Joint> described_joints(const Surface& merged, const std::vector<Surface>& placed,
                                    const PreparedRow& row) {
  std::vector<Joint> joints;
  for (std::size_t p = 1; p < placed.size(); ++p) {
    const double start = placed[p - 1].v.domain_end(), end = placed[p].v.domain_start();
    const JointMeasure& joint = row.joints[p - 1];
    joints.push_back(
        {joint.gap_m, joint.bridged, start, end, joint.bridged ? mean_length_m(merged, start, end) : 0.0});
  }
  return joints;
}

}  // namespace

Result<PreparedRow> prepare_row(std::vector<Surface> patches, const JoinRequest& request) {
  auto compatible =
      compatible_along_v(std::move(patches), request.tolerance_m, request.continuity + 1, request.twist);
  if (!compatible) return compatible.error();
  PreparedRow row{std::move(compatible->patches), {}, compatible->deviation_m};
  for (std::size_t p = 1; p < row.patches.size(); ++p) {
    Surface &before = row.patches[p - 1], &after = row.patches[p];
    auto joint = measure(before, after, request);
    if (joint && request.blend_m > 0.0) {
      if (Status status = cut_for_blend(before, after, joint.value(), request); !status) {
        return status.error();
      }
      joint = measure(before, after, request);
    }
    if (!joint) return joint.error();
    row.joints.push_back(joint.value());
  }
  return row;
}

Result<Joined> join_prepared(const PreparedRow& row, const JoinRequest& request) {
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
  auto merged =
      approximated(whole.value(), Direction::v, knots.value(), request.tolerance_m, request.largest_count);
  if (!merged) return merged.error();
  const double deviation_m = row.deviation_m + measured_deviation_m(merged->surface, placed.value());
  std::vector<Joint> described = described_joints(merged->surface, placed.value(), row);
  return Joined{std::move(merged->surface), deviation_m, std::move(described)};
}

Result<Joined> join_row(std::vector<Surface> patches, const JoinRequest& request) {
  const auto row = prepare_row(std::move(patches), request);
  if (!row) return row.error();
  return join_prepared(row.value(), request);
}

}  // namespace spoonbill
