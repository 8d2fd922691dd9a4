#include "engine/simulation/body_mapping.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"
#include "engine/material/lattice/embed_point.h"
#include "engine/simulation/contact_samples.h"

namespace spoonbill {
namespace {

// Smallest and largest number of times that elements are halved to get the samples of the refit. One halving
// gives at least twice as many samples as control points for simple knots, and a well-conditioned refit.
// Elements between repeated knots have as many control points as the degree and need more samples.
constexpr int refit_levels = 1, max_refit_levels = 4;
static_assert(1 << max_refit_levels > max_degree);
constexpr int edge_stations = 512;
constexpr int edge_bisections = 40;

constexpr int samples_around = 64;

bool is_ring_behind(const Surface& surface, const FixingPlane& plane, double v) {
  const double start = surface.u.domain_start(), length = surface.u.domain_end() - start;
  for (int s = 0; s <= samples_around; ++s) {
    const Vector3 point = position(surface, start + length * s / samples_around, v);
    if (plane.normal.dot(point - plane.point_m) > 0.0) return false;
  }
  return true;
}

// Returns the fraction of the v domain, from its start or its end, over which the surface is wholly behind
// the plane.
double find_fraction_behind(const Surface& surface, const FixingPlane& plane, bool from_end) {
  const double start = surface.v.domain_start(), end = surface.v.domain_end();
  const auto behind = [&](double fraction) {
    return is_ring_behind(surface, plane,
                          from_end ? end - fraction * (end - start) : start + fraction * (end - start));
  };
  int station = 0;
  while (station <= edge_stations && behind(static_cast<double>(station) / edge_stations)) ++station;
  if (station == 0) return 0.0;
  if (station > edge_stations) return 1.0;
  double low = static_cast<double>(station - 1) / edge_stations,
         high = static_cast<double>(station) / edge_stations;
  for (int b = 0; b < edge_bisections; ++b) {
    const double midpoint = 0.5 * (low + high);
    (behind(midpoint) ? low : high) = midpoint;
  }
  return low;
}

// Stretches of the v domain, one at each end, over which the surface is wholly behind some plane.
struct FixedStretch {
  double low_end;     // end of the stretch that begins at the domain's start
  double high_start;  // start of the stretch that ends at the domain's end
};

FixedStretch find_fixed_stretch(const Surface& surface, const std::vector<FixingPlane>& planes) {
  const double start = surface.v.domain_start(), length = surface.v.domain_end() - start;
  double low = 0.0, high = 0.0;
  for (const FixingPlane& plane : planes) {
    if (surface.v.is_periodic()) break;
    low = std::max(low, find_fraction_behind(surface, plane, false));
    high = std::max(high, find_fraction_behind(surface, plane, true));
  }
  return {start + low * length, start + (1.0 - high) * length};
}

// Inserts a knot of multiplicity degree - 1 at v. The curvature of the displacement may jump at this knot,
// and the surface stays C1. Moves v to an existing knot nearby, which avoids sliver elements. If the surface
// would get too many control points, inserts nothing; up to `degree` additional columns of control points are
// then fixed.
Result<Surface> insert_edge_knot(const Surface& surface, double& v) {
  const std::vector<double> breaks = surface.v.breakpoints();
  const double tolerance = 1e-3 * surface.v.domain_length();
  for (const double knot : breaks) {
    if (std::abs(knot - v) < tolerance) v = knot;
  }
  if (v <= surface.v.domain_start() || v >= surface.v.domain_end()) return surface;
  const int multiplicity = std::max(1, surface.v.degree() - 1);
  if (surface.v.control_point_count() + multiplicity > sculpted_control_point_count_range.high)
    return surface;
  return insert_knot(surface, Direction::v, v, multiplicity);
}

// Returns the midpoint of the element that contains the parameter; at a knot, the midpoint of the element
// before it.
double find_element_midpoint(const KnotVector& knots, double parameter) {
  const std::vector<double> breaks = knots.breakpoints();
  auto next = std::lower_bound(breaks.begin() + 1, breaks.end() - 1, parameter);
  return 0.5 * (*(next - 1) + *next);
}

// Inserts a knot at the midpoint of each element that contains one of the parameters.
Result<Surface> halve_elements(Surface surface, Direction direction, std::span<const double> parameters) {
  const KnotVector knots = direction == Direction::u ? surface.u : surface.v;
  std::vector<double> midpoints;
  for (const double parameter : parameters) midpoints.push_back(find_element_midpoint(knots, parameter));
  std::sort(midpoints.begin(), midpoints.end());
  midpoints.erase(std::unique(midpoints.begin(), midpoints.end()), midpoints.end());
  for (const double midpoint : midpoints) {
    Result<Surface> finer = insert_knot(surface, direction, midpoint, 1);
    if (!finer.ok()) return finer.error();
    surface = std::move(finer).value();
  }
  return surface;
}

Result<Surface> halve_elements(const Surface& surface, std::span<const double> u, std::span<const double> v) {
  Result<Surface> finer = halve_elements(surface, Direction::u, u);
  if (!finer.ok()) return finer.error();
  return halve_elements(std::move(finer).value(), Direction::v, v);
}

// Returns one byte per column of control points: 1 if its basis function is nonzero in a fixed stretch of v.
std::vector<std::uint8_t> find_fixed_columns(const KnotVector& v, const FixedStretch& fixed) {
  const std::vector<double>& knots = v.extended_knots();
  std::vector<std::uint8_t> fixed_columns(static_cast<std::size_t>(v.control_point_count()), 0);
  for (int c = 0; c < v.control_point_count(); ++c) {
    const bool in_low = fixed.low_end > v.domain_start() && knots[c] < fixed.low_end;
    const bool in_high = fixed.high_start < v.domain_end() && knots[c + v.degree() + 1] > fixed.high_start;
    fixed_columns[static_cast<std::size_t>(c)] = in_low || in_high;
  }
  return fixed_columns;
}

// Returns whether the surface is a single point at an end of v.
bool is_pole(const Surface& surface, bool at_end) {
  constexpr double tolerance = 1e-6;  // as a fraction of the control net's extent
  if (!surface.u.is_periodic() || surface.v.is_periodic()) return false;
  const double v = at_end ? surface.v.domain_end() : surface.v.domain_start();
  const double start = surface.u.domain_start(), length = surface.u.domain_end() - start;
  const Vector3 first = position(surface, start, v);
  double farthest = 0.0, extent = 0.0;
  for (int s = 1; s < samples_around; ++s) {
    farthest = std::max(farthest, (position(surface, start + length * s / samples_around, v) - first).norm());
  }
  for (int i = 0; i < surface.net.rows; ++i) {
    for (int j = 0; j < surface.net.columns; ++j) {
      extent = std::max(extent, (surface.net.point(i, j) - first).norm());
    }
  }
  return farthest <= tolerance * extent;
}

struct SampledRefit {
  NestedGrid nested;
  DisplacementRefit refit;
};

// Chooses how often elements are halved at least, so that samples are dense enough for cells of this size.
Result<int> choose_levels(const Surface& surface, double contact_cell_m) {
  if (!std::isfinite(contact_cell_m)) return refit_levels;
  const Result<NestedGrid> nested = make_nested_grid(surface.u, surface.v, refit_levels);
  if (!nested.ok()) return nested.error();
  const double longest_m = longest_sample_spacing_cells * contact_cell_m;
  return find_largest_spacing_m(surface, nested->grid) > longest_m ? refit_levels + 1 : refit_levels;
}

// Makes the refit on the coarsest grid of samples from which the control points can be determined. Elements
// are halved at least `least_levels` times.
Result<SampledRefit> make_sampled_refit(const Surface& surface, const RefitConstraints& constraints,
                                        int least_levels, InstructionSet set) {
  for (int levels = least_levels;; ++levels) {
    Result<NestedGrid> nested = make_nested_grid(surface.u, surface.v, levels);
    if (!nested.ok()) return nested.error();
    Result<DisplacementRefit> refit = DisplacementRefit::make(nested->grid, constraints, set);
    if (refit.ok()) return SampledRefit{std::move(nested).value(), std::move(refit).value()};
    if (levels == max_refit_levels) return refit.error();
  }
}

}  // namespace

Result<BodyMapping> BodyMapping::make(const Surface& rest, const Surface& current,
                                      const SpringLattice& lattice, const std::vector<FixingPlane>& planes,
                                      InstructionSet set, double contact_cell_m) {
  SPOONBILL_ASSERT(contact_cell_m > 0.0);
  SPOONBILL_ASSERT_DEBUG(rest.u == current.u && rest.v == current.v);
  BodyMapping mapping(rest, current, set);
  FixedStretch fixed = find_fixed_stretch(current, planes);
  for (double* edge : {&fixed.low_end, &fixed.high_start}) {
    Result<Surface> finer_rest = insert_edge_knot(mapping.rest_, *edge);
    if (!finer_rest.ok()) return finer_rest.error();
    Result<Surface> finer = insert_edge_knot(mapping.current_, *edge);
    if (!finer.ok()) return finer.error();
    mapping.rest_ = std::move(finer_rest).value();
    mapping.current_ = std::move(finer).value();
  }
  mapping.base_ = mapping.current_;
  mapping.collapsed_edges_ = find_collapsed_edges(mapping.rest_);
  const KnotVector& v = mapping.rest_.v;
  RefitConstraints constraints{find_fixed_columns(v, fixed), true, true};
  if (lattice.mesh().thin || lattice.mesh().is_frame || v.is_periodic()) {
    constraints.keep_first = v.is_clamped(false);
    constraints.keep_last = v.is_clamped(true);
    mapping.first_pole_ = is_pole(mapping.rest_, false);
    mapping.last_pole_ = is_pole(mapping.rest_, true);
  }
  const Result<int> levels = choose_levels(mapping.rest_, contact_cell_m);
  if (!levels.ok()) return levels.error();
  Result<SampledRefit> sampled = make_sampled_refit(mapping.rest_, constraints, levels.value(), set);
  if (!sampled.ok()) return sampled.error();
  mapping.contact_cell_m_ = mapping.contact_spacing_m_ = contact_cell_m;
  if (std::isfinite(contact_cell_m)) {
    mapping.contact_spacing_m_ = find_largest_spacing_m(mapping.rest_, sampled->nested.grid);
    if (levels.value() > refit_levels) {
      const double least_m = least_sample_spacing_cells * contact_cell_m;
      mapping.skipped_ = find_crowded_samples(mapping.rest_, sampled->nested.grid, least_m);
      // A sample that is skipped is less than this way from one that is not.
      mapping.contact_spacing_m_ = std::max(mapping.contact_spacing_m_, 2.0 * least_m);
    }
  }
  mapping.nested_ = std::make_shared<NestedGrid>(std::move(sampled->nested));
  mapping.refit_.push_back(std::move(sampled->refit));
  mapping.evaluator_.emplace_back(mapping.nested_->grid, set);
  mapping.followed_.resize(static_cast<std::size_t>(mapping.nested_->grid.rows()) *
                           static_cast<std::size_t>(mapping.nested_->grid.columns()));
  const std::vector<double>& columns = mapping.nested_->grid.v.parameters;
  const auto index_of = [&](auto place) { return static_cast<int>(place - columns.begin()); };
  const bool fixes_low = fixed.low_end > v.domain_start(), fixes_high = fixed.high_start < v.domain_end();
  mapping.free_columns_begin_ =
      fixes_low ? index_of(std::upper_bound(columns.begin(), columns.end(), fixed.low_end)) : 0;
  mapping.free_columns_end_ =
      fixes_high ? index_of(std::lower_bound(columns.begin(), columns.end(), fixed.high_start))
                 : static_cast<int>(columns.size());
  mapping.embed(lattice);
  mapping.compute_base_displacements();
  mapping.start_catching_up(lattice);
  return mapping;
}

int BodyMapping::find_twin(int row, int column) const {
  const Grid& grid = nested_->grid;
  const int last_column = grid.columns() - 1;
  const bool pole = (column == 0 && first_pole_) || (column == last_column && last_pole_);
  const bool over_u = row == grid.rows() - 1 && rest_.u.is_periodic();
  const bool over_v = column == last_column && rest_.v.is_periodic();
  return (pole || over_u ? 0 : row) * grid.columns() + (over_v ? 0 : column);
}

void BodyMapping::embed(const SpringLattice& lattice) {
  const Grid& grid = nested_->grid;
  columns_ = static_cast<std::size_t>(grid.columns());
  stride_ = static_cast<std::size_t>(refit_.front().sample_stride());
  const std::size_t samples = static_cast<std::size_t>(grid.rows()) * columns_;
  embedding_.reserve(samples);
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      // Samples at the same point share one embedding, so that their positions stay bitwise equal.
      const int twin = find_twin(i, j);
      if (twin != i * grid.columns() + j) {
        embedding_.push_back(embedding_[static_cast<std::size_t>(twin)]);
        continue;
      }
      embedding_.push_back(embed_in_mesh(
          lattice.mesh(), evaluate(rest_, grid.u.parameters[i], grid.v.parameters[j]).position_m));
    }
  }
  embedded_rest_m_.reserve(samples);
  for (const EmbeddedPoint& point : embedding_) embedded_rest_m_.push_back(point.rest_m(lattice));
  cell_weights_.assign(samples, CellWeights{});
  for (std::size_t s = 0; s < samples; ++s) {
    const EmbeddedPoint& point = embedding_[s];
    std::copy_n(point.node.begin(), point.count, cell_weights_[s].node);
    std::copy_n(point.weight.begin(), point.count, cell_weights_[s].weight);
  }
  node_moves_.assign(4 * static_cast<std::size_t>(lattice.mesh().node_count()), 0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    sample_[axis].assign(static_cast<std::size_t>(grid.rows()) * stride_, 0.0f);
    control_[axis].assign(rest_.net.size(), 0.0f);
  }
  base_moves_.assign(4 * samples, 0.0f);
  reached_moves_.assign(4 * samples, 0.0f);
}

