#include "engine/trial/mass_points.h"

#include <array>
#include <optional>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/surfaces/closed_surface.h"
#include "engine/material/lattice/lattice_mesh.h"

namespace spoonbill {

MassPoints::MassPoints(const SpringLattice& lattice, const Surface& at_rest) {
  const LatticeMesh& mesh = lattice.mesh();
  // Only a box about a closed surface has cells of which a part is outside.
  const bool is_box = !mesh.filled.empty() && check_closed(at_rest).ok();
  std::optional<ShellDistance> inside;
  if (is_box) {
    const ClosedSkin skin = make_skin(at_rest);
    inside.emplace(skin.mesh.vertices_m, skin.mesh.triangles, ShellDistance::Kind::solid);
  }
  for (int place = 0; place < points_a_side * points_a_side * points_a_side; ++place) {
    const auto local = [](int index) { return (index + 0.5) / points_a_side; };
    const double along[3] = {local(place / (points_a_side * points_a_side)),
                             local(place / points_a_side % points_a_side), local(place % points_a_side)};
    std::array<double, 8>& weights = weights_.emplace_back();
    for (std::size_t c = 0; c < 8; ++c) {
      const bool bit[3] = {(c >> 2 & 1) != 0, (c >> 1 & 1) != 0, (c & 1) != 0};
      weights[c] = 1.0;
      for (int axis = 0; axis < 3; ++axis) weights[c] *= bit[axis] ? along[axis] : 1.0 - along[axis];
    }
  }
  double volume_m3 = 0.0;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        if (!mesh.is_filled(i, j, k)) continue;
        const CellCorners corners = mesh.cell(i, j, k);
        Cell cell;
        for (std::size_t c = 0; c < 8; ++c) {
          cell.nodes[c] = mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1));
        }
        // A cell that is farther inside than its own size needs no closer look.
        const bool is_whole =
            !inside || -inside->at(corners[0]).distance_m > (corners[7] - corners[0]).norm();
        std::vector<unsigned char> places;
        for (std::size_t place = 0; place < weights_.size(); ++place) {
          Vector3 point = Vector3::Zero();
          for (std::size_t c = 0; c < 8; ++c) point += weights_[place][c] * corners[c];
          if (is_whole || inside->at(point).distance_m < 0.0)
            places.push_back(static_cast<unsigned char>(place));
        }
        if (places.empty()) continue;
        const double part = inside ? static_cast<double>(places.size()) / static_cast<double>(weights_.size())
                                   : mesh.cell_fraction(i, j, k);
        cell.count = static_cast<int>(places.size());
        cell.fraction = part * cell_volume(corners) / cell.count;
        volume_m3 += part * cell_volume(corners);
        places_.insert(places_.end(), places.begin(), places.end());
        cells_.push_back(cell);
      }
    }
  }
  SPOONBILL_ASSERT(volume_m3 > 0.0);
  for (Cell& cell : cells_) cell.fraction /= volume_m3;
  std::vector<double> node_fractions(static_cast<std::size_t>(mesh.node_count()), 0.0);
  std::size_t at = 0;
  for (const Cell& cell : cells_) {
    for (int k = 0; k < cell.count; ++k, ++at) {
      for (std::size_t c = 0; c < 8; ++c)
        node_fractions[static_cast<std::size_t>(cell.nodes[c])] += cell.fraction * weights_[places_[at]][c];
    }
  }
  for (std::size_t n = 0; n < node_fractions.size(); ++n) {
    if (node_fractions[n] > 0.0) node_weights_.push_back({static_cast<int>(n), node_fractions[n]});
  }
}

}  // namespace spoonbill
