#include "engine/simulation/body_mapping.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/bspline/reparameterise.h"

namespace spoonbill {
namespace {

// Two cells for each element and direction: of single knots at least twice as many samples as control points,
// where the refit is well conditioned. Elements between repeated knots have as many control points as the
// degree, and ask for more.
constexpr int refit_levels = 1, most_refit_levels = 4;
static_assert(1 << most_refit_levels > max_degree);
constexpr int edge_stations = 512;
constexpr int edge_bisections = 40;

constexpr int around = 64;

bool ring_behind(const Surface& surface, const FixingPlane& plane, double v) {
  const double start = surface.u.domain_start(), length = surface.u.domain_end() - start;
  for (int s = 0; s <= around; ++s) {
    const Vector3 point = evaluate(surface, start + length * s / around, v).position_m;
    if (plane.normal.dot(point - plane.point_m) > 0.0) return false;
  }
  return true;
}

// How far from one end of v (share 0 to 1) the surface lies wholly behind the plane.
double share_behind(const Surface& surface, const FixingPlane& plane, bool from_end) {
  const double start = surface.v.domain_start(), end = surface.v.domain_end();
  const auto behind = [&](double share) {
    return ring_behind(surface, plane,
                       from_end ? end - share * (end - start) : start + share * (end - start));
  };
  int station = 0;
  while (station <= edge_stations && behind(static_cast<double>(station) / edge_stations)) ++station;
  if (station == 0) return 0.0;
  if (station > edge_stations) return 1.0;
  double low = static_cast<double>(station - 1) / edge_stations,
         high = static_cast<double>(station) / edge_stations;
  for (int b = 0; b < edge_bisections; ++b) {
    const double middle = 0.5 * (low + high);
    (behind(middle) ? low : high) = middle;
  }
  return low;
}

// The stretch of v at each end that lies wholly behind some plane.
struct FixedStretch {
  double low_end;     // fixed from the domain's start to here
  double high_start;  // and from here to its end
};

FixedStretch fixed_stretch(const Surface& surface, const std::vector<FixingPlane>& planes) {
  const double start = surface.v.domain_start(), length = surface.v.domain_end() - start;
  double low = 0.0, high = 0.0;
  for (const FixingPlane& plane : planes) {
    if (surface.v.is_periodic()) break;
    low = std::max(low, share_behind(surface, plane, false));
    high = std::max(high, share_behind(surface, plane, true));
  }
  return {start + low * length, start + (1.0 - high) * length};
}

// A knot of multiplicity degree - 1: the displacement may start there with a curvature of its own, the
// surface stays smooth (C1). Near an existing knot that one is used, so that no sliver of an element arises.
// Without it, where a document could not hold the control points any more, more columns are held, by up to a
// degree.
Result<Surface> with_edge_knot(const Surface& surface, double& v) {
  const std::vector<double> breaks = surface.v.breakpoints();
  const double near = 1e-3 * (surface.v.domain_end() - surface.v.domain_start());
  for (const double knot : breaks) {
    if (std::abs(knot - v) < near) v = knot;
  }
  if (v <= surface.v.domain_start() || v >= surface.v.domain_end()) return surface;
  const int multiplicity = std::max(1, surface.v.degree() - 1);
  if (surface.v.control_point_count() + multiplicity > control_point_count_range.high) return surface;
  return insert_knot(surface, Direction::v, v, multiplicity);
}

// The middle of the element that holds the parameter, of two the one before it.
double middle_of_element(const KnotVector& knots, double parameter) {
  const std::vector<double> breaks = knots.breakpoints();
  auto next = std::lower_bound(breaks.begin() + 1, breaks.end() - 1, parameter);
  return 0.5 * (*(next - 1) + *next);
}

Result<Surface> with_element_halved(const Surface& surface, double u, double v) {
  const Result<Surface> finer = insert_knot(surface, Direction::u, middle_of_element(surface.u, u), 1);
  if (!finer.ok()) return finer.error();
  return insert_knot(finer.value(), Direction::v, middle_of_element(surface.v, v), 1);
}

// Columns whose basis function reaches into the fixed stretch.
std::vector<std::uint8_t> columns_to_hold(const KnotVector& v, const FixedStretch& fixed) {
  const std::vector<double>& knots = v.extended_knots();
  std::vector<std::uint8_t> held(static_cast<std::size_t>(v.control_point_count()), 0);
  for (int c = 0; c < v.control_point_count(); ++c) {
    const bool in_low = fixed.low_end > v.domain_start() && knots[c] < fixed.low_end;
    const bool in_high = fixed.high_start < v.domain_end() && knots[c + v.degree() + 1] > fixed.high_start;
    held[static_cast<std::size_t>(c)] = in_low || in_high;
  }
  return held;
}

bool is_clamped(const KnotVector& knots, bool at_end) {
  if (knots.is_periodic()) return false;
  const std::vector<double>& all = knots.knots();
  const auto degree = static_cast<std::size_t>(knots.degree());
  return at_end ? all.back() == all[all.size() - 1 - degree] : all.front() == all[degree];
}

// Whether an end of v is a single point, to a millionth of the net's extent.
bool is_pole(const Surface& surface, bool at_end) {
  constexpr double share = 1e-6;
  if (!surface.u.is_periodic() || surface.v.is_periodic()) return false;
  const double v = at_end ? surface.v.domain_end() : surface.v.domain_start();
  const double start = surface.u.domain_start(), length = surface.u.domain_end() - start;
  const Vector3 first = position(surface, start, v);
  double farthest = 0.0, extent = 0.0;
  for (int s = 1; s < around; ++s) {
    farthest = std::max(farthest, (position(surface, start + length * s / around, v) - first).norm());
  }
  for (int i = 0; i < surface.net.rows; ++i) {
    for (int j = 0; j < surface.net.columns; ++j) {
      extent = std::max(extent, (surface.net.point(i, j) - first).norm());
    }
  }
  return farthest <= share * extent;
}

void offer_cells_around(const LatticeMesh& mesh, int node, const Vector3& point, CellLocation& best,
                        std::array<int, 3>& cell) {
  const auto [ni, nj, nk] = mesh.place(node);
  for (int i = std::max(0, ni - 1); i <= std::min(ni, mesh.count[0] - 2); ++i) {
    for (int j = std::max(0, nj - 1); j <= std::min(nj, mesh.count[1] - 2); ++j) {
      for (int k = std::max(0, nk - 1); k <= std::min(nk, mesh.count[2] - 2); ++k) {
        const CellLocation location = locate_in_cell(mesh.cell(i, j, k), point);
        if (location.outside < best.outside - 1e-9) {
          best = location;
          cell = {i, j, k};
        }
      }
    }
  }
}

// The cell in which a point lies, or which it lies nearest to, among those around the nearest node.
EmbeddedPoint embed_point(const LatticeMesh& mesh, const Vector3& point) {
  int nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int n = 0; n < mesh.node_count(); ++n) {
    const double distance = (mesh.nodes[n] - point).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = n;
    }
  }
  CellLocation best;
  best.outside = std::numeric_limits<double>::infinity();
  std::array<int, 3> cell{};
  offer_cells_around(mesh, nearest, point, best, cell);
  if (mesh.twin(nearest) != nearest) offer_cells_around(mesh, mesh.twin(nearest), point, best, cell);
  EmbeddedPoint embedded;
  if (!(best.outside < 1.0)) {
    embedded.count = 1;
    embedded.node[0] = nearest;
    embedded.weight[0] = 1.0f;
    return embedded;
  }
  embedded.count = 8;
  for (int c = 0; c < 8; ++c) {
    embedded.node[c] =
        mesh.joined(mesh.index(cell[0] + (c >> 2 & 1), cell[1] + (c >> 1 & 1), cell[2] + (c & 1)));
    embedded.weight[c] = static_cast<float>(best.weights[c]);
  }
  return embedded;
}

