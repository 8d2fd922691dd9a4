#include "engine/simulation/ground_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/simulation/body_contact.h"
#include "engine/simulation/sampled_ground_contact.h"

namespace spoonbill {
namespace {

// Number of times that elements are halved to get the samples of the heights.
constexpr int height_levels = 2;
constexpr double infinite = std::numeric_limits<double>::infinity();

// Returns how far the lowest point of a parabola through three points is below the middle point. Returns 0 if
// the lowest point is not between the outer points.
double dip(double before, double middle, double after, double step_before, double step_after) {
  const double rise_before = (middle - before) / step_before, rise_after = (after - middle) / step_after;
  const double steps = step_before + step_after;
  const double slope = (step_after * rise_before + step_before * rise_after) / steps;
  const double curvature = 2.0 * (rise_after - rise_before) / steps;
  if (!(curvature > 0.0) || !std::isfinite(curvature)) return 0.0;
  const double lowest_at = -slope / curvature;
  if (lowest_at < -step_before || lowest_at > step_after) return 0.0;
  return 0.5 * slope * slope / curvature;
}

}  // namespace

Result<SkinHeights> SkinHeights::make(const KnotVector& u, const KnotVector& v) {
  Result<NestedGrid> nested = make_nested_grid(u, v, height_levels);
  if (!nested.ok()) return nested.error();
  return SkinHeights(std::move(nested).value());
}

SkinHeights::SkinHeights(NestedGrid nested) : nested_(std::move(nested)) {
  const auto along_u = static_cast<std::size_t>(nested_.grid.u.values.columns);
  const auto along_v = static_cast<std::size_t>(nested_.grid.v.values.columns);
  control_.assign(along_u * along_v, 0.0);
  blended_.assign(along_v, 0.0);
  height_.assign(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(columns()), infinite);
}

bool SkinHeights::compute(const Surface& surface, const Vector3& point_m, const Vector3& normal,
                          double reach_m) {
  SPOONBILL_ASSERT_DEBUG(std::abs(normal.squaredNorm() - 1.0) < 1e-5);
  const ControlNet& net = surface.net;
  double lowest = infinite;
  for (std::size_t p = 0; p < control_.size(); ++p) {
    control_[p] = normal.dot(Vector3(net.x[p], net.y[p], net.z[p]) - point_m);
    lowest = std::min(lowest, control_[p]);
  }
  // The surface is within the convex hull of its control points.
  if (lowest > reach_m) return false;
  bool any = false;
  for (int row = 0; row < rows(); ++row) any |= compute_row(row, reach_m);
  return any;
}

bool SkinHeights::compute_row(int row, double reach_m) {
  const BlendingMatrix &along_u = nested_.grid.u.values, &along_v = nested_.grid.v.values;
  const auto blend = [](const BlendingMatrix& matrix, int at, const auto& of) {
    double sum = 0.0;
    for (int k = 0; k < matrix.bandwidth; ++k) {
      sum += matrix.values[static_cast<std::size_t>(at * matrix.bandwidth + k)] * of(matrix.column(at, k));
    }
    return sum;
  };
  double lowest = infinite;
  for (int c = 0; c < along_v.columns; ++c) {
    double& here = blended_[static_cast<std::size_t>(c)];
    here = blend(along_u, row,
                 [&](int r) { return control_[static_cast<std::size_t>(r * along_v.columns + c)]; });
    lowest = std::min(lowest, here);
  }
  double* const heights = height_.data() + static_cast<std::ptrdiff_t>(row) * columns();
  if (lowest > reach_m) {
    std::fill_n(heights, columns(), infinite);
    return false;
  }
  for (int j = 0; j < columns(); ++j) {
    heights[j] = blend(along_v, j, [&](int c) { return blended_[static_cast<std::size_t>(c)]; });
  }
  return true;
}

double SkinHeights::dip_along_u(int row, int column) const {
  const GridDirection& along = nested_.grid.u;
  const int last = rows() - 1;
  const bool closed = along.knots.is_periodic();
  if (!closed && (row == 0 || row == last)) return 0.0;
  // At a seam, the first and the last row coincide, and one neighbour of this row is on the other side of the
  // seam.
  const int before = row == 0 ? last - 1 : row - 1, after = row == last ? 1 : row + 1;
  const int end = row == 0 ? last : row, start = row == last ? 0 : row;
  return dip(height(before, column), height(row, column), height(after, column), u(end) - u(before),
             u(after) - u(start));
}

double SkinHeights::dip_along_v(int row, int column) const {
  const GridDirection& along = nested_.grid.v;
  const int last = columns() - 1;
  const bool closed = along.knots.is_periodic();
  if (!closed && (column == 0 || column == last)) return 0.0;
  const int before = column == 0 ? last - 1 : column - 1, after = column == last ? 1 : column + 1;
  const int end = column == 0 ? last : column, start = column == last ? 0 : column;
  return dip(height(row, before), height(row, column), height(row, after), v(end) - v(before),
             v(after) - v(start));
}

double SkinHeights::lowest_m(int row, int column) const {
  SPOONBILL_ASSERT_DEBUG(row >= 0 && row < rows() && column >= 0 && column < columns());
  const double here = height(row, column);
  if (here == infinite) return here;
  return here - dip_along_u(row, column) - dip_along_v(row, column);
}

namespace {

// Gap in lattice cells that is added to the movement of a tick when contacts are searched.
constexpr double ground_margin_cells = 0.25;

// Time constant of the filter on a footing's skin height (Footing::skin_m), for an inertia scale of 1. It is
// longer than the time in which a round body rolls over. Without the filter a node would push its neighbours'
// skin at once, and round bodies would roll for ever.
constexpr double skin_time_constant_s = 0.07;
// The same for a stiff body, whose nodes hardly push its skin. It tips over within the longer time.
constexpr double stiff_skin_time_constant_s = 0.02;

// Bodies with a larger inertia scale respond more slowly.
double find_skin_constant_s(const SpringLattice& lattice) {
  const double constant_s = lattice.moved_by_solver() ? stiff_skin_time_constant_s : skin_time_constant_s;
  return constant_s * std::sqrt(lattice.inertia_scale());
}

bool on_shell(const LatticeMesh& mesh, int node) {
  const std::array<int, 3> at = mesh.grid_index(node);
  return mesh.node_location(at[0], at[1], at[2]) == NodeLocation::on_shell;
}

// Returns the node with the largest weight in a sample among those that the filter accepts; -1 if the filter
// accepts no node.
template <class Filter>
int find_heaviest_node(const EmbeddedPoint& sample, const Filter& accepts) {
  int node = -1;
  float largest = 0.0f;
  for (int i = 0; i < sample.count; ++i) {
    if (!(sample.weight[i] > largest) || !accepts(sample.node[i])) continue;
    largest = sample.weight[i];
    node = sample.node[i];
  }
  return node;
}

// Returns the node to which a sample is attached: of its nodes on the lattice's outer shell, the one with the
// largest weight. In a box of cells, a sample without nodes on that shell is attached to its node with the
// largest weight. Returns -1 if there is no such node.
int find_footing_node(const LatticeMesh& mesh, const EmbeddedPoint& sample) {
  const int node = find_heaviest_node(sample, [&](int candidate) { return on_shell(mesh, candidate); });
  return node < 0 && is_boxed(mesh) ? find_heaviest_node(sample, [](int) { return true; }) : node;
}

int find_nearest(const std::vector<double>& parameters, double parameter) {
  const auto after = std::lower_bound(parameters.begin(), parameters.end() - 1, parameter);
  const bool before = after != parameters.begin() && parameter - *(after - 1) < *after - parameter;
  return static_cast<int>(after - parameters.begin()) - (before ? 1 : 0);
}

int count_nodes(std::span<const BodyState> bodies) {
  int nodes = 0;
  for (const BodyState& body : bodies) nodes += body.lattice.mesh().node_count();
  return nodes;
}

}  // namespace

bool is_boxed(const LatticeMesh& mesh) {
  return !mesh.along.empty();
}

double find_ground_margin_m(const BodyState& body, const Vector3& gravity_m_per_s2, double time_s) {
  const double fall_m = time_s * time_s * gravity_m_per_s2.norm();
  return contact_margin_cells * static_cast<double>(body.lattice.cell_size_m()) +
         2.0 * (time_s * body.fastest_m_per_s() + fall_m);
}

BodyGroundContact::BodyGroundContact(std::span<const BodyState> bodies) : contacts_(count_nodes(bodies)) {
  for (const BodyState& body : bodies) bodies_.push_back(make_footings(body));
}

std::vector<BodyGroundContact::AttachedSamples> BodyGroundContact::attach_samples(
    const BodyState& body, const SkinHeights& heights) {
  const LatticeMesh& mesh = body.lattice.mesh();
  std::vector<AttachedSamples> result(mesh.nodes.size());
  const Grid& grid = body.mapping().nested().grid;
  for (int s = 0; s < grid.rows() * grid.columns(); ++s) {
    const int node = find_footing_node(mesh, body.mapping().sample(s));
    if (node >= 0) result[static_cast<std::size_t>(mesh.joined(node))].followed.push_back(s);
  }
  for (int i = 0; i < heights.rows(); ++i) {
    for (int j = 0; j < heights.columns(); ++j) {
      const int node = find_footing_node(mesh, body.mapping().at(heights.u(i), heights.v(j)));
      if (node >= 0) result[static_cast<std::size_t>(mesh.joined(node))].skin.push_back({i, j});
    }
  }
  if (!is_boxed(mesh)) return result;
  for (AttachedSamples& on_node : result) {
    if (!on_node.followed.empty()) continue;
    for (const Sample& at : on_node.skin) {
      const int row = find_nearest(grid.u.parameters, heights.u(at.row));
      on_node.followed.push_back(row * grid.columns() +
                                 find_nearest(grid.v.parameters, heights.v(at.column)));
    }
  }
  return result;
}

BodyGroundContact::BodyFootings BodyGroundContact::make_footings(const BodyState& body) {
  if (body.rigid) return {};
  const LatticeMesh& mesh = body.lattice.mesh();
  const Surface& skin = body.mapping().current();
  // make() cannot fail, because the mapping already has a grid of these knots.
  BodyFootings result{
      SkinHeights::make(skin.u, skin.v).value(), static_cast<double>(body.lattice.cell_size_m()), {}, {}, {}};
  const std::vector<AttachedSamples> attached = attach_samples(body, *result.heights);
  const bool boxed = is_boxed(mesh);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const AttachedSamples& on_node = attached[static_cast<std::size_t>(n)];
    if (boxed ? on_node.followed.empty() : !on_shell(mesh, n) || mesh.joined(n) != n) continue;
    Footing& footing = result.footings.emplace_back();
    footing.node = n;
    footing.first = static_cast<int>(result.samples.size());
    footing.count = static_cast<int>(on_node.skin.size());
    footing.first_followed = static_cast<int>(result.followed.size());
    footing.followed_count = static_cast<int>(on_node.followed.size());
    result.samples.insert(result.samples.end(), on_node.skin.begin(), on_node.skin.end());
    result.followed.insert(result.followed.end(), on_node.followed.begin(), on_node.followed.end());
    for (const int s : on_node.followed) {
      const Vector3 sample_m = body.mapping().sample(s).rest_m(body.lattice);
      const double distance_m = (sample_m - mesh.nodes[static_cast<std::size_t>(n)]).norm();
      if (boxed) result.max_sample_distance_m = std::max(result.max_sample_distance_m, distance_m);
    }
  }
  return result;
}

