#include "engine/material/implicit/implicit_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"

namespace spoonbill {

std::vector<Overlap> find_overlaps(int block_cell, int block_count, int lattice_count) {
  SPOONBILL_ASSERT(block_count >= 2 && lattice_count >= 2);
  SPOONBILL_ASSERT(block_cell >= 0 && block_cell < block_count - 1);
  // Overlaps below this length are due to rounding.
  constexpr double least = 1e-9;
  std::vector<Overlap> result;
  const double scale = static_cast<double>(block_count - 1) / (lattice_count - 1);
  for (int cell = 0; cell + 1 < lattice_count; ++cell) {
    const double low = std::max(2.0 * (cell * scale - block_cell) - 1.0, -1.0);
    const double high = std::min(2.0 * ((cell + 1) * scale - block_cell) - 1.0, 1.0);
    if (high - low > least) result.push_back({cell, low, high});
  }
  return result;
}

namespace {

using Part = BlockMaterials::Part;

// Appends a part, or merges it into the last part if it follows that part along j and has the same material.
void add_part(const Part& part, std::vector<Part>& parts) {
  if (!parts.empty()) {
    Part& last = parts.back();
    const bool follows = last.material == part.material && last.high.y() == part.low.y() &&
                         last.low.x() == part.low.x() && last.low.z() == part.low.z();
    if (follows) {
      last.high.y() = part.high.y();
      return;
    }
  }
  parts.push_back(part);
}

// Returns a single part if all parts of a cell have the same material; otherwise returns the parts unchanged.
std::vector<Part> merge_parts(std::vector<Part> parts) {
  const bool alike = std::all_of(parts.begin(), parts.end(),
                                 [&](const Part& part) { return part.material == parts[0].material; });
  if (!alike) return parts;
  return {Part{-Vector3::Ones(), Vector3::Ones(), parts[0].material}};
}

}  // namespace

BlockMaterials make_block_materials(const LatticeMaterials& of, const std::array<int, 3>& lattice_count,
                                    const std::array<int, 3>& block_count) {
  BlockMaterials result(of.own());
  if (!of.has_several_materials()) return result;
  result.materials = of.materials;
  LatticeMesh lattice, block;  // used only to index cells
  lattice.count = lattice_count;
  block.count = block_count;
  result.parts_by_cell.resize(block.cell_count());
  for (int i = 0; i + 1 < block_count[0]; ++i) {
    const std::vector<Overlap> along_i = find_overlaps(i, block_count[0], lattice_count[0]);
    for (int j = 0; j + 1 < block_count[1]; ++j) {
      const std::vector<Overlap> along_j = find_overlaps(j, block_count[1], lattice_count[1]);
      for (int k = 0; k + 1 < block_count[2]; ++k) {
        std::vector<Part> parts;
        for (const Overlap& ck : find_overlaps(k, block_count[2], lattice_count[2])) {
          for (const Overlap& ci : along_i) {
            for (const Overlap& cj : along_j) {
              add_part({{ci.low, cj.low, ck.low},
                        {ci.high, cj.high, ck.high},
                        of.index_of(lattice.cell_index(ci.cell, cj.cell, ck.cell))},
                       parts);
            }
          }
        }
        result.parts_by_cell[block.cell_index(i, j, k)] = merge_parts(std::move(parts));
      }
    }
  }
  return result;
}

std::vector<BlockMaterials::Part> cell_parts(const BlockMaterials& materials, std::size_t cell) {
  if (materials.parts_by_cell.empty()) return {BlockMaterials::Part{}};
  return materials.parts_by_cell[cell];
}

CellMatrix BlockCell::stiffness() const {
  SPOONBILL_ASSERT(!parts.empty() && materials != nullptr);
  std::vector<HexahedronPart> elastic;
  for (const BlockMaterials::Part& part : parts) {
    const Material& material = (*materials)[part.material];
    elastic.push_back({part.low, part.high, material.youngs_modulus_pa, material.poissons_ratio});
  }
  return hexahedron_stiffness(corners, elastic);
}

std::array<double, 8> BlockCell::masses() const {
  std::array<double, 8> result{};
  if (parts.size() == 1) {
    result.fill((*materials)[parts[0].material].density_kg_per_m3 * fraction * cell_volume(corners) / 8.0);
    return result;
  }
  for (const BlockMaterials::Part& part : parts) {
    const std::array<double, 8> volumes = part_volumes(corners, part.low, part.high);
    for (std::size_t c = 0; c < 8; ++c) {
      result[c] += (*materials)[part.material].density_kg_per_m3 * fraction * volumes[c];
    }
  }
  return result;
}

void BlockCell::report(const CellMatrix& stiffness, LatticeReport& report) const {
  report.worst_jacobian = std::min(report.worst_jacobian, smallest_jacobian_ratio(corners));
  std::vector<double> filled(materials->size(), 0.0);
  for (const BlockMaterials::Part& part : parts) {
    filled[part.material] += (part.high - part.low).prod() / 8.0;
  }
  for (std::size_t m = 0; m < filled.size(); ++m) {
    if (filled[m] == 0.0) continue;
    const double youngs = (*materials)[m].youngs_modulus_pa, poisson = (*materials)[m].poissons_ratio;
    const CellMatrix alone = parts.size() == 1 ? stiffness : hexahedron_stiffness(corners, youngs, poisson);
    report.add(filled[m] * volume_m3(), achieved_elasticity(corners, alone), youngs, poisson);
  }
}

namespace {

constexpr int iteration_limit = 4;
// Residual at which the velocities are accepted, relative to the initial one, in the norm of the
// preconditioner.
constexpr double accepted_residual = 1e-4;
// Largest displacement of a node in a step, in cells.
constexpr double speed_cap_cells = 0.5;

template <class Kernels>
const Kernels& choose_kernels(InstructionSet set, const Kernels& baseline, const Kernels& avx2,
                              const Kernels& avx512) {
  switch (set) {
    case InstructionSet::avx512:
      return avx512;
    case InstructionSet::avx2:
      return avx2;
    case InstructionSet::baseline:
      break;
  }
  return baseline;
}

int rounded_up(int count, int block) {
  return (count + block - 1) / block * block;
}

void gather_cell(CellBatch& batch, int lane, const CellCorners& corners, const CellMatrix& stiffness) {
  Vector3 centre = Vector3::Zero();
  for (const Vector3& corner : corners) centre += corner / 8.0;
  const CellGradients gradients = centre_gradients(corners);
  for (int c = 0; c < 8; ++c) {
    for (int axis = 0; axis < 3; ++axis) {
      batch.rest[3 * c + axis][lane] = corners[static_cast<std::size_t>(c)][axis] - centre[axis];
      batch.gradient[3 * c + axis][lane] = gradients(c, axis);
    }
  }
  int entry = 0;
  for (int row = 0; row < cell_axes; ++row) {
    for (int column = 0; column <= row; ++column, ++entry) {
      batch.stiffness[entry][lane] = stiffness(row, column);
    }
  }
}

}  // namespace

Result<ImplicitBody> ImplicitBody::make(const LatticeMesh& mesh, const BlockMaterials& materials,
                                        InstructionSet set) {
  for (const Material& material : materials.materials) {
    if (const Status status = check_material(material); !status.ok()) return status.error();
  }
  for (const int count : mesh.count) {
    if (count < 2)
      return Error{ErrorCode::out_of_range, "lattice: node counts must be at least 2 in each direction",
                   "nodes"};
  }
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  ImplicitBody body(mesh,
                    choose_kernels(set, kernels_baseline::band_kernels, kernels_avx2::band_kernels,
                                   kernels_avx512::band_kernels),
                    choose_kernels(set, kernels_baseline::cell_kernels, kernels_avx2::cell_kernels,
                                   kernels_avx512::cell_kernels));
  body.add_cells(materials);
  body.set_damping_time(materials);
  body.fix_nodes(std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.node_count()), 0));
  return body;
}