struct SampledRefit {
  NestedGrid nested;
  DisplacementRefit refit;
};

// On the coarsest grid whose samples determine the control points.
Result<SampledRefit> sampled_refit(const Surface& surface, const RefitConstraints& constraints,
                                   InstructionSet set) {
  for (int levels = refit_levels;; ++levels) {
    Result<NestedGrid> nested = make_nested_grid(surface.u, surface.v, levels);
    if (!nested.ok()) return nested.error();
    Result<DisplacementRefit> refit = DisplacementRefit::make(nested->grid, constraints, set);
    if (refit.ok()) return SampledRefit{std::move(nested).value(), std::move(refit).value()};
    if (levels == most_refit_levels) return refit.error();
  }
}

}  // namespace

Result<BodyMapping> BodyMapping::make(const Surface& rest, const Surface& current,
                                      const SpringLattice& lattice, const std::vector<FixingPlane>& planes,
                                      InstructionSet set) {
  SPOONBILL_ASSERT_DEBUG(rest.u == current.u && rest.v == current.v);
  BodyMapping mapping(rest, current, set);
  FixedStretch fixed = fixed_stretch(current, planes);
  for (double* edge : {&fixed.low_end, &fixed.high_start}) {
    Result<Surface> finer_rest = with_edge_knot(mapping.rest_, *edge);
    if (!finer_rest.ok()) return finer_rest.error();
    Result<Surface> finer = with_edge_knot(mapping.current_, *edge);
    if (!finer.ok()) return finer.error();
    mapping.rest_ = std::move(finer_rest).value();
    mapping.current_ = std::move(finer).value();
  }
  mapping.base_ = mapping.current_;
  const KnotVector& v = mapping.rest_.v;
  RefitConstraints constraints{columns_to_hold(v, fixed), true, true};
  if (lattice.mesh().thin || v.is_periodic()) {
    constraints.keep_first = is_clamped(v, false);
    constraints.keep_last = is_clamped(v, true);
    mapping.first_pole_ = is_pole(mapping.rest_, false);
    mapping.last_pole_ = is_pole(mapping.rest_, true);
  }
  mapping.held_columns_ = constraints.fixed_columns;
  Result<SampledRefit> sampled = sampled_refit(mapping.rest_, constraints, set);
  if (!sampled.ok()) return sampled.error();
  mapping.nested_ = std::make_shared<NestedGrid>(std::move(sampled->nested));
  mapping.refit_.push_back(std::move(sampled->refit));
  mapping.evaluator_.emplace_back(mapping.nested_->grid, set);
  mapping.followed_.resize(static_cast<std::size_t>(mapping.nested_->grid.rows()) *
                           static_cast<std::size_t>(mapping.nested_->grid.columns()));
  mapping.embed(lattice);
  return mapping;
}

