// How deep the vertices and edges of one mesh are in another, by the other's signed distance.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collision/meshes/mesh_distance.h"
#include "engine/collision/rigid/posed_mesh.h"

namespace spoonbill {

// A point of a mesh's triangles in the other mesh.
struct DeepPoint {
  double depth_m = -std::numeric_limits<double>::infinity();  // of the mesh's surface; negative outside
  Vector3 point_m = Vector3::Zero();
  DistanceSample other;  // the other mesh's, there
};

// One owner. The meshes must outlive it.
class MeshDepths {
 public:
  MeshDepths(const PosedMesh& mesh, const PosedMesh& other, double thickness_m);

  // The triangles whose boxes are near the other mesh: all those that can be in it.
  const std::vector<std::uint32_t>& near() const { return near_; }

  const DeepPoint& at_vertex(std::uint32_t v);
  bool is_inside(std::uint32_t v);

  // Calls `visit` with the deepest point of each stretch of the edge that is inside, if it is deeper than
  // `least_m` (0 or more). To rounding where the other mesh is convex; elsewhere stretches may be missed that
  // are shorter than a thirty-second of its size.
  void visit_edge(std::uint32_t from, std::uint32_t to, double least_m,
                  const std::function<void(const DeepPoint&)>& visit);

  // The other mesh's triangle that is nearest to the point, where a plate of either fills all between them.
  std::optional<std::uint32_t> plate_neighbour(const DeepPoint& deep) const;

  // The other mesh's direction outwards from a point of it.
  Vector3 outward_of_other(const Vector3& point_m) const { return distance_.at(point_m).gradient; }

 private:
  DeepPoint at(const Vector3& point_m, double grown_m) const;
  void climb(DeepPoint low, DeepPoint high, double grown_m, DeepPoint& best) const;

  const PosedMesh& mesh_;
  const PosedMesh& other_;
  MeshDistance distance_;  // the other's
  Box around_;             // the other
  std::vector<std::uint32_t> near_;
  std::vector<std::optional<DeepPoint>> vertices_;  // those that were asked for
  std::unique_ptr<ShellDistance> surface_;          // the other's triangles, where a mesh has plates
};

}  // namespace spoonbill
