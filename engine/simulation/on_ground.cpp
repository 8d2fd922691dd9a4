#include "engine/simulation/on_ground.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Beyond what a tick moves, in lattice cells.
constexpr double margin_cells = 0.25;

// How fast a node learns how high its skin is. Slower than a body rolls about: a node that the skin pushed at
// once would push the skin of its neighbours, and so set round bodies rolling for ever.
constexpr double skin_memory_s = 0.3;

bool on_shell(const LatticeMesh& mesh, int node) {
  const std::array<int, 3> at = mesh.place(node);
  return mesh.place_of(at[0], at[1], at[2]) == NodePlace::on_shell;
}

// Whether the body lies in a box of cells, whose nodes are beside its skin, not on it.
bool is_boxed(const LatticeMesh& mesh) {
  return !mesh.along.empty();
}

// The node that has most of a sample, of those that `may` have any; -1 where none has.
template <class May>
int most_of(const EmbeddedPoint& sample, const May& may) {
  int node = -1;
  float most = 0.0f;
  for (int i = 0; i < sample.count; ++i) {
    if (!(sample.weight[i] > most) || !may(sample.node[i])) continue;
    most = sample.weight[i];
    node = sample.node[i];
  }
  return node;
}

// One on the shell; in a box, where all of a sample's are within, any.
int node_of(const LatticeMesh& mesh, const EmbeddedPoint& sample) {
  const int node = most_of(sample, [&](int of) { return on_shell(mesh, of); });
  return node < 0 && is_boxed(mesh) ? most_of(sample, [](int) { return true; }) : node;
}

int nearest_to(const std::vector<double>& parameters, double parameter) {
  const auto after = std::lower_bound(parameters.begin(), parameters.end() - 1, parameter);
  const bool before = after != parameters.begin() && parameter - *(after - 1) < *after - parameter;
  return static_cast<int>(after - parameters.begin()) - (before ? 1 : 0);
}

Vector3 place_of(const SpringLattice& lattice, const EmbeddedPoint& sample) {
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < sample.count; ++i) {
    sum += static_cast<double>(sample.weight[i]) * lattice.position(sample.node[i]);
  }
  return sum;
}

int capacity_for(std::span<const BodyState> bodies) {
  int nodes = 0;
  for (const BodyState& body : bodies) nodes += body.lattice.mesh().node_count();
  return nodes;
}

}  // namespace

OnGround::OnGround(std::span<const BodyState> bodies) : contacts_(capacity_for(bodies)) {
  for (const BodyState& body : bodies) bodies_.push_back(footings_of(body));
}

std::vector<OnGround::Hung> OnGround::hung_on_nodes(const BodyState& body, const SkinHeights& heights) {
  const LatticeMesh& mesh = body.lattice.mesh();
  std::vector<Hung> result(mesh.nodes.size());
  const Grid& grid = body.mapping().nested().grid;
  for (int s = 0; s < grid.rows() * grid.columns(); ++s) {
    const int node = node_of(mesh, body.mapping().sample(s));
    if (node >= 0) result[static_cast<std::size_t>(mesh.joined(node))].followed.push_back(s);
  }
  for (int i = 0; i < heights.rows(); ++i) {
    for (int j = 0; j < heights.columns(); ++j) {
      const int node = node_of(mesh, body.mapping().at(heights.u(i), heights.v(j)));
      if (node >= 0) result[static_cast<std::size_t>(mesh.joined(node))].skin.push_back({i, j});
    }
  }
  if (!is_boxed(mesh)) return result;
  for (Hung& on_node : result) {
    if (!on_node.followed.empty()) continue;
    for (const Sample& at : on_node.skin) {
      const int row = nearest_to(grid.u.parameters, heights.u(at.row));
      on_node.followed.push_back(row * grid.columns() + nearest_to(grid.v.parameters, heights.v(at.column)));
    }
  }
  return result;
}

