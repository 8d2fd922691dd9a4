#include "engine/material/springs/spring_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/material/cells/spring_cell.h"

namespace spoonbill {
namespace {

// Steps in i, j, k along the 13 spring directions of a regular lattice. A step in any of them increases the
// node index.
constexpr int direction_step[lattice_direction_count][3] = {
    {0, 1, 0}, {1, 0, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0}, {0, 1, 1},   {0, -1, 1},
    {1, 0, 1}, {-1, 0, 1}, {1, 1, 1}, {1, -1, 1}, {-1, 1, 1}, {-1, -1, 1},
};

// Returns the index of a spring direction, or -1 if there is no such direction.
int find_direction(int di, int dj, int dk) {
  for (int d = 0; d < lattice_direction_count; ++d) {
    if (direction_step[d][0] == di && direction_step[d][1] == dj && direction_step[d][2] == dk) return d;
  }
  return -1;
}

// Returns a fixed pseudo-random number in [-1, 1), by Knuth's multiplicative hash. Start vectors made of such
// numbers contain every mode.
float hashed_noise(std::uint32_t i) {
  const std::uint32_t bits = (i * 2654435761u) ^ ((i * 2654435761u) >> 15);
  return static_cast<float>(bits & 0xffffu) / 32768.0f - 1.0f;
}

const LatticeKernels& kernels_for(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx512:
      return kernels_avx512::lattice_kernels;
    case InstructionSet::avx2:
      return kernels_avx2::lattice_kernels;
    case InstructionSet::baseline:
      break;
  }
  return kernels_baseline::lattice_kernels;
}

const float* data_or_null(const AlignedVector<float>& values) {
  return values.empty() ? nullptr : values.data();
}

// Numbers of steps of the power iteration: from noise, and from noise with the mode of another spring weight.
constexpr int frequency_steps = 120, further_frequency_steps = 40;

// Volume stiffness K_v that a crushed cell gets in addition, divided by its shear modulus. A material with
// Poisson's ratio 0.45 has this ratio.
constexpr double crushed_ratio = 8.0;
constexpr float noise_fraction = 1e-4f;

template <class Property>
bool differ(const LatticeMaterials& materials, const Property& property) {
  return std::any_of(materials.materials.begin(), materials.materials.end(), [&](const Material& material) {
    return property(material) != property(materials.own());
  });
}

}  // namespace

// Sums over the cells of the lattice, by node and by spring, in double precision, before they are stored in
// single precision.
struct SpringLattice::Assembly {
  // One value per node for each direction; it belongs to the spring that starts at the node.
  using BySpring = std::array<std::vector<double>, lattice_direction_count>;

  // Moduli of one material.
  struct Stiffness {
    double youngs_modulus_pa, poissons_ratio, shear_pa, bulk_pa;
  };

  explicit Assembly(const SpringLattice& lattice);

  // Returns the index of the material that contributes most to a spring's stiffness; the first one on a
  // tie. Only for lattices of several materials.
  std::size_t leading_material(int direction, std::size_t node) const;

  std::vector<Stiffness> materials;
  std::vector<double> mass, cell_count;  // mass, kg, and number of cells around each node
  BySpring stiffness;
  // Contribution of each material to the stiffness of each spring; empty for a single material.
  std::vector<BySpring> by_material;
};

Result<SpringLattice> SpringLattice::make(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                          InstructionSet set) {
  if (const Status status = check_materials(materials); !status.ok()) return status.error();
  for (int axis = 0; axis < 3; ++axis) {
    if (mesh.count[axis] < 2)
      return Error{ErrorCode::out_of_range, "lattice: node counts must be at least 2 in each direction",
                   "nodes"};
  }
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  SpringLattice lattice;
  lattice.kernels_ = &kernels_for(set);
  lattice.materials_ = materials;
  lattice.allocate(mesh);
  Assembly sum(lattice);
  lattice.assemble(sum);
  lattice.kernels_->measure_rest_volumes(lattice.view());
  lattice.fix_nodes(std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.node_count()), 0));
  lattice.set_damping(sum);
  lattice.start_power_iteration();
  lattice.rest_modes_.push_back(lattice.measure_fastest_mode(frequency_steps));
  return lattice;
}

