#include "engine/material/implicit/implicit_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/material/implicit/implicit_body.h"
#include "engine/material/lattice/lattice_mesh.h"
#include "engine/material/lattice/layer_volumes.h"

namespace spoonbill {
namespace {

// Largest number of entries in the band of the matrix. Each solve multiplies every entry twice, and a tick
// needs about five solves.
constexpr double max_band = 1.3e5;
constexpr int min_budget = 30;
// Largest work of the contacts' impulses at the end of a step, relative to the assumed one. A contact that
// stops a velocity v with an assumed inverse mass w leaves (1 - W / w) v if the inverse mass is W: beyond 2
// w, the body would rebound faster than it came.
constexpr double largest_response = 2.0;
// Inverse mass in contacts, relative to that of the whole body: the value before the first contact, and the
// largest value.
constexpr double initial_lightness = 8.0, max_lightness = 1e5;

// Returns the mean extents of a lattice along i, j and k, m.
Vector3 extents(const LatticeMesh& mesh, const std::vector<Vector3>& nodes) {
  Vector3 size = Vector3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0.0;
    int lines = 0;
    for (int n = 0; n < mesh.node_count(); ++n) {
      std::array<int, 3> next = mesh.grid_index(n);
      if (next[static_cast<std::size_t>(axis)] == 0) ++lines;
      if (++next[static_cast<std::size_t>(axis)] == mesh.count[static_cast<std::size_t>(axis)]) continue;
      const int beyond = mesh.index(next[0], next[1], next[2]);
      sum += (nodes[static_cast<std::size_t>(beyond)] - nodes[static_cast<std::size_t>(n)]).norm();
    }
    size[axis] = sum / lines;
  }
  return size;
}

// Returns the number of entries in the band of the matrix.
double band_size(const LatticeMesh& block) {
  return 9.0 * block.node_count() * (node_reach(block) + 1);
}

Vector3 applied_force_n(const SpringLattice& lattice, int node) {
  return {lattice.applied_force(0)[node], lattice.applied_force(1)[node], lattice.applied_force(2)[node]};
}

// Chooses node counts that do not exceed the counts of the lattice. Reduces the node budget until the band
// has at most max_band entries or the budget is below min_budget.
Result<LatticeMesh> choose_coarse_counts(const LatticeMesh& mesh, const Vector3& size_m) {
  LatticeMesh block;
  block.closed = mesh.closed;
  block.thin = mesh.thin;
  for (int budget = implicit_node_budget;; budget = budget * 4 / 5) {
    const LatticeRequest request{budget, std::nullopt};
    Result<std::array<int, 3>> counts =
        mesh.thin ? shell_counts(request, size_m, mesh.closed) : lattice_counts(request, size_m);
    if (!counts.ok()) return counts.error();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      block.count[axis] = std::min(counts.value()[axis], mesh.count[axis]);
    }
    if (band_size(block) <= max_band || budget < min_budget) return block;
  }
}

// Returns the fraction of a coarse cell that belongs to the body, from the overlapping cells of the lattice.
// Cells of a box are congruent, so the body's mass is conserved.
double overlapped_fraction(const LatticeMesh& mesh, const std::array<std::vector<Overlap>, 3>& overlaps) {
  double fraction = 0.0;
  for (const Overlap& k : overlaps[2]) {
    for (const Overlap& i : overlaps[0]) {
      for (const Overlap& j : overlaps[1]) {
        fraction += i.fraction() * j.fraction() * k.fraction() * mesh.cell_fraction(i.cell, j.cell, k.cell);
      }
    }
  }
  return fraction;
}

void set_box_fractions(const LatticeMesh& mesh, LatticeMesh& coarse) {
  const auto overlaps = [&](std::size_t axis, int cell) {
    return find_overlaps(cell, coarse.count[axis], mesh.count[axis]);
  };
  coarse.cell_fractions.assign(coarse.cell_count(), 0.0);
  for (int k = 0; k + 1 < coarse.count[2]; ++k) {
    for (int i = 0; i + 1 < coarse.count[0]; ++i) {
      for (int j = 0; j + 1 < coarse.count[1]; ++j) {
        coarse.cell_fractions[coarse.cell_index(i, j, k)] =
            overlapped_fraction(mesh, {overlaps(0, i), overlaps(1, j), overlaps(2, k)});
      }
    }
  }
}

