#include "engine/material/statics/static_body.h"

#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

std::variant<SpringCell, CorotatedCell> cell_of(const CellCorners& corners, const Material& material,
                                                CellKind kind, double share) {
  const double youngs = material.youngs_modulus_pa, poisson = material.poissons_ratio;
  if (kind == CellKind::hexahedra) {
    return CorotatedCell(corners, share * hexahedron_stiffness(corners, youngs, poisson));
  }
  return SpringCell(corners, cell_springs(corners, shear_modulus(youngs, poisson)),
                    bulk_stiffness(youngs, poisson), share);
}

}  // namespace

void hold_node(int node, const Vector3& displacement_m, std::vector<HeldAxis>& held) {
  SPOONBILL_ASSERT(node >= 0);
  for (int axis = 0; axis < 3; ++axis) held.push_back({node, axis, displacement_m[axis]});
}

Result<StaticBody> StaticBody::make(const LatticeMesh& mesh, const LatticeMaterials& materials,
                                    CellKind kind) {
  for (const Material& material : materials.materials) {
    if (const Status status = check_material(material); !status.ok()) return status.error();
    if (kind == CellKind::springs && material.poissons_ratio < 0.25) {
      return Error{"material " + material.name + ": poissons_ratio is " +
                   number_text(material.poissons_ratio) +
                   ", must be 0.25 or more for springs at rest; use hexahedra"};
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
        const double share = mesh.share(i, j, k);
        const Material& material = materials.of(mesh.cell_index(i, j, k));
        Cell cell{{}, cell_of(corners, material, kind, share)};
        for (int c = 0; c < 8; ++c) {
          const int node = mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1));
          cell.nodes[static_cast<std::size_t>(c)] = node;
          body.mass_[static_cast<std::size_t>(node)] +=
              material.density_kg_per_m3 * share * cell_volume(corners) / 8.0;
        }
        body.cells_.push_back(std::move(cell));
      }
    }
  }
  return body;
}

CellResponse StaticBody::respond(std::size_t cell, const CellMoves& moves, Tangent tangent) const {
  return std::visit([&](const auto& is) { return is.respond(moves, tangent); }, cells_[cell].is);
}

double StaticBody::energy_j(std::size_t cell, const CellMoves& moves) const {
  return std::visit([&](const auto& is) { return is.energy_j(moves); }, cells_[cell].is);
}

}  // namespace spoonbill