void SpringLattice::allocate(const LatticeMesh& mesh) {
  mesh_ = mesh;
  outside_ = OutsideNodes(mesh);
  flat_corners_ = FlatCorners(mesh);
  // The frame of a rigid body has a single cell. Searches for contacts need a length like that of the cells
  // of deformable bodies.
  constexpr double frame_fraction = 1.0 / 16.0;
  cell_size_ = static_cast<float>((mesh.is_frame ? frame_fraction : 1.0) * mesh.mean_edge());
  const int row = mesh.count[1], layer = mesh.count[0] * mesh.count[1];
  int reach = 0;
  for (int d = 0; d < lattice_direction_count; ++d) {
    offset_[d] = direction_step[d][0] * row + direction_step[d][1] + direction_step[d][2] * layer;
    reach = std::max(reach, offset_[d]);
  }
  for (int n = 0; n < mesh.node_count(); ++n) {
    if (mesh.joined(n) != n) seam_.insert(seam_.end(), {mesh.joined(n), n});
  }
  padded_count_ = (mesh.node_count() + lattice_block - 1) / lattice_block * lattice_block;
  const std::size_t size = static_cast<std::size_t>(padded_count_ + reach + lattice_block);
  for (Floats* a : {&dx_,
                    &dy_,
                    &dz_,
                    &vx_,
                    &vy_,
                    &vz_,
                    &fx_,
                    &fy_,
                    &fz_,
                    &node_mass_,
                    &free_mass_,
                    &inverse_mass_,
                    &free_node_,
                    &applied_[0],
                    &applied_[1],
                    &applied_[2],
                    &bulk_,
                    &crushed_,
                    &inverse_volume_,
                    &rest_volume_sum_,
                    &has_cell_,
                    &inverse_cell_count_,
                    &node_dilation_,
                    &row_sum_,
                    &stable_inverse_mass_,
                    &power_x_,
                    &power_y_,
                    &power_z_,
                    &power_noise_}) {
    a->assign(size, 0.0f);
  }
  for (auto* vector : {&reference_, &moved_, &spring_force_}) {
    for (Floats& a : *vector) a.assign(size, 0.0f);
  }
  std::fill(inverse_volume_.begin(), inverse_volume_.end(), 1.0f);
  for (int d = 0; d < lattice_direction_count; ++d) {
    for (Floats* a : {&rest_y_[d], &rest_z_[d], &stiffness_[d], &square_difference_[d], &crept_[d]}) {
      a->assign(size, 0.0f);
    }
    tangent_[d].assign(tangent_runs * static_cast<std::size_t>(padded_count_), 0.0f);
    // Unused entries get a nonzero length so that no kernel divides by zero.
    for (Floats* a : {&rest_x_[d], &rest_length_[d], &first_rest_length_[d]}) a->assign(size, cell_size_);
  }
}

// Starts the power iteration with noise, which contains every mode.
void SpringLattice::start_power_iteration() {
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const int representative = mesh_.joined(n);
    power_x_[n] = hashed_noise(static_cast<std::uint32_t>(3 * representative + 1));
    power_y_[n] = hashed_noise(static_cast<std::uint32_t>(3 * representative + 2));
    power_z_[n] = hashed_noise(static_cast<std::uint32_t>(3 * representative + 3));
  }
}

// Measures the square of the largest angular frequency by steps of the power iteration at the present shape.
SpringLattice::RestMode SpringLattice::measure_fastest_mode(int steps) {
  const LatticeView lattice = view();
  kernels_->linearise_springs(lattice, 0.0f, Linearised::tangents);
  for (int step = 0; step < steps; ++step) {
    fastest_square_ = kernels_->power_step(lattice, node_mass_.data());
  }
  return {spring_weight_, fastest_square_, power_x_, power_y_, power_z_};
}

// Returns a copy without displacements and velocities, with the rest lengths and rest volumes at
// construction, every node free and an inertia scale of 1.
SpringLattice SpringLattice::at_rest() const {
  SpringLattice copy = *this;
  for (Floats* a : {&copy.dx_, &copy.dy_, &copy.dz_, &copy.vx_, &copy.vy_, &copy.vz_}) {
    std::fill(a->begin(), a->end(), 0.0f);
  }
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    copy.rest_length_[d] = copy.first_rest_length_[d];
    std::fill(copy.square_difference_[d].begin(), copy.square_difference_[d].end(), 0.0f);
  }
  copy.kernels_->measure_rest_volumes(copy.view());
  copy.inertia_scale_ = 1.0f;
  copy.contact_inverse_mass_ = 0.0f;
  copy.fix_nodes(std::vector<std::uint8_t>(static_cast<std::size_t>(mesh_.node_count()), 0));
  return copy;
}

// Adds a mode to the vector of the power iteration, with the norm that the vector has.
void SpringLattice::add_to_power_vector(const RestMode& mode) {
  double present = 0.0, added = 0.0;
  for (int n = 0; n < mesh_.node_count(); ++n) {
    present += Vector3(power_x_[n], power_y_[n], power_z_[n]).squaredNorm();
    added += Vector3(mode.power_x[n], mode.power_y[n], mode.power_z[n]).squaredNorm();
  }
  const auto factor = static_cast<float>(added > 0.0 ? std::sqrt(present / added) : 0.0);
  for (int n = 0; n < mesh_.node_count(); ++n) {
    power_x_[n] += factor * mode.power_x[n];
    power_y_[n] += factor * mode.power_y[n];
    power_z_[n] += factor * mode.power_z[n];
  }
}