Result<LatticeMesh> make_coarse_mesh(const LatticeMesh& mesh, const std::vector<Vector3>& nodes) {
  Result<LatticeMesh> block = choose_coarse_counts(mesh, extents(mesh, nodes));
  if (!block.ok()) return block;
  LatticeMesh coarse = std::move(block).value();
  coarse.nodes.assign(static_cast<std::size_t>(coarse.node_count()), Vector3::Zero());
  for (int n = 0; n < coarse.node_count(); ++n) {
    const GridPoint at = embed_node(coarse, n, mesh);
    for (std::size_t c = 0; c < 8; ++c) {
      coarse.nodes[static_cast<std::size_t>(n)] += at.weight[c] * nodes[static_cast<std::size_t>(at.node[c])];
    }
  }
  if (!mesh.filled.empty()) {
    set_box_fractions(mesh, coarse);
  } else {
    // Restores the volume that the longer chords of the coarse mesh lose where the body is bent or round.
    scale_layers_to(redistribute_layers(layer_volumes_m3(mesh), coarse.count[2] - 1), coarse);
  }
  return coarse;
}

}  // namespace

ImplicitSolver::ImplicitSolver(ImplicitBody body, int nodes, double mass_kg)
    : body_(std::move(body)),
      velocity_(static_cast<std::size_t>(nodes)),
      known_(3 * static_cast<std::size_t>(body_.node_count()), 0.0),
      impulse_(3 * static_cast<std::size_t>(body_.node_count()), 0.0),
      ground_contacts_(nodes, mass_kg),
      contact_inverse_mass_(initial_lightness / mass_kg),
      min_inverse_mass_(1.0 / mass_kg) {}

Result<ImplicitSolver> ImplicitSolver::make(const LatticeMesh& mesh, const std::vector<Vector3>& rest_m,
                                            const LatticeMaterials& materials, InstructionSet set) {
  const Result<LatticeMesh> coarse = make_coarse_mesh(mesh, rest_m);
  if (!coarse.ok()) return coarse.error();
  Result<ImplicitBody> body =
      ImplicitBody::make(coarse.value(), make_block_materials(materials, mesh.count, coarse->count), set);
  if (!body.ok()) return body.error();
  double mass_kg = 0.0;
  for (int n = 0; n < coarse->node_count(); ++n) mass_kg += body->mass_kg(n);
  ImplicitSolver solver(std::move(body).value(), mesh.node_count(), mass_kg);
  solver.rest_m_ = solver.first_rest_m_ = rest_m;
  for (int n = 0; n < mesh.node_count(); ++n) {
    solver.by_index_.push_back(embed_node(mesh, n, coarse.value()));
    solver.followers_.push_back(solver.by_index_.back());
    place_exactly(rest_m[static_cast<std::size_t>(n)], coarse->nodes, solver.followers_.back());
  }
  for (int n = 0; n < coarse->node_count(); ++n) {
    const GridPoint at = embed_node(coarse.value(), n, mesh);
    solver.nearest_.push_back(static_cast<int>(find_heaviest_node(at)));
  }
  solver.fixing_node_.assign(solver.nearest_.size(), -1);
  return solver;
}

void ImplicitSolver::set_inertia_scale(double scale) {
  body_.set_inertia_scale(scale);
  const double factor = scale / inertia_scale_;
  inertia_scale_ = scale;
  ground_contacts_.scale_inertia(factor);
  contact_inverse_mass_ /= factor;
  min_inverse_mass_ /= factor;
}

void ImplicitSolver::fix_nodes(std::span<const std::uint8_t> fixed) {
  SPOONBILL_ASSERT(fixed.size() == followers_.size());
  for (std::size_t b = 0; b < nearest_.size(); ++b) {
    fixing_node_[b] = fixed[static_cast<std::size_t>(nearest_[b])] != 0 ? nearest_[b] : -1;
  }
  for (std::size_t n = 0; n < fixed.size(); ++n) {
    if (fixed[n] == 0 || follows_fixed(by_index_[n])) continue;
    fixing_node_[find_heaviest_node(by_index_[n])] = static_cast<int>(n);
  }
  std::vector<std::uint8_t> block_fixed;
  block_fixed.reserve(fixing_node_.size());
  for (const int node : fixing_node_) block_fixed.push_back(node >= 0 ? 1 : 0);
  body_.fix_nodes(block_fixed);
}