void BodyMapping::compute_base_displacements() {
  if (base_.net.x == rest_.net.x && base_.net.y == rest_.net.y && base_.net.z == rest_.net.z) return;
  const Grid& grid = nested_->grid;
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      const std::size_t s = static_cast<std::size_t>(i) * columns_ + static_cast<std::size_t>(j);
      const auto twin = static_cast<std::size_t>(find_twin(i, j));
      if (twin != s) {
        std::copy_n(reached_moves_.begin() + static_cast<std::ptrdiff_t>(4 * twin), 4,
                    reached_moves_.begin() + static_cast<std::ptrdiff_t>(4 * s));
        continue;
      }
      const double u = grid.u.parameters[i], v = grid.v.parameters[j];
      const Vector3 moved = position(base_, u, v) - position(rest_, u, v);
      for (int axis = 0; axis < 3; ++axis) reached_moves_[4 * s + axis] = static_cast<float>(moved[axis]);
    }
  }
}

void BodyMapping::start_catching_up(const SpringLattice& lattice) {
  std::fill(base_moves_.begin(), base_moves_.end(), 0.0f);
  sample_displacements(lattice);
  const std::array<const float*, 3> followed{followed_.x.data(), followed_.y.data(), followed_.z.data()};
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t s = 0; s < embedding_.size(); ++s) {
      base_moves_[4 * s + axis] = sample_[axis][s / columns_ * stride_ + s % columns_] - followed[axis][s];
    }
  }
  catch_up_ticks_left_ = base_moves_ == reached_moves_ ? 0 : catch_up_ticks;
  sample_displacements(lattice);
}

