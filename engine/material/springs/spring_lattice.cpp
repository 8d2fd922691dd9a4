#include "engine/material/springs/spring_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/material/cells/cell_springs.h"

namespace spoonbill {
namespace {

// The 13 directions of a regular lattice as steps in i, j, k, each with a positive offset in memory.
constexpr int direction_step[lattice_direction_count][3] = {
    {0, 1, 0}, {1, 0, 0},  {0, 0, 1}, {1, 1, 0},  {1, -1, 0}, {0, 1, 1},   {0, -1, 1},
    {1, 0, 1}, {-1, 0, 1}, {1, 1, 1}, {1, -1, 1}, {-1, 1, 1}, {-1, -1, 1},
};

int direction_of(int di, int dj, int dk) {
  for (int d = 0; d < lattice_direction_count; ++d) {
    if (direction_step[d][0] == di && direction_step[d][1] == dj && direction_step[d][2] == dk) return d;
  }
  return -1;
}

// A fixed, well-mixed sequence (Knuth's multiplicative hash), so that no mode is absent from it.
float mixed(std::uint32_t i) {
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

constexpr int frequency_steps = 300;
// Of the shear modulus: what is crushed holds its volume as a material of Poisson's ratio 0.45 does.
constexpr double crushed_share = 8.0;
constexpr float noise_share = 1e-4f;

}  // namespace

Result<SpringLattice> SpringLattice::make(const LatticeMesh& mesh, const Material& material,
                                          double youngs_modulus_pa, InstructionSet set) {
  if (const Status status = check_material(material); !status.ok()) return status.error();
  for (int axis = 0; axis < 3; ++axis) {
    if (mesh.count[axis] < 2) return Error{"lattice: node counts must be at least 2 in each direction"};
  }
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  SpringLattice lattice;
  lattice.kernels_ = &kernels_for(set);
  lattice.material_ = material;
  lattice.lay_out(mesh);
  lattice.assemble(material, youngs_modulus_pa);
  lattice.kernels_->measure_rest_volumes(lattice.view());
  lattice.hold(std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.node_count()), 0));
  lattice.measure_fastest_frequency();
  lattice.damping_time_ = static_cast<float>(2.0 * material.damping_ratio / lattice.fastest_frequency_);
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

// What the cells add up to, in double, before it is stored in single precision.
struct SpringLattice::Assembly {
  double shear_pa, bulk_pa, density_kg_per_m3;
  std::vector<double> mass, cell_count;  // one a node
  std::array<std::vector<double>, lattice_direction_count>
      stiffness;  // one a node: of the spring that starts there
};

void SpringLattice::assemble(const Material& material, double youngs_modulus_pa) {
  youngs_modulus_ = youngs_modulus_pa;
  rest_volume_ = 0.0;
  report_ = {};
  report_.worst_jacobian = 1.0;
  const auto nodes = static_cast<std::size_t>(mesh_.node_count());
  // Below, a core moves the lattice, and its springs rest.
  const double poissons_ratio = std::max(material.poissons_ratio, least_spring_poissons_ratio);
  Assembly sum{shear_modulus(youngs_modulus_pa, poissons_ratio),
               bulk_stiffness(youngs_modulus_pa, poissons_ratio),
               material.density_kg_per_m3,
               std::vector<double>(nodes, 0.0),
               std::vector<double>(nodes, 0.0),
               {}};
  sum.stiffness.fill(std::vector<double>(nodes, 0.0));
  for (int i = 0; i + 1 < mesh_.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh_.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh_.count[2]; ++k) add_cell(i, j, k, sum);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    report_.youngs_modulus_ratio[axis] /= rest_volume_;
    report_.poissons_ratio[axis] /= rest_volume_;
  }
  total_mass_ = material.density_kg_per_m3 * rest_volume_;
  join_nodes(sum);
  store_nodes(sum);
  for (int d = 0; d < lattice_direction_count; ++d) store_springs(d, sum);
}

