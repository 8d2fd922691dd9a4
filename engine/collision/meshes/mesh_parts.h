// The parts of a mesh: what hangs together, facing one way, and outward where it is closed.
#pragma once

#include <vector>

#include "engine/collision/meshes/triangle_mesh.h"

namespace spoonbill {

struct MeshParts {
  TriangleMesh mesh;  // part by part, no vertex in two of them
  std::vector<MeshPart> parts;
  std::vector<bool> orientable;  // of each part: its triangles can all agree (a Moebius strip's cannot)
  std::size_t triangles_turned = 0;
};

// Floods from triangle to triangle over the edges that exactly two share. The triangles must have three
// different corners each. No part is closed yet.
MeshParts split_into_parts(const TriangleMesh& mesh);

// Drops the open parts of less than speck_share of the closed parts' area; returns how many.
std::size_t drop_specks(MeshParts& parts);

// Turns closed parts outward and cavities inward, counts both in the report.
void turn_outward(TriangleMesh& mesh, std::vector<MeshPart>& parts, MeshReport& report);

// In cubic metres, by the divergence theorem; negative where a closed part faces inward.
double signed_volume(const TriangleMesh& mesh, const MeshPart& part);

double triangle_area(const Vector3& a, const Vector3& b, const Vector3& c);
double area_of(const TriangleMesh& mesh, const MeshPart& part);

// Adds the part's vertices and triangles to those that stand there; returns the part as it is there.
MeshPart append_part(const TriangleMesh& from, const MeshPart& part, TriangleMesh& to);

}  // namespace spoonbill
