// Provides bodies, equilibrium checks and faces for the tests of the static solver.
#pragma once

#include <vector>

#include "engine/material/statics/static_solver.h"

namespace spoonbill {

StaticBody body_of(const LatticeMesh& mesh, const Material& material, CellKind kind);

StaticResult rest_of(const StaticBody& body, const StaticLoads& loads, const std::vector<FixedAxis>& held);

// Visits the nodes of the face at the low or high end of an axis (0 to 2: i, j, k). `visit` also receives the
// node's fraction of the face's area, for a mesh of equal cells.
template <class Visit>
void visit_face(const LatticeMesh& mesh, int axis, bool high, const Visit& visit) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  const double cells = (mesh.count[a] - 1) * (mesh.count[b] - 1);
  for (int p = 0; p < mesh.count[a]; ++p) {
    for (int q = 0; q < mesh.count[b]; ++q) {
      std::array<int, 3> at{};
      at[axis] = high ? mesh.count[axis] - 1 : 0;
      at[a] = p;
      at[b] = q;
      const double share = (p == 0 || p == mesh.count[a] - 1 ? 0.5 : 1.0) *
                           (q == 0 || q == mesh.count[b] - 1 ? 0.5 : 1.0) / cells;
      visit(mesh.index(at[0], at[1], at[2]), share);
    }
  }
}

// Returns the axes to fix: `axis` at all nodes of the base, and at two corners the axes that prevent sliding
// and turning.
std::vector<FixedAxis> slipping_base(const LatticeMesh& mesh, int axis);

}  // namespace spoonbill
