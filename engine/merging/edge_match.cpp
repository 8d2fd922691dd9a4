#include "engine/merging/edge_match.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace spoonbill {

namespace {

constexpr int samples_of_open = 33;
constexpr int samples_of_ring = 64;
constexpr int seams_tried = 256;

struct Gaps {
  double largest = 0.0, mean = 0.0;
};

Gaps gaps_between(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  Gaps gaps;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double gap = (a[k] - b[k]).norm();
    gaps.largest = std::max(gaps.largest, gap);
    gaps.mean += gap / static_cast<double>(a.size());
  }
  return gaps;
}

EdgeMatch match_open(PatchEdge a, PatchEdge b, const EdgeCurve& of_a, const EdgeCurve& of_b,
                     std::optional<bool> asked) {
  const std::vector<Vector3> along = edge_samples(of_a, samples_of_open).points_m;
  std::vector<Vector3> beside = edge_samples(of_b, samples_of_open).points_m;
  const Gaps direct = gaps_between(along, beside);
  std::reverse(beside.begin(), beside.end());
  const Gaps against = gaps_between(along, beside);
  const bool reversed = asked.value_or(against.mean < direct.mean);
  const Gaps& gaps = reversed ? against : direct;
  return {a, b, reversed, 0.0, gaps.largest, gaps.mean};
}

// A ring seen from its middle, so that a gap between rings does not tell how they are turned.
class Ring {
 public:
  explicit Ring(const EdgeCurve& curve) : curve_(curve) {
    const std::vector<Vector3> points = edge_samples(curve, samples_of_ring).points_m;
    centre_ = std::accumulate(points.begin(), points.end(), Vector3(Vector3::Zero())) /
              static_cast<double>(points.size());
  }
  // At a share of the way around from a parameter, forwards or backwards.
  double parameter(double from, double share, bool backwards) const {
    const double length = curve_.knots.domain_end() - curve_.knots.domain_start();
    return from + (backwards ? -share : share) * length;
  }
  Vector3 at(double t) const { return position(curve_, t) - centre_; }
  Vector3 derivative_at(double t) const { return derivative(curve_, t); }
  const EdgeCurve& curve() const { return curve_; }

 private:
  const EdgeCurve& curve_;
  Vector3 centre_ = Vector3::Zero();
};

double misfit(const Ring& a, const Ring& b, double seam, bool backwards) {
  double sum = 0.0;
  for (int k = 0; k < samples_of_ring; ++k) {
    const double share = static_cast<double>(k) / samples_of_ring;
    const double of_a = a.parameter(a.curve().knots.domain_start(), share, false);
    sum += (a.at(of_a) - b.at(b.parameter(seam, share, backwards))).squaredNorm();
  }
  return sum;
}

// Gauss and Newton's step of the seam; converges to rounding where the rings are the same one.
double better_seam(const Ring& a, const Ring& b, double seam, bool backwards) {
  double along = 0.0, squared = 0.0;
  for (int k = 0; k < samples_of_ring; ++k) {
    const double share = static_cast<double>(k) / samples_of_ring;
    const double of_b = b.parameter(seam, share, backwards);
    const Vector3 slope = b.derivative_at(of_b);
    const Vector3 apart = a.at(a.parameter(a.curve().knots.domain_start(), share, false)) - b.at(of_b);
    along += apart.dot(slope);
    squared += slope.squaredNorm();
  }
  return squared > 0.0 ? seam + along / squared : seam;
}

EdgeMatch match_rings(PatchEdge a, PatchEdge b, const EdgeCurve& of_a, const EdgeCurve& of_b,
                      std::optional<bool> asked) {
  const Ring ring_a(of_a), ring_b(of_b);
  double least = std::numeric_limits<double>::infinity();
  EdgeMatch best{a, b, false, 0.0, 0.0, 0.0};
  for (const bool backwards : {false, true}) {
    if (asked.value_or(backwards) != backwards) continue;
    for (int k = 0; k < seams_tried; ++k) {
      const double seam =
          ring_b.parameter(of_b.knots.domain_start(), static_cast<double>(k) / seams_tried, false);
      const double sum = misfit(ring_a, ring_b, seam, backwards);
      if (sum < least * (1.0 - 1e-9)) {
        least = sum;
        best.seam = seam;
        best.reversed = backwards;
      }
    }
  }
  for (int step = 0; step < 30; ++step) {
    const double seam = better_seam(ring_a, ring_b, best.seam, best.reversed);
    if (misfit(ring_a, ring_b, seam, best.reversed) >= misfit(ring_a, ring_b, best.seam, best.reversed))
      break;
    best.seam = seam;
  }
  best.seam = of_b.knots.into_domain(best.seam);
  std::vector<Vector3> along, beside;
  for (int k = 0; k < samples_of_ring; ++k) {
    const double share = static_cast<double>(k) / samples_of_ring;
    along.push_back(position(of_a, ring_a.parameter(of_a.knots.domain_start(), share, false)));
    beside.push_back(position(of_b, ring_b.parameter(best.seam, share, best.reversed)));
  }
  const Gaps gaps = gaps_between(along, beside);
  best.gap_m = gaps.largest;
  best.mean_gap_m = gaps.mean;
  return best;
}

