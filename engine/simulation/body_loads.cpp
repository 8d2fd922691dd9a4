#include "engine/simulation/body_loads.h"

#include <algorithm>
#include <string>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_parts.h"
#include "engine/material/lattice/body_coordinates.h"

namespace spoonbill {
namespace {

// Returns the volume of the body that each node represents: an eighth of the filled volume of each cell
// around it.
std::vector<double> compute_node_volumes(const LatticeMesh& mesh) {
  std::vector<double> volumes(mesh.nodes.size(), 0.0);
  for (int i = 0; i + 1 < mesh.count[0]; ++i) {
    for (int j = 0; j + 1 < mesh.count[1]; ++j) {
      for (int k = 0; k + 1 < mesh.count[2]; ++k) {
        const double node_volume_m3 = mesh.cell_fraction(i, j, k) * cell_volume(mesh.cell(i, j, k)) / 8.0;
        for (int c = 0; c < 8; ++c) {
          volumes[static_cast<std::size_t>(mesh.index(i + (c >> 2 & 1), j + (c >> 1 & 1), k + (c & 1)))] +=
              node_volume_m3;
        }
      }
    }
  }
  return volumes;
}

// Returns the triangles whose centres are in the region.
std::vector<std::size_t> find_triangles(const BodyRegion& region, const BodySkin& skin) {
  std::vector<std::size_t> within;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    if (contains(region, skin.triangle_centres[t])) within.push_back(t);
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

}  // namespace

// Converts the loads of a body to forces on nodes and pressed faces.
struct BodyLoads::Builder {
  const LatticeMesh& mesh;
  const std::function<EmbeddedPoint(double u, double v)>& point_at;
  std::vector<BodyCoordinates> coordinates;
  std::vector<ShellFace> faces;
  BodyLoads result{};

  bool is_boxed() const { return !mesh.skin.triangles.empty(); }

  Status operator()(const PressureLoad& load) {
    if (is_boxed()) return press_skin(load);
    const std::vector<ShellFace> within = find_faces_in(load.region, mesh, faces, coordinates);
    if (within.empty()) return no_face();
    for (const ShellFace& face : within) result.pressures_.push_back({face, load.pressure_pa});
    return {};
  }

  Status operator()(const ForceLoad& load) {
    std::vector<double> weights(mesh.nodes.size(), 0.0);
    if (load.distributed_by == ForceDistribution::surface) {
      is_boxed() ? weigh_by_skin(load.region, weights) : weigh_by_faces(load.region, weights);
      if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0.0; })) {
        return no_face();
      }
    } else {
      const std::vector<double> volumes = compute_node_volumes(mesh);
      for (std::size_t n = 0; n < weights.size(); ++n) {
        if (contains(load.region, coordinates[n])) weights[n] = volumes[n];
      }
    }
    return distribute(load.force_n, weights);
  }

  Status operator()(const PointLoad& load) {
    const EmbeddedPoint point = point_at(load.u, load.v);
    for (int i = 0; i < point.count; ++i) {
      result.forces_.push_back({point.node[i], static_cast<double>(point.weight[i]) * load.force_n});
    }
    return {};
  }

  Status press_skin(const PressureLoad& load) {
    const std::vector<std::size_t> within = find_triangles(load.region, mesh.skin);
    if (within.empty()) return no_face();
    for (const std::size_t triangle : within) {
      result.pressed_skin_.press(mesh.skin, triangle, load.pressure_pa);
    }
    return {};
  }

  void weigh_by_faces(const BodyRegion& region, std::vector<double>& weights) const {
    for (const ShellFace& face : find_faces_in(region, mesh, faces, coordinates)) {
      const auto at = [&](std::size_t c) { return mesh.nodes[static_cast<std::size_t>(face[c])]; };
      const double area = vector_area(at(0), at(1), at(2), at(3)).norm();
      for (const int node : face) weights[static_cast<std::size_t>(node)] += 0.25 * area;
    }
  }

  void weigh_by_skin(const BodyRegion& region, std::vector<double>& weights) const {
    for (const std::size_t triangle : find_triangles(region, mesh.skin)) {
      const auto point = [&](std::size_t c) -> const CellPoint& {
        return mesh.skin.points[mesh.skin.triangles[triangle][c]];
      };
      const double area =
          triangle_area(rest_m(point(0), mesh), rest_m(point(1), mesh), rest_m(point(2), mesh));
      for (std::size_t corner = 0; corner < 3; ++corner) {
        for (std::size_t c = 0; c < 8; ++c) {
          weights[static_cast<std::size_t>(point(corner).nodes[c])] += area / 3.0 * point(corner).weights[c];
        }
      }
    }
  }

  Status distribute(const Vector3& force_n, const std::vector<double>& weights) {
    double sum = 0.0;
    for (const double weight : weights) sum += weight;
    if (!(sum > 0.0))
      return Error{ErrorCode::too_few, "the region contains no lattice node; enlarge it", "region"};
    for (std::size_t n = 0; n < weights.size(); ++n) {
      if (weights[n] > 0.0) result.forces_.push_back({static_cast<int>(n), weights[n] / sum * force_n});
    }
    return {};
  }

  static Status no_face() {
    return Error{ErrorCode::too_few,
                 "the region contains no face centre of the lattice's shell; enlarge the region", "region"};
  }
};

