// Connected parts of a mesh, their orientation, their cavities and the filling of their small holes.
#pragma once

#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

// A mesh split into connected parts.
struct MeshParts {
  TriangleMesh mesh;  // triangles sorted by part; parts have no vertex in common
  std::vector<MeshPart> parts;
  // For each part, true if its triangles can be oriented consistently, unlike those of a Moebius strip.
  std::vector<bool> orientable;
  std::size_t triangles_flipped = 0;
};

// Splits a mesh into parts that are connected over edges of exactly two triangles, and orients each part
// consistently. The corners of each triangle must differ. Sets MeshPart::closed to false.
MeshParts split_into_parts(const TriangleMesh& mesh);

// Removes open parts whose area is below speck_area_fraction of the closed parts' area. Returns the number of
// removed parts.
std::size_t drop_specks(MeshParts& parts);

// Finds the cavities and sets MeshPart::cavity_of. Orients cavities inward and all other closed parts
// outward. Adds the numbers of closed parts, cavities, open parts (sheets) and flipped parts to the report.
void orient_outward(TriangleMesh& mesh, std::vector<MeshPart>& parts, MeshReport& report);

// Returns the volume of a closed part in cubic metres, by the divergence theorem; negative if the part is
// inside out.
double signed_volume(const TriangleMesh& mesh, const MeshPart& part);

double triangle_area(const Vector3& a, const Vector3& b, const Vector3& c);
double part_area(const TriangleMesh& mesh, const MeshPart& part);

// Appends the part's vertices and triangles to `to`. Returns the description of the appended part.
MeshPart append_part(const TriangleMesh& from, const MeshPart& part, TriangleMesh& to);

// Marks an orientable part as closed if it has no holes or only small holes (hole_area_fraction), and fills
// these holes. A hole with three sides is filled by one triangle. Any other hole is filled by a fan of
// triangles around the length-weighted mean of its boundary loop. Returns the number of holes filled. A
// crack, whose loop has almost no area, counts as filled but gets no triangles.
std::size_t fill_small_holes(MeshParts& parts);

}  // namespace spoonbill
