#include "engine/merging/edge_match.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/merging/ring_bend.h"

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

// An edge, prepared to be compared with several others.
struct Edge {
  PatchEdge name;
  EdgeCurve curve;
  std::vector<Vector3> points_m;  // at equal shares of the way along an open one
  RingPlace place;                // of a ring
};

Edge prepared(const std::vector<Surface>& patches, PatchEdge name) {
  Edge edge{name, edge_curve(patches[name.patch], name.side), {}, {}};
  if (edge.curve.knots.is_periodic()) {
    edge.place = ring_place(patches[name.patch], name.side);
  } else {
    edge.points_m = edge_samples(edge.curve, samples_of_open).points_m;
  }
  return edge;
}

EdgeMatch match_open(const Edge& a, const Edge& b, std::optional<bool> asked) {
  const std::vector<Vector3>& along = a.points_m;
  std::vector<Vector3> beside = b.points_m;
  const Gaps direct = gaps_between(along, beside);
  std::reverse(beside.begin(), beside.end());
  const Gaps against = gaps_between(along, beside);
  const bool reversed = asked.value_or(against.mean < direct.mean);
  const Gaps& gaps = reversed ? against : direct;
  return {a.name, b.name, reversed, 0.0, gaps.largest, gaps.mean};
}

// A ring seen from its middle, so that a gap between rings does not tell how they are turned; the second one
// as it is when it has been turned towards the first.
class EdgeRing {
 public:
  explicit EdgeRing(const Edge& edge) : curve_(edge.curve), centre_(edge.place.centre_m) {}
  void turn(const Eigen::Matrix3d& turn) { turn_ = turn; }

  // At a share of the way around from a parameter, forwards or backwards.
  double parameter(double from, double share, bool backwards) const {
    const double length = curve_.knots.domain_end() - curve_.knots.domain_start();
    return from + (backwards ? -share : share) * length;
  }
  double seam() const { return curve_.knots.domain_start(); }
  Vector3 at(double t) const { return turn_ * (position(curve_, t) - centre_); }
  Vector3 derivative_at(double t) const { return turn_ * derivative(curve_, t); }

 private:
  const EdgeCurve& curve_;
  Vector3 centre_;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
};

double misfit(const EdgeRing& a, const EdgeRing& b, double seam, bool backwards) {
  double sum = 0.0;
  for (int k = 0; k < samples_of_ring; ++k) {
    const double share = static_cast<double>(k) / samples_of_ring;
    const double of_a = a.parameter(a.seam(), share, false);
    sum += (a.at(of_a) - b.at(b.parameter(seam, share, backwards))).squaredNorm();
  }
  return sum;
}

// Gauss and Newton's step of the seam; converges to rounding where the rings are the same one.
double better_seam(const EdgeRing& a, const EdgeRing& b, double seam, bool backwards) {
  double along = 0.0, squared = 0.0;
  for (int k = 0; k < samples_of_ring; ++k) {
    const double share = static_cast<double>(k) / samples_of_ring;
    const double of_b = b.parameter(seam, share, backwards);
    const Vector3 slope = b.derivative_at(of_b);
    const Vector3 apart = a.at(a.parameter(a.seam(), share, false)) - b.at(of_b);
    along += apart.dot(slope);
    squared += slope.squaredNorm();
  }
  return squared > 0.0 ? seam + along / squared : seam;
}

struct RingFit {
  double seam = 0.0;
  bool reversed = false;
  double misfit = std::numeric_limits<double>::infinity();
};

