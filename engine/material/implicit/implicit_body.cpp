#include "engine/material/implicit/implicit_body.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/material/implicit/block_cell.h"

namespace spoonbill {
namespace {

constexpr int iteration_limit = 4;
// Of the residual that a step begins with, in the norm of the preconditioner.
constexpr double enough = 1e-4;
constexpr int power_steps = 200;
// Of a cell, in a step.
constexpr double speed_cap_cells = 0.5;

template <class Kernels>
const Kernels& chosen(InstructionSet set, const Kernels& baseline, const Kernels& avx2,
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

void take_cell(CellBatch& batch, int lane, const CellCorners& corners, const CellMatrix& stiffness) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& corner : corners) middle += corner / 8.0;
  const CellGradients gradients = middle_gradients(corners);
  for (int c = 0; c < 8; ++c) {
    for (int axis = 0; axis < 3; ++axis) {
      batch.rest[3 * c + axis][lane] = corners[static_cast<std::size_t>(c)][axis] - middle[axis];
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
    if (count < 2) return Error{"lattice: node counts must be at least 2 in each direction"};
  }
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  ImplicitBody body(
      mesh,
      chosen(set, kernels_baseline::band_kernels, kernels_avx2::band_kernels, kernels_avx512::band_kernels),
      chosen(set, kernels_baseline::cell_kernels, kernels_avx2::cell_kernels, kernels_avx512::cell_kernels));
  body.take_cells(materials);
  body.take_damping(materials);
  body.hold(std::vector<std::uint8_t>(static_cast<std::size_t>(mesh.node_count()), 0));
  return body;
}

ImplicitBody::ImplicitBody(const LatticeMesh& mesh, const BandKernels& band, const CellKernels& cells)
    : mesh_(mesh),
      band_(&band),
      cells_(&cells),
      cell_size_(mesh.mean_edge()),
      size_(3 * mesh.node_count()),
      factor_(mesh, band) {
  for (Doubles* a : {&mass3_, &free_, &moved_, &velocity_, &applied_, &held_velocity_, &force_, &residual_,
                     &direction_, &image_, &conditioned_}) {
    a->assign(static_cast<std::size_t>(factor_.padded_size()), 0.0);
  }
  mass_.assign(static_cast<std::size_t>(mesh.node_count()), 0.0);
}

void ImplicitBody::take_cells(const BlockMaterials& materials) {
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
        const BlockCell cell{mesh_.cell(i, j, k), mesh_.share(i, j, k),
                             parts_of(materials, mesh_.cell_index(i, j, k)), &materials.materials};
        CellBatch& batch = block_.batches.back();
        const CellMatrix stiffness = cell.stiffness();
        take_cell(batch, lane, cell.corners, cell.share * stiffness);
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
          for (const int diagonal : {0, 4, 8}) batch.turning[diagonal][rest] = 0.5;
        }
        ++lane;
      }
    }
  }
  block_.layers.push_back(static_cast<int>(block_.batches.size()));
  report_.divide_by(volume_m3);
}

// The largest eigenvalue of M^-1 K, by power iteration.
double ImplicitBody::fastest_square() {
  std::uint32_t mixed = 1;
  for (int n = 0; n < size_; ++n) {
    mixed = mixed * 1664525u + 1013904223u;
    direction_[static_cast<std::size_t>(n)] = static_cast<double>(mixed >> 16) / 32768.0 - 1.0;
  }
  double square = 0.0;
  for (int step = 0; step < power_steps; ++step) {
    std::fill(image_.begin(), image_.end(), 0.0);
    cells_->apply(block_.batches.data(), static_cast<int>(block_.batches.size()), 1.0, direction_.data(),
                  image_.data());
    for (int n = 0; n < size_; ++n) {
      const double mass = mass_[static_cast<std::size_t>(n / 3)];
      image_[static_cast<std::size_t>(n)] *= mass > 0.0 ? 1.0 / mass : 0.0;
    }
    const double length = std::sqrt(band_->dot(image_.data(), image_.data(), rounded_up(size_, band_block)));
    square =
        length / std::sqrt(band_->dot(direction_.data(), direction_.data(), rounded_up(size_, band_block)));
    for (int n = 0; n < size_; ++n) {
      direction_[static_cast<std::size_t>(n)] = image_[static_cast<std::size_t>(n)] / length;
    }
  }
  return square;
}

// As springs are damped: the ratio is of the fastest mode.
void ImplicitBody::take_damping(const BlockMaterials& materials) {
  const Material& stiffest = *std::max_element(
      materials.materials.begin(), materials.materials.end(),
      [](const Material& a, const Material& b) { return a.youngs_modulus_pa < b.youngs_modulus_pa; });
  std::fill(force_.begin(), force_.end(), 0.0);
  cells_->take_forces(block_.batches.data(), static_cast<int>(block_.batches.size()), moved_.data(),
                      force_.data());
  damping_time_ = 2.0 * stiffest.damping_ratio / std::sqrt(fastest_square());
}