void BodyMapping::catch_up() {
  if (catch_up_ticks_left_ == 0) return;
  const float part = 1.0f / static_cast<float>(catch_up_ticks_left_);
  if (--catch_up_ticks_left_ == 0) return finish_catching_up();
  for (std::size_t k = 0; k < base_moves_.size(); ++k) {
    base_moves_[k] += part * (reached_moves_[k] - base_moves_[k]);
  }
}

void BodyMapping::finish_catching_up() {
  catch_up_ticks_left_ = 0;
  std::copy(reached_moves_.begin(), reached_moves_.end(), base_moves_.begin());
}

void BodyMapping::sample_displacements(const SpringLattice& lattice) {
  using Vector4 = float __attribute__((vector_size(16)));
  const auto nodes = static_cast<std::size_t>(lattice.mesh().node_count());
  const float *x = lattice.displacements(0), *y = lattice.displacements(1), *z = lattice.displacements(2);
  auto* const moves = reinterpret_cast<Vector4*>(node_moves_.data());
  for (std::size_t n = 0; n < nodes; ++n) moves[n] = Vector4{x[n], y[n], z[n], 0.0f};
  const auto* const base = reinterpret_cast<const Vector4*>(base_moves_.data());
  const Grid& grid = nested_->grid;
  std::size_t s = 0;
  for (int i = 0; i < grid.rows(); ++i) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * stride_);
    float *const x_row = sample_[0].data() + first, *const y_row = sample_[1].data() + first,
                 *const z_row = sample_[2].data() + first;
    for (int j = 0; j < grid.columns(); ++j, ++s) {
      const CellWeights& cell = cell_weights_[s];
      const auto term = [&](int c) { return cell.weight[c] * moves[cell.node[c]]; };
      const Vector4 sum =
          ((term(0) + term(1)) + (term(2) + term(3))) + ((term(4) + term(5)) + (term(6) + term(7)));
      // Subtracting the base last makes the displacement of unmoved samples exactly zero.
      const Vector4 moved = sum - base[s];
      x_row[j] = moved[0];
      y_row[j] = moved[1];
      z_row[j] = moved[2];
    }
  }
}

