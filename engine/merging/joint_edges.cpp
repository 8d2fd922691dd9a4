#include "engine/merging/joint_edges.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/assert.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/reparameterise.h"

namespace spoonbill {

namespace {

constexpr int samples_across = 64;

// How far ahead of point k before that after it lies; none where the patches turn back.
double advance_m(const JointEdges& edges, std::size_t k) {
  const SurfacePoint &a = edges.before[k], &b = edges.after[k];
  const Vector3 ahead = a.dv.normalized() + b.dv.normalized();
  constexpr double turned_back = 1e-3;
  if (ahead.norm() < turned_back) return 0.0;
  return (b.position_m - a.position_m).dot(ahead.normalized());
}

double gap_m(const JointEdges& edges, std::size_t k) {
  return (edges.before[k].position_m - edges.after[k].position_m).norm();
}

// The k-th difference of a line's control points from one end of a polynomial piece inwards.
Vector3 difference_at_end(const Surface& piece, int line, int k, bool at_end) {
  std::vector<Vector3> points;
  const int last = piece.net.columns - 1;
  for (int j = 0; j <= k; ++j) points.push_back(piece.net.point(line, at_end ? last - k + j : j));
  for (int order = k; order > 0; --order) {
    for (int j = 0; j < order; ++j) points[j] = points[j + 1] - points[j];
  }
  return points[0];
}

// By the Taylor terms of the pieces beside the joint, which may differ as far as the first ones do.
bool agree_beyond_second(const Surface& before, const Surface& after, double stretch, int continuity,
                         double speed) {
  const std::vector<double> of_before = before.v.breakpoints(), of_after = after.v.breakpoints();
  const auto last = part_of(before, Direction::v, of_before[of_before.size() - 2], of_before.back());
  const auto first = part_of(after, Direction::v, of_after[0], of_after[1]);
  if (!last || !first) return false;
  const double length = of_before.back() - of_before[of_before.size() - 2];
  const double ratio = length / (stretch * (of_after[1] - of_after[0]));
  double choices =
      0.5 * before.v.degree() * (before.v.degree() - 1.0);  // of k control points from the degree
  for (int k = 3; k <= std::min(continuity, before.v.degree()); ++k) {
    choices *= (before.v.degree() - k + 1.0) / k;
    for (int line = 0; line < last->net.rows; ++line) {
      const Vector3 apart = difference_at_end(last.value(), line, k, true) -
                            std::pow(ratio, k) * difference_at_end(first.value(), line, k, false);
      if (choices * apart.norm() > 1e-6 * speed * length) return false;
    }
  }
  return true;
}

}  // namespace

JointEdges joint_edges(const Surface& before, const Surface& after) {
  JointEdges edges;
  for (const double u : uniform_parameters_without_seam(before.u, samples_across)) {
    edges.before.push_back(evaluate(before, u, before.v.domain_end()));
    edges.after.push_back(evaluate(after, u, after.v.domain_start()));
  }
  if (!before.u.is_periodic()) {
    edges.before.push_back(evaluate(before, before.u.domain_end(), before.v.domain_end()));
    edges.after.push_back(evaluate(after, after.u.domain_end(), after.v.domain_start()));
  }
  return edges;
}

double largest_gap_m(const JointEdges& edges) {
  SPOONBILL_ASSERT(edges.before.size() == edges.after.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < edges.before.size(); ++k) largest = std::max(largest, gap_m(edges, k));
  return largest;
}

double mean_gap_m(const JointEdges& edges) {
  SPOONBILL_ASSERT(edges.before.size() == edges.after.size() && !edges.before.empty());
  double sum = 0.0;
  for (std::size_t k = 0; k < edges.before.size(); ++k) sum += gap_m(edges, k);
  return sum / static_cast<double>(edges.before.size());
}

double mean_advance_m(const JointEdges& edges) {
  SPOONBILL_ASSERT(edges.before.size() == edges.after.size() && !edges.before.empty());
  double sum = 0.0;
  for (std::size_t k = 0; k < edges.before.size(); ++k) sum += advance_m(edges, k);
  return sum / static_cast<double>(edges.before.size());
}

bool leads_on(const JointEdges& edges, double touching_m) {
  constexpr double ahead_cosine = 0.95;
  for (std::size_t k = 0; k < edges.before.size(); ++k) {
    const double gap = gap_m(edges, k);
    if (gap > touching_m && advance_m(edges, k) < ahead_cosine * gap) return false;
  }
  return true;
}

double stretch_at_edge(const JointEdges& edges) {
  double along = 0.0, squared = 0.0, length_before = 0.0, length_after = 0.0;
  for (std::size_t k = 0; k < edges.before.size(); ++k) {
    along += edges.before[k].dv.dot(edges.after[k].dv);
    squared += edges.before[k].dv.squaredNorm();
    length_before += edges.before[k].dv.norm();
    length_after += edges.after[k].dv.norm();
  }
  if (!(length_before > 0.0) || !(length_after > 0.0)) return 1.0;
  const double by_length = length_after / length_before, exact = along / squared;
  return exact > 0.5 * by_length ? exact : by_length;
}

bool is_smooth(const Surface& before, const Surface& after, double stretch, int continuity) {
  SPOONBILL_ASSERT(continuity >= 0);
  const JointEdges edges = joint_edges(before, after);
  for (std::size_t k = 0; k < edges.before.size(); ++k) {
    const SurfacePoint &a = edges.before[k], &b = edges.after[k];
    const double speed = a.dv.norm();
    if (continuity >= 1 && (a.dv - b.dv / stretch).norm() > 1e-6 * speed) return false;
    const double bend = std::max(a.dvv.norm(), speed);
    if (continuity >= 2 && (a.dvv - b.dvv / (stretch * stretch)).norm() > 1e-6 * bend) return false;
  }
  return continuity <= 2 || agree_beyond_second(before, after, stretch, continuity, mean_speed(edges.before));
}

double mean_speed(const std::vector<SurfacePoint>& points) {
  SPOONBILL_ASSERT(!points.empty());
  double sum = 0.0;
  for (const SurfacePoint& point : points) sum += point.dv.norm() / static_cast<double>(points.size());
  return sum;
}

double piece_length_m(const Surface& patch, bool at_end, double speed) {
  const std::vector<double> ends = patch.v.breakpoints();
  return speed * (at_end ? ends.back() - ends[ends.size() - 2] : ends[1] - ends[0]);
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

}  // namespace spoonbill