void ImplicitBody::hold(std::span<const std::uint8_t> held) {
  SPOONBILL_ASSERT(held.size() == static_cast<std::size_t>(node_count()));
  has_held_nodes_ = std::find(held.begin(), held.end(), std::uint8_t{1}) != held.end();
  for (int n = 0; n < node_count(); ++n) {
    const bool is_first = mesh_.joined(n) == n;  // the second of a place has no coordinates of its own
    const bool is_free = held[static_cast<std::size_t>(n)] == 0 && is_first;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::size_t>(3 * n + axis);
      free_[at] = is_free ? 1.0 : 0.0;
      mass3_[at] = is_free ? mass_[static_cast<std::size_t>(n)] : 0.0;
    }
    if (!is_free && is_first) set_velocity(n, Vector3::Zero());
  }
  std::fill(held_velocity_.begin(), held_velocity_.end(), 0.0);
  held_moves_ = false;
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

// Leaves the free nodes their velocities, and takes what the held ones will pull at them.
void ImplicitBody::take_held_motion(double stiffness, double h) {
  free_only(velocity_);
  apply_matrix(0.0, stiffness, held_velocity_, image_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) force_[n] -= image_[n] / h;
}

// Takes the residual of the best multiple of the present velocities, from none to all of them: what is left
// of them where the gradients stop early is then no more than they can bear.
void ImplicitBody::begin_solve(double inertia, double stiffness, double h) {
  apply_matrix(inertia, stiffness, velocity_, image_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    residual_[n] = free_[n] * (mass3_[n] * velocity_[n] + h * force_[n]);
  }
  // Forces within the body add up to nothing.
  momentum_ = sum_over_nodes(residual_) / inertia;
  const int blocks = rounded_up(size_, band_block);
  const double kept = band_->dot(residual_.data(), velocity_.data(), blocks),
               all = band_->dot(image_.data(), velocity_.data(), blocks);
  const double share = all > 0.0 ? std::clamp(kept / all, 0.0, 1.0) : 1.0;
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    velocity_[n] *= share;
    residual_[n] -= share * image_[n];
  }
}

// With the residual taken.
ImplicitReport ImplicitBody::solve(double inertia, double stiffness) {
  const int blocks = rounded_up(size_, band_block);
  const auto dot = [&](const Doubles& a, const Doubles& b) { return band_->dot(a.data(), b.data(), blocks); };
  factor_.solve(residual_.data(), free_.data(), conditioned_.data());
  std::copy(conditioned_.begin(), conditioned_.end(), direction_.begin());
  const double first = dot(residual_, conditioned_);
  double square = first;
  ImplicitReport report;
  while (report.iterations < iteration_limit && square > enough * enough * first && first > 0.0) {
    apply_matrix(inertia, stiffness, direction_, image_);
    const double step = square / dot(direction_, image_);
    if (!std::isfinite(step)) break;
    ++report.iterations;
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
      velocity_[n] += step * direction_[n];
      residual_[n] -= step * image_[n];
    }
    factor_.solve(residual_.data(), free_.data(), conditioned_.data());
    const double next = dot(residual_, conditioned_), turn = next / square;
    square = next;
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
      direction_[n] = conditioned_[n] + turn * direction_[n];
    }
  }
  report.residual = first > 0.0 ? std::sqrt(square / first) : 0.0;
  return report;
}

// With the momentum and the moment of momentum that the body has.
ImplicitBody::RigidMotion ImplicitBody::rigid_motion() const {
  double mass_kg = 0.0;
  RigidMotion motion;
  for (int n = 0; n < node_count(); ++n) {
    mass_kg += this->mass_kg(n);
    motion.centre_m += this->mass_kg(n) * place(n);
    motion.velocity_m_per_s += this->mass_kg(n) * velocity(n);
  }
  motion.centre_m /= mass_kg;
  motion.velocity_m_per_s /= mass_kg;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vector3 moment = Vector3::Zero();
  for (int n = 0; n < node_count(); ++n) {
    const Vector3 from_middle = place(n) - motion.centre_m;
    moment += this->mass_kg(n) * from_middle.cross(velocity(n));
    inertia += this->mass_kg(n) * (from_middle.squaredNorm() * Eigen::Matrix3d::Identity() -
                                   from_middle * from_middle.transpose());
  }
  // A body drawn out to a line has no inertia about it.
  inertia.diagonal().array() += 1e-9 * inertia.trace();
  motion.spin_rad_per_s = inertia.ldlt().solve(moment);
  return motion;
}