OnGround::BodyFootings OnGround::footings_of(const BodyState& body) {
  const LatticeMesh& mesh = body.lattice.mesh();
  const Surface& skin = body.mapping().current();
  // The mapping has a grid of these knots, and so have the heights.
  BodyFootings of_body{
      SkinHeights::make(skin.u, skin.v).value(), static_cast<double>(body.lattice.cell_size_m()), {}, {}, {}};
  const std::vector<Hung> hung = hung_on_nodes(body, of_body.heights);
  const bool boxed = is_boxed(mesh);
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Hung& on_node = hung[static_cast<std::size_t>(n)];
    if (boxed ? on_node.followed.empty() : !on_shell(mesh, n) || mesh.joined(n) != n) continue;
    Footing& footing = of_body.footings.emplace_back();
    footing.node = n;
    footing.first = static_cast<int>(of_body.samples.size());
    footing.count = static_cast<int>(on_node.skin.size());
    footing.first_followed = static_cast<int>(of_body.followed.size());
    footing.followed_count = static_cast<int>(on_node.followed.size());
    of_body.samples.insert(of_body.samples.end(), on_node.skin.begin(), on_node.skin.end());
    of_body.followed.insert(of_body.followed.end(), on_node.followed.begin(), on_node.followed.end());
    for (const int s : on_node.followed) {
      const Vector3 sample_m = body.mapping().sample(s).rest_m(body.lattice);
      const double away_m = (sample_m - mesh.nodes[static_cast<std::size_t>(n)]).norm();
      if (boxed) of_body.hang_m = std::max(of_body.hang_m, away_m);
    }
  }
  return of_body;
}

void OnGround::find(std::span<const BodyState> bodies, const Ground& ground, const Vector3& gravity_m_per_s2,
                    double time_s) {
  SPOONBILL_ASSERT(bodies.size() == bodies_.size());
  SPOONBILL_ASSERT(time_s > 0.0);
  contacts_.begin(ground.normal, time_s);
  const double fall_m = time_s * time_s * gravity_m_per_s2.norm();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyState& body = bodies[b];
    double fastest = 0.0;
    for (const Footing& footing : bodies_[b].footings) {
      fastest = std::max(fastest, -ground.normal.dot(body.lattice.velocity(footing.node)));
    }
    const double margin_m = margin_cells * static_cast<double>(body.lattice.cell_size_m());
    find(static_cast<int>(b), body, ground, fastest * time_s + fall_m + margin_m, time_s);
  }
}

void OnGround::take_skin(const BodyFootings& of_body, double followed_m, double time_s,
                         Footing& footing) const {
  double skin_m = std::numeric_limits<double>::infinity();
  for (int s = footing.first; s < footing.first + footing.count; ++s) {
    const Sample& sample = of_body.samples[static_cast<std::size_t>(s)];
    skin_m = std::min(skin_m, of_body.heights.lowest_m(sample.row, sample.column));
  }
  if (!std::isfinite(skin_m)) skin_m = followed_m;
  const double share = footing.is_near ? time_s / (skin_memory_s + time_s) : 1.0;
  footing.skin_m += share * (skin_m - followed_m - footing.skin_m);
}

void OnGround::find(int number, const BodyState& body, const Ground& ground, double reach_m, double time_s) {
  BodyFootings& of_body = bodies_[static_cast<std::size_t>(number)];
  const double look_m = reach_m + of_body.hang_m;
  // Of a shell the skin is the middle, and the nodes are where its faces are.
  const bool thin = body.lattice.mesh().thin, boxed = is_boxed(body.lattice.mesh());
  if (!thin && !of_body.heights.take(body.mapping().current(), ground.point_m, ground.normal, look_m)) {
    for (Footing& footing : of_body.footings) footing.is_near = false;
    return;
  }
  for (Footing& footing : of_body.footings) {
    double gap_m = ground.normal.dot(body.lattice.position(footing.node) - ground.point_m);
    if (gap_m > look_m) {
      footing.is_near = false;
      continue;
    }
    // A corner of a cell may stand out of the skin, and is no part of the body.
    if (boxed) gap_m = std::numeric_limits<double>::infinity();
    for (int s = footing.first_followed; s < footing.first_followed + footing.followed_count; ++s) {
      const EmbeddedPoint& sample = body.mapping().sample(of_body.followed[static_cast<std::size_t>(s)]);
      gap_m = std::min(gap_m, ground.normal.dot(place_of(body.lattice, sample) - ground.point_m));
    }
    if (!thin) take_skin(of_body, gap_m, time_s, footing);
    footing.is_near = true;
    gap_m += footing.skin_m;
    if (gap_m > reach_m) continue;
    const double friction = std::min(ground.friction, body.lattice.friction(footing.node));
    contacts_.add(number, body.lattice, footing.node, gap_m, friction);
  }
}

}  // namespace spoonbill