ImplicitBody::ImplicitBody(const LatticeMesh& mesh, const BandKernels& band, const CellKernels& cells)
    : mesh_(mesh),
      band_(&band),
      cells_(&cells),
      cell_size_(mesh.mean_edge()),
      size_(3 * mesh.node_count()),
      factor_(mesh, band) {
  for (Doubles* a : {&mass3_, &free_, &moved_, &velocity_, &applied_, &fixed_velocity_, &force_, &residual_,
                     &direction_, &image_, &conditioned_, &in_frame_}) {
    a->assign(static_cast<std::size_t>(factor_.padded_size()), 0.0);
  }
  mass_.assign(static_cast<std::size_t>(mesh.node_count()), 0.0);
}

void ImplicitBody::add_cells(const BlockMaterials& materials) {
  block_.layer_cells = (mesh_.count[0] - 1) * (mesh_.count[1] - 1);
  double volume_m3 = 0.0;
  for (int k = 0; k + 1 < mesh_.count[2]; ++k) {
    block_.layers.push_back(static_cast<int>(block_.batches.size()));
    int lane = cell_lanes;
    for (int i = 0; i + 1 < mesh_.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh_.count[1]; ++j) {
        if (lane == cell_lanes) {
          block_.batches.emplace_back();
          block_.batches.back() = {};
          lane = 0;
        }
        const BlockCell cell{mesh_.cell(i, j, k), mesh_.cell_fraction(i, j, k),
                             cell_parts(materials, mesh_.cell_index(i, j, k)), &materials.materials};
        CellBatch& batch = block_.batches.back();
        const CellMatrix stiffness = cell.stiffness();
        gather_cell(batch, lane, cell.corners, cell.fraction * stiffness);
        cell.report(stiffness, report_);
        volume_m3 += cell.volume_m3();
        const std::array<double, 8> masses = cell.masses();
        for (int c = 0; c < 8; ++c) {
          const int node = mesh_.joined(mesh_.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1)));
          mass_[static_cast<std::size_t>(node)] += masses[static_cast<std::size_t>(c)];
          for (int rest = lane; rest < cell_lanes; ++rest) batch.node[c][rest] = node;
        }
        for (int rest = lane; rest < cell_lanes; ++rest) {
          batch.quaternion[0][rest] = 1.0;
          for (const int diagonal : {0, 4, 8}) batch.spin_map[diagonal][rest] = 0.5;
        }
        ++lane;
      }
    }
  }
  block_.layers.push_back(static_cast<int>(block_.batches.size()));
  report_.divide_by(volume_m3);
}

