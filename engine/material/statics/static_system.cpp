#include "engine/material/statics/static_system.h"

#include <algorithm>
#include <cmath>

#include "engine/material/lattice/body_coordinates.h"

namespace spoonbill {
namespace {

constexpr int corner_axes = 24, cell_entries = 300;

Eigen::Index coordinate(const std::array<int, 8>& nodes, int cell_axis) {
  return 3 * static_cast<Eigen::Index>(nodes[static_cast<std::size_t>(cell_axis / 3)]) + cell_axis % 3;
}

Vector3 at_node(const Eigen::VectorXd& all, int node) {
  return all.segment<3>(3 * static_cast<Eigen::Index>(node));
}

// Adds to each corner of a face a quarter of the pressure's force on the face's vector area.
void add_pressure(const PressedFace& face, const LatticeMesh& mesh, const Eigen::VectorXd& at,
                  Eigen::VectorXd& forces) {
  const auto corner = [&](std::size_t c) -> Vector3 {
    return mesh.nodes[static_cast<std::size_t>(face.nodes[c])] + at_node(at, face.nodes[c]);
  };
  const Vector3 area = vector_area(corner(0), corner(1), corner(2), corner(3));
  for (const int node : face.nodes) {
    forces.segment<3>(3 * static_cast<Eigen::Index>(node)) -= 0.25 * face.pressure_pa * area;
  }
}

}  // namespace

StaticSystem::StaticSystem(const StaticBody& body, const std::vector<FixedAxis>& fixed)
    : body_(&body), fixed_(fixed), free_(3 * static_cast<std::size_t>(body.mesh().node_count()), 0) {
  const LatticeMesh& mesh = body.mesh();
  for (const FixedAxis& axis : fixed) {
    if (mesh.twin(axis.node) != axis.node) {
      fixed_.push_back({mesh.twin(axis.node), axis.axis, axis.displacement_m});
    }
  }
  for (const FixedAxis& axis : fixed_) free_[static_cast<std::size_t>(3 * axis.node + axis.axis)] = -1;
  for (std::size_t c = 0; c < free_.size(); ++c) {
    const int node = static_cast<int>(c / 3), joined = mesh.joined(node);  // `joined` <= `node`
    if (free_[c] != 0) continue;
    free_[c] = joined == node ? free_count_++ : free_[3 * static_cast<std::size_t>(joined) + c % 3];
  }
  build_pattern();
}

void StaticSystem::build_pattern() {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(body_->cell_count() * cell_entries);
  const auto visit = [&](const auto& receive) {
    for (std::size_t cell = 0; cell < body_->cell_count(); ++cell) {
      const std::array<int, 8>& nodes = body_->cell_nodes(cell);
      for (int row = 0; row < corner_axes; ++row) {
        for (int column = 0; column <= row; ++column) {
          const Eigen::Index a = free_[static_cast<std::size_t>(coordinate(nodes, row))];
          const Eigen::Index b = free_[static_cast<std::size_t>(coordinate(nodes, column))];
          receive(std::max(a, b), std::min(a, b));
        }
      }
    }
  };
  visit([&](Eigen::Index row, Eigen::Index column) {
    if (column >= 0) entries.emplace_back(row, column, 1.0);
  });
  stiffness_.resize(free_count_, free_count_);
  stiffness_.setFromTriplets(entries.begin(), entries.end());
  stiffness_.makeCompressed();
  value_index_.reserve(entries.size());
  const auto *begin = stiffness_.innerIndexPtr(), *start = stiffness_.outerIndexPtr();
  visit([&](Eigen::Index row, Eigen::Index column) {
    if (column < 0) {
      value_index_.push_back(-1);
      return;
    }
    const auto* const found =
        std::lower_bound(begin + start[column], begin + start[column + 1], static_cast<int>(row));
    value_index_.push_back(found - begin);
  });
}

void StaticSystem::set_fixed(double fraction, Coordinates& at) const {
  for (const FixedAxis& axis : fixed_) {
    at[3 * static_cast<Eigen::Index>(axis.node) + axis.axis] = fraction * axis.displacement_m;
  }
}

void StaticSystem::move(const Coordinates& free_step, double fraction, Coordinates& at) const {
  for (std::size_t c = 0; c < free_.size(); ++c) {
    if (free_[c] >= 0) at[static_cast<Eigen::Index>(c)] += fraction * free_step[free_[c]];
  }
}

CellMoves StaticSystem::cell_moves(std::size_t cell, const Coordinates& at) const {
  CellMoves moves;
  for (std::size_t c = 0; c < 8; ++c) moves[c] = at_node(at, body_->cell_nodes(cell)[c]);
  return moves;
}

double StaticSystem::energy_j(const Coordinates& at) const {
  double sum = 0.0;
  for (std::size_t cell = 0; cell < body_->cell_count(); ++cell) {
    sum += body_->energy_j(cell, cell_moves(cell, at));
  }
  return sum;
}

StaticSystem::Forces StaticSystem::respond(const Coordinates& at, Tangent tangent) {
  Forces forces{Coordinates::Zero(at.size())};
  std::fill_n(stiffness_.valuePtr(), stiffness_.nonZeros(), 0.0);
  for (std::size_t cell = 0; cell < body_->cell_count(); ++cell) {
    const CellResponse response = body_->respond(cell, cell_moves(cell, at), tangent);
    const std::array<int, 8>& nodes = body_->cell_nodes(cell);
    for (int a = 0; a < corner_axes; ++a) forces.restoring[coordinate(nodes, a)] += response.force_n[a];
    forces.size += response.force_n.squaredNorm();
    add(cell, response.tangent);
  }
  forces.size = std::sqrt(forces.size);
  return forces;
}

void StaticSystem::add(std::size_t cell, const CellMatrix& tangent) {
  const Eigen::Index* index = value_index_.data() + cell * cell_entries;
  for (int row = 0; row < corner_axes; ++row) {
    for (int column = 0; column <= row; ++column, ++index) {
      if (*index >= 0) stiffness_.valuePtr()[*index] += tangent(row, column);
    }
  }
}

StaticSystem::Coordinates StaticSystem::loads(const StaticLoads& loads, const Coordinates& at) const {
  Coordinates forces(at.size());
  for (int n = 0; n < body_->mesh().node_count(); ++n) {
    forces.segment<3>(3 * static_cast<Eigen::Index>(n)) = body_->mass_kg(n) * loads.gravity_m_per_s2;
  }
  for (const NodeForce& force : loads.forces) {
    forces.segment<3>(3 * static_cast<Eigen::Index>(force.node)) += force.force_n;
  }
  for (const PressedFace& face : loads.pressures) add_pressure(face, body_->mesh(), at, forces);
  PressedSkin skin = loads.pressed_skin;
  skin.find_forces(
      [&](int node) -> Vector3 {
        return body_->mesh().nodes[static_cast<std::size_t>(node)] + at_node(at, node);
      },
      [&](int node, const Vector3& force_n) {
        forces.segment<3>(3 * static_cast<Eigen::Index>(node)) += force_n;
      });
  return forces;
}

StaticSystem::Coordinates StaticSystem::restrict_to_free(const Coordinates& all) const {
  Coordinates result = Coordinates::Zero(free_count_);
  for (std::size_t c = 0; c < free_.size(); ++c) {
    if (free_[c] >= 0) result[free_[c]] += all[static_cast<Eigen::Index>(c)];
  }
  return result;
}

}  // namespace spoonbill
