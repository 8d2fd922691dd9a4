#include "engine/collision/meshes/mesh_distance.h"

#include <limits>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/meshes/mesh_parts.h"

namespace spoonbill {
namespace {

std::unique_ptr<ShellDistance> make_shell(TriangleMesh mesh, ShellDistance::Kind kind) {
  return std::make_unique<ShellDistance>(std::move(mesh.vertices_m), std::move(mesh.triangles), kind);
}

}  // namespace

std::vector<MeshDistance::Solid> MeshDistance::make_solids(const CleanMesh& mesh, double thickness_m) {
  using Kind = ShellDistance::Kind;
  std::vector<Solid> solids;
  std::vector<std::size_t> solid_of(mesh.parts.size(), 0);
  TriangleMesh sheets;
  for (std::size_t p = 0; p < mesh.parts.size(); ++p) {
    const MeshPart& part = mesh.parts[p];
    if (!part.closed) append_part(mesh.mesh, part, sheets);
    if (!part.closed || part.cavity_of >= 0) continue;
    TriangleMesh own;
    append_part(mesh.mesh, part, own);
    solid_of[p] = solids.size();
    solids.emplace_back().outside = make_shell(std::move(own), Kind::solid);
  }
  for (const MeshPart& part : mesh.parts) {
    if (part.cavity_of < 0) continue;
    TriangleMesh own;
    append_part(mesh.mesh, part, own);
    solids[solid_of[static_cast<std::size_t>(part.cavity_of)]].cavities.push_back(
        make_shell(std::move(own), Kind::cavity));
  }
  if (!sheets.triangles.empty()) {
    solids.emplace_back().outside = make_shell(std::move(sheets), Kind::sheets);
    solids.back().grown_m = 0.5 * thickness_m;
  }
  return solids;
}

std::vector<Box> MeshDistance::boxes_of(const std::vector<Solid>& solids) {
  std::vector<Box> boxes;
  boxes.reserve(solids.size());
  for (const Solid& solid : solids) {
    const Box& box = solid.outside->bounds();
    boxes.push_back({box.low.array() - solid.grown_m, box.high.array() + solid.grown_m});
  }
  return boxes;
}

MeshDistance::MeshDistance(const CleanMesh& mesh, double thickness_m)
    : solids_(make_solids(mesh, thickness_m)),
      tree_(boxes_of(solids_), 1),
      convex_(solids_.size() == 1 && solids_[0].cavities.empty() && solids_[0].outside->is_convex()) {
  SPOONBILL_ASSERT(!mesh.parts.empty());
  SPOONBILL_ASSERT(thickness_m > 0.0);
}

DistanceSample MeshDistance::Solid::at(const Vector3& point_m) const {
  DistanceSample sample = outside->at(point_m);
  sample.distance_m -= grown_m;
  if (sample.distance_m >= 0.0) return sample;
  for (const auto& cavity : cavities) {
    const DistanceSample other = cavity->at(point_m);
    if (other.distance_m > sample.distance_m) sample = other;
  }
  return sample;
}

DistanceSample MeshDistance::at(const Vector3& point_m) const {
  if (solids_.size() == 1) return solids_[0].at(point_m);
  DistanceSample best;
  best.distance_m = std::numeric_limits<double>::infinity();
  const std::vector<BoxTree::Node>& nodes = tree_.nodes();
  tree_.search(
      [&](std::uint32_t index) { return signed_distance(nodes[index].box, point_m) < best.distance_m; },
      [&](std::uint32_t left, std::uint32_t right) {
        return signed_distance(nodes[right].box, point_m) < signed_distance(nodes[left].box, point_m);
      },
      [&](std::uint32_t first, std::uint32_t) {
        const DistanceSample sample = solids_[tree_.order()[first]].at(point_m);
        if (sample.distance_m < best.distance_m) best = sample;
      });
  return best;
}

Box MeshDistance::bounds() const {
  return tree_.nodes()[0].box;
}

}  // namespace spoonbill
