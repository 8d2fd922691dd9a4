#include "engine/simulation/body_loads.h"

#include <algorithm>
#include <string>

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

// Each load becomes forces on nodes, or pressed faces.
struct BodyLoads::Making {
  const LatticeMesh& mesh;
  const std::function<EmbeddedPoint(double u, double v)>& point_at;
  std::vector<BodyPlace> places;
  std::vector<ShellFace> faces;
  BodyLoads result{};

  Status operator()(const PressureLoad& load) {
    const std::vector<ShellFace> within = faces_in(load.region, mesh, faces, places);
    if (within.empty()) return no_face();
    for (const ShellFace& face : within) result.pressures_.push_back({face, load.pressure_pa});
    return {};
  }

  Status operator()(const ForceLoad& load) {
    std::vector<double> shares(mesh.nodes.size(), 0.0);
    if (load.shared_by == ForceShare::surface) {
      const std::vector<ShellFace> within = faces_in(load.region, mesh, faces, places);
      if (within.empty()) return no_face();
      for (const ShellFace& face : within) {
        const auto at = [&](std::size_t c) { return mesh.nodes[static_cast<std::size_t>(face[c])]; };
        const double area = vector_area(at(0), at(1), at(2), at(3)).norm();
        for (const int node : face) shares[static_cast<std::size_t>(node)] += 0.25 * area;
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
  std::sort(result.nodes_.begin(), result.nodes_.end());
  result.nodes_.erase(std::unique(result.nodes_.begin(), result.nodes_.end()), result.nodes_.end());
  result.force_n_.assign(mesh.nodes.size(), Vector3::Zero());
  return result;
}

void BodyLoads::apply(double share, SpringLattice& lattice, ImplicitCore* core) {
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
  for (const int n : nodes_) lattice.set_node_force(n, force_n_[static_cast<std::size_t>(n)]);
  if (core) core->take_node_forces(lattice, nodes_);
}

}  // namespace spoonbill
