#include "engine/material/lattice/shell_faces.h"

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

void add_side(const LatticeMesh& mesh, std::size_t axis, int end, std::vector<ShellFace>& faces) {
  const std::size_t first = (axis + 1) % 3, second = (axis + 2) % 3;
  const auto node = [&](int a, int b) {
    std::array<int, 3> place{};
    place[axis] = end;
    place[first] = a;
    place[second] = b;
    return mesh.index(place[0], place[1], place[2]);
  };
  for (int a = 0; a + 1 < mesh.count[first]; ++a) {
    for (int b = 0; b + 1 < mesh.count[second]; ++b) {
      const int corner = node(a, b), beside = node(a + 1, b), across = node(a + 1, b + 1),
                above = node(a, b + 1);
      faces.push_back(end > 0 ? ShellFace{corner, beside, across, above}
                              : ShellFace{corner, above, across, beside});
    }
  }
}

}  // namespace

std::vector<ShellFace> shell_faces(const LatticeMesh& mesh) {
  std::vector<ShellFace> faces;
  for (std::size_t axis = mesh.closed ? 1 : 0; axis < 3; ++axis) {
    add_side(mesh, axis, 0, faces);
    add_side(mesh, axis, mesh.count[axis] - 1, faces);
  }
  return faces;
}

std::vector<ShellFace> faces_in(const BodyRegion& region, const LatticeMesh& mesh,
                                const std::vector<ShellFace>& faces, const std::vector<BodyCoordinates>& places) {
  SPOONBILL_ASSERT(places.size() == static_cast<std::size_t>(mesh.node_count()));
  std::vector<ShellFace> within;
  for (const ShellFace& face : faces) {
    if (contains(region, mean_place(mesh, places, face))) within.push_back(face);
  }
  return within;
}

}  // namespace spoonbill
