// Reader of PLY files, for meshes and point clouds alike.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/exchange/scans/file_mesh.h"
#include "engine/exchange/scans/point_cloud.h"

namespace spoonbill {

// Reads a PLY file in text form or in binary form of either byte order. The result is a mesh if the header
// declares faces or triangle strips, otherwise a cloud with the normals of its vertices. The elements may be
// in any order and of any number type. Faces are lists named vertex_indices or vertex_index. Polygons are cut
// into triangles, and faces of one or two corners are ignored. The index -1 ends a strip and starts the next.
// Other elements and properties are ignored.
//
// Refused: what read_ply_header() refuses; vertices without x, y and z; faces without a list of indices; an
// index without a vertex; a face with more corners than the limit; missing rows, or numbers after the last
// row.
Result<std::variant<FileMesh, PointCloud>> parse_ply(std::string_view bytes);

}  // namespace spoonbill
