#include "engine/collision/meshes/winding_number.h"

#include <cmath>

#include "engine/base/assert.h"
#include "engine/collision/meshes/solid_angle.h"

namespace spoonbill {
namespace {

// Barill et al. take 2, with moments of the next order; without them this is as exact.
constexpr double far_radii = 3.0;

struct Moments {
  Vector3 area = Vector3::Zero();  // half the sum of cross products
  Vector3 weighted = Vector3::Zero();
  double weight = 0.0;
};

}  // namespace

WindingNumber::WindingNumber(const std::vector<Vector3>& vertices_m,
                             const std::vector<TriangleCorners>& triangles, const BoxTree& tree)
    : vertices_m_(&vertices_m), triangles_(&triangles), tree_(&tree), dipoles_(tree.nodes().size()) {
  SPOONBILL_ASSERT(tree.order().size() == triangles.size());
  std::vector<Moments> moments(dipoles_.size());
  for (std::size_t index = dipoles_.size(); index-- > 0;) {
    const BoxTree::Node& node = tree.nodes()[index];
    Moments& sum = moments[index];
    for (std::uint32_t t = node.first; t < node.first + node.count; ++t) {
      const auto& [i, j, k] = triangles[t];
      const Vector3 &a = vertices_m[i], &b = vertices_m[j], &c = vertices_m[k];
      const Vector3 area = 0.5 * (b - a).cross(c - a);
      sum.area += area;
      sum.weight += area.norm();
      sum.weighted += area.norm() / 3.0 * (a + b + c);
    }
    if (!node.is_leaf()) {
      for (const std::size_t child : {index + 1, static_cast<std::size_t>(node.first)}) {
        sum.area += moments[child].area;
        sum.weight += moments[child].weight;
        sum.weighted += moments[child].weighted;
      }
    }
    const Vector3 centre = sum.weighted / sum.weight;
    const Vector3 farthest = (node.box.high - centre).cwiseMax(centre - node.box.low);
    dipoles_[index] = {centre, sum.area, far_radii * farthest.norm()};
  }
}

double WindingNumber::at(const Vector3& point_m) const {
  double angle = 0.0;
  tree_->search(
      [&](std::uint32_t index) {
        const Dipole& dipole = dipoles_[index];
        const Vector3 way = dipole.centre_m - point_m;
        const double distance = way.norm();
        if (distance <= dipole.far_m) return true;
        angle += way.dot(dipole.area_m2) / (distance * distance * distance);
        return false;
      },
      [](std::uint32_t, std::uint32_t) { return false; },
      [&](std::uint32_t first, std::uint32_t count) {
        for (std::uint32_t t = first; t < first + count; ++t) {
          const auto& [a, b, c] = (*triangles_)[t];
          const std::vector<Vector3>& vertices = *vertices_m_;
          angle += solid_angle(vertices[a] - point_m, vertices[b] - point_m, vertices[c] - point_m);
        }
      });
  return angle / full_solid_angle;
}

}  // namespace spoonbill