// Returns the mode for springs of this weight (see LatticeView::spring_weight). It is measured only once.
// It usually resembles the first mode, from which the measurement starts. It may also be in another region of
// the body, so noise is added.
const SpringLattice::RestMode& SpringLattice::find_rest_mode(float weight) {
  for (const RestMode& mode : rest_modes_) {
    if (mode.spring_weight == weight) return mode;
  }
  SpringLattice copy = at_rest();
  copy.spring_weight_ = weight;
  copy.start_power_iteration();
  copy.add_to_power_vector(rest_modes_.front());
  return rest_modes_.emplace_back(copy.measure_fastest_mode(further_frequency_steps));
}

// Sets the mode that is tracked, scaled to the present inertia.
void SpringLattice::adopt_mode(const RestMode& mode) {
  spring_weight_ = mode.spring_weight;
  fastest_square_ = mode.fastest_square / inertia_scale_;
  power_x_ = mode.power_x;
  power_y_ = mode.power_y;
  power_z_ = mode.power_z;
}

double SpringLattice::find_inertia_scale(double step_s) {
  SPOONBILL_ASSERT(step_s > 0.0);
  const double used = step_s / (2.0 * rest_stability_fraction);
  const RestMode& mode = find_rest_mode(static_cast<float>(spring_weight(step_s)));
  return std::max(1.0, used * used * static_cast<double>(mode.fastest_square));
}

double SpringLattice::find_real_time_step_s(double longest_s) {
  SPOONBILL_ASSERT(longest_s > 0.0);
  // With damping, the squared frequency grows with the number of substeps, so several attempts may be
  // necessary. Each attempt assumes no growth, and so never takes more substeps than necessary.
  constexpr double most_substeps = 1e9;
  double count = 1.0;
  while (count < most_substeps) {
    const double scale = find_inertia_scale(longest_s / count);
    if (!(scale > 1.0)) break;
    count = std::max(count + 1.0, std::ceil(count * std::sqrt(scale)));
  }
  return longest_s / count;
}

void SpringLattice::set_inertia(double scale, double step_s) {
  SPOONBILL_ASSERT(scale >= 1.0 && step_s > 0.0);
  const auto weight = static_cast<float>(spring_weight(step_s));
  if (weight != spring_weight_) adopt_mode(find_rest_mode(weight));
  const auto rounded = static_cast<float>(scale);
  fastest_square_ *= inertia_scale_ / rounded;
  inertia_scale_ = rounded;
  for (int n = 0; n < mesh_.node_count(); ++n) {
    if (inverse_mass_[n] > 0.0f) inverse_mass_[n] = free_inverse_mass(n);
  }
}

double SpringLattice::fastest_frequency() const {
  return std::sqrt(fastest_square());
}

// A substep h is stable while h^2 (K_v + K_s) + 2 h tau K_s is below 4 M for every mode, where K_v is the
// stiffness of the cells and K_s that of the springs. Only the sum q = K_v + (1 + 2 tau / h0) K_s has been
// measured, for substeps of h0. The result is therefore the smaller of two steps: one as if q came from the
// cells alone, one as if it came from the springs alone.
double SpringLattice::stable_step_s(double fraction) const {
  if (!(fastest_square() > 0.0)) return std::numeric_limits<double>::infinity();
  const double tau = static_cast<double>(step_damping_time_);
  const double of_cells = 4.0 * fraction * fraction / fastest_square();
  const double of_springs = of_cells * static_cast<double>(spring_weight_);
  return std::min(std::sqrt(of_cells), std::sqrt(tau * tau + of_springs) - tau);
}