void BodyGroundContact::find(std::span<const BodyState> bodies, const Ground& ground,
                             const Sculpting& sculpting, double time_s) {
  SPOONBILL_ASSERT(bodies.size() == bodies_.size());
  SPOONBILL_ASSERT(time_s > 0.0);
  contacts_.begin(ground.normal, time_s);
  const double fall_m = time_s * time_s * sculpting.gravity_m_per_s2.norm();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyState& body = bodies[b];
    if (has_sampled_ground_contact(body, sculpting.real_time)) {
      for (Footing& footing : bodies_[b].footings) footing.is_near = false;
      continue;
    }
    double fastest = 0.0;
    for (const Footing& footing : bodies_[b].footings) {
      fastest = std::max(fastest, -ground.normal.dot(body.lattice.velocity(footing.node)));
    }
    const double margin_m = ground_margin_cells * static_cast<double>(body.lattice.cell_size_m());
    find(static_cast<int>(b), body, ground, fastest * time_s + fall_m + margin_m, time_s);
  }
}

void BodyGroundContact::update_skin_offset(const BodyFootings& footings, double followed_m, double time_s,
                                           double constant_s, Footing& footing) const {
  double skin_m = std::numeric_limits<double>::infinity();
  for (int s = footing.first; s < footing.first + footing.count; ++s) {
    const Sample& sample = footings.samples[static_cast<std::size_t>(s)];
    skin_m = std::min(skin_m, footings.heights->lowest_m(sample.row, sample.column));
  }
  if (!std::isfinite(skin_m)) skin_m = followed_m;
  const double fraction = footing.is_near ? time_s / (constant_s + time_s) : 1.0;
  footing.skin_m += fraction * (skin_m - followed_m - footing.skin_m);
}