RingFit best_fit(const EdgeRing& a, const EdgeRing& b, std::optional<bool> asked) {
  RingFit best;
  for (const bool backwards : {false, true}) {
    if (asked.value_or(backwards) != backwards) continue;
    for (int k = 0; k < seams_tried; ++k) {
      const double seam = b.parameter(b.seam(), static_cast<double>(k) / seams_tried, false);
      const double sum = misfit(a, b, seam, backwards);
      if (sum < best.misfit * (1.0 - 1e-9)) best = {seam, backwards, sum};
    }
  }
  for (int step = 0; step < 30; ++step) {
    const double seam = better_seam(a, b, best.seam, best.reversed);
    const double sum = misfit(a, b, seam, best.reversed);
    if (sum >= best.misfit) break;
    best.seam = seam;
    best.misfit = sum;
  }
  return best;
}

// Rings that lie upon each other are taken as they lie, which is exact where they are one; others turned.
RingFit best_turned_fit(const Edge& a, const Edge& b, std::optional<bool> asked) {
  constexpr double upon_share = 0.02;  // of the radius
  const EdgeRing ring_a(a);
  EdgeRing ring_b(b);
  const RingFit as_they_lie = best_fit(ring_a, ring_b, asked);
  const double upon_m = upon_share * a.place.radius_m;
  const bool upon = (b.place.centre_m - a.place.centre_m).norm() <= upon_m &&
                    as_they_lie.misfit <= samples_of_ring * upon_m * upon_m;
  if (upon) return as_they_lie;
  const Eigen::Matrix3d turn = turn_towards(a.place, b.place);
  if (turn.isIdentity(0.0)) return as_they_lie;
  ring_b.turn(turn);
  return best_fit(ring_a, ring_b, asked);
}

EdgeMatch match_rings(const Edge& a, const Edge& b, std::optional<bool> asked) {
  const RingFit best = best_turned_fit(a, b, asked);
  const double seam = b.curve.knots.into_domain(best.seam);
  const EdgeRing ring_a(a), ring_b(b);
  std::vector<Vector3> along, beside;
  for (int k = 0; k < samples_of_ring; ++k) {
    const double share = static_cast<double>(k) / samples_of_ring;
    along.push_back(position(a.curve, ring_a.parameter(ring_a.seam(), share, false)));
    beside.push_back(position(b.curve, ring_b.parameter(seam, share, best.reversed)));
  }
  const Gaps gaps = gaps_between(along, beside);
  return {a.name, b.name, best.reversed, seam, gaps.largest, gaps.mean};
}

Result<EdgeMatch> match_prepared(const Edge& a, const Edge& b, std::optional<bool> reversed) {
  const bool ring = a.curve.knots.is_periodic();
  if (ring != b.curve.knots.is_periodic()) {
    return Error{text_of(a.name) + " and " + text_of(b.name) +
                 " do not fit: one is a closed ring and the other is not"};
  }
  return ring ? match_rings(a, b, reversed) : Result(match_open(a, b, reversed));
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
  std::vector<Edge> edges;
  for (const PatchEdge& name : free_edges(patches)) edges.push_back(prepared(patches, name));
  std::vector<EdgeMatch> found;
  for (std::size_t a = 0; a < edges.size(); ++a) {
    for (std::size_t b = a + 1; b < edges.size(); ++b) {
      if (edges[a].name.patch == edges[b].name.patch) continue;
      const auto match = match_prepared(edges[a], edges[b], std::nullopt);
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

std::string text_of(PatchEdge edge) {
  return "patch " + std::to_string(edge.patch + 1) + "'s " + side_name(edge.side);
}

Result<EdgeMatch> match_edges(const std::vector<Surface>& patches, PatchEdge a, PatchEdge b,
                              std::optional<bool> reversed) {
  SPOONBILL_ASSERT(a.patch >= 0 && a.patch < static_cast<int>(patches.size()));
  SPOONBILL_ASSERT(b.patch >= 0 && b.patch < static_cast<int>(patches.size()));
  return match_prepared(prepared(patches, a), prepared(patches, b), reversed);
}

Result<std::vector<EdgeMatch>> matches_of(const std::vector<Surface>& patches, double together_m) {
  SPOONBILL_ASSERT(together_m >= 0.0);
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