LatticeView SpringLattice::view() {
  LatticeView v;
  v.padded_count = padded_count_;
  v.stiffening = static_cast<float>(material().stiffening);
  for (const Material& each : materials_.materials) {
    v.stiffening = std::max(v.stiffening, static_cast<float>(each.stiffening));
  }
  v.volume_softens = min_poissons_ratio(materials_) < 0.25;
  v.dx = dx_.data();
  v.dy = dy_.data();
  v.dz = dz_.data();
  v.vx = vx_.data();
  v.vy = vy_.data();
  v.vz = vz_.data();
  v.fx = fx_.data();
  v.fy = fy_.data();
  v.fz = fz_.data();
  v.reference_x = reference_[0].data();
  v.reference_y = reference_[1].data();
  v.reference_z = reference_[2].data();
  v.moved_x = moved_[0].data();
  v.moved_y = moved_[1].data();
  v.moved_z = moved_[2].data();
  v.spring_x = spring_force_[0].data();
  v.spring_y = spring_force_[1].data();
  v.spring_z = spring_force_[2].data();
  v.inverse_mass = inverse_mass_.data();
  v.spring_weight = spring_weight_;
  v.free_node = free_node_.data();
  v.seam = seam_.data();
  v.seam_count = static_cast<int>(seam_.size() / 2);
  v.active_block = active_block_.data();
  v.free_block = free_block_.data();
  for (int d = 0; d < lattice_direction_count; ++d) {
    v.springs[d] = {offset_[d],
                    rest_x_[d].data(),
                    rest_y_[d].data(),
                    rest_z_[d].data(),
                    stiffness_[d].data(),
                    rest_length_[d].data(),
                    square_difference_[d].data(),
                    first_rest_length_[d].data(),
                    crept_[d].data(),
                    tangent_[d].data(),
                    data_or_null(stiffening_[d]),
                    data_or_null(further_damping_[d]),
                    data_or_null(yield_[d]),
                    data_or_null(hardening_[d]),
                    data_or_null(flow_rate_[d]),
                    data_or_null(relaxing_fraction_[d]),
                    data_or_null(relaxation_time_[d])};
  }
  for (int c = 1; c < 8; ++c) {
    v.corner_direction[c] = find_direction(c >> 2 & 1, c >> 1 & 1, c & 1);
    v.corner_offset[c] = offset_[v.corner_direction[c]];
  }
  v.bulk_stiffness = bulk_.data();
  v.crushed_stiffness = crushed_.data();
  v.inverse_volume = inverse_volume_.data();
  v.rest_volume_sum = rest_volume_sum_.data();
  v.has_cell = has_cell_.data();
  v.inverse_cell_count = inverse_cell_count_.data();
  v.node_dilation = node_dilation_.data();
  v.power_x = power_x_.data();
  v.power_y = power_y_.data();
  v.power_z = power_z_.data();
  v.power_noise = power_noise_.data();
  return v;
}

double SpringLattice::volume_m3() const {
  double volume = 0.0;
  for (int i = 0; i + 1 < mesh_.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh_.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh_.count[2]; ++k) {
        CellCorners corners;
        for (int c = 0; c < 8; ++c) {
          corners[c] = position(mesh_.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1)));
        }
        volume += mesh_.cell_fraction(i, j, k) * cell_volume(corners);
      }
    }
  }
  return volume;
}

double SpringLattice::rest_volume_change() const {
  constexpr double sum_of_volume = 12.0;
  double at_first_m3 = 0.0, now_m3 = 0.0;
  for (std::size_t n = 0; n < static_cast<std::size_t>(mesh_.node_count()); ++n) {
    if (has_cell_[n] == 0.0f) continue;
    at_first_m3 += 1.0 / static_cast<double>(inverse_volume_[n]);
    now_m3 += static_cast<double>(rest_volume_sum_[n]) / sum_of_volume;
  }
  return now_m3 / at_first_m3 - 1.0;
}

double SpringLattice::fastest_m_per_s() const {
  return std::sqrt(kernels_->find_largest_square(vx_.data(), vy_.data(), vz_.data(), padded_count_));
}

NodeSpeeds SpringLattice::find_node_speeds() const {
  const int count = mesh_.node_count();
  NodeSpeeds found;
  for (int n = 0; n < count; ++n) found.mean_m_per_s += velocity(n);
  found.mean_m_per_s /= count;
  double square = 0.0;
  for (int n = 0; n < count; ++n) square = std::max(square, (velocity(n) - found.mean_m_per_s).squaredNorm());
  found.fastest_from_mean_m_per_s = std::sqrt(square);
  return found;
}

void SpringLattice::set_displacement(int node, const Vector3& d) {
  for (const int n : {node, mesh_.twin(node)}) {
    dx_[n] = static_cast<float>(d.x());
    dy_[n] = static_cast<float>(d.y());
    dz_[n] = static_cast<float>(d.z());
  }
}

void SpringLattice::set_velocity(int node, const Vector3& v) {
  for (const int n : {node, mesh_.twin(node)}) {
    vx_[n] = static_cast<float>(v.x());
    vy_[n] = static_cast<float>(v.y());
    vz_[n] = static_cast<float>(v.z());
  }
}

void SpringLattice::set_node_force(int node, const Vector3& force_n) {
  for (int axis = 0; axis < 3; ++axis) applied_[axis][node] = static_cast<float>(force_n[axis]);
  has_applied_force_ = true;
}