void ImplicitBody::set_damping_time(const BlockMaterials& materials) {
  const Material& stiffest = *std::max_element(
      materials.materials.begin(), materials.materials.end(),
      [](const Material& a, const Material& b) { return a.youngs_modulus_pa < b.youngs_modulus_pa; });
  damping_time_ = stiffest.damping_time_s;
  // Computes the derivatives of the cells' rotations, which a Rayleigh quotient before the first step needs.
  cells_->compute_forces(block_.batches.data(), static_cast<int>(block_.batches.size()), moved_.data(),
                         force_.data());
}

void ImplicitBody::set_inertia_scale(double scale) {
  SPOONBILL_ASSERT(scale >= 1.0);
  if (scale == inertia_scale_) return;
  inertia_scale_ = scale;
  factor_.forget();
}

void ImplicitBody::fix_nodes(std::span<const std::uint8_t> fixed) {
  SPOONBILL_ASSERT(fixed.size() == static_cast<std::size_t>(node_count()));
  has_fixed_nodes_ = std::find(fixed.begin(), fixed.end(), std::uint8_t{1}) != fixed.end();
  for (int n = 0; n < node_count(); ++n) {
    // The second of two joined nodes has no coordinates of its own.
    const bool is_first = mesh_.joined(n) == n;
    const bool is_free = fixed[static_cast<std::size_t>(n)] == 0 && is_first;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(3 * n + axis);
      free_[at] = is_free ? 1.0 : 0.0;
      mass3_[at] = is_free ? mass_[static_cast<std::size_t>(n)] : 0.0;
    }
    if (!is_free && is_first) set_velocity(n, Vector3::Zero());
  }
  std::fill(fixed_velocity_.begin(), fixed_velocity_.end(), 0.0);
  fixed_moves_ = false;
  frame_ = Quaternion::Identity();
  factor_.forget();
}

