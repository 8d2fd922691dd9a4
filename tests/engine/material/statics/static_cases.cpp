#include "tests/engine/material/statics/static_cases.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>

namespace spoonbill {

StaticBody body_of(const LatticeMesh& mesh, const Material& material, CellKind kind) {
  Result<StaticBody> body = StaticBody::make(mesh, material, kind);
  EXPECT_TRUE(body.ok()) << body.error().message;
  return std::move(body).value();
}

StaticResult rest_of(const StaticBody& body, const StaticLoads& loads, const std::vector<FixedAxis>& held) {
  Result<StaticResult> result = rest_under_load(body, loads, held);
  EXPECT_TRUE(result.ok()) << result.error().message;
  return std::move(result).value();
}

std::vector<FixedAxis> slipping_base(const LatticeMesh& mesh, int axis) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  std::vector<FixedAxis> held;
  visit_face(mesh, axis, false, [&](int node, double) { held.push_back({node, axis, 0.0}); });
  std::array<int, 3> beside{};
  beside[a] = mesh.count[a] - 1;
  const int first = mesh.index(0, 0, 0), second = mesh.index(beside[0], beside[1], beside[2]);
  held.push_back({first, a, 0.0});
  held.push_back({first, b, 0.0});
  held.push_back({second, b, 0.0});
  return held;
}

}  // namespace spoonbill
