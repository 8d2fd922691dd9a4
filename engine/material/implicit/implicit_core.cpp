#include "engine/material/implicit/implicit_core.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/material/implicit/grid_stretches.h"
#include "engine/material/lattice/lattice_counts.h"

namespace spoonbill {
namespace {

// A solution takes two products for each entry of the band, and a tick some five solutions.
constexpr double largest_band = 1.3e5;
constexpr int least_budget = 30;
// Of the whole body's: before the first contact, and the most.
constexpr double first_lightness = 8.0, largest_lightness = 1e5;

// Where a node of one grid lies in another over the same block, along one axis.
struct GridPlace {
  int first;
  double share;  // of the way to the next
};

GridPlace place_in(int at, int count, int other_count) {
  const double where = static_cast<double>(at) * (other_count - 1) / (count - 1);
  const int first = std::min(static_cast<int>(where), other_count - 2);
  return {first, where - first};
}

// The mean extents of a block.
Vector3 extents(const LatticeMesh& mesh, const std::vector<Vector3>& nodes) {
  Vector3 size = Vector3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    double sum = 0.0;
    int lines = 0;
    for (int n = 0; n < mesh.node_count(); ++n) {
      std::array<int, 3> next = mesh.place(n);
      if (next[static_cast<std::size_t>(axis)] == 0) ++lines;
      if (++next[static_cast<std::size_t>(axis)] == mesh.count[static_cast<std::size_t>(axis)]) continue;
      const int beyond = mesh.index(next[0], next[1], next[2]);
      sum += (nodes[static_cast<std::size_t>(beyond)] - nodes[static_cast<std::size_t>(n)]).norm();
    }
    size[axis] = sum / lines;
  }
  return size;
}

// A node of one block as a weighted sum of another's, trilinear in the grid.
GridPoint weighted(const LatticeMesh& of, int node, const LatticeMesh& by) {
  const std::array<int, 3> at = of.place(node);
  std::array<GridPlace, 3> places{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    places[axis] = place_in(at[axis], of.count[axis], by.count[axis]);
  }
  GridPoint result;
  for (int c = 0; c < 8; ++c) {
    const std::array<int, 3> high = {c >> 2 & 1, c >> 1 & 1, c & 1};
    std::array<int, 3> corner{};
    double weight = 1.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corner[axis] = places[axis].first + high[axis];
      weight *= high[axis] ? places[axis].share : 1.0 - places[axis].share;
    }
    result.node[static_cast<std::size_t>(c)] = by.joined(by.index(corner[0], corner[1], corner[2]));
    result.weight[static_cast<std::size_t>(c)] = weight;
  }
  return result;
}

std::size_t most_followed(const GridPoint& follower) {
  const auto most =
      std::max_element(follower.weight.begin(), follower.weight.end()) - follower.weight.begin();
  return static_cast<std::size_t>(follower.node[static_cast<std::size_t>(most)]);
}

// Entries of the band: what a solution multiplies.
double band_size(const LatticeMesh& block) {
  return 9.0 * block.node_count() * (node_reach(block) + 1);
}

Vector3 applied_force_n(const SpringLattice& lattice, int node) {
  return {lattice.applied_force(0)[node], lattice.applied_force(1)[node], lattice.applied_force(2)[node]};
}

// As many as fit the budget and the band, and no more than the lattice has.
Result<LatticeMesh> coarse_block(const LatticeMesh& mesh, const Vector3& size_m) {
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
    if (band_size(block) <= largest_band || budget < least_budget) return block;
  }
}

// A shell's cells are bent: coarser ones, whose chords are longer, must have its volume all the same.
void take_shell_shares(const LatticeMesh& mesh, LatticeMesh& coarse) {
  const auto volume_of = [](const LatticeMesh& of) {
    double volume = 0.0;
    for (int k = 0; k + 1 < of.count[2]; ++k) {
      for (int i = 0; i + 1 < of.count[0]; ++i) {
        for (int j = 0; j + 1 < of.count[1]; ++j) volume += of.share(i, j, k) * cell_volume(of.cell(i, j, k));
      }
    }
    return volume;
  };
  coarse.cell_shares.assign(coarse.cell_count(), volume_of(mesh) / volume_of(coarse));
}

// What the finer cells of a box have of the body in a coarser one: of each, by how much of it they overlap.
// Cells of a box are alike, so that the body's mass stays what it is.
double overlapped_share(const LatticeMesh& mesh, const std::array<std::vector<Stretch>, 3>& overlaps) {
  double share = 0.0;
  for (const Stretch& k : overlaps[2]) {
    for (const Stretch& i : overlaps[0]) {
      for (const Stretch& j : overlaps[1]) {
        share += i.share() * j.share() * k.share() * mesh.share(i.cell, j.cell, k.cell);
      }
    }
  }
  return share;
}