bool ImplicitSolver::follows_fixed(const GridPoint& follower) const {
  for (std::size_t c = 0; c < 8; ++c) {
    if (follower.weight[c] > 0.0 && fixing_node_[static_cast<std::size_t>(follower.node[c])] >= 0)
      return true;
  }
  return false;
}

void ImplicitSolver::adopt_shape(const SpringLattice& lattice) {
  for (int n = 0; n < body_.node_count(); ++n) {
    const GridPoint at = embed_node(body_.mesh(), n, lattice.mesh());
    Vector3 position = Vector3::Zero(), velocity = Vector3::Zero();
    for (std::size_t c = 0; c < 8; ++c) {
      // Permanent moves of nodes do not move the block.
      const auto node = static_cast<std::size_t>(at.node[c]);
      position += at.weight[c] * (lattice.position(at.node[c]) - (rest_m_[node] - first_rest_m_[node]));
      velocity += at.weight[c] * lattice.velocity(at.node[c]);
    }
    body_.set_displacement(n, position - body_.mesh().nodes[static_cast<std::size_t>(n)]);
    body_.set_velocity(n, velocity);
  }
}

void ImplicitSolver::restore_rest(std::span<const Vector3> rest_m) {
  SPOONBILL_ASSERT(rest_m.size() == rest_m_.size());
  std::copy(rest_m.begin(), rest_m.end(), rest_m_.begin());
}

void ImplicitSolver::adopt_moved_nodes(const SpringLattice& lattice) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    if (lattice.is_fixed(n)) continue;
    rest_m_[at] =
        lattice.position(n) - followers_[at].sum_over([&](int node) { return body_.displacement(node); });
  }
}

void ImplicitSolver::set_node_forces(const SpringLattice& lattice, std::span<const int> nodes) {
  body_.clear_node_forces();
  for (const int n : nodes) {
    if (lattice.is_fixed(n)) continue;
    const Vector3 force_n = applied_force_n(lattice, n);
    const GridPoint& follower = followers_[static_cast<std::size_t>(n)];
    for (std::size_t c = 0; c < 8; ++c) body_.add_node_force(follower.node[c], follower.weight[c] * force_n);
  }
}

void ImplicitSolver::move_fixed(std::span<const int> nodes, const Vector3& velocity_m_per_s) {
  SPOONBILL_ASSERT_DEBUG(std::is_sorted(nodes.begin(), nodes.end()));
  for (int n = 0; n < body_.node_count(); ++n) {
    if (is_fixed_by(n, nodes)) body_.move_fixed(n, velocity_m_per_s);
  }
}

bool ImplicitSolver::is_fixed_by(int node, std::span<const int> nodes) const {
  return std::binary_search(nodes.begin(), nodes.end(), fixing_node_[static_cast<std::size_t>(node)]);
}

Vector3 ImplicitSolver::force_on_fixed(const SpringLattice& lattice, std::span<const int> nodes,
                                       const Vector3& gravity_m_per_s2) const {
  Vector3 sum = Vector3::Zero();
  for (int n = 0; n < body_.node_count(); ++n) {
    if (mesh().joined(n) != n || !is_fixed_by(n, nodes)) continue;
    sum += body_.force_on_fixed(n) + body_.mass_kg(n) * gravity_m_per_s2;
  }
  for (const int n : nodes) sum += applied_force_n(lattice, n);
  return sum;
}

void ImplicitSolver::add_known_impulse(const SpringLattice& lattice, int node, const Vector3& impulse_ns) {
  if (lattice.is_fixed(node)) return;
  followers_[static_cast<std::size_t>(node)].spread(impulse_ns, known_);
}

ImplicitReport ImplicitSolver::begin_step(const ImplicitStep& step, SpringLattice& lattice,
                                          std::span<GroundContact> on_ground) {
  SPOONBILL_ASSERT(step.step_s > 0.0);
  step_s_ = step.step_s;
  ground_contacts_.restore_last_impulses(on_ground, followers_, step_s_, known_);
  const ImplicitReport report = body_.solve_velocities(step, known_);
  std::fill(known_.begin(), known_.end(), 0.0);
  write_velocities(lattice);
  return report;
}