const float* SpringLattice::stabilise_strained_nodes(float h_s, float fraction) {
  LatticeView weighted = view();
  weighted.spring_weight = static_cast<float>(spring_weight(static_cast<double>(h_s)));
  kernels_->row_sums(weighted, row_sum_.data());
  const float limit = 4.0f * fraction * fraction / (h_s * h_s);
  for (int i = 0; i < padded_count_; ++i) {
    const float stable = limit / std::max(row_sum_[i], 1e-30f);
    stable_inverse_mass_[i] = std::min(inverse_mass_[i], stable);
    if (!(stable < inverse_mass_[i])) continue;
    // The velocity is reduced so that the momentum stays the same. At the old velocity, the forces could not
    // stop the larger inertia.
    const float slower = stable / inverse_mass_[i];
    for (Floats* v : {&vx_, &vy_, &vz_}) (*v)[i] *= slower;
  }
  return stable_inverse_mass_.data();
}

void SpringLattice::continue_displacements() {
  for (Floats* field : {&dx_, &dy_, &dz_}) outside_.continue_field(free_node_.data(), field->data());
}

void SpringLattice::continue_velocities(const SpeedCap& cap) {
  for (Floats* field : {&vx_, &vy_, &vz_}) outside_.continue_field(free_node_.data(), field->data());
  outside_.limit_speeds(cap, view());
}

SpringLattice::Assembly::Assembly(const SpringLattice& lattice) {
  const LatticeMaterials& composition = lattice.materials();
  for (const Material& material : composition.materials) {
    // Bodies with a Poisson's ratio below this bound are stepped by the implicit solver; their springs are
    // inactive.
    const double poisson = std::max(material.poissons_ratio, min_spring_poissons_ratio);
    const double youngs = material.youngs_modulus_pa;
    materials.push_back({youngs, poisson, shear_modulus(youngs, poisson), bulk_stiffness(youngs, poisson)});
  }
  const std::vector<double> none(static_cast<std::size_t>(lattice.mesh().node_count()), 0.0);
  mass = cell_count = none;
  stiffness.fill(none);
  if (composition.has_several_materials()) by_material.assign(materials.size(), stiffness);
}

std::size_t SpringLattice::Assembly::leading_material(int direction, std::size_t node) const {
  std::size_t leading = 0;
  const auto contribution = [&](std::size_t material) {
    return by_material[material][static_cast<std::size_t>(direction)][node];
  };
  for (std::size_t m = 1; m < by_material.size(); ++m) {
    if (contribution(m) > contribution(leading)) leading = m;
  }
  return leading;
}

void SpringLattice::assemble(Assembly& sum) {
  total_mass_ = rest_volume_ = 0.0;
  report_ = {};
  for (int i = 0; i + 1 < mesh_.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh_.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh_.count[2]; ++k) add_cell(i, j, k, sum);
    }
  }
  report_.divide_by(rest_volume_);
  if (!materials_.has_several_materials()) total_mass_ = material().density_kg_per_m3 * rest_volume_;
  join_nodes(sum);
  store_nodes(sum);
  for (int d = 0; d < lattice_direction_count; ++d) store_springs(d, sum);
  store_stiffening(sum);
  store_flow_and_creep(sum);
}

void SpringLattice::add_cell(int i, int j, int k, Assembly& sum) {
  const CellCorners corners = mesh_.cell(i, j, k);
  const std::size_t composition = materials_.index_of(mesh_.cell_index(i, j, k));
  const Assembly::Stiffness& material = sum.materials[composition];
  const double density = materials_.materials[composition].density_kg_per_m3;
  const CellSprings springs = material_springs(corners, material.youngs_modulus_pa, material.poissons_ratio);
  // Mass and stiffness scale with the same fraction, so a partly filled cell vibrates no faster than a
  // whole one.
  const double fraction = mesh_.cell_fraction(i, j, k), volume_m3 = fraction * springs.volume_m3;
  const auto corner_node = [&](int corner) {
    return mesh_.index(i + (corner >> 2 & 1), j + (corner >> 1 & 1), k + (corner & 1));
  };
  for (int s = 0; s < cell_spring_count; ++s) {
    int from = cell_spring_corners[s][0], to = cell_spring_corners[s][1];
    const auto step = [&](int bit) { return (to >> bit & 1) - (from >> bit & 1); };
    int d = find_direction(step(2), step(1), step(0));
    if (d < 0) {
      std::swap(from, to);
      d = find_direction(step(2), step(1), step(0));
    }
    const auto direction = static_cast<std::size_t>(d), node = static_cast<std::size_t>(corner_node(from));
    sum.stiffness[direction][node] += fraction * springs.stiffness_n_per_m[s];
    if (sum.by_material.empty()) continue;
    sum.by_material[composition][direction][node] += fraction * springs.stiffness_n_per_m[s];
  }
  for (int c = 0; c < 8; ++c) {
    const auto node = static_cast<std::size_t>(corner_node(c));
    sum.mass[node] += density * volume_m3 / 8.0;
    sum.cell_count[node] += 1.0;
  }
  const int first = corner_node(0);
  bulk_[first] = static_cast<float>(material.bulk_pa * volume_m3);
  crushed_[first] = static_cast<float>(crushed_ratio * material.shear_pa * volume_m3);
  inverse_volume_[first] = static_cast<float>(1.0 / springs.volume_m3);
  has_cell_[first] = 1.0f;
  rest_volume_ += volume_m3;
  total_mass_ += density * volume_m3;
  report_.add(volume_m3, achieved_elasticity(corners, springs, material.bulk_pa), material.youngs_modulus_pa,
              materials_.materials[composition].poissons_ratio);
  report_.worst_cell_misfit = std::max(report_.worst_cell_misfit, springs.misfit);
  report_.worst_jacobian = std::min(report_.worst_jacobian, smallest_jacobian_ratio(corners));
}

