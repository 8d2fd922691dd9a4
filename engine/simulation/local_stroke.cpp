#include "engine/simulation/local_stroke.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr float unreached = std::numeric_limits<float>::infinity();

// Largest number of samples within the radius, about. Of denser samples, every second, fourth and so on
// counts.
constexpr double samples_in_region = 300.0;

// Largest number of samples among which the thickness is searched, about.
constexpr int samples_for_thickness = 4000;

// Returns the distance of a vertex from the start of the march, given the distances `a` and `b` of two other
// vertices of its triangle. `to_a` and `to_b` are the edges from the vertex to them. The distance has a unit
// gradient in the triangle; if the front does not come through the triangle, it comes along an edge.
double march_over(double a, double b, const Vector3& to_a, const Vector3& to_b) {
  const double aa = to_a.squaredNorm(), bb = to_b.squaredNorm(), ab = to_a.dot(to_b);
  const double along_edge = std::min(a + std::sqrt(aa), b + std::sqrt(bb));
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > 1e-12 * aa * bb)) return along_edge;
  // With the Gram matrix G of the edges and d = (a - t, b - t), the gradient is unit if d^T G^-1 d = 1.
  const double p = bb - 2.0 * ab + aa;             // 1^T adj(G) 1
  const double q = a * (bb - ab) + b * (aa - ab);  // 1^T adj(G) (a, b)
  const double r = a * a * bb - 2.0 * a * b * ab + b * b * aa - determinant;
  const double root = q * q - p * r;
  if (!(root >= 0.0)) return along_edge;
  const double t = (q + std::sqrt(root)) / p;
  // The front comes through the triangle if the gradient points from inside it to the vertex.
  const double da = t - a, db = t - b;
  const bool comes_through = da * bb - db * ab > 0.0 && db * aa - da * ab > 0.0;
  return comes_through ? std::max({t, a, b}) : along_edge;
}

}  // namespace

struct LocalStroke::CoarseGrid {
  int rows = 0, columns = 0;  // of the mapping
  int row_stride = 1, column_stride = 1;
  bool wraps_rows = false, wraps_columns = false;

  CoarseGrid(const BodyMapping& mapping)
      : rows(mapping.nested().grid.rows()),
        columns(mapping.nested().grid.columns()),
        wraps_rows(mapping.rest().u.is_periodic()),
        wraps_columns(mapping.rest().v.is_periodic()) {}

  int index(int row, int column) const { return row * columns + column; }
  // Returns the next row or column in a direction, -1 or 1; -1 if there is none. The last one of a wrapped
  // direction is the same as the first and is never returned.
  static int next(int at, int direction, int stride, int count, bool wraps) {
    const int last = count - 1;
    if (!wraps) {
      const int to = direction > 0 ? std::min(at + stride, last) : (at - 1) / stride * stride;
      return (direction > 0 ? at == last : at == 0) ? -1 : to;
    }
    const int last_used = (last - 1) / stride * stride;
    if (direction > 0) return at >= last_used ? 0 : at + stride;
    return at == 0 ? last_used : at - stride;
  }
  int next_row(int row, int direction) const { return next(row, direction, row_stride, rows, wraps_rows); }
  int next_column(int column, int direction) const {
    return next(column, direction, column_stride, columns, wraps_columns);
  }
  // Returns the eight samples around a sample, in order: the next row first, then towards the next column.
  Ring ring(int row, int column) const {
    const std::array<int, 3> r = {next_row(row, -1), row, next_row(row, 1)};
    const std::array<int, 3> c = {next_column(column, -1), column, next_column(column, 1)};
    const auto at = [&](std::size_t i, std::size_t j) {
      return r[i] < 0 || c[j] < 0 ? -1 : index(r[i], c[j]);
    };
    return {at(2, 1), at(2, 2), at(1, 2), at(0, 2), at(0, 1), at(0, 0), at(1, 0), at(2, 0)};
  }
};

