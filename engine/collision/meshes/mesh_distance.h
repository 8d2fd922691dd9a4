// A triangle mesh as a signed distance.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/collision/meshes/box_tree.h"
#include "engine/collision/meshes/shell_distance.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/collision/solids/signed_distance.h"

namespace spoonbill {

// Thick enough that a surface does not slip through it between two ticks of a slow hand.
inline constexpr double sheet_thickness_m = 1e-3;

// The union of the mesh's closed parts, each without its cavities, and of its sheets, each a plate of the
// thickness with the sheet in its middle and a round rim. Outside, the distance is that to the nearest point
// of a triangle (of the plate's surface), to rounding. Inside one solid, too; where parts overlap it is the
// depth in the one that holds the point deepest, which the true depth may exceed. Continuous everywhere, and
// changes by no more than the distance moved.
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
    double grown_m = 0.0;  // half the thickness, of sheets
    DistanceSample at(const Vector3& point_m) const;
  };
  static std::vector<Solid> make_solids(const CleanMesh& mesh, double thickness_m);
  static std::vector<Box> boxes_of(const std::vector<Solid>& solids);

  std::vector<Solid> solids_;
  BoxTree tree_;  // over the solids
  bool convex_;
};

}  // namespace spoonbill
