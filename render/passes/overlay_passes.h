// Passes that draw the overlay shapes of render/overlay/overlays.h.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <vector>

#include "engine/base/result.h"
#include "render/gl/pipeline.h"
#include "render/overlay/overlays.h"
#include "render/passes/frame_view.h"

namespace spoonbill {

// An attribute of an instance. Unsigned bytes are mapped to the range from 0 to 1.
struct InstanceAttribute {
  GLint components = 1;
  GLenum type = GL_FLOAT;
  std::size_t offset_bytes = 0;
};

// Draws a quad for each instance, positioned by the vertex shader: six vertices with different gl_VertexID,
// and the attributes of the instance at locations 0, 1, ...
class InstancedQuads {
 public:
  // The context must be current during construction and in draw().
  InstancedQuads(const GlFunctions& gl, std::size_t instance_bytes,
                 std::initializer_list<InstanceAttribute> attributes);

  // Draws a quad for each instance, with the program in use. `Instance` must have the size and the layout
  // that the constructor received.
  template <class Instance>
  void draw(const std::vector<Instance>& instances) const {
    draw(instances.data(), instances.size());
  }

 private:
  void draw(const void* instances, std::size_t count) const;

  const GlFunctions* gl_;
  std::size_t instance_bytes_;
  GlHandle vertex_array_;
  GlHandle instances_;
};

// Draws lines of constant width on the screen, with smooth edges.
class LinePass {
 public:
  static Result<LinePass> make(const GlFunctions& gl);

  // Moves the lines toward the eye by lift_m before the depth test, so that lines on a surface are visible.
  void draw(const FrameView& view, const std::vector<OverlayLine>& lines, float lift_m) const;

 private:
  LinePass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  InstancedQuads quads_;
};

// Draws flat squares, discs and diamonds that face the eye, with smooth edges and a darker border.
class MarkPass {
 public:
  static Result<MarkPass> make(const GlFunctions& gl);

  // Draws marks with a radius of at most seven pixels at an interface scale of 1. Moves them toward the eye
  // before the depth test: by lift_m, or by 2.5 times their radius if that is more.
  void draw(const FrameView& view, const std::vector<OverlayMark>& marks, float lift_m) const;

 private:
  MarkPass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  InstancedQuads quads_;
};

// Draws translucent spheres with an outline, with depth test.
class ShellPass {
 public:
  static Result<ShellPass> make(const GlFunctions& gl);

  // Sorts the shells from back to front and draws them.
  void draw(const FrameView& view, std::vector<OverlayShell>& shells) const;

 private:
  ShellPass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  InstancedQuads quads_;
};

// Draws unlit triangles on a surface; the alpha of the colour is the opacity.
class TrianglePass {
 public:
  static Result<TrianglePass> make(const GlFunctions& gl);

  // Draws triangles, given as three corners each, moved toward the eye by lift_m before the depth test.
  void draw(const FrameView& view, const std::vector<OverlayCorner>& corners, float lift_m) const;

 private:
  TrianglePass(const GlFunctions& gl, Program program);

  const GlFunctions* gl_;
  Program program_;
  GlHandle vertex_array_;
  GlHandle vertices_;
};

}  // namespace spoonbill
