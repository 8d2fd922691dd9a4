// Signed distance to a triangle mesh and to each of its parts. Where normals cannot give the sign, the
// winding number of the mesh does.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// Winding number of a mesh around a point (Jacobson et al. 2013). It is 1 inside a mesh with outward normals
// and 0 outside. It is an integer for every closed mesh, even if the mesh intersects itself. Distant nodes of
// the tree count as dipoles (Barill et al. 2018); the error is below 0.1, so that rounding gives the integer.
// Immutable, so any thread may use it. at() allocates nothing.
class WindingNumber {
 public:
  // `triangles` must be in the order of the tree's leaves. Mesh and tree must outlive the object.
  WindingNumber(const std::vector<Vector3>& vertices_m, const std::vector<TriangleCorners>& triangles,
                const BoxTree& tree);

  double at(const Vector3& point_m) const;

 private:
  struct Dipole {
    Vector3 centre_m, area_m2;
    double far_m;  // distance beyond which the dipole replaces the node's triangles
  };
  const std::vector<Vector3>* vertices_m_;
  const std::vector<TriangleCorners>* triangles_;
  const BoxTree* tree_;
  std::vector<Dipole> dipoles_;  // one for each node of the tree
};

// Distance to the triangles of one closed part or of some open parts (sheets). Immutable, so any thread may
// use it. Queries allocate nothing.
class ShellDistance {
 public:
  // `triangles` must not be empty. The normals of a solid must point outward, those of a cavity into the
  // cavity.
  enum class Kind : std::uint8_t { solid, cavity, sheets };
  ShellDistance(std::vector<Vector3> vertices_m, std::vector<TriangleCorners> triangles, Kind kind);

  ShellDistance(ShellDistance&& other) noexcept = delete;

  // Returns the distance to the nearest point of the triangles. It is negative inside a solid, and negative
  // outside a cavity, where the material is. For sheets it is never negative.
  DistanceSample at(const Vector3& point_m) const;

  // Returns the index of the nearest triangle, in the order given to the constructor.
  std::uint32_t nearest_triangle(const Vector3& point_m) const;

  const Box& bounds() const { return tree_.nodes()[0].box; }

  // Returns true if the sign of the distance comes from the normals of faces, edges and vertices; the normals
  // of vertices are weighted by angle (Baerentzen and Aanaes 2005). This requires a manifold of at most
  // `checked_triangles` without self-intersections. Otherwise the sign comes from the winding number, which
  // takes at least twice as long.
  bool uses_normals() const { return !corner_normals_.empty(); }

  // Returns true if no vertex is in front of a face by more than 1e-7 of the mesh's size. Returns false
  // without a test if the kind is not `solid`, if uses_normals() is false, or if there are more than 20,000
  // triangles.
  bool is_convex() const;

  static constexpr std::size_t checked_triangles = 1'000'000;

 private:
  struct Nearest;
  Nearest nearest(const Vector3& point) const;
  bool is_behind(const Nearest& nearest, const Vector3& point) const;
  Vector3 face_normal(std::uint32_t triangle) const;
  Vector3 normal_at(const Nearest& nearest) const;
  void compute_normals();

  std::vector<Vector3> vertices_m_;
  BoxTree tree_;
  std::vector<TriangleCorners> triangles_;  // triangles in the order of the tree's leaves
  Kind kind_;
  double size_m_;
  std::vector<std::uint32_t> across_;    // for each side of a triangle, the adjacent triangle
  std::vector<Vector3> corner_normals_;  // one for each vertex, not normalised
  std::optional<WindingNumber> winding_;
};

// Default thickness of a sheet in metres. A slowly moved surface cannot pass through such a sheet between two
// ticks.
inline constexpr double sheet_thickness_m = 1e-3;

// Signed distance to the union of the mesh's closed parts (without their cavities) and its sheets. A sheet
// counts as a plate of the given thickness with rounded edges, centred on the sheet.
//
// Outside, and inside a single solid, the distance is exact up to rounding. Where parts overlap, its
// magnitude is the largest of the depths in the single parts, a lower bound of the true depth. When a point
// moves, its distance changes continuously and by at most the distance that the point moved. Immutable, so
// any thread may use it.
class MeshDistance final : public SignedDistance {
 public:
  explicit MeshDistance(const CleanMesh& mesh, double thickness_m = sheet_thickness_m);

  DistanceSample at(const Vector3& point_m) const override;
  bool is_convex() const override { return convex_; }
  Box bounds() const override;

 private:
  struct Solid {
    std::unique_ptr<ShellDistance> outside;
    std::vector<std::unique_ptr<ShellDistance>> cavities;
    double half_thickness_m = 0.0;  // half the thickness of a sheet; 0 for a solid
    DistanceSample at(const Vector3& point_m) const;
  };
  static std::vector<Solid> make_solids(const CleanMesh& mesh, double thickness_m);
  static std::vector<Box> make_boxes(const std::vector<Solid>& solids);

  std::vector<Solid> solids_;
  BoxTree tree_;  // tree over the boxes of the solids
  bool convex_;
};

}  // namespace spoonbill