LocalStroke::LocalStroke(std::span<const BodyState> bodies) {
  std::size_t nodes = 0, samples = 0;
  for (const BodyState& body : bodies) {
    if (body.mesh()) continue;
    const Grid& grid = body.mapping().nested().grid;
    nodes = std::max(nodes, static_cast<std::size_t>(body.lattice.mesh().node_count()));
    samples =
        std::max(samples, static_cast<std::size_t>(grid.rows()) * static_cast<std::size_t>(grid.columns()));
  }
  nodes_.reserve(nodes);
  narrower_.reserve(nodes);
  distance_m_.resize(samples, unreached);
  // A sample is pushed again each time that one of its eight neighbours shortens its distance.
  heap_.reserve(9 * samples);
  region_.reserve(samples);
}

void LocalStroke::carry_over(const LocalStroke& other) {
  SPOONBILL_ASSERT(nodes_.capacity() >= other.nodes_.size());
  touch_ = other.touch_;
  point_ = other.point_;
  moved_m_ = other.moved_m_;
  pressed_m_ = other.pressed_m_;
  radius_m_ = other.radius_m_;
  elastic_m_ = other.elastic_m_;
  is_spent_ = other.is_spent_;
  share_ = other.share_;
  nodes_.assign(other.nodes_.begin(), other.nodes_.end());
}

void LocalStroke::begin(const ToolSpot& touch, const BodyState& state, double radius_m) {
  SPOONBILL_ASSERT(touch.body >= 0 && radius_m > 0.0);
  if (!is_active()) elastic_m_ = 0.0;
  touch_ = touch;
  point_ = state.mapping().at(touch.u, touch.v);
  moved_m_.setZero();
  pressed_m_ = 0.0;
  radius_m_ = radius_m;
  is_spent_ = false;
  find_nodes(state);
}

void LocalStroke::widen(const BodyState& state, double radius_m) {
  SPOONBILL_ASSERT(is_active() && radius_m > 0.0);
  radius_m_ = radius_m;
  is_spent_ = false;
  narrower_.assign(nodes_.begin(), nodes_.end());
  find_nodes(state);
  // Both lists are in the order of the nodes. A node of the narrower region that is not in the wider one
  // keeps its place.
  auto wider = nodes_.begin();
  for (const WeighedNode& node : narrower_) {
    while (wider != nodes_.end() && wider->node < node.node) ++wider;
    if (wider != nodes_.end() && wider->node == node.node) wider->pressed_m = node.pressed_m;
  }
}

// Finds the nodes within the radius, their weights and the share of the touched point.
void LocalStroke::find_nodes(const BodyState& state) {
  const TouchedPoint at{touch_.u, touch_.v, point_.rest_m(state.lattice),
                        unit_normal(state.mapping().rest(), touch_.u, touch_.v)};
  CoarseGrid grid(state.mapping());
  march(state, grid, at);
  weigh_nodes(state, at, find_thickness_m(state, grid, at));
  share_ = 0.0;
  for (int c = 0; c < point_.count; ++c) {
    for (const WeighedNode& node : nodes_) {
      if (node.node == point_.node[c]) share_ += static_cast<double>(point_.weight[c]) * node.weight;
    }
  }
}