int BodyMapping::twin_of(int row, int column) const {
  const Grid& grid = nested_->grid;
  const int last_column = grid.columns() - 1;
  const bool pole = (column == 0 && first_pole_) || (column == last_column && last_pole_);
  const bool over_u = row == grid.rows() - 1 && rest_.u.is_periodic();
  const bool over_v = column == last_column && rest_.v.is_periodic();
  return (pole || over_u ? 0 : row) * grid.columns() + (over_v ? 0 : column);
}

void BodyMapping::embed(const SpringLattice& lattice) {
  const Grid& grid = nested_->grid;
  const auto columns = static_cast<std::size_t>(grid.columns());
  const auto stride = static_cast<std::size_t>(refit_.front().sample_stride());
  const std::size_t samples = static_cast<std::size_t>(grid.rows()) * columns;
  embedding_.reserve(samples);
  for (int i = 0; i < grid.rows(); ++i) {
    for (int j = 0; j < grid.columns(); ++j) {
      // What is one place must have one embedding to the last bit to stay so.
      const int twin = twin_of(i, j);
      if (twin != i * grid.columns() + j) {
        embedding_.push_back(embedding_[static_cast<std::size_t>(twin)]);
        continue;
      }
      embedding_.push_back(embed_point(
          lattice.mesh(), evaluate(rest_, grid.u.parameters[i], grid.v.parameters[j]).position_m));
    }
  }
  cell_weights_.assign(samples, CellWeights{});
  for (std::size_t s = 0; s < samples; ++s) {
    const EmbeddedPoint& point = embedding_[s];
    std::copy_n(point.node.begin(), point.count, cell_weights_[s].node);
    std::copy_n(point.weight.begin(), point.count, cell_weights_[s].weight);
  }
  node_moves_.assign(4 * static_cast<std::size_t>(lattice.mesh().node_count()), 0.0f);
  for (int axis = 0; axis < 3; ++axis) {
    sample_[axis].assign(static_cast<std::size_t>(grid.rows()) * stride, 0.0f);
    control_[axis].assign(rest_.net.size(), 0.0f);
  }
  base_moves_.assign(4 * samples, 0.0f);
  sample_displacements(lattice);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t s = 0; s < samples; ++s) {
      base_moves_[4 * s + axis] = sample_[axis][s / columns * stride + s % columns];
    }
  }
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
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(i) * refit_.front().sample_stride();
    float *const x_row = sample_[0].data() + first, *const y_row = sample_[1].data() + first,
                 *const z_row = sample_[2].data() + first;
    for (int j = 0; j < grid.columns(); ++j, ++s) {
      const CellWeights& cell = cell_weights_[s];
      const auto term = [&](int c) { return cell.weight[c] * moves[cell.node[c]]; };
      const Vector4 sum =
          ((term(0) + term(1)) + (term(2) + term(3))) + ((term(4) + term(5)) + (term(6) + term(7)));
      // The base last, so that what did not move is exactly zero.
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
}