void ImplicitSolver::write_velocities(SpringLattice& lattice) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.is_fixed(n)) continue;
    const auto at = static_cast<std::size_t>(n);
    lattice.set_velocity(n, followers_[at].sum_over([&](int node) { return body_.velocity(node); }));
    const Vector3 rounded = lattice.velocity(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      velocity_[at][axis] = static_cast<float>(rounded[static_cast<Eigen::Index>(axis)]);
    }
  }
}

// Collects in `impulse_` the contact impulses since the last response, from the velocity changes of the
// lattice's nodes. Returns the sum of the squares of the nodal impulses.
double ImplicitSolver::collect_impulses(const SpringLattice& lattice) {
  std::fill(impulse_.begin(), impulse_.end(), 0.0);
  double squares = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.is_fixed(n) || lattice.mesh().joined(n) != n) continue;
    const auto at = static_cast<std::size_t>(n);
    const Vector3 before(velocity_[at][0], velocity_[at][1], velocity_[at][2]);
    const Vector3 impulse = (lattice.velocity(n) - before) / contact_inverse_mass_;
    if (impulse.isZero(0.0)) continue;
    squares += impulse.squaredNorm();
    followers_[at].spread(impulse, impulse_);
  }
  return squares;
}

ImplicitSolver::ContactResponse ImplicitSolver::find_response(const SpringLattice& lattice) {
  const double squares = collect_impulses(lattice);
  if (!(squares > 0.0)) return {};
  const double work = body_.respond_to(impulse_);
  if (measured_inverse_mass_ == 0.0) measured_inverse_mass_ = work / squares;
  return {contact_inverse_mass_ * squares, work};
}

void ImplicitSolver::respond(double fraction, SpringLattice& lattice) {
  body_.apply_response(fraction);
  write_velocities(lattice);
}

// Updates the inverse mass in contacts to the geometric mean of its old value and the measured one, so that
// two bodies that adapt to each other converge.
void ImplicitSolver::update_contact_mass(SpringLattice& lattice) {
  const double measured = std::exchange(measured_inverse_mass_, 0.0);
  if (measured == 0.0 || !std::isfinite(measured)) return;
  const double target = std::clamp(measured, min_inverse_mass_, max_lightness * min_inverse_mass_);
  contact_inverse_mass_ = std::sqrt(contact_inverse_mass_ * target);
  lattice.set_contact_inverse_mass(contact_inverse_mass_);
}

double ImplicitSolver::respond_to_pairs(double assumed_work_of_pairs_j, SpringLattice& lattice) {
  const ContactResponse response = find_response(lattice);
  const double other_j = std::max(0.0, assumed_work_of_pairs_j - response.assumed_work_j);
  const bool gains = response.work_j + other_j > largest_response * (response.assumed_work_j + other_j);
  const double fraction = gains ? response.find_best_fraction(other_j) : 1.0;
  if (response.work_j > 0.0) respond(fraction, lattice);
  return fraction;
}

void ImplicitSolver::end_step(SpringLattice& lattice, const GroundPush& on_ground) {
  update_contact_mass(lattice);
  if (!on_ground.contacts.empty()) {
    ground_contacts_.solve(*on_ground.ground, on_ground.contacts, followers_, step_s_,
                           on_ground.push_speed_cap_m_per_s, body_, impulse_);
  }
  body_.move(step_s_);
  write_velocities(lattice);
  write_displacements(lattice);
}

void ImplicitSolver::move_rigidly(const RigidMove& move, SpringLattice& lattice) {
  for (int n = 0; n < body_.node_count(); ++n) {
    if (body_.mesh().joined(n) != n) continue;
    const Vector3& rest = body_.mesh().nodes[static_cast<std::size_t>(n)];
    const Vector3 position = rest + body_.displacement(n), velocity = body_.velocity(n);
    body_.set_displacement(n, move.moved(position) - rest);
    body_.set_velocity(n, move.slowed(position, velocity));
  }
  body_.turn_frame(Quaternion(move.turn));
  write_velocities(lattice);
  write_displacements(lattice);
}

void ImplicitSolver::write_displacements(SpringLattice& lattice) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.is_fixed(n)) continue;
    const auto at = static_cast<std::size_t>(n);
    const Vector3 moved = followers_[at].sum_over([&](int node) { return body_.displacement(node); });
    lattice.set_displacement(n, rest_m_[at] - lattice.mesh().nodes[at] + moved);
  }
}

}  // namespace spoonbill