void BodyMapping::update(const SpringLattice& lattice) {
  sample_displacements(lattice);
  std::vector<double>* net[3] = {&current_.net.x, &current_.net.y, &current_.net.z};
  const std::vector<double>* base[3] = {&base_.net.x, &base_.net.y, &base_.net.z};
  for (int axis = 0; axis < 3; ++axis) {
    refit_.front().control_displacement(sample_[axis].data(), control_[axis].data());
    for (std::size_t p = 0; p < net[axis]->size(); ++p) {
      (*net[axis])[p] = (*base[axis])[p] + static_cast<double>(control_[axis][p]);
    }
  }
  // Rounding to single precision separates the control points of a pole. join_edge() moves them to one point.
  for (const NetEdge& edge : collapsed_edges_) join_edge(current_.net, edge);
}

void BodyMapping::place(const Pose& pose) {
  placed_ = pose;
  const Eigen::Matrix3d turn = pose.orientation.toRotationMatrix();
  for (int i = 0; i < rest_.net.rows; ++i) {
    for (int j = 0; j < rest_.net.columns; ++j) {
      current_.net.set_point(i, j, pose.position_m + turn * rest_.net.point(i, j));
    }
  }
}

std::array<double, 2> BodyMapping::element_lengths_m(double u, double v) const {
  const auto ends_of = [](const KnotVector& knots, double parameter) {
    const std::vector<double>& extended = knots.extended_knots();
    const auto span = static_cast<std::size_t>(knots.find_span(parameter));
    return std::array<double, 2>{extended[span], extended[span + 1]};
  };
  const auto u_ends = ends_of(rest_.u, u), v_ends = ends_of(rest_.v, v);
  return {(position(rest_, u_ends[1], v) - position(rest_, u_ends[0], v)).norm(),
          (position(rest_, u, v_ends[1]) - position(rest_, u, v_ends[0])).norm()};
}