// Gives the first node of each seam pair the mass and the cells of both.
void SpringLattice::join_nodes(Assembly& sum) {
  for (std::size_t s = 0; s < seam_.size(); s += 2) {
    const auto first = static_cast<std::size_t>(seam_[s]), second = static_cast<std::size_t>(seam_[s + 1]);
    sum.mass[first] += sum.mass[second];
    sum.mass[second] = 0.0;
    sum.cell_count[first] += sum.cell_count[second];
    sum.cell_count[second] = sum.cell_count[first];
  }
}

void SpringLattice::store_nodes(const Assembly& sum) {
  for (std::size_t n = 0; n < sum.mass.size(); ++n) {
    node_mass_[n] = static_cast<float>(sum.mass[n]);
    inverse_cell_count_[n] = static_cast<float>(1.0 / sum.cell_count[n]);
    power_noise_[n] = noise_fraction *
                      hashed_noise(static_cast<std::uint32_t>(mesh_.joined(static_cast<int>(n))) + 1) /
                      std::sqrt(static_cast<float>(total_mass_));
  }
}

void SpringLattice::store_springs(int d, const Assembly& sum) {
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const std::array<int, 3> at = mesh_.grid_index(n);
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
      const int to = at[axis] + direction_step[d][axis];
      inside = inside && to >= 0 && to < mesh_.count[axis];
    }
    if (!inside) continue;
    const Vector3 rest = mesh_.nodes[n + offset_[d]] - mesh_.nodes[n];
    rest_x_[d][n] = static_cast<float>(rest.x());
    rest_y_[d][n] = static_cast<float>(rest.y());
    rest_z_[d][n] = static_cast<float>(rest.z());
    rest_length_[d][n] = static_cast<float>(rest.norm());
    first_rest_length_[d][n] = rest_length_[d][n];
    stiffness_[d][n] =
        static_cast<float>(sum.stiffness[static_cast<std::size_t>(d)][static_cast<std::size_t>(n)]);
  }
}

void SpringLattice::store_stiffening(const Assembly& sum) {
  if (!differ(materials_, [](const Material& material) { return material.stiffening; })) return;
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    stiffening_[d].assign(stiffness_[d].size(), 0.0f);
    for (std::size_t n = 0; n < sum.mass.size(); ++n) {
      if (!(sum.stiffness[d][n] > 0.0)) continue;
      double mean = 0.0;
      for (std::size_t m = 0; m < sum.by_material.size(); ++m) {
        mean += sum.by_material[m][d][n] / sum.stiffness[d][n] * materials_.materials[m].stiffening;
      }
      stiffening_[d][n] = static_cast<float>(mean);
    }
  }
}

void SpringLattice::store_flow_and_creep(const Assembly& sum) {
  for (const Material& material : materials_.materials) {
    flows_ = flows_ || material.plastic;
    creeps_ = creeps_ || material.relaxing_fraction > 0.0;
  }
  const bool own_flow = flows_ && differ(materials_, [](const Material& material) {
                          return std::array<double, 4>{material.plastic ? 1.0 : 0.0, material.yield_strain,
                                                       material.flow_rate_per_s, material.hardening};
                        });
  const bool own_creep =
      creeps_ && differ(materials_, [](const Material& material) {
        return std::array<double, 2>{material.relaxing_fraction, material.relaxation_time_s};
      });
  if (!own_flow && !own_creep) return;
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    const std::size_t size = stiffness_[d].size();
    if (own_flow) {
      for (Floats* a : {&yield_[d], &hardening_[d], &flow_rate_[d]}) a->assign(size, 0.0f);
      // For springs that do not flow, a large yield strain lets may_flow() skip their blocks.
      std::fill(yield_[d].begin(), yield_[d].end(), 1.0f);
    }
    if (own_creep) {
      relaxing_fraction_[d].assign(size, 0.0f);
      relaxation_time_[d].assign(size, 1.0f);
    }
    for (std::size_t n = 0; n < sum.mass.size(); ++n) {
      const Material& material = materials_.materials[sum.leading_material(static_cast<int>(d), n)];
      if (own_flow && material.plastic) {
        yield_[d][n] = static_cast<float>(material.yield_strain);
        hardening_[d][n] = static_cast<float>(material.hardening);
        flow_rate_[d][n] = static_cast<float>(material.flow_rate_per_s);
      }
      if (own_creep) {
        relaxing_fraction_[d][n] = static_cast<float>(material.relaxing_fraction);
        relaxation_time_[d][n] = static_cast<float>(material.relaxation_time_s);
      }
    }
  }
}