// Measures distances along the surface from the touched point to the samples within the radius.
void LocalStroke::march(const BodyState& state, const CoarseGrid& whole, const TouchedPoint& at) {
  const BodyMapping& mapping = state.mapping();
  CoarseGrid grid = whole;
  const Grid& samples = mapping.nested().grid;
  const int row = samples.u.find_cell(at.u), column = samples.v.find_cell(at.v);
  const Vector3 corner = mapping.embedded_rest_m(grid.index(row, column));
  const double spacing_u = (mapping.embedded_rest_m(grid.index(row + 1, column)) - corner).norm();
  const double spacing_v = (mapping.embedded_rest_m(grid.index(row, column + 1)) - corner).norm();
  const auto density = [&] {
    const double area =
        std::max(spacing_u * grid.row_stride, 1e-9) * std::max(spacing_v * grid.column_stride, 1e-9);
    return 3.2 * radius_m_ * radius_m_ / area;
  };
  while (density() > samples_in_region &&
         4 * std::max(grid.row_stride, grid.column_stride) < std::max(grid.rows, grid.columns)) {
    if (spacing_u * grid.row_stride < spacing_v * grid.column_stride && 8 * grid.row_stride < grid.rows) {
      grid.row_stride *= 2;
    } else if (8 * grid.column_stride < grid.columns) {
      grid.column_stride *= 2;
    } else {
      break;
    }
  }
  std::fill(distance_m_.begin(), distance_m_.end(), unreached);
  heap_.clear();
  region_.clear();
  const auto later = [](const std::pair<float, int>& one, const std::pair<float, int>& other) {
    return one.first > other.first;
  };
  const auto reach = [&](int index, double distance_m) {
    float& known = distance_m_[static_cast<std::size_t>(index)];
    if (!(static_cast<float>(distance_m) < known)) return;
    known = static_cast<float>(distance_m);
    heap_.emplace_back(known, index);
    std::push_heap(heap_.begin(), heap_.end(), later);
  };
  // The corners of the cell that contains the touched point, and their neighbours, are near enough for a
  // straight line.
  int first_row = row / grid.row_stride * grid.row_stride,
      first_column = column / grid.column_stride * grid.column_stride;
  for (int r = first_row, count_r = 0; r >= 0 && count_r < 2; r = grid.next_row(r, 1), ++count_r) {
    for (int c = first_column, count_c = 0; c >= 0 && count_c < 2; c = grid.next_column(c, 1), ++count_c) {
      reach(grid.index(r, c), (mapping.embedded_rest_m(grid.index(r, c)) - at.point_m).norm());
    }
  }
  while (!heap_.empty()) {
    const auto [distance, index] = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), later);
    heap_.pop_back();
    if (distance > distance_m_[static_cast<std::size_t>(index)]) continue;
    if (static_cast<double>(distance) > radius_m_) break;
    const int r = index / grid.columns, c = index % grid.columns;
    Sample sample{static_cast<double>(distance), mapping.embedded_rest_m(index), Vector3::Zero()};
    const Ring ring = grid.ring(r, c);
    for (std::size_t n = 0; n < ring.size(); ++n) {
      if (ring[n] < 0 || distance_m_[static_cast<std::size_t>(ring[n])] <= distance) continue;
      reach(ring[n], find_distance(mapping, index, ring, n));
    }
    sample.normal = unit_normal(mapping.rest(), samples.u.parameters[static_cast<std::size_t>(r)],
                                samples.v.parameters[static_cast<std::size_t>(c)]);
    region_.push_back(sample);
  }
}

// Returns the distance of the sample `to` from the start, through the triangles that it forms with `from`,
// whose distance has just been found, and with each sample beside both.
double LocalStroke::find_distance(const BodyMapping& mapping, int from, const Ring& ring,
                                  std::size_t at) const {
  const int to = ring[at];
  const Vector3 here = mapping.embedded_rest_m(to);
  const Vector3 to_from = mapping.embedded_rest_m(from) - here;
  const auto known = static_cast<double>(distance_m_[static_cast<std::size_t>(from)]);
  double least = known + to_from.norm();
  for (const std::size_t step : {std::size_t{1}, ring.size() - 1}) {
    const int beside = ring[(at + step) % ring.size()];
    if (beside < 0) continue;
    const float other = distance_m_[static_cast<std::size_t>(beside)];
    if (other == unreached) continue;
    least = std::min(least, march_over(known, static_cast<double>(other), to_from,
                                       mapping.embedded_rest_m(beside) - here));
  }
  return least;
}

double LocalStroke::find_thickness_m(const BodyState& state, const CoarseGrid& grid,
                                     const TouchedPoint& at) const {
  const BodyMapping& mapping = state.mapping();
  const int samples = grid.rows * grid.columns;
  const int stride = std::max(1, samples / samples_for_thickness);
  const double nearest_m = 0.01 * radius_m_;
  double least = std::numeric_limits<double>::infinity();
  for (int s = 0; s < samples; s += stride) {
    const Vector3 to = at.point_m - mapping.embedded_rest_m(s);
    const double inward = to.dot(at.normal), square = to.squaredNorm();
    // Samples beside the touched point, nearly in its tangent plane, say nothing about the thickness, and the
    // direction to one that coincides with it is rounding.
    if (square > nearest_m * nearest_m && inward > 0.1 * std::sqrt(square))
      least = std::min(least, square / inward);
  }
  return least;
}