void take_box_shares(const LatticeMesh& mesh, LatticeMesh& coarse) {
  const auto overlaps = [&](std::size_t axis, int cell) {
    return stretches(cell, coarse.count[axis], mesh.count[axis]);
  };
  coarse.cell_shares.assign(coarse.cell_count(), 0.0);
  for (int k = 0; k + 1 < coarse.count[2]; ++k) {
    for (int i = 0; i + 1 < coarse.count[0]; ++i) {
      for (int j = 0; j + 1 < coarse.count[1]; ++j) {
        coarse.cell_shares[coarse.cell_index(i, j, k)] =
            overlapped_share(mesh, {overlaps(0, i), overlaps(1, j), overlaps(2, k)});
      }
    }
  }
}

Result<LatticeMesh> coarser(const LatticeMesh& mesh, const std::vector<Vector3>& nodes) {
  Result<LatticeMesh> block = coarse_block(mesh, extents(mesh, nodes));
  if (!block.ok()) return block;
  LatticeMesh coarse = std::move(block).value();
  coarse.nodes.assign(static_cast<std::size_t>(coarse.node_count()), Vector3::Zero());
  for (int n = 0; n < coarse.node_count(); ++n) {
    const GridPoint at = weighted(coarse, n, mesh);
    for (std::size_t c = 0; c < 8; ++c) {
      coarse.nodes[static_cast<std::size_t>(n)] += at.weight[c] * nodes[static_cast<std::size_t>(at.node[c])];
    }
  }
  if (mesh.thin) take_shell_shares(mesh, coarse);
  if (!mesh.thin && !mesh.cell_shares.empty()) take_box_shares(mesh, coarse);
  return coarse;
}

}  // namespace

ImplicitCore::ImplicitCore(ImplicitBody body, int nodes, double mass_kg)
    : body_(std::move(body)),
      velocity_(static_cast<std::size_t>(nodes)),
      impulse_(3 * static_cast<std::size_t>(body_.node_count()), 0.0),
      on_ground_(nodes, mass_kg),
      contact_inverse_mass_(first_lightness / mass_kg),
      least_inverse_mass_(1.0 / mass_kg) {}

Result<ImplicitCore> ImplicitCore::make(const LatticeMesh& mesh, const std::vector<Vector3>& rest_m,
                                        const LatticeMaterials& materials, InstructionSet set) {
  const Result<LatticeMesh> coarse = coarser(mesh, rest_m);
  if (!coarse.ok()) return coarse.error();
  Result<ImplicitBody> body =
      ImplicitBody::make(coarse.value(), block_materials(materials, mesh.count, coarse->count), set);
  if (!body.ok()) return body.error();
  double mass_kg = 0.0;
  for (int n = 0; n < coarse->node_count(); ++n) mass_kg += body->mass_kg(n);
  ImplicitCore core(std::move(body).value(), mesh.node_count(), mass_kg);
  core.rest_m_ = rest_m;
  for (int n = 0; n < mesh.node_count(); ++n) {
    core.followers_.push_back(weighted(mesh, n, coarse.value()));
  }
  for (int n = 0; n < coarse->node_count(); ++n) {
    const GridPoint at = weighted(coarse.value(), n, mesh);
    core.nearest_.push_back(static_cast<int>(most_followed(at)));
  }
  core.holder_.assign(core.nearest_.size(), -1);
  return core;
}

void ImplicitCore::hold(std::span<const std::uint8_t> held) {
  SPOONBILL_ASSERT(held.size() == followers_.size());
  for (std::size_t b = 0; b < nearest_.size(); ++b) {
    holder_[b] = held[static_cast<std::size_t>(nearest_[b])] != 0 ? nearest_[b] : -1;
  }
  for (std::size_t n = 0; n < held.size(); ++n) {
    if (held[n] == 0 || follows_held(followers_[n])) continue;
    holder_[most_followed(followers_[n])] = static_cast<int>(n);
  }
  std::vector<std::uint8_t> of_block;
  of_block.reserve(holder_.size());
  for (const int node : holder_) of_block.push_back(node >= 0 ? 1 : 0);
  body_.hold(of_block);
}

bool ImplicitCore::follows_held(const GridPoint& follower) const {
  for (std::size_t c = 0; c < 8; ++c) {
    if (follower.weight[c] > 0.0 && holder_[static_cast<std::size_t>(follower.node[c])] >= 0) return true;
  }
  return false;
}

void ImplicitCore::take_shape(const SpringLattice& lattice) {
  for (int n = 0; n < body_.node_count(); ++n) {
    const GridPoint at = weighted(body_.mesh(), n, lattice.mesh());
    Vector3 position = Vector3::Zero(), velocity = Vector3::Zero();
    for (std::size_t c = 0; c < 8; ++c) {
      position += at.weight[c] * lattice.position(at.node[c]);
      velocity += at.weight[c] * lattice.velocity(at.node[c]);
    }
    body_.set_displacement(n, position - body_.mesh().nodes[static_cast<std::size_t>(n)]);
    body_.set_velocity(n, velocity);
  }
}

