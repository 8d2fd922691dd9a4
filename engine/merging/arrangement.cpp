#include "engine/merging/arrangement.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {
namespace {

constexpr int open_samples = 33;
constexpr int rotation_samples = 64;
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

// An edge with its samples, prepared for comparison with several other edges.
struct PreparedEdge {
  PatchEdge name;
  EdgeCurve curve;
  std::vector<Vector3> points_m;  // points at equal fractions of the length; for open edges only
  RingFrame frame;                // frame of the ring; for rings only
};

PreparedEdge prepare_edge(const std::vector<Surface>& patches, PatchEdge name) {
  PreparedEdge edge{name, edge_curve(patches[name.patch], name.side), {}, {}};
  if (edge.curve.knots.is_periodic()) {
    edge.frame = ring_frame(patches[name.patch], name.side);
  } else {
    edge.points_m = edge_samples(edge.curve, open_samples).points_m;
  }
  return edge;
}

EdgeMatch match_open(const PreparedEdge& a, const PreparedEdge& b, std::optional<bool> requested) {
  const std::vector<Vector3>& points_a = a.points_m;
  std::vector<Vector3> points_b = b.points_m;
  const Gaps direct = gaps_between(points_a, points_b);
  std::reverse(points_b.begin(), points_b.end());
  const Gaps against = gaps_between(points_a, points_b);
  const bool reversed = requested.value_or(against.mean < direct.mean);
  const Gaps& gaps = reversed ? against : direct;
  return {a.name, b.name, reversed, 0.0, gaps.largest, gaps.mean};
}

// A ring in coordinates relative to its centre, so that the gap between two rings does not affect their fit.
// The second ring is also rotated to face the first.
class EdgeRing {
 public:
  explicit EdgeRing(const PreparedEdge& edge) : curve_(edge.curve), centre_(edge.frame.centre_m) {}
  void turn(const Eigen::Matrix3d& turn) { turn_ = turn; }