std::string text_of(PatchEdge edge) {
  return "patch " + std::to_string(edge.patch + 1) + "'s " + side_name(edge.side);
}

std::vector<PatchEdge> free_edges(const std::vector<Surface>& patches) {
  std::vector<PatchEdge> edges;
  for (int p = 0; p < static_cast<int>(patches.size()); ++p) {
    for (const Side side : all_sides) {
      if (is_joinable(patches[p], side)) edges.push_back({p, side});
    }
  }
  return edges;
}

// Which patches hang together.
class Groups {
 public:
  explicit Groups(std::size_t count) : group_(count) { std::iota(group_.begin(), group_.end(), 0); }
  bool are_one(int a, int b) const { return group_[a] == group_[b]; }
  void join(int a, int b) {
    const int from = group_[b], to = group_[a];
    for (int& group : group_) group = group == from ? to : group;
  }
  int loose() const {  // a patch that does not hang on the first, or -1
    for (std::size_t p = 0; p < group_.size(); ++p) {
      if (group_[p] != group_[0]) return static_cast<int>(p);
    }
    return -1;
  }

 private:
  std::vector<int> group_;
};

std::vector<EdgeMatch> candidates(const std::vector<Surface>& patches) {
  const std::vector<PatchEdge> edges = free_edges(patches);
  std::vector<EdgeMatch> found;
  for (std::size_t a = 0; a < edges.size(); ++a) {
    for (std::size_t b = a + 1; b < edges.size(); ++b) {
      if (edges[a].patch == edges[b].patch) continue;
      const auto match = match_edges(patches, edges[a], edges[b]);
      if (match) found.push_back(match.value());
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const EdgeMatch& a, const EdgeMatch& b) { return a.mean_gap_m < b.mean_gap_m; });
  return found;
}

bool shares_edge(const std::vector<EdgeMatch>& taken, const EdgeMatch& match) {
  return std::any_of(taken.begin(), taken.end(), [&](const EdgeMatch& other) {
    return other.a == match.a || other.a == match.b || other.b == match.a || other.b == match.b;
  });
}

}  // namespace

Result<EdgeMatch> match_edges(const std::vector<Surface>& patches, PatchEdge a, PatchEdge b,
                              std::optional<bool> reversed) {
  const EdgeCurve of_a = edge_curve(patches[a.patch], a.side), of_b = edge_curve(patches[b.patch], b.side);
  if (of_a.knots.is_periodic() != of_b.knots.is_periodic()) {
    return Error{text_of(a) + " and " + text_of(b) +
                 " do not fit: one is a closed ring and the other is not"};
  }
  return of_a.knots.is_periodic() ? match_rings(a, b, of_a, of_b, reversed)
                                  : match_open(a, b, of_a, of_b, reversed);
}

Result<std::vector<EdgeMatch>> matches_of(const std::vector<Surface>& patches, double together_m) {
  const std::vector<EdgeMatch> all = candidates(patches);
  std::vector<EdgeMatch> taken;
  Groups groups(patches.size());
  for (const bool touching : {true, false}) {
    for (const EdgeMatch& match : all) {
      const bool wanted =
          touching ? match.gap_m <= together_m : !groups.are_one(match.a.patch, match.b.patch);
      if (!wanted || shares_edge(taken, match)) continue;
      taken.push_back(match);
      groups.join(match.a.patch, match.b.patch);
    }
  }
  if (const int loose = groups.loose(); loose >= 0) {
    return Error{"patch " + std::to_string(loose + 1) +
                 " has no edge that fits one of the others; open it there, or name the edges"};
  }
  return taken;
}

}  // namespace spoonbill
