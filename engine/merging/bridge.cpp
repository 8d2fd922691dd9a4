#include "engine/merging/bridge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/basis.h"
#include "engine/bspline/blending_matrix.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/knot_vector.h"
#include "engine/bspline/reparameterise.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {
namespace {

constexpr int samples_across = 64;

// Returns the distance by which point k of the second edge is ahead of the first edge, along the mean
// direction of both patches. Returns 0 where their directions are opposite.
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

// Returns the k-th difference of a line's control points at one end of a polynomial piece.
Vector3 difference_at_end(const Surface& piece, int line, int k, bool at_end) {
  std::vector<Vector3> points;
  const int last = piece.net.columns - 1;
  for (int j = 0; j <= k; ++j) points.push_back(piece.net.point(line, at_end ? last - k + j : j));
  for (int order = k; order > 0; --order) {
    for (int j = 0; j < order; ++j) points[j] = points[j + 1] - points[j];
  }
  return points[0];
}

// Returns true if the Taylor terms of third and higher order agree across the joint. The allowed difference
// is the same as for the first-order term.
bool agree_beyond_second(const Surface& before, const Surface& after, double stretch, int continuity,
                         double speed) {
  const std::vector<double> breaks_before = before.v.breakpoints(), breaks_after = after.v.breakpoints();
  const auto last =
      part_of(before, Direction::v, breaks_before[breaks_before.size() - 2], breaks_before.back());
  const auto first = part_of(after, Direction::v, breaks_after[0], breaks_after[1]);
  if (!last || !first) return false;
  const double length = breaks_before.back() - breaks_before[breaks_before.size() - 2];
  const double ratio = length / (stretch * (breaks_after[1] - breaks_after[0]));
  // Binomial coefficient "degree choose k", the factor of the k-th difference. It starts with k = 2.
  double choices = 0.5 * before.v.degree() * (before.v.degree() - 1.0);
  for (int k = 3; k <= std::min(continuity, before.v.degree()); ++k) {
    choices *= (before.v.degree() - k + 1.0) / k;
    for (int line = 0; line < last->net.rows; ++line) {
      const Vector3 difference = difference_at_end(last.value(), line, k, true) -
                                 std::pow(ratio, k) * difference_at_end(first.value(), line, k, false);
      if (choices * difference.norm() > 1e-6 * speed * length) return false;
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

bool continues_ahead(const JointEdges& edges, double touching_m) {
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

namespace {

// Normals du x dv, not normalised, at all pairs of the parameters u and v.
class NormalGrid {
 public:
  NormalGrid(const Surface& surface, std::vector<double> u, std::vector<double> v)
      : u_(std::move(u)), v_(std::move(v)) {
    const int columns = surface.net.columns;
    const std::vector<Vector3> lines = blend_along_u(surface.net, blending_matrix(surface.u, u_, 0));
    const std::vector<Vector3> slopes = blend_along_u(surface.net, blending_matrix(surface.u, u_, 1));
    const BlendingMatrix values = blending_matrix(surface.v, v_, 0);
    const BlendingMatrix derivatives = blending_matrix(surface.v, v_, 1);
    normals_.reserve(u_.size() * v_.size());
    for (std::size_t i = 0; i < u_.size(); ++i) {
      for (std::size_t j = 0; j < v_.size(); ++j) {
        Vector3 du = Vector3::Zero(), dv = Vector3::Zero();
        for (int k = 0; k < values.bandwidth; ++k) {
          const std::size_t at = j * static_cast<std::size_t>(values.bandwidth) + k;
          const std::size_t point = i * columns + values.column(static_cast<int>(j), k);
          du += values.values[at] * slopes[point];
          dv += derivatives.values[at] * lines[point];
        }
        normals_.push_back(du.cross(dv));
      }
    }
  }

  const std::vector<double>& u() const { return u_; }
  const std::vector<double>& v() const { return v_; }
  const Vector3& at(std::size_t i, std::size_t j) const { return normals_[i * v_.size() + j]; }
  bool turns(std::size_t i, std::size_t j, std::size_t other_i, std::size_t other_j) const {
    return at(i, j).dot(at(other_i, other_j)) < 0.0;
  }

 private:
  static std::vector<Vector3> blend_along_u(const ControlNet& net, const BlendingMatrix& blending) {
    std::vector<Vector3> result;
    result.reserve(static_cast<std::size_t>(blending.rows) * net.columns);
    for (int i = 0; i < blending.rows; ++i) {
      for (int j = 0; j < net.columns; ++j) {
        Vector3 sum = Vector3::Zero();
        for (int k = 0; k < blending.bandwidth; ++k) {
          sum += blending.values[static_cast<std::size_t>(i) * blending.bandwidth + k] *
                 net.point(blending.column(i, k), j);
        }
        result.push_back(sum);
      }
    }
    return result;
  }

  std::vector<double> u_, v_;
  std::vector<Vector3> normals_;
};

constexpr int cells_in_bridge_piece = 4;

struct Cells {
  std::vector<double> centres;
  // For each cell, true if the surface is smooth up to the next cell (the first follows the last), false if a
  // crease is in between.
  std::vector<bool> is_smooth;
};

Cells cells_along(const KnotVector& knots) {
  Cells cells;
  const std::vector<double> ends = knots.breakpoints();
  const std::vector<KnotMultiplicity> starts = knot_multiplicities(knots);
  for (std::size_t piece = 0; piece < starts.size(); ++piece) {
    for (int k = 0; k < cells_in_bridge_piece; ++k) {
      cells.centres.push_back(ends[piece] +
                              (ends[piece + 1] - ends[piece]) * (k + 0.5) / cells_in_bridge_piece);
      cells.is_smooth.push_back(true);
    }
    // Open ends count as clamped. Their knot has full multiplicity, so the surface is not smooth across them.
    cells.is_smooth.back() = starts[(piece + 1) % starts.size()].multiplicity < knots.degree();
  }
  return cells;
}

// Smallest number of lines on which a strip is sampled, and smallest number of steps along each line. These
// limits matter only for strips with few polynomial pieces.
constexpr int least_lines = 32, least_steps = 24;

std::vector<double> sample_lines(const KnotVector& u) {
  const int pieces = static_cast<int>(u.breakpoints().size()) - 1;
  return uniform_parameters(u, std::max(least_lines, cells_in_bridge_piece * pieces) + 1);
}

std::vector<double> sample_steps(const KnotVector& v, double start, double end) {
  const std::vector<double> knots = v.breakpoints();
  const auto inside =
      std::count_if(knots.begin(), knots.end(), [&](double knot) { return knot > start && knot < end; });
  const int steps = std::max(least_steps, cells_in_bridge_piece * (static_cast<int>(inside) + 1));
  std::vector<double> along;
  for (int k = 0; k <= steps; ++k) along.push_back(start + (end - start) * k / steps);
  return along;
}

bool folds_in_strip(const NormalGrid& normals, std::size_t i, std::size_t j) {
  const std::size_t last = normals.v().size() - 1;
  if (j > 0 && normals.turns(i, j - 1, i, j)) return true;
  if (!normals.turns(i, 0, i, last) && normals.turns(i, 0, i, j) && normals.turns(i, last, i, j)) return true;
  return i > 0 && normals.turns(i - 1, j, i, j) && !normals.turns(i - 1, 0, i, 0) &&
         !normals.turns(i - 1, last, i, last);
}

}  // namespace

std::optional<Vector3> find_fold(const Surface& surface) {
  SPOONBILL_ASSERT_DEBUG(is_valid(surface));
  const Cells along_u = cells_along(surface.u), along_v = cells_along(surface.v);
  const NormalGrid normals(surface, along_u.centres, along_v.centres);
  const std::size_t rows = along_u.centres.size(), columns = along_v.centres.size();
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      if ((along_u.is_smooth[i] && normals.turns(i, j, (i + 1) % rows, j)) ||
          (along_v.is_smooth[j] && normals.turns(i, j, i, (j + 1) % columns))) {
        return position(surface, normals.u()[i], normals.v()[j]);
      }
    }
  }
  return std::nullopt;
}

std::optional<Vector3> find_fold_between(const Surface& surface, double start, double end) {
  SPOONBILL_ASSERT(start <= end);
  const NormalGrid normals(surface, sample_lines(surface.u), sample_steps(surface.v, start, end));
  for (std::size_t i = 0; i < normals.u().size(); ++i) {
    for (std::size_t j = 0; j < normals.v().size(); ++j) {
      if (folds_in_strip(normals, i, j)) return position(surface, normals.u()[i], normals.v()[j]);
    }
  }
  return std::nullopt;
}

namespace {

// Returns clamped knots for `count` control points, with pieces of equal length.
Result<KnotVector> strip_knots(int degree, int count, double start, double end) {
  std::vector<double> knots(static_cast<std::size_t>(degree) + 1, start);
  const int pieces = count - degree;
  for (int k = 1; k < pieces; ++k) knots.push_back(start + (end - start) * k / pieces);
  knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, end);
  return KnotVector::open(degree, std::move(knots));
}

// Sets column j of the strip's control points so that the strip extends the patch's last or first piece.
void continue_into(const Surface& patch, bool from_end, const KnotVector& strip, int j, ControlNet& net) {
  const double at = from_end ? patch.v.domain_end() : patch.v.domain_start();
  const int span = patch.v.find_span(at);
  std::array<double, max_degree> arguments{};
  for (int k = 0; k < strip.degree(); ++k) arguments[k] = strip.knots()[j + 1 + k];
  const BlossomWeights weights = blossom(patch.v, span, std::span(arguments).first(strip.degree()));
  for (int i = 0; i < net.rows; ++i) {
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k <= patch.v.degree(); ++k) {
      sum += weights[k] * patch.net.point(i, patch.v.control_index(span, k));
    }
    net.set_point(i, j, sum);
  }
}

constexpr double tightening = 0.75;
constexpr int tightenings_for_waist = 5, most_tightenings = 12;
constexpr int steps_along = 24;
constexpr int columns_between = 5;

double mean_radius_m(const Surface& tube, double v) {
  const std::vector<double> parameters = uniform_parameters_without_seam(tube.u, 32);
  std::vector<Vector3> points;
  Vector3 centre = Vector3::Zero();
  for (const double u : parameters) {
    points.push_back(position(tube, u, v));
    centre += points.back() / static_cast<double>(parameters.size());
  }
  double radius = 0.0;
  for (const Vector3& point : points)
    radius += (point - centre).norm() / static_cast<double>(parameters.size());
  return radius;
}

bool has_waist(const Surface& strip) {
  const double first = strip.v.domain_start(), last = strip.v.domain_end();
  const double narrowest = std::min(mean_radius_m(strip, first), mean_radius_m(strip, last));
  constexpr double unseen = 0.99;
  for (int k = 1; k < steps_along; ++k) {
    if (mean_radius_m(strip, first + (last - first) * k / steps_along) < unseen * narrowest) return true;
  }
  return false;
}

Result<Surface> make_strip(const Surface& before, const Surface& after, const BridgeLength& length,
                           int continuity) {
  const double start = before.v.domain_end() + length.parameter;
  const double length_after = after.v.domain_length();
  const auto moved = with_domain(after, Direction::v, start, start + length.stretch_of_after * length_after);
  if (!moved) return moved.error();
  return bridge(before, moved.value(), continuity);
}

// Returns the length along v of a bridge whose mean derivative equals the mean derivative of `before` at the
// gap. The stretch in the result gives `after` the same mean derivative at the gap.
Result<BridgeLength> even_speed_length(const Surface& before, const Surface& after) {
  double chord = 0.0, speed_before = 0.0, speed_after = 0.0;
  const std::vector<double> parameters = uniform_parameters_without_seam(before.u, 64);
  for (const double u : parameters) {
    const SurfacePoint a = evaluate(before, u, before.v.domain_end());
    const SurfacePoint b = evaluate(after, u, after.v.domain_start());
    chord += (a.position_m - b.position_m).norm() / static_cast<double>(parameters.size());
    speed_before += a.dv.norm() / static_cast<double>(parameters.size());
    speed_after += b.dv.norm() / static_cast<double>(parameters.size());
  }
  if (!(speed_before > 0.0) || !(speed_after > 0.0)) {
    return Error(ErrorCode::degenerate,
                 "a patch's tangents across the edge to bridge are zero; cut a piece off there");
  }
  return BridgeLength{chord / speed_before, speed_after / speed_before, chord};
}

// Form of a bridge between two rings. Further columns of control points are added between the two ends if the
// bridge bends, or if it is long. Without them, irregular patch ends would grow into folds in a long bridge.
struct BridgeForm {
  // Rotation that makes the ring after the gap face the ring before it.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  bool bends = false, has_columns_between = false;
};

BridgeForm choose_form(const Surface& before, const Surface& after) {
  if (!before.u.is_periodic()) return {};
  const RingFrame a = ring_frame(before, Side::v_end), b = ring_frame(after, Side::v_start);
  const Eigen::Matrix3d turn = rotation_towards(a, b);
  constexpr double long_fraction = 2.0;  // length of a long bridge, relative to the sum of both rings' radii
  const bool bends = is_bend(turn);
  const bool is_long = (b.centre_m - a.centre_m).norm() > long_fraction * (a.radius_m + b.radius_m);
  const bool has_directions = !a.outward.isZero() && !b.outward.isZero();
  return {turn, bends, bends || (is_long && has_directions)};
}

}  // namespace

Result<BridgeLength> bridge_length(const Surface& before, const Surface& after, int continuity,
                                   bool may_fold) {
  SPOONBILL_ASSERT(continuity >= 0);
  SPOONBILL_ASSERT(before.u.is_periodic() == after.u.is_periodic());
  auto even = even_speed_length(before, after);
  if (!even) return even.error();
  BridgeLength length = even.value();
  const BridgeForm form = choose_form(before, after);
  if (form.bends) length.parameter *= bend_stretch(form.turn);
  for (int attempt = 0; attempt <= most_tightenings; ++attempt) {
    const auto strip = make_strip(before, after, length, continuity);
    if (!strip) return strip.error();
    const bool folds =
        !may_fold && find_fold_between(strip.value(), strip->v.domain_start(), strip->v.domain_end());
    const bool waisted = before.u.is_periodic() && !form.has_columns_between &&
                         attempt < tightenings_for_waist && has_waist(strip.value());
    if (!folds && !waisted) return length;
    length.parameter *= tightening;
  }
  return Error(
      ErrorCode::self_intersecting,
      "the gap of " + short_length_text(length.chord_m) +
          " cannot be bridged without a fold: its edges run into each other, or the parameter lines cross it "
          "at a slant; cut a piece off, or allow a larger tolerance");
}

Result<Surface> bridge(const Surface& before, const Surface& after, int continuity) {
  SPOONBILL_ASSERT(continuity >= 0);
  SPOONBILL_ASSERT(before.u.control_point_count() == after.u.control_point_count() &&
                   before.v.degree() == after.v.degree());
  const int degree = before.v.degree();
  // An order of up to half the degree needs no more than two polynomial pieces. The order is therefore at
  // least half the degree.
  const int order = std::max(continuity, degree / 2);
  const BridgeForm form = choose_form(before, after);
  const int between = form.has_columns_between ? columns_between : 0;
  const int count = std::max(2 * (order + 1), degree + 1) + between;
  auto knots = strip_knots(degree, count, before.v.domain_end(), after.v.domain_start());
  if (!knots) return Error(ErrorCode::degenerate, "the gap to bridge has no length; merge without a bridge");
  ControlNet net(before.net.rows, count);
  for (int j = 0; j <= order; ++j) {
    continue_into(before, true, knots.value(), j, net);
    continue_into(after, false, knots.value(), count - 1 - j, net);
  }
  if (between > 0) fill_bend(net, order, count - 1 - order, outward(before, Side::v_end), form.turn);
  return make_surface(before.u, std::move(knots).value(), std::move(net));
}

}  // namespace spoonbill
