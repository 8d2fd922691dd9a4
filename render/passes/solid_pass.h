// Draws simple solids (the tool, the force arrow) and flat translucent panes (fixing planes).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/base/result.h"
#include "render/gl/functions.h"
#include "render/gl/handle.h"
#include "render/gl/program.h"
#include "render/overlay/palette.h"
#include "render/overlay/solid_tool.h"
#include "render/passes/frame_view.h"
#include "render/passes/tool_buffers.h"

namespace spoonbill {

class SolidPass {
 public:
  static Result<SolidPass> make(const GlFunctions& gl);

  // A glassy sphere: what lies inside and behind shows, most in the middle. After everything opaque.
  void draw_glass_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                         Colour colour) const;

  // A tool of the same glass.
  void draw_glass_tool(const FrameView& view, ToolBuffers& tool, const ToolFrame& frame, Colour colour) const;

  void draw_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                   Colour colour) const;

  // A shaft with a cone for a head, `width_m` across the shaft.
  void draw_arrow(const FrameView& view, const Eigen::Vector3f& start_m, const Eigen::Vector3f& tip_m,
                  float width_m, Colour colour) const;

  // A flat quadrilateral, the colour's alpha its opacity; unlit, seen from both sides.
  void draw_pane(const FrameView& view, const std::array<Eigen::Vector3f, 4>& corners_m, Colour colour) const;

 private:
  // A range of the shared vertex buffer.
  struct Shape {
    GLint first = 0;
    GLsizei count = 0;
  };
  struct Programs {
    Program solid, glass, pane;
  };

  SolidPass(const GlFunctions& gl, Programs programs);
  const Shape& sphere_for(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m) const;
  void draw_solid(const FrameView& view, const Shape& shape, const Eigen::Matrix4f& model,
                  Colour colour) const;
  void draw_shape(const Program& program, const FrameView& view, const Shape& shape,
                  const Eigen::Matrix4f& model, const Eigen::Vector4f& colour) const;

  void use_program(const Program& program, const FrameView& view, const Eigen::Matrix4f& model,
                   const Eigen::Vector4f& colour) const;

  const GlFunctions* gl_;
  Programs programs_;
  GlHandle vertex_array_;
  GlHandle vertices_;
  std::vector<Shape> spheres_;  // from coarse to fine
  Shape shaft_, head_, pane_;
};

}  // namespace spoonbill