void BodyMapping::measure_residual(double tolerance_m) {
  const Grid& grid = nested_->grid;
  evaluator_.front().points(control_[0].data(), control_[1].data(), control_[2].data(), followed_);
  double largest = 0.0, sum = 0.0;
  int worst_row = 0, worst_column = 0, count = 0;
  int first_row = grid.rows(), last_row = -1, first_column = grid.columns(), last_column = -1;
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = free_columns_begin_; j < free_columns_end_; ++j, ++count) {
      const std::size_t s = static_cast<std::size_t>(i) * columns_ + static_cast<std::size_t>(j);
      const std::size_t from = static_cast<std::size_t>(i) * stride_ + static_cast<std::size_t>(j);
      const float* const base = base_moves_.data() + 4 * s;
      const float* const reached = reached_moves_.data() + 4 * s;
      const Vector3 residual_m(
          static_cast<double>(sample_[0][from] - followed_.x[s] + (base[0] - reached[0])),
          static_cast<double>(sample_[1][from] - followed_.y[s] + (base[1] - reached[1])),
          static_cast<double>(sample_[2][from] - followed_.z[s] + (base[2] - reached[2])));
      const double square = residual_m.squaredNorm();
      sum += square;
      if (square > tolerance_m * tolerance_m) {
        first_row = std::min(first_row, i);
        last_row = i;
        first_column = std::min(first_column, j);
        last_column = std::max(last_column, j);
      }
      if (square <= largest) continue;
      largest = square;
      worst_row = i;
      worst_column = j;
    }
  }
  residual_ = {std::sqrt(largest), std::sqrt(sum / std::max(count, 1)), grid.u.parameters[worst_row],
               grid.v.parameters[worst_column]};
  if (last_row < 0) return;
  residual_.u_range = {grid.u.parameters[first_row], grid.u.parameters[last_row]};
  residual_.v_range = {grid.v.parameters[first_column], grid.v.parameters[last_column]};
}