// Finds the nodes that the stroke moves.
void LocalStroke::weigh_nodes(const BodyState& state, const TouchedPoint& at, double thickness_m) {
  constexpr double least_weight = 1e-3;
  const SpringLattice& lattice = state.lattice;
  const double depth_m = local_depth_fraction * thickness_m;
  const bool is_shell = state.shell_thickness_m > 0.0;
  const double farthest_m = radius_m_ + depth_m;
  nodes_.clear();
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.is_fixed(n) || lattice.mesh().joined(n) != n) continue;
    const Vector3& position = lattice.mesh().nodes[static_cast<std::size_t>(n)];
    if ((position - at.point_m).squaredNorm() > farthest_m * farthest_m) continue;
    const Sample* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const Sample& sample : region_) {
      const double square = (sample.point_m - position).squaredNorm();
      if (square < least) {
        least = square;
        nearest = &sample;
      }
    }
    if (nearest == nullptr) continue;
    const Vector3 from_sample = position - nearest->point_m;
    const double depth = is_shell ? 0.0 : std::max(0.0, -from_sample.dot(nearest->normal));
    const auto across = [&](const Vector3& vector) {
      return Vector3(vector - vector.dot(nearest->normal) * nearest->normal);
    };
    const Vector3 away = across(nearest->point_m - at.point_m);
    const double away_m = away.norm();
    // The sample is at its distance from the touched point in the direction away from it.
    const Vector3 to_sample =
        away_m > 0.0 ? Vector3(nearest->distance_m / away_m * away) : Vector3(Vector3::Zero());
    const double s = (to_sample + across(from_sample)).norm() / radius_m_;
    if (!(s < 1.0) || !(depth < depth_m)) continue;
    const double weight = (1.0 - s * s) * (1.0 - s * s) * (1.0 - depth / depth_m);
    if (weight > least_weight) nodes_.push_back({n, weight, 0.0});
  }
}

void LocalStroke::move(SpringLattice& lattice, const Vector3& move_m) {
  SPOONBILL_ASSERT(is_active());
  if (is_spent_) return;
  const Vector3 before_m = point_m(lattice);
  for (const WeighedNode& node : nodes_) lattice.reform(node.node, node.weight * move_m);
  record_move(lattice, before_m, share_ * move_m.norm());
}

void LocalStroke::press(SpringLattice& lattice, double deeper_m, double most_m) {
  SPOONBILL_ASSERT(is_active() && deeper_m >= 0.0 && most_m >= 0.0);
  if (is_spent_) return;
  const Vector3 before_m = point_m(lattice);
  pressed_m_ += deeper_m;
  for (WeighedNode& node : nodes_) {
    const double move_m = std::min(node.weight * pressed_m_ - node.pressed_m, most_m);
    if (move_m > 0.0 && lattice.reform(node.node, -move_m * touch_.normal)) node.pressed_m += move_m;
  }
  record_move(lattice, before_m, share_ * deeper_m);
}

// Adds a move of the touched point. The stroke is spent if it is much shorter than was asked.
void LocalStroke::record_move(const SpringLattice& lattice, const Vector3& before_m, double asked_m) {
  const Vector3 point_moved_m = point_m(lattice) - before_m;
  const double moved_m = point_moved_m.norm();
  moved_m_ += point_moved_m;
  elastic_m_ += moved_m;
  // If only nodes beside the touched point still moved, the surface would become uneven. Shorter moves are
  // lost in the rounding of displacements.
  constexpr double least_part = 0.5, least_move_m = 2e-7;
  is_spent_ = asked_m > least_move_m && moved_m < least_part * asked_m;
}

void LocalStroke::relax(double time_s) {
  elastic_m_ /= 1.0 + time_s / local_relaxation_s;
}

}  // namespace spoonbill