void SpringLattice::add_cell(int i, int j, int k, Assembly& sum) {
  const CellCorners corners = mesh_.cell(i, j, k);
  const CellSprings springs = cell_springs(corners, sum.shear_pa);
  // Mass and stiffness by the same share: what vibrates in a part of a cell is no faster than the whole.
  const double share = mesh_.share(i, j, k), volume_m3 = share * springs.volume_m3;
  const auto node_of = [&](int corner) {
    return mesh_.index(i + (corner >> 2 & 1), j + (corner >> 1 & 1), k + (corner & 1));
  };
  for (int s = 0; s < cell_spring_count; ++s) {
    int from = cell_spring_corners[s][0], to = cell_spring_corners[s][1];
    const auto step = [&](int bit) { return (to >> bit & 1) - (from >> bit & 1); };
    int d = direction_of(step(2), step(1), step(0));
    if (d < 0) {
      std::swap(from, to);
      d = direction_of(step(2), step(1), step(0));
    }
    sum.stiffness[static_cast<std::size_t>(d)][static_cast<std::size_t>(node_of(from))] +=
        share * springs.stiffness_n_per_m[s];
  }
  for (int c = 0; c < 8; ++c) {
    const auto node = static_cast<std::size_t>(node_of(c));
    sum.mass[node] += sum.density_kg_per_m3 * volume_m3 / 8.0;
    sum.cell_count[node] += 1.0;
  }
  const int first = node_of(0);
  bulk_[first] = static_cast<float>(sum.bulk_pa * volume_m3);
  crushed_[first] = static_cast<float>(crushed_share * sum.shear_pa * volume_m3);
  inverse_volume_[first] = static_cast<float>(1.0 / springs.volume_m3);
  has_cell_[first] = 1.0f;
  rest_volume_ += volume_m3;
  const AchievedElasticity achieved = achieved_elasticity(corners, springs, sum.bulk_pa);
  for (int axis = 0; axis < 3; ++axis) {
    report_.youngs_modulus_ratio[axis] += volume_m3 * achieved.youngs_modulus_pa[axis] / youngs_modulus_;
    report_.poissons_ratio[axis] += volume_m3 * achieved.poissons_ratio[axis];
  }
  report_.worst_cell_misfit = std::max(report_.worst_cell_misfit, springs.misfit);
  report_.worst_jacobian = std::min(report_.worst_jacobian, smallest_jacobian_ratio(corners));
}

// The first of a seam's pair has the mass of both.
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
    power_noise_[n] = noise_share * mixed(static_cast<std::uint32_t>(mesh_.joined(static_cast<int>(n))) + 1) /
                      std::sqrt(static_cast<float>(total_mass_));
  }
}

void SpringLattice::store_springs(int d, const Assembly& sum) {
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const std::array<int, 3> at = mesh_.place(n);
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

void SpringLattice::measure_fastest_frequency() {
  const LatticeView lattice = view();
  for (int n = 0; n < mesh_.node_count(); ++n) {
    const int place = mesh_.joined(n);
    power_x_[n] = mixed(static_cast<std::uint32_t>(3 * place + 1));
    power_y_[n] = mixed(static_cast<std::uint32_t>(3 * place + 2));
    power_z_[n] = mixed(static_cast<std::uint32_t>(3 * place + 3));
  }
  kernels_->look_ahead(lattice, 0.0f);
  kernels_->linearise_springs(lattice);
  float square = 0.0f;
  for (int step = 0; step < frequency_steps; ++step) {
    square = kernels_->power_step(lattice, node_mass_.data());
  }
  fastest_frequency_ = std::sqrt(square);
}

LatticeView SpringLattice::view() {
  LatticeView v;
  v.padded_count = padded_count_;
  v.stiffening = static_cast<float>(material_.stiffening);
  v.volume_gives_way = material_.poissons_ratio < 0.25;
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
                    tangent_[d].data()};
  }
  for (int c = 1; c < 8; ++c) {
    v.corner_direction[c] = direction_of(c >> 2 & 1, c >> 1 & 1, c & 1);
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
  const float limit = 4.0f * share * share / (h_s * h_s + 2.0f * damping_time_ * h_s);
  for (int i = 0; i < padded_count_; ++i) {
    const float stable = limit / std::max(row_sum_[i], 1e-30f);
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