void BodyMapping::measure_residual() {
  const Grid& grid = nested_->grid;
  const auto columns = static_cast<std::size_t>(grid.columns());
  const auto stride = static_cast<std::size_t>(refit_.front().sample_stride());
  evaluator_.front().points(control_[0].data(), control_[1].data(), control_[2].data(), followed_);
  double largest = 0.0, sum = 0.0;
  std::size_t worst = 0;
  for (std::size_t s = 0; s < embedding_.size(); ++s) {
    const std::size_t from = s / columns * stride + s % columns;
    const Vector3 left(static_cast<double>(sample_[0][from] - followed_.x[s]),
                       static_cast<double>(sample_[1][from] - followed_.y[s]),
                       static_cast<double>(sample_[2][from] - followed_.z[s]));
    sum += left.squaredNorm();
    if (left.squaredNorm() <= largest) continue;
    largest = left.squaredNorm();
    worst = s;
  }
  residual_ = {std::sqrt(largest), std::sqrt(sum / static_cast<double>(embedding_.size())),
               grid.u.parameters[worst / columns], grid.v.parameters[worst % columns]};
}

Result<BodyMapping> BodyMapping::refined_at(double u, double v, const SpringLattice& lattice,
                                            const std::vector<FixingPlane>& planes) const {
  const Result<Surface> finer_rest = with_element_halved(rest_, u, v);
  if (!finer_rest.ok()) return finer_rest.error();
  const Result<Surface> finer = with_element_halved(current_, u, v);
  if (!finer.ok()) return finer.error();
  return make(finer_rest.value(), finer.value(), lattice, planes, set_);
}

EmbeddedPoint BodyMapping::at(double u, double v) const {
  const auto cell = [](const std::vector<double>& parameters, double value) {
    const auto upper = std::upper_bound(parameters.begin(), parameters.end(), value);
    const auto at = std::clamp<std::ptrdiff_t>(upper - parameters.begin() - 1, 0,
                                               static_cast<std::ptrdiff_t>(parameters.size()) - 2);
    return static_cast<int>(at);
  };
  const Grid& grid = nested_->grid;
  const int i = cell(grid.u.parameters, u), j = cell(grid.v.parameters, v);
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
