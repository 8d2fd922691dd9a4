#include "engine/material/springs/spring_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/material/springs/lattice_assembly.h"

namespace spoonbill {
namespace {

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

constexpr int frequency_steps = 300;

}  // namespace

Result<SpringLattice> SpringLattice::make(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                          double youngs_modulus_pa, InstructionSet set) {
  if (const Status status = check_materials(materials); !status.ok()) return status.error();
  for (int axis = 0; axis < 3; ++axis) {
    if (mesh.count[axis] < 2) return Error{"lattice: node counts must be at least 2 in each direction"};
  }
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  SpringLattice lattice;
  lattice.kernels_ = &kernels_for(set);
  lattice.materials_ = materials;
  lattice.youngs_modulus_ = youngs_modulus_pa;
  lattice.lay_out(mesh);
  Assembly sum(lattice);
  lattice.assemble(sum);
  lattice.kernels_->measure_rest_volumes(lattice.view());
  lattice.hold(std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.node_count()), 0));
  lattice.fastest_frequency_ = lattice.measured_frequency();
  lattice.take_damping(sum);
  return lattice;
}

void SpringLattice::lay_out(const LatticeMesh& mesh) {
  mesh_ = mesh;
  cell_size_ = static_cast<float>(mesh.mean_edge());
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
  for (auto* vector : {&ahead_, &reference_, &moved_, &spring_force_}) {
    for (Floats& a : *vector) a.assign(size, 0.0f);
  }
  std::fill(inverse_volume_.begin(), inverse_volume_.end(), 1.0f);
  for (int d = 0; d < lattice_direction_count; ++d) {
    for (Floats* a : {&rest_y_[d], &rest_z_[d], &stiffness_[d], &square_difference_[d], &crept_[d]}) {
      a->assign(size, 0.0f);
    }
    tangent_[d].assign(tangent_runs * static_cast<std::size_t>(padded_count_), 0.0f);
    // Springs that do not exist have a length all the same, so that nothing divides by zero.
    for (Floats* a : {&rest_x_[d], &rest_length_[d], &first_rest_length_[d]}) a->assign(size, cell_size_);
  }
}

// By power iteration at rest.
float SpringLattice::measured_frequency() {
  const LatticeView lattice = view();
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const int place = mesh_.joined(n);
    power_x_[n] = mixed(static_cast<std::uint32_t>(3 * place + 1));
    power_y_[n] = mixed(static_cast<std::uint32_t>(3 * place + 2));
    power_z_[n] = mixed(static_cast<std::uint32_t>(3 * place + 3));
  }
  kernels_->look_ahead(lattice, 0.0f);
  kernels_->linearise_springs(lattice, Linearised::tangents);
  float square = 0.0f;
  for (int step = 0; step < frequency_steps; ++step) {
    square = kernels_->power_step(lattice, node_mass_.data());
  }
  return std::sqrt(square);
}

LatticeView SpringLattice::view() {
  LatticeView v;
  v.padded_count = padded_count_;
  v.stiffening = static_cast<float>(material().stiffening);
  for (const Material& each : materials_.materials) {
    v.stiffening = std::max(v.stiffening, static_cast<float>(each.stiffening));
  }
  v.volume_gives_way = least_poissons_ratio(materials_) < 0.25;
  v.dx = dx_.data();
  v.dy = dy_.data();
  v.dz = dz_.data();
  v.vx = vx_.data();
  v.vy = vy_.data();
  v.vz = vz_.data();
  v.fx = fx_.data();
  v.fy = fy_.data();
  v.fz = fz_.data();
  v.ahead_x = ahead_[0].data();
  v.ahead_y = ahead_[1].data();
  v.ahead_z = ahead_[2].data();
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
                    data_or_null(relaxing_share_[d]),
                    data_or_null(relaxation_time_[d])};
  }
  for (int c = 1; c < 8; ++c) {
    v.corner_direction[c] = direction_of(c >> 2 & 1, c >> 1 & 1, c & 1);
    v.corner_offset[c] = offset_[v.corner_direction[c]];
  }
  v.bulk_stiffness = bulk_.data();
  v.crushed_stiffness = crushed_.data();
  v.inverse_volume = inverse_volume_.data();
  v.rest_volume_sum = rest_volume_sum_.data();
  v.further_bulk_damping = data_or_null(further_bulk_damping_);
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
        volume += mesh_.share(i, j, k) * cell_volume(corners);
      }
    }
  }
  return volume;
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

const float* SpringLattice::steady_strained_nodes(float h_s, float share) {
  kernels_->row_sums(view(), row_sum_.data());
  // w^2 (h^2 + 2 tau h) <= 4 is h <= (2 / w) (sqrt(1 + z^2) - z) with z = tau w / 2.
  const float by_all = h_s * h_s + 2.0f * damping_time_ * h_s, limit = 4.0f * share * share / by_all;
  for (int i = 0; i < padded_count_; ++i) {
    float stable = limit / std::max(row_sum_[i], 1e-30f);
    if (is_damped_further()) stable *= by_all / (by_all + 2.0f * slowest_damping_[i] * h_s);
    stable_inverse_mass_[i] = std::min(inverse_mass_[i], stable);
    if (!(stable < inverse_mass_[i])) continue;
    // Heavier at the same momentum: otherwise forces that now act on more mass could not stop what they let
    // loose.
    const float slower = stable / inverse_mass_[i];
    for (Floats* v : {&vx_, &vy_, &vz_}) (*v)[i] *= slower;
  }
  return stable_inverse_mass_.data();
}

}  // namespace spoonbill