void BodyGroundContact::forget() {
  contacts_.forget();
  for (BodyFootings& body : bodies_) {
    for (Footing& footing : body.footings) footing.is_near = false;
  }
}

void BodyGroundContact::find(int index, const BodyState& body, const Ground& ground, double reach_m,
                             double time_s) {
  BodyFootings& footings = bodies_[static_cast<std::size_t>(index)];
  if (footings.footings.empty()) return;  // a rigid body
  const double look_m = reach_m + footings.max_sample_distance_m;
  // A shell's nodes are on its faces, so its skin needs no correction.
  const bool thin = body.lattice.mesh().thin, boxed = is_boxed(body.lattice.mesh());
  if (!thin && !footings.heights->compute(body.mapping().current(), ground.point_m, ground.normal, look_m)) {
    for (Footing& footing : footings.footings) footing.is_near = false;
    return;
  }
  for (Footing& footing : footings.footings) {
    double gap_m = ground.normal.dot(body.lattice.position(footing.node) - ground.point_m);
    if (gap_m > look_m) {
      footing.is_near = false;
      continue;
    }
    // A node of a boxed body may be outside the body's skin, so only the samples count.
    if (boxed) gap_m = std::numeric_limits<double>::infinity();
    for (int s = footing.first_followed; s < footing.first_followed + footing.followed_count; ++s) {
      const EmbeddedPoint& sample = body.mapping().sample(footings.followed[static_cast<std::size_t>(s)]);
      gap_m = std::min(gap_m, ground.normal.dot(sample.position_m(body.lattice) - ground.point_m));
    }
    if (!thin) update_skin_offset(footings, gap_m, time_s, find_skin_constant_s(body.lattice), footing);
    footing.is_near = true;
    gap_m += footing.skin_m;
    if (gap_m > reach_m) continue;
    const double friction = std::min(ground.friction, body.lattice.friction(footing.node));
    contacts_.add(index, body.lattice, footing.node, gap_m, friction);
  }
}

}  // namespace spoonbill