Result<BodyLoads> BodyLoads::make(const std::vector<Load>& loads, const LatticeMesh& mesh,
                                  const std::function<EmbeddedPoint(double u, double v)>& point_at) {
  SPOONBILL_ASSERT(static_cast<bool>(point_at));
  if (loads.empty()) return BodyLoads();
  Builder builder{mesh, point_at, find_node_coordinates(mesh), shell_faces(mesh)};
  for (std::size_t l = 0; l < loads.size(); ++l) {
    Status status = check_load(loads[l]);
    if (status.ok()) status = std::visit(builder, loads[l]);
    if (!status.ok()) return status.error().in("loads[" + std::to_string(l) + "]");
  }
  BodyLoads result = std::move(builder.result);
  for (const NodeForce& force : result.forces_) result.nodes_.push_back(force.node);
  for (const PressedFace& face : result.pressures_) {
    result.nodes_.insert(result.nodes_.end(), face.nodes.begin(), face.nodes.end());
  }
  const std::vector<int> skin_nodes = result.pressed_skin_.nodes();
  result.nodes_.insert(result.nodes_.end(), skin_nodes.begin(), skin_nodes.end());
  std::sort(result.nodes_.begin(), result.nodes_.end());
  result.nodes_.erase(std::unique(result.nodes_.begin(), result.nodes_.end()), result.nodes_.end());
  result.force_n_.assign(mesh.nodes.size(), Vector3::Zero());
  return result;
}

void BodyLoads::apply(SpringLattice& lattice, ImplicitSolver* solver) {
  if (empty()) return;
  for (const int n : nodes_) force_n_[static_cast<std::size_t>(n)].setZero();
  for (const NodeForce& force : forces_) {
    force_n_[static_cast<std::size_t>(force.node)] += force.force_n;
  }
  for (const PressedFace& face : pressures_) {
    const auto at = [&](std::size_t c) { return lattice.position(face.nodes[c]); };
    const Vector3 force = -0.25 * face.pressure_pa * vector_area(at(0), at(1), at(2), at(3));
    for (const int node : face.nodes) force_n_[static_cast<std::size_t>(node)] += force;
  }
  pressed_skin_.find_forces(
      [&](int node) { return lattice.position(node); },
      [&](int node, const Vector3& force_n) { force_n_[static_cast<std::size_t>(node)] += force_n; });
  for (const int n : nodes_) lattice.set_node_force(n, force_n_[static_cast<std::size_t>(n)]);
  if (solver) solver->set_node_forces(lattice, nodes_);
}

namespace {

// Sets the support's displacement from the displacement of its first node. A support without nodes keeps its
// displacement.
void measure_displacement(const SpringLattice& lattice, SupportedNodes& support) {
  if (support.nodes.empty()) return;
  support.end_m = lattice.displacement(support.nodes.front()) - support.base_m.front();
}

void record_base(const SpringLattice& lattice, SupportedNodes& support) {
  support.base_m.clear();
  for (const int node : support.nodes) {
    support.base_m.push_back(lattice.displacement(node) - support.end_m);
  }
}

}  // namespace

Result<BodySupports> BodySupports::make(const std::vector<Support>& supports, const LatticeMesh& mesh) {
  BodySupports result;
  if (supports.empty()) return result;
  const std::vector<BodyCoordinates> coordinates = find_node_coordinates(mesh);
  for (std::size_t s = 0; s < supports.size(); ++s) {
    const std::string name = "supports[" + std::to_string(s) + "]";
    if (Status status = check_support(supports[s]); !status.ok()) return status.error().in(name);
    std::vector<int> nodes;
    for (int n = 0; n < mesh.node_count(); ++n) {
      if (contains(supports[s].region, coordinates[static_cast<std::size_t>(n)])) nodes.push_back(n);
    }
    if (nodes.empty()) {
      return Error{ErrorCode::too_few, "the region contains no lattice node; enlarge it", "region"}.in(name);
    }
    result.region_nodes_.push_back(std::move(nodes));
  }
  result.definitions_ = supports;
  result.supported_.resize(supports.size());
  return result;
}

void BodySupports::claim_nodes(const SpringLattice& lattice, std::vector<std::uint8_t>& fixed) {
  SPOONBILL_ASSERT(fixed.size() == static_cast<std::size_t>(lattice.mesh().node_count()));
  for (std::size_t s = supported_.size(); s-- > 0;) {
    SupportedNodes& support = supported_[s];
    measure_displacement(lattice, support);
    support.moves = definitions_[s].motion.has_value();
    support.nodes.clear();
    for (const int node : region_nodes_[s]) {
      std::uint8_t& is_fixed = fixed[static_cast<std::size_t>(node)];
      if (is_fixed == 0) support.nodes.push_back(node);
      is_fixed = 1;
    }
    record_base(lattice, support);
  }
}

void BodySupports::rebase(const SpringLattice& before, const SpringLattice& after) {
  for (SupportedNodes& support : supported_) {
    measure_displacement(before, support);
    record_base(after, support);
  }
}

void BodySupports::clear_impulses() {
  for (SupportedNodes& support : supported_) support.impulse_ns.setZero();
}

std::span<SupportedNodes> BodySupports::begin_step(const SpringLattice& lattice, double end_s,
                                                   double time_s) {
  SPOONBILL_ASSERT(time_s > 0.0);
  for (std::size_t s = 0; s < supported_.size(); ++s) {
    SupportedNodes& support = supported_[s];
    if (!support.moves) continue;
    measure_displacement(lattice, support);
    support.start_m = support.end_m;
    support.end_m = displacement_at(*definitions_[s].motion, end_s);
    support.largest_step_m = time_s * top_speed_m_per_s(*definitions_[s].motion);
  }
  return supported_;
}

}  // namespace spoonbill
