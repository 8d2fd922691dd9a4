#include "engine/simulation/on_ground.h"

#include <algorithm>

namespace spoonbill {
namespace {

// Beyond what a tick moves, in lattice cells.
constexpr double margin_cells = 0.25;

bool on_shell(const LatticeMesh& mesh, int node) {
  const std::array<int, 3> at = mesh.place(node);
  return mesh.place_of(at[0], at[1], at[2]) == NodePlace::on_shell;
}

// The node on the shell that has most of a sample; -1 where none has any.
int node_of(const LatticeMesh& mesh, const EmbeddedPoint& sample) {
  int node = -1;
  float most = 0.0f;
  for (int i = 0; i < sample.count; ++i) {
    if (!(sample.weight[i] > most) || !on_shell(mesh, sample.node[i])) continue;
    most = sample.weight[i];
    node = sample.node[i];
  }
  return node;
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
  for (const BodyState& body : bodies) {
    BodyFootings& of_body = bodies_.emplace_back();
    const LatticeMesh& mesh = body.lattice.mesh();
    const Grid& grid = body.mapping().nested().grid;
    std::vector<std::vector<int>> hanging(mesh.nodes.size());
    for (int s = 0; s < grid.rows() * grid.columns(); ++s) {
      const int node = node_of(mesh, body.mapping().sample(s));
      if (node >= 0) hanging[static_cast<std::size_t>(node)].push_back(s);
    }
    for (int n = 0; n < mesh.node_count(); ++n) {
      const std::vector<int>& samples = hanging[static_cast<std::size_t>(n)];
      if (!on_shell(mesh, n) || mesh.joined(n) != n) continue;
      of_body.footings.push_back(
          {n, static_cast<int>(of_body.samples.size()), static_cast<int>(samples.size())});
      of_body.samples.insert(of_body.samples.end(), samples.begin(), samples.end());
    }
  }
}

void OnGround::find(std::span<const BodyState> bodies, const Ground& ground, const Vector3& gravity_m_per_s2,
                    double time_s) {
  contacts_.begin(ground.normal, time_s);
  const double fall_m = time_s * time_s * gravity_m_per_s2.norm();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyState& body = bodies[b];
    double fastest = 0.0;
    for (const Footing& footing : bodies_[b].footings) {
      fastest = std::max(fastest, -ground.normal.dot(body.lattice.velocity(footing.node)));
    }
    const double margin_m = margin_cells * static_cast<double>(body.lattice.cell_size_m());
    find(static_cast<int>(b), body, ground, fastest * time_s + fall_m + margin_m);
  }
}

void OnGround::find(int number, const BodyState& body, const Ground& ground, double reach_m) {
  const BodyFootings& of_body = bodies_[static_cast<std::size_t>(number)];
  const double cell_m = static_cast<double>(body.lattice.cell_size_m());
  for (const Footing& footing : of_body.footings) {
    double gap_m = ground.normal.dot(body.lattice.position(footing.node) - ground.point_m);
    if (gap_m > reach_m + cell_m) continue;
    for (int s = footing.first; s < footing.first + footing.count; ++s) {
      const EmbeddedPoint& sample = body.mapping().sample(of_body.samples[static_cast<std::size_t>(s)]);
      gap_m = std::min(gap_m, ground.normal.dot(place_of(body.lattice, sample) - ground.point_m));
    }
    if (gap_m > reach_m) continue;
    const double friction = std::min(ground.friction, body.lattice.friction(footing.node));
    contacts_.add(number, body.lattice, footing.node, gap_m, friction);
  }
}

}  // namespace spoonbill