Result<BodyMapping> BodyMapping::refined(std::span<const double> u, std::span<const double> v,
                                         const SpringLattice& lattice,
                                         const std::vector<FixingPlane>& planes) const {
  const Result<Surface> finer_rest = halve_elements(rest_, u, v);
  if (!finer_rest.ok()) return finer_rest.error();
  const Result<Surface> finer = halve_elements(base_, u, v);
  if (!finer.ok()) return finer.error();
  Result<BodyMapping> made = make(finer_rest.value(), finer.value(), lattice, planes, set_, contact_cell_m_);
  if (!made.ok()) return made;
  const Grid& grid = made->nested_->grid;
  made->coarser_u_ = blending_matrix(rest_.u, grid.u.parameters, 0);
  made->coarser_v_ = blending_matrix(rest_.v, grid.v.parameters, 0);
  made->half_.resize(static_cast<std::size_t>(rest_.net.columns));
  return made;
}

void BodyMapping::adopt(const BodyMapping& coarser, const SpringLattice& lattice) {
  SPOONBILL_ASSERT(coarser_u_ && coarser_v_);
  const BlendingMatrix &u = *coarser_u_, &v = *coarser_v_;
  const std::array<std::vector<float>*, 3> followed{&followed_.x, &followed_.y, &followed_.z};
  const auto columns = static_cast<std::size_t>(u.rows > 0 ? coarser.rest_.net.columns : 0);
  SPOONBILL_ASSERT(half_.size() == columns && v.columns == static_cast<int>(columns) &&
                   u.columns == coarser.rest_.net.rows);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<float>& control = coarser.control_[axis];
    for (int i = 0; i < u.rows; ++i) {
      std::fill(half_.begin(), half_.end(), 0.0);
      for (int k = 0; k < u.bandwidth; ++k) {
        const double weight = u.values[static_cast<std::size_t>(i * u.bandwidth + k)];
        const float* const row = control.data() + static_cast<std::size_t>(u.column(i, k)) * columns;
        for (std::size_t c = 0; c < columns; ++c) half_[c] += weight * static_cast<double>(row[c]);
      }
      for (int j = 0; j < v.rows; ++j) {
        double moved = 0.0;
        for (int k = 0; k < v.bandwidth; ++k) {
          moved += v.values[static_cast<std::size_t>(j * v.bandwidth + k)] *
                   half_[static_cast<std::size_t>(v.column(j, k))];
        }
        (*followed[axis])[static_cast<std::size_t>(i) * columns_ + static_cast<std::size_t>(j)] =
            static_cast<float>(moved);
      }
    }
  }
  start_catching_up(lattice);
  update(lattice);
}

std::vector<int> BodyMapping::find_samples_of(const BodyMapping& coarser) const {
  // Halving an element keeps its samples; rounding may shift their parameters.
  const auto find_places = [](const std::vector<double>& fine, const std::vector<double>& coarse) {
    std::vector<int> places;
    for (const double parameter : coarse) {
      const auto after = std::lower_bound(fine.begin(), fine.end(), parameter);
      const bool is_before =
          after == fine.end() || (after != fine.begin() && parameter - *(after - 1) < *after - parameter);
      places.push_back(static_cast<int>(after - fine.begin()) - (is_before ? 1 : 0));
    }
    return places;
  };
  const Grid &fine = nested_->grid, &coarse = coarser.nested_->grid;
  const std::vector<int> rows = find_places(fine.u.parameters, coarse.u.parameters);
  const std::vector<int> columns = find_places(fine.v.parameters, coarse.v.parameters);
  std::vector<int> samples;
  for (const int row : rows) {
    for (const int column : columns) samples.push_back(row * fine.columns() + column);
  }
  return samples;
}

EmbeddedPoint BodyMapping::at(double u, double v) const {
  const Grid& grid = nested_->grid;
  const int i = grid.u.find_cell(u), j = grid.v.find_cell(v);
  const double a = (u - grid.u.parameters[i]) / (grid.u.parameters[i + 1] - grid.u.parameters[i]);
  const double b = (v - grid.v.parameters[j]) / (grid.v.parameters[j + 1] - grid.v.parameters[j]);
  const int first = i * grid.columns() + j;
  EmbeddedPoint point;
  point.add(embedding_[first], static_cast<float>((1 - a) * (1 - b)));
  point.add(embedding_[first + 1], static_cast<float>((1 - a) * b));
  point.add(embedding_[first + grid.columns()], static_cast<float>(a * (1 - b)));
  point.add(embedding_[first + grid.columns() + 1], static_cast<float>(a * b));
  return point;
}

}  // namespace spoonbill
