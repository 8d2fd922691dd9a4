// Passes that draw lit surfaces: the bodies (surface_pass.cpp), and the tool, arrows and panes
// (solid_pass.cpp).
#pragma once

#include <Eigen/Core>
#include <array>
#include <compare>
#include <map>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "render/colour.h"
#include "render/gl/pipeline.h"
#include "render/passes/frame_view.h"
#include "render/passes/mesh_buffers.h"
#include "render/passes/shadow_pass.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {

// The features of a program that draws a body. A software renderer computes both sides of every branch, so
// each variant has a program of its own.
struct SurfaceVariant {
  bool is_clear = false;
  bool reflects = true;
  SurfacePattern pattern = SurfacePattern::none;

  friend auto operator<=>(const SurfaceVariant&, const SurfaceVariant&) = default;
};

// How one surface is drawn.
struct SurfaceDrawing {
  SurfaceLook look;
  Eigen::Matrix4f world_to_pattern = Eigen::Matrix4f::Identity();  // see find_pattern_frame()
  bool reflects = true;
  bool shows_fixed = false;  // tints the fixed part

  SurfaceVariant variant() const { return {look.is_clear(), reflects, look.pattern}; }
};

// Draws the surface of a body, lit by the studio lights.
class SurfacePass {
 public:
  explicit SurfacePass(const GlFunctions& gl) : gl_(&gl) {}

  // Makes the program of a variant if it does not exist. Call before draw().
  Status prepare(const SurfaceVariant& variant);

  // Draws a surface. An opaque look writes depth. A clear look is blended, back faces first, and must be
  // drawn after everything opaque. `shadow` is null if shadows are off.
  void draw(const FrameView& view, const SurfaceBuffers& surface, const SurfaceDrawing& drawing,
            const ToolSphere& tool, const ShadowPass* shadow) const;

 private:
  void set_uniforms(const Program& program, const FrameView& view, const SurfaceDrawing& drawing,
                    const ToolSphere& tool, const ShadowPass* shadow) const;

  const GlFunctions* gl_;
  std::map<SurfaceVariant, Program> programs_;
};

// Draws simple solids (the tool, arrows) and flat translucent panes (fixing planes).
class SolidPass {
 public:
  static Result<SolidPass> make(const GlFunctions& gl);

  // Draws a glassy sphere, most transparent in the centre. Draw after everything opaque.
  void draw_glass_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                         Colour colour) const;

  // Draws a solid tool with the glass of draw_glass_sphere(). Draw after everything opaque.
  void draw_glass_tool(const FrameView& view, ToolBuffers& tool, const ToolFrame& frame, Colour colour) const;

  void draw_sphere(const FrameView& view, const Eigen::Vector3f& centre_m, float radius_m,
                   Colour colour) const;

  // Draws an arrow: a shaft of diameter `width_m` with a cone as its head.
  void draw_arrow(const FrameView& view, const Eigen::Vector3f& start_m, const Eigen::Vector3f& tip_m,
                  float width_m, Colour colour) const;

  // Draws a flat, unlit quadrilateral, visible from both sides. The alpha of the colour is its opacity.
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
  std::vector<Shape> spheres_;  // spheres from coarse to fine
  Shape shaft_, head_, pane_;
};

}  // namespace spoonbill