  // Returns the parameter at a fraction of the period, counted from `from` forwards or backwards.
  double parameter(double from, double fraction, bool backwards) const {
    const double length = curve_.knots.domain_length();
    return from + (backwards ? -fraction : fraction) * length;
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
  for (int k = 0; k < rotation_samples; ++k) {
    const double fraction = static_cast<double>(k) / rotation_samples;
    const double parameter_a = a.parameter(a.seam(), fraction, false);
    sum += (a.at(parameter_a) - b.at(b.parameter(seam, fraction, backwards))).squaredNorm();
  }
  return sum;
}

// Returns the seam of ring b after one Gauss-Newton step that reduces misfit(). For identical rings the steps
// converge up to rounding.
double improve_seam(const EdgeRing& a, const EdgeRing& b, double seam, bool backwards) {
  double along = 0.0, squared = 0.0;
  for (int k = 0; k < rotation_samples; ++k) {
    const double fraction = static_cast<double>(k) / rotation_samples;
    const double parameter_b = b.parameter(seam, fraction, backwards);
    const Vector3 slope = b.derivative_at(parameter_b);
    const Vector3 offset = a.at(a.parameter(a.seam(), fraction, false)) - b.at(parameter_b);
    along += offset.dot(slope);
    squared += slope.squaredNorm();
  }
  return squared > 0.0 ? seam + along / squared : seam;
}

struct RingFit {
  double seam = 0.0;
  bool reversed = false;
  double misfit = std::numeric_limits<double>::infinity();
};

RingFit fit_best(const EdgeRing& a, const EdgeRing& b, std::optional<bool> requested) {
  RingFit best;
  for (const bool backwards : {false, true}) {
    if (requested.value_or(backwards) != backwards) continue;
    for (int k = 0; k < seams_tried; ++k) {
      const double seam = b.parameter(b.seam(), static_cast<double>(k) / seams_tried, false);
      const double sum = misfit(a, b, seam, backwards);
      if (sum < best.misfit * (1.0 - 1e-9)) best = {seam, backwards, sum};
    }
  }
  for (int step = 0; step < 30; ++step) {
    const double seam = improve_seam(a, b, best.seam, best.reversed);
    const double sum = misfit(a, b, seam, best.reversed);
    if (sum >= best.misfit) break;
    best.seam = seam;
    best.misfit = sum;
  }
  return best;
}

// Returns the best fit of two rings. Coincident rings are compared without a rotation, which is exact for
// identical rings. Other rings are compared after ring b is rotated to face ring a.
RingFit fit_best_rotated(const PreparedEdge& a, const PreparedEdge& b, std::optional<bool> requested) {
  // Largest distance between rings that count as coincident, as a fraction of the radius of ring a.
  constexpr double coincidence_fraction = 0.02;
  const EdgeRing ring_a(a);
  EdgeRing ring_b(b);
  const RingFit unrotated = fit_best(ring_a, ring_b, requested);
  const double coincidence_m = coincidence_fraction * a.frame.radius_m;
  const bool coincides = (b.frame.centre_m - a.frame.centre_m).norm() <= coincidence_m &&
                         unrotated.misfit <= rotation_samples * coincidence_m * coincidence_m;
  if (coincides) return unrotated;
  const Eigen::Matrix3d turn = rotation_towards(a.frame, b.frame);
  if (turn.isIdentity(0.0)) return unrotated;
  ring_b.turn(turn);
  return fit_best(ring_a, ring_b, requested);
}

EdgeMatch match_rings(const PreparedEdge& a, const PreparedEdge& b, std::optional<bool> requested) {
  const RingFit best = fit_best_rotated(a, b, requested);
  const double seam = b.curve.knots.into_domain(best.seam);
  const EdgeRing ring_a(a), ring_b(b);
  std::vector<Vector3> points_a, points_b;
  for (int k = 0; k < rotation_samples; ++k) {
    const double fraction = static_cast<double>(k) / rotation_samples;
    points_a.push_back(position(a.curve, ring_a.parameter(ring_a.seam(), fraction, false)));
    points_b.push_back(position(b.curve, ring_b.parameter(seam, fraction, best.reversed)));
  }
  const Gaps gaps = gaps_between(points_a, points_b);
  return {a.name, b.name, best.reversed, seam, gaps.largest, gaps.mean};
}

Result<EdgeMatch> match_edge_pair(const PreparedEdge& a, const PreparedEdge& b,
                                  std::optional<bool> reversed) {
  const bool ring = a.curve.knots.is_periodic();
  if (ring != b.curve.knots.is_periodic()) {
    return Error(ErrorCode::mismatch, edge_name(a.name) + " and " + edge_name(b.name) +
                                          " do not fit: one is a closed ring and the other is not");
  }
  return ring ? match_rings(a, b, reversed) : Result(match_open(a, b, reversed));
}

std::vector<PatchEdge> joinable_edges(const std::vector<Surface>& patches) {
  std::vector<PatchEdge> edges;
  for (int p = 0; p < static_cast<int>(patches.size()); ++p) {
    for (const Side side : all_sides) {
      if (is_joinable(patches[p], side)) edges.push_back({p, side});
    }
  }
  return edges;
}

// Sets of patches that are connected by matches.
class Groups {
 public:
  explicit Groups(std::size_t count) : group_(count) { std::iota(group_.begin(), group_.end(), 0); }
  bool are_one(int a, int b) const { return group_[a] == group_[b]; }
  void join(int a, int b) {
    const int from = group_[b], to = group_[a];
    for (int& group : group_) group = group == from ? to : group;
  }
  int find_loose() const {  // returns a patch that is not connected to the first patch, or -1
    for (std::size_t p = 0; p < group_.size(); ++p) {
      if (group_[p] != group_[0]) return static_cast<int>(p);
    }
    return -1;
  }

