#include "engine/merging/joint_edges.h"

#include <algorithm>

#include "engine/bspline/grid.h"

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
  double largest = 0.0;
  for (std::size_t k = 0; k < edges.before.size(); ++k) largest = std::max(largest, gap_m(edges, k));
  return largest;
}

double mean_gap_m(const JointEdges& edges) {
  double sum = 0.0;
  for (std::size_t k = 0; k < edges.before.size(); ++k) sum += gap_m(edges, k);
  return sum / static_cast<double>(edges.before.size());
}

double mean_advance_m(const JointEdges& edges) {
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

bool is_smooth(const JointEdges& edges, double stretch, int continuity) {
  for (std::size_t k = 0; k < edges.before.size(); ++k) {
    const SurfacePoint &a = edges.before[k], &b = edges.after[k];
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
