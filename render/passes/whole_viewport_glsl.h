// The vertex shader of passes over a whole viewport: three vertices without attributes, one triangle that
// covers it.
#pragma once

namespace spoonbill {

inline constexpr const char* whole_viewport_vertex_glsl = R"(
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

}  // namespace spoonbill