 private:
  std::vector<int> group_;
};

std::vector<EdgeMatch> find_candidates(const std::vector<Surface>& patches) {
  std::vector<PreparedEdge> edges;
  for (const PatchEdge& name : joinable_edges(patches)) edges.push_back(prepare_edge(patches, name));
  std::vector<EdgeMatch> found;
  for (std::size_t a = 0; a < edges.size(); ++a) {
    for (std::size_t b = a + 1; b < edges.size(); ++b) {
      if (edges[a].name.patch == edges[b].name.patch) continue;
      const auto match = match_edge_pair(edges[a], edges[b], std::nullopt);
      if (match) found.push_back(match.value());
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const EdgeMatch& a, const EdgeMatch& b) { return a.mean_gap_m < b.mean_gap_m; });
  return found;
}

bool uses_same_edge(const std::vector<EdgeMatch>& chosen, const EdgeMatch& match) {
  return std::any_of(chosen.begin(), chosen.end(), [&](const EdgeMatch& other) {
    return other.a == match.a || other.a == match.b || other.b == match.a || other.b == match.b;
  });
}

}  // namespace

std::string edge_name(PatchEdge edge) {
  return "patch " + std::to_string(edge.patch + 1) + "'s " + side_name(edge.side);
}

Result<EdgeMatch> match_edges(const std::vector<Surface>& patches, PatchEdge a, PatchEdge b,
                              std::optional<bool> reversed) {
  SPOONBILL_ASSERT(a.patch >= 0 && a.patch < static_cast<int>(patches.size()));
  SPOONBILL_ASSERT(b.patch >= 0 && b.patch < static_cast<int>(patches.size()));
  return match_edge_pair(prepare_edge(patches, a), prepare_edge(patches, b), reversed);
}

Result<std::vector<EdgeMatch>> find_edge_matches(const std::vector<Surface>& patches, double together_m) {
  SPOONBILL_ASSERT(together_m >= 0.0);
  const std::vector<EdgeMatch> all = find_candidates(patches);
  std::vector<EdgeMatch> chosen;
  Groups groups(patches.size());
  for (const bool touching : {true, false}) {
    for (const EdgeMatch& match : all) {
      const bool is_needed =
          touching ? match.gap_m <= together_m : !groups.are_one(match.a.patch, match.b.patch);
      if (!is_needed || uses_same_edge(chosen, match)) continue;
      chosen.push_back(match);
      groups.join(match.a.patch, match.b.patch);
    }
  }
  if (const int loose = groups.find_loose(); loose >= 0) {
    return Error(ErrorCode::mismatch, "patch " + std::to_string(loose + 1) +
                                          " has no edge that fits an edge of another patch; open it where it "
                                          "should be joined, or name the edges");
  }
  return chosen;
}

namespace {

struct GridCell {
  int a = 0, b = 0;
  Orientation orientation;

