// How thick a closed body is: from a point of its surface straight inwards to where the line comes out again.
// Outside the tick; any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/collision/meshes/box_tree.h"
#include "engine/study/piece_sampling.h"

namespace spoonbill {

// Where a line inwards from a place of the surface leaves the body.
struct Thickness {
  double thickness_m = 0.0;
  double u = 0.0, v = 0.0, opposite_u = 0.0, opposite_v = 0.0;
  Vector3 position_m = Vector3::Zero(), opposite_m = Vector3::Zero();
};

// One owner. The surface, which is closed and whose normals point outwards, must outlive it.
class ThicknessSearch {
 public:
  explicit ThicknessSearch(const Surface& surface);

  // None where there is no normal, or the line meets the surface nowhere, as between samples at an edge.
  std::optional<Thickness> at(double u, double v) const;

  // From samples, refined about the least of them. A wall thinner than a cell of samples is wide is found
  // where a sample looks through it.
  std::optional<Thickness> smallest(const StudyWatch& watch = {}) const;

 private:
  struct Facet {
    Vector3 a, b, c;
    double u[3], v[3];
  };
  struct Hit {
    double distance;
    std::uint32_t facet;
    double weight_b, weight_c;
  };
  void add_facets(const PieceCell& cell);
  Thickness settled(const Hit& hit, Thickness thickness, const Vector3& inward) const;
  std::optional<Hit> first_exit(const Vector3& from, const Vector3& direction) const;

  const Surface* surface_;
  std::vector<PieceCell> cells_;
  std::vector<Facet> facets_;
  std::unique_ptr<BoxTree> tree_;
};

}  // namespace spoonbill