void SpringLattice::set_damping(const Assembly& sum) {
  const auto [least, most] = std::minmax_element(
      materials_.materials.begin(), materials_.materials.end(),
      [](const Material& a, const Material& b) { return a.damping_time_s < b.damping_time_s; });
  damping_time_ = static_cast<float>(least->damping_time_s);
  step_damping_time_ = static_cast<float>(most->damping_time_s);
  is_damped_further_ = step_damping_time_ > damping_time_;
  if (!is_damped_further_) return;
  for (std::size_t d = 0; d < lattice_direction_count; ++d) {
    further_damping_[d].assign(stiffness_[d].size(), 0.0f);
    for (std::size_t n = 0; n < sum.mass.size(); ++n) {
      double damping = 0.0;
      for (std::size_t m = 0; m < sum.by_material.size(); ++m) {
        damping +=
            sum.by_material[m][d][n] * (materials_.materials[m].damping_time_s - least->damping_time_s);
      }
      further_damping_[d][n] = static_cast<float>(damping);
    }
  }
}

float SpringLattice::free_inverse_mass(int node) const {
  if (contact_inverse_mass_ > 0.0f) return contact_inverse_mass_;
  return 1.0f / (inertia_scale_ * node_mass_[mesh_.joined(node)]);
}

void SpringLattice::set_contact_inverse_mass(double inverse_mass_per_kg) {
  SPOONBILL_ASSERT(inverse_mass_per_kg >= 0.0);
  contact_inverse_mass_ = static_cast<float>(inverse_mass_per_kg);
  for (int n = 0; n < mesh_.node_count(); ++n) {
    if (inverse_mass_[n] > 0.0f) inverse_mass_[n] = free_inverse_mass(n);
  }
}

void SpringLattice::fix_nodes(std::span<const std::uint8_t> fixed) {
  SPOONBILL_ASSERT(fixed.size() == static_cast<std::size_t>(mesh_.node_count()));
  fixed_count_ =
      static_cast<int>(std::count_if(fixed.begin(), fixed.end(), [](std::uint8_t is) { return is != 0; }));
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const bool free =
        fixed[static_cast<std::size_t>(n)] == 0 && fixed[static_cast<std::size_t>(mesh_.twin(n))] == 0;
    inverse_mass_[n] = free ? free_inverse_mass(n) : 0.0f;
    free_mass_[n] = free ? node_mass_[n] : 0.0f;
    free_node_[n] = free ? 1.0f : 0.0f;
    if (!free) set_velocity(n, Vector3::Zero());
  }
  find_active_blocks();
}

void SpringLattice::find_active_blocks() {
  active_block_.assign(static_cast<std::size_t>(padded_count_ / lattice_block), 0);
  free_block_ = active_block_;
  const int reach = *std::max_element(offset_, offset_ + lattice_direction_count);
  for (int n = 0; n < mesh_.node_count(); ++n) {
    if (free_node_[n] == 0.0f) continue;
    free_block_[static_cast<std::size_t>(n / lattice_block)] = 1;
    const int first = std::max(0, n - reach) / lattice_block;
    for (int b = first; b <= n / lattice_block; ++b) active_block_[static_cast<std::size_t>(b)] = 1;
  }
}

void SpringLattice::write_shape(std::vector<float>& shape) const {
  shape.clear();
  visit_shape([&](const float* data, std::size_t count) { shape.insert(shape.end(), data, data + count); });
}

std::vector<float> SpringLattice::shape() const {
  std::vector<float> all;
  write_shape(all);
  return all;
}

std::vector<Vector3> SpringLattice::positions() const {
  std::vector<Vector3> all;
  all.reserve(mesh_.nodes.size());
  for (int n = 0; n < mesh_.node_count(); ++n) all.push_back(position(n));
  return all;
}

std::size_t SpringLattice::shape_size() const {
  std::size_t size = 0;
  visit_shape([&](const float*, std::size_t count) { size += count; });
  return size;
}