void ImplicitBody::free_only(Doubles& of) const {
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) of[n] *= free_[n];
}

void ImplicitBody::apply_matrix(double inertia, double stiffness, const Doubles& field, Doubles& out) const {
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) out[n] = inertia * mass3_[n] * field[n];
  cells_->apply(block_.batches.data(), static_cast<int>(block_.batches.size()), stiffness, field.data(),
                out.data());
  free_only(out);
}

// Sets the velocities of fixed nodes to zero, and adds the forces that the prescribed motion of fixed nodes
// exerts on free nodes.
void ImplicitBody::apply_fixed_motion(double stiffness, double h) {
  free_only(velocity_);
  apply_matrix(0.0, stiffness, fixed_velocity_, image_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) force_[n] -= image_[n] / h;
}

// Scales the velocities at the start of the step by the factor between 0 and 1 that minimises the quadratic
// form of the step, and computes the residual. Without this, conjugate gradients that stop early could leave
// velocities larger than the forces allow.
void ImplicitBody::begin_solve(double inertia, double stiffness, double h) {
  apply_matrix(inertia, stiffness, velocity_, image_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    residual_[n] = free_[n] * (inertia * mass3_[n] * velocity_[n] + h * force_[n]);
  }
  if (!has_fixed_nodes_) {
    // The internal forces and their moments sum to zero, so this is the motion at the end of the step.
    motion_ = rigid_motion([&](int n) { return Vector3(at(residual_, n) / inertia); });
  }
  const int blocks = rounded_up(size_, band_block);
  const double along_velocity = band_->dot(residual_.data(), velocity_.data(), blocks),
               all = band_->dot(image_.data(), velocity_.data(), blocks);
  const double fraction = all > 0.0 ? std::clamp(along_velocity / all, 0.0, 1.0) : 1.0;
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    velocity_[n] *= fraction;
    residual_[n] -= fraction * image_[n];
  }
}

// Solves for the velocities by conjugate gradients. The residual must be set.
ImplicitReport ImplicitBody::solve(double inertia, double stiffness) {
  const int blocks = rounded_up(size_, band_block);
  const auto dot = [&](const Doubles& a, const Doubles& b) { return band_->dot(a.data(), b.data(), blocks); };
  precondition(residual_, conditioned_);
  std::copy(conditioned_.begin(), conditioned_.end(), direction_.begin());
  const double first = dot(residual_, conditioned_);
  double square = first;
  ImplicitReport report;
  while (report.iterations < iteration_limit && square > accepted_residual * accepted_residual * first &&
         first > 0.0) {
    apply_matrix(inertia, stiffness, direction_, image_);
    const double step = square / dot(direction_, image_);
    if (!std::isfinite(step)) break;
    ++report.iterations;
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
      velocity_[n] += step * direction_[n];
      residual_[n] -= step * image_[n];
    }
    precondition(residual_, conditioned_);
    const double next = dot(residual_, conditioned_), turn = next / square;
    square = next;
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
      direction_[n] = conditioned_[n] + turn * direction_[n];
    }
  }
  report.residual = first > 0.0 ? std::sqrt(square / first) : 0.0;
  return report;
}

void ImplicitBody::update_inertia() {
  inertia_ = {};
  for (int n = 0; n < node_count(); ++n) {
    inertia_.mass_kg += mass_kg(n);
    inertia_.centre_m += mass_kg(n) * deformed_position(n);
  }
  inertia_.centre_m /= inertia_.mass_kg;
  for (int n = 0; n < node_count(); ++n) {
    const Vector3 from_centre = deformed_position(n) - inertia_.centre_m;
    inertia_.tensor_kg_m2 += mass_kg(n) * (from_centre.squaredNorm() * Eigen::Matrix3d::Identity() -
                                           from_centre * from_centre.transpose());
  }
  // A body stretched to a line has no inertia about that line; the small term keeps the tensor regular.
  inertia_.tensor_kg_m2.diagonal().array() += 1e-9 * inertia_.tensor_kg_m2.trace();
}

