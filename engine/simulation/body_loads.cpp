#include "engine/simulation/body_loads.h"

#include <algorithm>
#include <string>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/material/lattice/shell_faces.h"

namespace spoonbill {
namespace {

// The volume of the cells around each node, an eighth of each.
std::vector<double> node_volumes(const LatticeMesh& mesh) {
  std::vector<double> volumes(mesh.nodes.size(), 0.0);
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        const double share_m3 = mesh.share(i, j, k) * cell_volume(mesh.cell(i, j, k)) / 8.0;
        for (int c = 0; c < 8; ++c) {
          volumes[static_cast<std::size_t>(mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1)))] +=
              share_m3;
        }
      }
    }
  }
  return volumes;
}

}  // namespace

// The triangles whose middles are in the region.
std::vector<std::size_t> triangles_in(const BodyRegion& region, const BodySkin& skin) {
  std::vector<std::size_t> within;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    if (contains(region, skin.middles[t])) within.push_back(t);
  }
  return within;
}

Vector3 rest_m(const CellPoint& point, const LatticeMesh& mesh) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t c = 0; c < 8; ++c) {
    sum += point.weights[c] * mesh.nodes[static_cast<std::size_t>(point.nodes[c])];
  }
  return sum;
}

// Each load becomes forces on nodes, or pressed faces.
struct BodyLoads::Making {
  const LatticeMesh& mesh;
  const std::function<EmbeddedPoint(double u, double v)>& point_at;
  std::vector<BodyPlace> places;
  std::vector<ShellFace> faces;
  BodyLoads result{};

  bool in_box() const { return !mesh.skin.triangles.empty(); }

  Status operator()(const PressureLoad& load) {
    if (in_box()) return press_skin(load);
    const std::vector<ShellFace> within = faces_in(load.region, mesh, faces, places);
    if (within.empty()) return no_face();
    for (const ShellFace& face : within) result.pressures_.push_back({face, load.pressure_pa});
    return {};
  }

  Status operator()(const ForceLoad& load) {
    std::vector<double> shares(mesh.nodes.size(), 0.0);
    if (load.shared_by == ForceShare::surface) {
      in_box() ? share_by_skin(load.region, shares) : share_by_faces(load.region, shares);
      if (std::all_of(shares.begin(), shares.end(), [](double share) { return share == 0.0; })) {
        return no_face();
      }
    } else {
      const std::vector<double> volumes = node_volumes(mesh);
      for (std::size_t n = 0; n < shares.size(); ++n) {
        if (contains(load.region, places[n])) shares[n] = volumes[n];
      }
    }
    return share_out(load.force_n, shares);
  }

  Status operator()(const PointLoad& load) {
    const EmbeddedPoint point = point_at(load.u, load.v);
    for (int i = 0; i < point.count; ++i) {
      result.forces_.push_back({point.node[i], static_cast<double>(point.weight[i]) * load.force_n});
    }
    return {};
  }

  Status press_skin(const PressureLoad& load) {
    const std::vector<std::size_t> within = triangles_in(load.region, mesh.skin);
    if (within.empty()) return no_face();
    for (const std::size_t triangle : within) {
      result.pressed_skin_.press(mesh.skin, triangle, load.pressure_pa);
    }
    return {};
  }

  void share_by_faces(const BodyRegion& region, std::vector<double>& shares) const {
    for (const ShellFace& face : faces_in(region, mesh, faces, places)) {
      const auto at = [&](std::size_t c) { return mesh.nodes[static_cast<std::size_t>(face[c])]; };
      const double area = vector_area(at(0), at(1), at(2), at(3)).norm();
      for (const int node : face) shares[static_cast<std::size_t>(node)] += 0.25 * area;
    }
  }

  void share_by_skin(const BodyRegion& region, std::vector<double>& shares) const {
    for (const std::size_t triangle : triangles_in(region, mesh.skin)) {
      const auto point = [&](std::size_t c) -> const CellPoint& {
        return mesh.skin.points[mesh.skin.triangles[triangle][c]];
      };
      const double area =
          triangle_area(rest_m(point(0), mesh), rest_m(point(1), mesh), rest_m(point(2), mesh));
      for (std::size_t corner = 0; corner < 3; ++corner) {
        for (std::size_t c = 0; c < 8; ++c) {
          shares[static_cast<std::size_t>(point(corner).nodes[c])] += area / 3.0 * point(corner).weights[c];
        }
      }
    }
  }

  Status share_out(const Vector3& force_n, const std::vector<double>& shares) {
    double sum = 0.0;
    for (const double share : shares) sum += share;
    if (!(sum > 0.0)) return Error{"its region holds no node of the lattice; make it larger"};
    for (std::size_t n = 0; n < shares.size(); ++n) {
      if (shares[n] > 0.0) result.forces_.push_back({static_cast<int>(n), shares[n] / sum * force_n});
    }
    return {};
  }

  static Status no_face() {
    return Error{"its region holds no middle of a face of the lattice's shell; make it larger"};
  }
};

Result<BodyLoads> BodyLoads::make(const std::vector<Load>& loads, const LatticeMesh& mesh,
                                  const std::function<EmbeddedPoint(double u, double v)>& point_at) {
  SPOONBILL_ASSERT(static_cast<bool>(point_at));
  if (loads.empty()) return BodyLoads();
  Making making{mesh, point_at, node_places(mesh), shell_faces(mesh)};
  for (std::size_t l = 0; l < loads.size(); ++l) {
    Status status = check_load(loads[l]);
    if (status.ok()) status = std::visit(making, loads[l]);
    if (!status.ok()) return Error{"loads[" + std::to_string(l) + "]: " + status.error().message};
  }
  BodyLoads result = std::move(making.result);
  for (const NodeForce& force : result.forces_) result.nodes_.push_back(force.node);
  for (const PressedFace& face : result.pressures_) {
    result.nodes_.insert(result.nodes_.end(), face.nodes.begin(), face.nodes.end());
  }
  const std::vector<int> under_skin = result.pressed_skin_.nodes();
  result.nodes_.insert(result.nodes_.end(), under_skin.begin(), under_skin.end());
  std::sort(result.nodes_.begin(), result.nodes_.end());
  result.nodes_.erase(std::unique(result.nodes_.begin(), result.nodes_.end()), result.nodes_.end());
  result.force_n_.assign(mesh.nodes.size(), Vector3::Zero());
  return result;
}

void BodyLoads::apply(double share, SpringLattice& lattice, ImplicitCore* core) {
  SPOONBILL_ASSERT(share >= 0.0);
  if (empty()) return;
  for (const int n : nodes_) force_n_[static_cast<std::size_t>(n)].setZero();
  for (const NodeForce& force : forces_) {
    force_n_[static_cast<std::size_t>(force.node)] += share * force.force_n;
  }
  for (const PressedFace& face : pressures_) {
    const auto at = [&](std::size_t c) { return lattice.position(face.nodes[c]); };
    const Vector3 force = -0.25 * share * face.pressure_pa * vector_area(at(0), at(1), at(2), at(3));
    for (const int node : face.nodes) force_n_[static_cast<std::size_t>(node)] += force;
  }
  pressed_skin_.find_forces(
      [&](int node) { return lattice.position(node); },
      [&](int node, const Vector3& force_n) { force_n_[static_cast<std::size_t>(node)] += share * force_n; });
  for (const int n : nodes_) lattice.set_node_force(n, force_n_[static_cast<std::size_t>(n)]);
  if (core) core->take_node_forces(lattice, nodes_);
}

}  // namespace spoonbill
