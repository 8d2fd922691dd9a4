// The triangles of a tool's solid for drawing, with normals. No GL.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "engine/base/result.h"
#include "engine/scene/tool.h"

namespace spoonbill {

struct ToolVertex {
  Eigen::Vector3f position_m;
  Eigen::Vector3f normal;  // unit, outward
};

// In the tool's frame. Three indices a triangle, counter-clockwise seen from outside. Vertices are shared
// where the solid is smooth and doubled along its edges. A sheet, which has no inside, has both its sides.
struct ToolMesh {
  std::vector<ToolVertex> vertices;
  std::vector<std::uint32_t> indices;
  bool convex = false;  // no eye sees more than one layer of outsides
};

// Fine enough for a tool that fills the screen. Empty for a sphere of radius 0. Refused: a surface that
// cannot be tessellated.
Result<ToolMesh> make_tool_mesh(const ToolSolid& solid);

}  // namespace spoonbill