template <class Momenta>
ImplicitBody::RigidMotion ImplicitBody::rigid_motion(const Momenta& momentum_ns) const {
  Vector3 momentum = Vector3::Zero(), moment = Vector3::Zero();
  for (int n = 0; n < node_count(); ++n) {
    const Vector3 of_node = momentum_ns(n);
    momentum += of_node;
    moment += (deformed_position(n) - inertia_.centre_m).cross(of_node);
  }
  return {inertia_.centre_m, momentum / inertia_.mass_kg, solve_symmetric(inertia_.tensor_kg_m2, moment)};
}

ImplicitBody::RigidMotion ImplicitBody::rigid_part(const Doubles& velocities) const {
  return rigid_motion([&](int n) { return Vector3(mass_kg(n) * at(velocities, n)); });
}

// Caps the speeds relative to the rigid motion. Returns whether any speed was capped.
bool ImplicitBody::cap_speeds(const RigidMotion& motion, double cap_m_per_s) {
  bool capped = false;
  for (int n = 0; n < node_count(); ++n) {
    if (free_[3 * static_cast<std::size_t>(n)] == 0.0) continue;
    const Vector3 whole = motion.velocity_at(deformed_position(n));
    const Vector3 own = velocity(n) - whole;
    const double speed = own.norm();
    if (speed <= cap_m_per_s) continue;
    set_velocity(n, whole + cap_m_per_s / speed * own);
    capped = true;
  }
  return capped;
}

// Moves a free body: it rotates as a whole, and the relative motion of its nodes rotates with it. If nodes
// moved along straight lines, a fast spin would stretch the body by half the square of the angle per step.
// The body keeps its angular momentum, so its spin changes with its inertia tensor; it rotates with the spin
// at half of the step.
void ImplicitBody::move_and_turn(const RigidMotion& motion, double step_s) {
  const Vector3 moment = inertia_.tensor_kg_m2 * motion.spin_rad_per_s;
  const auto spin_after = [&](const Quaternion& turn) {
    const Eigen::Matrix3d matrix = turn.toRotationMatrix();
    return Vector3(solve_symmetric(matrix * inertia_.tensor_kg_m2 * matrix.transpose(), moment));
  };
  const Vector3 spin = spin_after(rotation_about(0.5 * step_s * motion.spin_rad_per_s));
  const Quaternion rotation = rotation_about(step_s * spin);
  const RigidMotion after{motion.centre_m, motion.velocity_m_per_s, spin_after(rotation)};
  const Eigen::Matrix3d turn = rotation.toRotationMatrix() - Eigen::Matrix3d::Identity();
  for (int n = 0; n < node_count(); ++n) {
    if (mesh_.joined(n) != n) continue;
    const Vector3 here = deformed_position(n);
    const Vector3 rotated = turn * (here - motion.centre_m);
    Vector3 own = velocity(n) - motion.velocity_at(here);
    own += turn * own;
    set_displacement(n, displacement(n) + rotated + step_s * (motion.velocity_m_per_s + own));
    set_velocity(n, after.velocity_at(here + rotated) + own);
  }
  turn_frame(rotation);
}

// Applies the inverse of the matrix of some ticks ago. The factor of a free body is in the body's frame,
// where its rotation does not change the matrix.
void ImplicitBody::precondition(const Doubles& from, Doubles& to) {
  if (has_fixed_nodes_) {
    factor_.solve(from.data(), free_.data(), to.data());
    return;
  }
  const Eigen::Matrix3d turn = frame_.toRotationMatrix();
  for (int n = 0; n < node_count(); ++n) put(in_frame_, n, turn.transpose() * at(from, n));
  factor_.solve(in_frame_.data(), free_.data(), to.data());
  for (int n = 0; n < node_count(); ++n) put(to, n, turn * at(to, n));
}