void ImplicitCore::take_moved_nodes(const SpringLattice& lattice) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    if (lattice.is_held(n)) continue;
    rest_m_[at] =
        lattice.position(n) - followers_[at].sum_over([&](int node) { return body_.displacement(node); });
  }
}

void ImplicitCore::take_node_forces(const SpringLattice& lattice, std::span<const int> nodes) {
  body_.clear_node_forces();
  for (const int n : nodes) {
    if (lattice.is_held(n)) continue;
    const Vector3 force_n = applied_force_n(lattice, n);
    const GridPoint& follower = followers_[static_cast<std::size_t>(n)];
    for (std::size_t c = 0; c < 8; ++c) body_.add_node_force(follower.node[c], follower.weight[c] * force_n);
  }
}

void ImplicitCore::move_held(std::span<const int> nodes, const Vector3& velocity_m_per_s) {
  SPOONBILL_ASSERT_DEBUG(std::is_sorted(nodes.begin(), nodes.end()));
  for (int n = 0; n < body_.node_count(); ++n) {
    if (is_held_by(n, nodes)) body_.move_held(n, velocity_m_per_s);
  }
}

bool ImplicitCore::is_held_by(int node, std::span<const int> nodes) const {
  return std::binary_search(nodes.begin(), nodes.end(), holder_[static_cast<std::size_t>(node)]);
}

Vector3 ImplicitCore::force_on_held(const SpringLattice& lattice, std::span<const int> nodes,
                                    const Vector3& gravity_m_per_s2) const {
  Vector3 sum = Vector3::Zero();
  for (int n = 0; n < body_.node_count(); ++n) {
    if (mesh().joined(n) != n || !is_held_by(n, nodes)) continue;
    sum += body_.force_on_held(n) + body_.mass_kg(n) * gravity_m_per_s2;
  }
  for (const int n : nodes) sum += applied_force_n(lattice, n);
  return sum;
}

ImplicitReport ImplicitCore::begin_step(const ImplicitStep& step, SpringLattice& lattice,
                                        std::span<GroundContact> on_ground) {
  SPOONBILL_ASSERT(step.step_s > 0.0);
  step_s_ = step.step_s;
  std::span<const double> known_ns;
  if (!on_ground.empty()) {
    on_ground_.take_last(on_ground, followers_, step_s_, impulse_);
    known_ns = impulse_;
  }
  const ImplicitReport report = body_.solve_velocities(step, known_ns);
  write_velocities(lattice);
  return report;
}

void ImplicitCore::write_velocities(SpringLattice& lattice) {
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.is_held(n)) continue;
    const auto at = static_cast<std::size_t>(n);
    lattice.set_velocity(n, followers_[at].sum_over([&](int node) { return body_.velocity(node); }));
    const Vector3 rounded = lattice.velocity(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      velocity_[at][axis] = static_cast<float>(rounded[static_cast<Eigen::Index>(axis)]);
    }
  }
}

// Returns the sum of the squares of what each node got.
double ImplicitCore::take_impulses(const SpringLattice& lattice) {
  std::fill(impulse_.begin(), impulse_.end(), 0.0);
  double squares = 0.0;
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.is_held(n) || lattice.mesh().joined(n) != n) continue;
    const auto at = static_cast<std::size_t>(n);
    const Vector3 before(velocity_[at][0], velocity_[at][1], velocity_[at][2]);
    const Vector3 impulse = (lattice.velocity(n) - before) / contact_inverse_mass_;
    if (impulse.isZero(0.0)) continue;
    squares += impulse.squaredNorm();
    followers_[at].share_out(impulse, impulse_);
  }
  return squares;
}

// The mass is moved half the way, so that two bodies that learn from each other settle.
void ImplicitCore::take_lightness(double answered, SpringLattice& lattice) {
  if (!std::isfinite(answered)) return;
  const double wanted = std::clamp(answered, least_inverse_mass_, largest_lightness * least_inverse_mass_);
  contact_inverse_mass_ = std::sqrt(contact_inverse_mass_ * wanted);
  lattice.set_contact_inverse_mass(contact_inverse_mass_);
}

void ImplicitCore::end_step(SpringLattice& lattice, const OnGround& on_ground) {
  // The contacts gave each node its impulse over its mass; the block gives all of them together what it does.
  const double squares = take_impulses(lattice);
  if (squares > 0.0) take_lightness(body_.push(impulse_) / squares, lattice);
  if (!on_ground.contacts.empty()) {
    on_ground_.solve(*on_ground.ground, on_ground.contacts, followers_, step_s_,
                     on_ground.push_speed_cap_m_per_s, body_, impulse_);
  }
  body_.move(step_s_);
  write_velocities(lattice);
  for (int n = 0; n < lattice.mesh().node_count(); ++n) {
    if (lattice.is_held(n)) continue;
    const auto at = static_cast<std::size_t>(n);
    const Vector3 moved = followers_[at].sum_over([&](int node) { return body_.displacement(node); });
    lattice.set_displacement(n, rest_m_[at] - lattice.mesh().nodes[at] + moved);
  }
}

}  // namespace spoonbill