// Beside the rigid motion. Returns whether any was.
bool ImplicitBody::cap_speeds(const RigidMotion& motion, double cap_m_per_s) {
  bool capped = false;
  for (int n = 0; n < node_count(); ++n) {
    if (free_[3 * static_cast<std::size_t>(n)] == 0.0) continue;
    const Vector3 whole = motion.velocity_at(place(n));
    const Vector3 own = velocity(n) - whole;
    const double speed = own.norm();
    if (speed <= cap_m_per_s) continue;
    set_velocity(n, whole + cap_m_per_s / speed * own);
    capped = true;
  }
  return capped;
}

// A free body turns as a whole, and what its nodes do beside that turns with it: along straight lines a fast
// spin would draw it out, by half the square of the angle of a step.
void ImplicitBody::move_and_turn(const RigidMotion& motion, double step_s) {
  const Vector3 half_turn = 0.5 * step_s * motion.spin_rad_per_s;
  const Eigen::Matrix3d turn =
      Quaternion(1.0, half_turn.x(), half_turn.y(), half_turn.z()).normalized().toRotationMatrix() -
      Eigen::Matrix3d::Identity();
  for (int n = 0; n < node_count(); ++n) {
    if (mesh_.joined(n) != n) continue;
    const Vector3 from_middle = place(n) - motion.centre_m, now = velocity(n);
    const Vector3 own = now - motion.velocity_at(place(n));
    const Vector3 turned = turn * from_middle;
    set_displacement(n, displacement(n) + turned + step_s * (motion.velocity_m_per_s + own + turn * own));
    set_velocity(n, now + motion.spin_rad_per_s.cross(turned) + turn * own);
  }
}

Vector3 ImplicitBody::sum_over_nodes(const Doubles& of) const {
  Vector3 sum = Vector3::Zero();
  for (int n = 0; n < node_count(); ++n) sum += at(of, n);
  return sum;
}

// Of a free body; gradients that stop early, and the cap, leave a little of it elsewhere.
void ImplicitBody::restore_momentum() {
  Vector3 momentum = Vector3::Zero();
  double mass = 0.0;
  for (int n = 0; n < node_count(); ++n) {
    momentum += mass_kg(n) * velocity(n);
    mass += mass_kg(n);
  }
  const Vector3 more = (momentum_ - momentum) / mass;
  for (int n = 0; n < node_count(); ++n) {
    if (mass_kg(n) > 0.0) set_velocity(n, velocity(n) + more);
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
  return moved > 0.0 ? strained / moved : 0.0;
}

ImplicitReport ImplicitBody::solve_velocities(const ImplicitStep& step, std::span<const double> known_ns) {
  SPOONBILL_ASSERT(step.step_s > 0.0 && step.damping_per_s >= 0.0);
  const double h = step.step_s, inertia = 1.0 + h * step.damping_per_s, stiffness = h * (h + damping_time_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) {
    force_[n] = applied_[n] + mass3_[n] * step.gravity_m_per_s2[static_cast<Eigen::Index>(n % 3)];
  }
  for (std::size_t n = 0; n < known_ns.size(); ++n) force_[n] += known_ns[n] / h;
  cells_->take_forces(block_.batches.data(), static_cast<int>(block_.batches.size()), moved_.data(),
                      force_.data());
  factor_.take_piece({&block_, mass_.data(), free_.data(), inertia, stiffness});
  if (held_moves_) take_held_motion(stiffness, h);
  begin_solve(inertia, stiffness, h);
  ImplicitReport report = solve(inertia, stiffness);
  if (held_moves_) {
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) velocity_[n] += held_velocity_[n];
  }
  if (!has_held_nodes_) restore_momentum();
  return report;
}

double ImplicitBody::answer(const std::vector<double>& impulses) {
  SPOONBILL_ASSERT(impulses.size() >= 3 * static_cast<std::size_t>(node_count()));
  std::copy(impulses.begin(), impulses.end(), image_.begin());
  free_only(image_);
  factor_.solve(image_.data(), free_.data(), conditioned_.data());
  return band_->dot(image_.data(), conditioned_.data(), rounded_up(size_, band_block));
}

void ImplicitBody::take_answer(double share) {
  for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) velocity_[n] += share * conditioned_[n];
}

bool ImplicitBody::move(double step_s) {
  const RigidMotion motion = has_held_nodes_ ? RigidMotion{} : rigid_motion();
  const bool capped = cap_speeds(motion, speed_cap_cells * cell_size_ / step_s);
  if (has_held_nodes_) {
    for (std::size_t n = 0; n < static_cast<std::size_t>(size_); ++n) moved_[n] += step_s * velocity_[n];
  } else {
    move_and_turn(motion, step_s);
  }
  return capped;
}

}  // namespace spoonbill