// Sets the rigid part of velocities, which truncated conjugate gradients, the speed cap and the factor of an
// earlier shape change.
void ImplicitBody::set_rigid_part(const RigidMotion& motion, Doubles& velocities) const {
  const RigidMotion part = rigid_part(velocities);
  const RigidMotion missing{motion.centre_m, motion.velocity_m_per_s - part.velocity_m_per_s,
                            motion.spin_rad_per_s - part.spin_rad_per_s};
  for (int n = 0; n < node_count(); ++n) {
    if (mesh_.joined(n) != n) continue;
    put(velocities, n, at(velocities, n) + missing.velocity_at(deformed_position(n)));
  }
}

double ImplicitBody::rayleigh_quotient() {
  const int blocks = rounded_up(size_, band_block);
  std::copy(velocity_.begin(), velocity_.end(), direction_.begin());
  free_only(direction_);
  apply_matrix(0.0, 1.0, direction_, image_);
  const double strained = band_->dot(direction_.data(), image_.data(), blocks);
  apply_matrix(1.0, 0.0, direction_, image_);
  const double moved = band_->dot(direction_.data(), image_.data(), blocks);
  return moved > 0.0 ? strained / (inertia_scale_ * moved) : 0.0;
}

ImplicitReport ImplicitBody::solve_velocities(const ImplicitStep& step, std::span<const double> known_ns) {
  SPOONBILL_ASSERT(step.step_s > 0.0 && step.drag_per_s >= 0.0);
  const double h = step.step_s, inertia = inertia_scale_, stiffness = h * (h + damping_time_);
  const double decay = 1.0 / (1.0 + h * step.drag_per_s);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) velocity_[n] *= decay;
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    force_[n] = applied_[n] + mass3_[n] * step.gravity_m_per_s2[static_cast<Eigen::Index>(n % 3)];
  }
  for (std::size_t n = 0; n < known_ns.size(); ++n) force_[n] += known_ns[n] / h;
  cells_->compute_forces(block_.batches.data(), static_cast<int>(block_.batches.size()), moved_.data(),
                         force_.data());
  factor_.advance({&block_, mass_.data(), free_.data(), frame_.toRotationMatrix(), inertia, stiffness});
  if (fixed_moves_) apply_fixed_motion(stiffness, h);
  if (!has_fixed_nodes_) update_inertia();
  begin_solve(inertia, stiffness, h);
  ImplicitReport report = solve(inertia, stiffness);
  if (fixed_moves_) {
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) velocity_[n] += fixed_velocity_[n];
  }
  if (!has_fixed_nodes_) set_rigid_part(motion_, velocity_);
  return report;
}

double ImplicitBody::respond_to(const std::vector<double>& impulses) {
  SPOONBILL_ASSERT_DEBUG(has_fixed_nodes_ || inertia_.mass_kg > 0.0);
  SPOONBILL_ASSERT(impulses.size() >= 3 * static_cast<std::size_t>(node_count()));
  std::copy(impulses.begin(), impulses.end(), image_.begin());
  free_only(image_);
  precondition(image_, conditioned_);
  if (!has_fixed_nodes_) {
    set_rigid_part(rigid_motion([&](int n) { return Vector3(at(image_, n) / inertia_scale_); }),
                   conditioned_);
  }
  return band_->dot(image_.data(), conditioned_.data(), rounded_up(size_, band_block));
}

void ImplicitBody::apply_response(double fraction) {
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n)
    velocity_[n] += fraction * conditioned_[n];
}

bool ImplicitBody::move(double step_s) {
  const RigidMotion motion = has_fixed_nodes_ ? RigidMotion{} : rigid_part(velocity_);
  const bool capped = cap_speeds(motion, speed_cap_cells * cell_size_ / step_s);
  if (has_fixed_nodes_) {
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) moved_[n] += step_s * velocity_[n];
  } else {
    move_and_turn(motion, step_s);
  }
  return capped;
}

}  // namespace spoonbill
