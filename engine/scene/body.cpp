#include "engine/scene/body.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <variant>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_distance.h"

namespace spoonbill {
namespace {

Status check_in_domain(const std::string& field, double parameter, const KnotVector& knots) {
  return check_range(field, parameter, Range<double>{knots.domain_start(), knots.domain_end()});
}

// Checks that the parameters of a point load are within the surface's domain. check_load() checks all other
// values of a load.
Status check_point(const Load& load, std::size_t index, const Surface& surface) {
  const auto* point = std::get_if<PointLoad>(&load);
  if (point == nullptr) return {};
  Status status = check_in_domain("u", point->u, surface.u);
  if (status.ok()) status = check_in_domain("v", point->v, surface.v);
  if (status.ok()) return {};
  return status.error().in("loads[" + std::to_string(index) + "]");
}

}  // namespace

Pose BodyPlacement::pose() const {
  return {position_m, Quaternion(Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, axis))};
}

Status check_feature_map(const FeatureMapSettings& settings) {
  return check_fields("feature_map: ", settings);
}

Status check_lattice_request(const LatticeRequest& lattice) {
  if (lattice.feature_map) {
    if (Status status = check_feature_map(*lattice.feature_map); !status.ok()) {
      return status.error().in("lattice");
    }
    if (lattice.cells == LatticeCells::box) {
      return Error{ErrorCode::inconsistent,
                   "lattice: feature_map: the nodes of a box are not spread; remove feature_map or cells",
                   "feature_map"};
    }
  }
  if (!lattice.counts) return check_range("lattice: node_budget", lattice.node_budget, node_budget_range);
  int product = 1;
  for (std::size_t direction = 0; direction < 3; ++direction) {
    const int count = (*lattice.counts)[direction];
    const std::string name = "nodes[" + std::to_string(direction) + "]";
    if (Status status = check_range(name, count, node_count_range); !status) {
      return status.error().in("lattice");
    }
    product *= count;
  }
  if (product <= node_budget_range.high) return {};
  return Error{ErrorCode::too_many,
               "lattice: the product of the node counts is " + std::to_string(product) +
                   ", must be at most " + std::to_string(node_budget_range.high),
               "nodes"};
}

Status check_loads(const Body& body) {
  if (Status status = check_range("loads", static_cast<int>(body.loads.size()), load_count_range);
      !status.ok()) {
    return status;
  }
  for (std::size_t l = 0; !body.mesh && l < body.loads.size(); ++l) {
    if (Status status = check_point(body.loads[l], l, body.surface); !status.ok()) return status;
  }
  return check_range("supports", static_cast<int>(body.supports.size()), support_count_range);
}

namespace {

// Checks what a body with a mesh must not have.
Status check_mesh_body(const Body& body) {
  if (body.kind == BodyKind::deformable) {
    return Error{
        ErrorCode::unsupported,
        "mesh: a deformable body needs a surface; fit one to the mesh, or make the body fixed or rigid",
        "mesh"};
  }
  const char* const field = body.shell_thickness_m ? "shell_thickness_mm"
                            : !body.rim.empty()    ? "rim_uv"
                                                   : nullptr;
  if (field == nullptr) return {};
  return Error{ErrorCode::inconsistent,
               std::string("a body with a mesh has no ") + field + "; remove it, or give the body a surface",
               field};
}

}  // namespace

Status check_kind(const Body& body) {
  if (body.hand && body.kind != BodyKind::rigid) {
    return Error{ErrorCode::inconsistent,
                 "a hand holds only a rigid body; remove hand, or make the body rigid", "hand"};
  }
  if (body.motion && body.kind != BodyKind::fixed && !body.hand) {
    return Error{
        ErrorCode::inconsistent,
        "only a fixed body moves as stated, or a rigid one that a hand holds; remove motion, or make "
        "the body fixed",
        "motion"};
  }
  if (body.motion) {
    if (Status status = check_motion(*body.motion); !status.ok()) return status.error().in("motion");
  }
  if (body.mesh) {
    if (Status status = check_mesh_body(body); !status.ok()) return status;
  }
  if (body.kind == BodyKind::deformable) return {};
  const char* const field = !body.regions.empty()    ? "regions"
                            : !body.loads.empty()    ? "loads"
                            : !body.supports.empty() ? "supports"
                                                     : nullptr;
  if (field == nullptr) return {};
  return Error{ErrorCode::inconsistent,
               std::string("a ") + body_kind_names[static_cast<std::size_t>(body.kind)] + " body has no " +
                   field + "; remove them, or make the body deformable",
               field};
}

Status check_mesh(const CleanMesh& mesh) {
  const std::size_t triangles = mesh.mesh.triangles.size();
  if (triangles > body_triangle_limit) {
    return Error{ErrorCode::too_many,
                 "mesh: has " + std::to_string(triangles) + " triangles, but a body may have at most " +
                     std::to_string(body_triangle_limit) + "; reduce it, or fit a surface to it",
                 "mesh"};
  }
  const bool closed =
      std::all_of(mesh.parts.begin(), mesh.parts.end(), [](const MeshPart& part) { return part.closed; });
  if (!closed) {
    return Error{ErrorCode::inconsistent, "mesh: has an open edge; close it, or fit a surface to it", "mesh"};
  }
  const auto solids = std::count_if(mesh.parts.begin(), mesh.parts.end(),
                                    [](const MeshPart& part) { return part.cavity_of < 0; });
  if (solids != 1) {
    return Error{ErrorCode::inconsistent,
                 "mesh: has " + std::to_string(solids) +
                     " separate parts, but a body is one; join them, or give each a body of its own",
                 "mesh"};
  }
  const ShellDistance inside(mesh.mesh.vertices_m, mesh.mesh.triangles, ShellDistance::Kind::solid);
  if (inside.uses_normals()) return {};
  return Error{ErrorCode::self_intersecting,
               "mesh: passes through itself or has edges of more than two triangles; repair it", "mesh"};
}

TriangleMesh find_placed_mesh(const Body& body) {
  SPOONBILL_ASSERT(body.mesh != nullptr);
  TriangleMesh mesh = body.mesh->mesh;
  if (body.mesh_pose == Pose{}) return mesh;
  for (Vector3& vertex : mesh.vertices_m) {
    vertex = body.mesh_pose.position_m + body.mesh_pose.orientation * vertex;
  }
  return mesh;
}

Box find_bounds(const Body& body) {
  if (!body.mesh) return bounding_box(body.surface.net);
  return box_about(find_placed_mesh(body).vertices_m);
}

Result<std::shared_ptr<const TrimmedArea>> make_trimmed_area(const Body& body) {
  std::shared_ptr<const TrimmedArea> trim;
  if (body.trims.empty()) return trim;
  Result<TrimmedArea> area = TrimmedArea::make(body.surface.u, body.surface.v, body.trims);
  if (!area.ok()) return area.error();
  trim = std::make_shared<const TrimmedArea>(std::move(area).value());
  return trim;
}

}  // namespace spoonbill