bool SpringLattice::set_shape(std::span<const float> shape) {
  if (shape_size() != shape.size()) return false;
  const float* from = shape.data();
  const auto restore = [&](Floats& to) {
    std::copy(from, from + to.size(), to.begin());
    from += to.size();
  };
  for (Floats* a : {&dx_, &dy_, &dz_, &vx_, &vy_, &vz_}) restore(*a);
  for (Floats& a : rest_length_) restore(a);
  for (Floats& a : square_difference_) restore(a);
  for (Floats& a : crept_) restore(a);
  restore(rest_volume_sum_);
  return true;
}

struct SpringLattice::Reforming {
  struct Spring {
    int direction, start;
    float rest_length;
  };
  struct Cell {
    int first;
    float rest_volume_sum;
  };
  std::array<Spring, 2 * lattice_direction_count> springs{};
  std::array<Cell, 8> cells{};
  std::size_t spring_count = 0, cell_count = 0;
};

bool SpringLattice::reform_springs(int node, const Vector3& move, Reforming& next) const {
  const Vector3 here = position(node);
  for (int d = 0; d < lattice_direction_count; ++d) {
    for (const bool starts_here : {true, false}) {
      const int start = starts_here ? node : node - offset_[d];
      if (start < 0 || !(stiffness_[d][start] > 0.0f)) continue;
      const Vector3 there = position(starts_here ? node + offset_[d] : start);
      const double longer = (here + move - there).norm() - (here - there).norm();
      const float rest = rest_length_[d][start] + static_cast<float>(longer);
      const float first = first_rest_length_[d][start];
      if (!(rest >= 0.5f * first && rest <= 2.0f * first)) return false;
      next.springs[next.spring_count++] = {d, start, rest};
    }
  }
  return true;
}

bool SpringLattice::reform_cells(int node, const Vector3& move, Reforming& next) const {
  constexpr float min_fraction = 0.25f, max_fraction = 4.0f, sum_of_volume = 12.0f;
  for (int c = 0; c < 8; ++c) {
    const int step_i = c >> 2 & 1, step_j = c >> 1 & 1, step_k = c & 1;
    const int first = node - mesh_.index(step_i, step_j, step_k);
    if (first < 0 || has_cell_[first] == 0.0f) continue;
    CellCorners corners;
    for (int o = 0; o < 8; ++o) corners[o] = position(first + mesh_.index(o >> 2 & 1, o >> 1 & 1, o & 1));
    const double before = cell_volume(corners);
    corners[c] += move;
    const double larger = cell_volume(corners) - before;
    const float sum = rest_volume_sum_[first] + sum_of_volume * static_cast<float>(larger);
    const float fraction = sum * inverse_volume_[first] / sum_of_volume;
    if (!(fraction >= min_fraction && fraction <= max_fraction)) return false;
    next.cells[next.cell_count++] = {first, sum};
  }
  return true;
}

bool SpringLattice::reform(int node, const Vector3& move_m) {
  // Uses the move between the stored positions, which are rounded to single precision.
  const Vector3 before = displacement(node);
  const Vector3 move = (before + move_m).cast<float>().cast<double>() - before;
  const int twin = mesh_.twin(node);
  Reforming next, twin_next;
  if (!reform_springs(node, move, next) || !reform_cells(node, move, next)) return false;
  if (twin != node && (!reform_springs(twin, move, twin_next) || !reform_cells(twin, move, twin_next))) {
    return false;
  }
  set_displacement(node, before + move);
  apply_reforming(next);
  apply_reforming(twin_next);
  return true;
}

void SpringLattice::apply_reforming(const Reforming& next) {
  for (std::size_t s = 0; s < next.spring_count; ++s) {
    const auto& [d, start, rest] = next.springs[s];
    const float change = rest - rest_length_[d][start];
    square_difference_[d][start] -= change * (2.0f * rest_length_[d][start] + change);
    rest_length_[d][start] = rest;
  }
  for (std::size_t c = 0; c < next.cell_count; ++c) {
    rest_volume_sum_[next.cells[c].first] = next.cells[c].rest_volume_sum;
  }
}

void join_seam_positions(const LatticeView& view) {
  for (float* const field : {view.dx, view.dy, view.dz, view.moved_x, view.moved_y, view.moved_z}) {
    for (int s = 0; s < view.seam_count; ++s) field[view.seam[2 * s + 1]] = field[view.seam[2 * s]];
  }
}

void shift_nodes(const LatticeView& view, int count, const Vector3& shift_m) {
  const float x = static_cast<float>(shift_m.x()), y = static_cast<float>(shift_m.y()),
              z = static_cast<float>(shift_m.z());
  for (int n = 0; n < count; ++n) {
    view.dx[n] += x;
    view.dy[n] += y;
    view.dz[n] += z;
    view.reference_x[n] += x;
    view.reference_y[n] += y;
    view.reference_z[n] += z;
  }
}

}  // namespace spoonbill
