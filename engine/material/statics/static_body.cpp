#include "engine/material/statics/static_body.h"

#include <algorithm>

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {

void PressedSkin::press(const BodySkin& skin, std::size_t triangle, double pressure_pa) {
  SPOONBILL_ASSERT(triangle < skin.triangles.size());
  point_index_.resize(skin.points.size(), -1);
  Pressed pressed{{}, pressure_pa};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t skin_point = skin.triangles[triangle][c];
    if (point_index_[skin_point] < 0) {
      point_index_[skin_point] = static_cast<int>(points_.size());
      points_.push_back(skin.points[skin_point]);
      position_m_.emplace_back(Vector3::Zero());
      force_n_.emplace_back(Vector3::Zero());
    }
    pressed.points[c] = static_cast<std::uint32_t>(point_index_[skin_point]);
  }
  triangles_.push_back(pressed);
}

std::vector<int> PressedSkin::nodes() const {
  std::vector<int> nodes;
  nodes.reserve(8 * points_.size());
  for (const CellPoint& point : points_) nodes.insert(nodes.end(), point.nodes.begin(), point.nodes.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void PressedSkin::update_point_forces() {
  for (const Pressed& pressed : triangles_) {
    const Vector3 &a = position_m_[pressed.points[0]], &b = position_m_[pressed.points[1]],
                  &c = position_m_[pressed.points[2]];
    const Vector3 each_n = -pressed.pressure_pa / 6.0 * (b - a).cross(c - a);
    for (const std::uint32_t point : pressed.points) force_n_[point] += each_n;
  }
}

namespace {

std::variant<SpringCell, CorotatedCell> make_cell(const CellCorners& corners, const Material& material,
                                                  CellKind kind, double fraction) {
  const double youngs = material.youngs_modulus_pa, poisson = material.poissons_ratio;
  if (kind == CellKind::hexahedra) {
    return CorotatedCell(corners, fraction * hexahedron_stiffness(corners, youngs, poisson));
  }
  return SpringCell(corners, material_springs(corners, youngs, poisson), bulk_stiffness(youngs, poisson),
                    fraction);
}

}  // namespace

void fix_node(int node, const Vector3& displacement_m, std::vector<FixedAxis>& fixed) {
  SPOONBILL_ASSERT(node >= 0);
  for (int axis = 0; axis < 3; ++axis) fixed.push_back({node, axis, displacement_m[axis]});
}

Result<StaticBody> StaticBody::make(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                    CellKind kind) {
  for (const Material& material : materials.materials) {
    if (const Status status = check_material(material); !status.ok()) return status.error();
    if (kind == CellKind::springs && material.poissons_ratio < 0.25) {
      return Error{ErrorCode::unsupported,
                   "material " + material.name + ": poissons_ratio is " +
                       number_text(material.poissons_ratio) +
                       ", must be 0.25 or more for a static study with springs; use hexahedra",
                   "poissons_ratio"};
    }
  }
  if (const Status status = check_cells(mesh); !status.ok()) return status.error();
  StaticBody body;
  body.mesh_ = mesh;
  body.mass_.assign(static_cast<std::size_t>(mesh.node_count()), 0.0);
  body.cells_.reserve(mesh.cell_count());
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        const CellCorners corners = mesh.cell(i, j, k);
        const double fraction = mesh.cell_fraction(i, j, k);
        const Material& material = materials.of(mesh.cell_index(i, j, k));
        Cell cell{{}, make_cell(corners, material, kind, fraction)};
        for (int c = 0; c < 8; ++c) {
          const int node = mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1));
          cell.nodes[static_cast<std::size_t>(c)] = node;
          body.mass_[static_cast<std::size_t>(node)] +=
              material.density_kg_per_m3 * fraction * cell_volume(corners) / 8.0;
        }
        body.cells_.push_back(std::move(cell));
      }
    }
  }
  return body;
}

CellResponse StaticBody::respond(std::size_t cell, const CellMoves& moves, Tangent tangent) const {
  return std::visit([&](const auto& model) { return model.respond(moves, tangent); }, cells_[cell].model);
}

double StaticBody::energy_j(std::size_t cell, const CellMoves& moves) const {
  return std::visit([&](const auto& model) { return model.energy_j(moves); }, cells_[cell].model);
}

}  // namespace spoonbill