  friend bool operator==(const GridCell&, const GridCell&) = default;
};

constexpr bool both[] = {false, true};

// Returns the orientation that moves the side `side` of a patch to `target` and reverses the direction of
// this side's edge if `reversed` is true; nothing if there is no such orientation.
std::optional<Orientation> facing(Side side, Side target, bool reversed) {
  for (const bool exchange : both) {
    for (const bool reverse_u : both) {
      for (const bool reverse_v : both) {
        const Orientation orientation{exchange, reverse_u, reverse_v};
        const TurnedSide result = turn_side(side, orientation);
        if (result.side == target && result.reversed == reversed) return orientation;
      }
    }
  }
  return std::nullopt;
}

GridCell neighbour(const GridCell& cell, Side own, Side other, bool against) {
  const TurnedSide here = turn_side(own, cell.orientation);
  GridCell there = cell;
  int& moved = across(here.side) == Direction::u ? there.a : there.b;
  moved += is_start(here.side) ? -1 : 1;
  there.orientation = *facing(other, opposite(here.side), here.reversed != against);
  return there;
}

std::vector<std::optional<GridCell>> place_patches(std::size_t count, const std::vector<EdgeMatch>& matches) {
  std::vector<std::optional<GridCell>> cells(count);
  cells[0] = GridCell{};
  for (bool more = true; more;) {
    more = false;
    for (const EdgeMatch& match : matches) {
      auto &a = cells[match.a.patch], &b = cells[match.b.patch];
      if (a.has_value() == b.has_value()) continue;
      if (a) {
        b = neighbour(*a, match.a.side, match.b.side, match.reversed);
      } else {
        a = neighbour(*b, match.b.side, match.a.side, match.reversed);
      }
      more = true;
    }
  }
  return cells;
}

Error layout_error(const std::string& what) {
  return Error(ErrorCode::mismatch,
               what + "; merge patches that make a row or a full grid, or name the edges");
}

// Classifies the matches between patches that are not neighbours in the grid. If there is one for each row or
// for each column, they close the grid; otherwise their edges stay open.
void sort_closing_matches(const std::vector<std::optional<GridCell>>& cells,
                          const std::vector<EdgeMatch>& matches, Arrangement& arrangement) {
  arrangement.closing_u.clear();
  arrangement.closing_v.clear();
  arrangement.left_open.clear();
  for (const EdgeMatch& match : matches) {
    const GridCell &there = *cells[match.b.patch],
                   expected = neighbour(*cells[match.a.patch], match.a.side, match.b.side, match.reversed);
    if (expected == there) continue;
    const int da = std::abs(expected.a - there.a), db = std::abs(expected.b - there.b);
    const bool is_same_orientation = expected.orientation == there.orientation;
    if (is_same_orientation && da == arrangement.rows && db == 0) {
      arrangement.closing_u.push_back(match);
    } else if (is_same_orientation && db == arrangement.columns && da == 0) {
      arrangement.closing_v.push_back(match);
    } else {
      arrangement.left_open.push_back(match);
    }
  }
  const auto open_unless_all = [&](std::vector<EdgeMatch>& closing, int count) {
    if (static_cast<int>(closing.size()) == count) return;
    arrangement.left_open.insert(arrangement.left_open.end(), closing.begin(), closing.end());
    closing.clear();
  };
  open_unless_all(arrangement.closing_u, arrangement.columns);
  open_unless_all(arrangement.closing_v, arrangement.rows);
}

// Wraps the cells of closed directions so that the first patch, which is in cell 0, comes directly after the
// seam. Returns true if there are closed directions.
bool start_rings_at_first(const Arrangement& arrangement, std::vector<std::optional<GridCell>>& cells) {
  const auto wrapped = [](int cell, int count) { return (cell % count + count) % count; };
  for (std::optional<GridCell>& cell : cells) {
    if (!arrangement.closing_u.empty()) cell->a = wrapped(cell->a, arrangement.rows);
    if (!arrangement.closing_v.empty()) cell->b = wrapped(cell->b, arrangement.columns);
  }
  return !arrangement.closing_u.empty() || !arrangement.closing_v.empty();
}

Result<Arrangement> fill_cells(Arrangement arrangement, const std::vector<std::optional<GridCell>>& cells,
                               int low_a, int low_b) {
  const std::size_t cell_count = static_cast<std::size_t>(arrangement.rows) * arrangement.columns;
  arrangement.patches.assign(cell_count, -1);
  arrangement.orientations.resize(cell_count);
  for (std::size_t p = 0; p < cells.size(); ++p) {
    const int cell = arrangement.cell(cells[p]->a - low_a, cells[p]->b - low_b);
    if (arrangement.patches[cell] >= 0) {
      return layout_error("patch " + std::to_string(p + 1) + " is in the same cell as another one");
    }
    arrangement.patches[cell] = static_cast<int>(p);
    arrangement.orientations[cell] = cells[p]->orientation;
  }
  for (const int patch : arrangement.patches) {
    if (patch < 0) return layout_error("the patches leave a gap in their grid");
  }
  return arrangement;
}

}  // namespace

Surface orient(const Surface& surface, const Orientation& orientation) {
  Surface result = orientation.exchanged ? exchanged(surface) : surface;
  if (orientation.reversed_u) result = reversed(result, Direction::u);
  if (orientation.reversed_v) result = reversed(result, Direction::v);
  return result;
}

TurnedSide turn_side(Side side, const Orientation& orientation) {
  Direction direction = across(side);
  bool start = is_start(side);
  if (orientation.exchanged) direction = direction == Direction::u ? Direction::v : Direction::u;
  const bool across_reversed = direction == Direction::u ? orientation.reversed_u : orientation.reversed_v;
  const bool along_reversed = direction == Direction::u ? orientation.reversed_v : orientation.reversed_u;
  if (across_reversed) start = !start;
  const Side result = direction == Direction::u ? (start ? Side::u_start : Side::u_end)
                                                : (start ? Side::v_start : Side::v_end);
  return {result, along_reversed};
}

Result<Arrangement> arrange(const std::vector<Surface>& patches, const std::vector<EdgeMatch>& matches) {
  SPOONBILL_ASSERT(!patches.empty());
  auto cells = place_patches(patches.size(), matches);
  int low_a = 0, low_b = 0, high_a = 0, high_b = 0;
  for (std::size_t p = 0; p < cells.size(); ++p) {
    if (!cells[p]) return layout_error("patch " + std::to_string(p + 1) + " is connected to no other patch");
    low_a = std::min(low_a, cells[p]->a);
    high_a = std::max(high_a, cells[p]->a);
    low_b = std::min(low_b, cells[p]->b);
    high_b = std::max(high_b, cells[p]->b);
  }
  Arrangement arrangement;
  arrangement.rows = high_a - low_a + 1;
  arrangement.columns = high_b - low_b + 1;
  sort_closing_matches(cells, matches, arrangement);
  if (start_rings_at_first(arrangement, cells)) sort_closing_matches(cells, matches, arrangement);
  if (!arrangement.closing_u.empty()) low_a = 0;
  if (!arrangement.closing_v.empty()) low_b = 0;
  return fill_cells(std::move(arrangement), cells, low_a, low_b);
}

}  // namespace spoonbill
