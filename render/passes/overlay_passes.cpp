#include "render/passes/overlay_passes.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace spoonbill {
namespace {

constexpr const char* line_vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform vec2 viewport;
uniform float lift;
uniform float width_scale;
uniform float nearest_depth;
layout(location = 0) in vec3 start;
layout(location = 1) in vec3 end;
layout(location = 2) in vec4 start_colour;
layout(location = 3) in vec4 end_colour;
layout(location = 4) in float width;
noperspective out float side_px;
noperspective out vec4 colour;
flat out float half_width;

vec4 lifted(vec3 p) { return world_to_clip * vec4(p + normalize(eye - p) * lift, 1.0); }

void main() {
  vec4 a = lifted(start);
  vec4 b = lifted(end);
  half_width = 0.5 * width * width_scale;
  side_px = 0.0;
  colour = vec4(0.0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  if (max(a.w, b.w) < nearest_depth) return;
  if (a.w < nearest_depth) a = mix(a, b, (nearest_depth - a.w) / (b.w - a.w));
  if (b.w < nearest_depth) b = mix(b, a, (nearest_depth - b.w) / (a.w - b.w));
  vec2 along = (b.xy / b.w - a.xy / a.w) * viewport;
  float length_px = length(along);
  along = length_px > 1e-4 ? along / length_px : vec2(1.0, 0.0);
  bool at_end = gl_VertexID == 1 || gl_VertexID == 2 || gl_VertexID == 4;
  float side = gl_VertexID == 2 || gl_VertexID == 4 || gl_VertexID == 5 ? 1.0 : -1.0;
  // Makes the quad wide enough that every pixel of the line is covered fully, so that only the smooth edge is
  // visible.
  side_px = side * (half_width + 1.25);
  colour = at_end ? end_colour : start_colour;
  vec4 clip = at_end ? b : a;
  clip.xy += vec2(-along.y, along.x) * side_px * 2.0 / viewport * clip.w;
  gl_Position = clip;
}
)";

constexpr const char* line_fragment_source = R"(
noperspective in float side_px;
noperspective in vec4 colour;
flat in float half_width;
out vec4 result;
void main() {
  float alpha = colour.a * clamp(half_width + 0.5 - abs(side_px), 0.0, 1.0);
  result = vec4(colour.rgb * alpha, alpha);
}
)";

constexpr const char* mark_vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform vec2 viewport;
uniform float lift;
uniform float scale;
uniform float pixel_depth_ratio;
layout(location = 0) in vec3 centre;
layout(location = 1) in vec4 srgb;
layout(location = 2) in float radius;
layout(location = 3) in float least_px;
layout(location = 4) in float shape_in;
noperspective out vec2 offset_px;
flat out float radius_px;
flat out vec4 colour;
flat out int shape;

void main() {
  float px_per_m = pixel_depth_ratio / max((world_to_clip * vec4(centre, 1.0)).w, 1e-6);
  radius_px = clamp(radius * px_per_m, least_px * scale, 7.0 * scale);
  // Raises the mark far enough toward the eye that a slanting surface does not cut off the near half.
  float raised = max(lift, 2.5 * radius_px / px_per_m);
  vec4 clip = world_to_clip * vec4(centre + normalize(eye - centre) * raised, 1.0);
  colour = srgb;
  shape = int(shape_in + 0.5);
  vec2 corner = vec2(gl_VertexID == 1 || gl_VertexID == 2 || gl_VertexID == 4 ? 1.0 : -1.0,
                     gl_VertexID == 2 || gl_VertexID == 4 || gl_VertexID == 5 ? 1.0 : -1.0);
  offset_px = corner * (radius_px * (shape == 2 ? 1.5 : 1.0) + 1.25);
  clip.xy += offset_px * 2.0 / viewport * clip.w;
  gl_Position = clip;
}
)";

constexpr const char* mark_fragment_source = R"(
noperspective in vec2 offset_px;
flat in float radius_px;
flat in vec4 colour;
flat in int shape;
out vec4 result;

float distance_to_edge() {
  vec2 q = abs(offset_px);
  if (shape == 0) return max(q.x, q.y) - 0.9 * radius_px;
  if (shape == 1) return length(q) - radius_px;
  return (q.x + q.y - 1.4 * radius_px) * 0.7071;
}

void main() {
  float edge = distance_to_edge();
  float alpha = colour.a * clamp(0.5 - edge, 0.0, 1.0);
  float inside = clamp(-edge - 0.4, 0.0, 1.0);
  vec3 shade = mix(0.6 * colour.rgb, colour.rgb, inside);
  result = vec4(shade * alpha, alpha);
}
)";

// Draws a square at the centre, perpendicular to the direction from the eye, that covers the projection of
// the sphere.
constexpr const char* shell_vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform vec3 eye_up;
uniform float pixel_depth_ratio;
layout(location = 0) in vec3 centre_in;
layout(location = 1) in float radius_in;
layout(location = 2) in vec4 srgb;
out vec3 position;
flat out vec3 centre;
flat out float radius;
flat out vec4 colour;
void main() {
  centre = centre_in;
  radius = radius_in;
  colour = srgb;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  position = centre;
  vec3 away = centre - eye;
  float far = length(away);
  if (far < 1.05 * radius) return;
  vec3 right = normalize(cross(away, eye_up));
  vec3 up = normalize(cross(right, away));
  float size = radius * far / sqrt(far * far - radius * radius) + 2.0 * far / pixel_depth_ratio;
  vec2 corner = vec2(gl_VertexID == 1 || gl_VertexID == 2 || gl_VertexID == 4 ? 1.0 : -1.0,
                     gl_VertexID == 2 || gl_VertexID == 4 || gl_VertexID == 5 ? 1.0 : -1.0);
  position = centre + size * (corner.x * right + corner.y * up);
  gl_Position = world_to_clip * vec4(position, 1.0);
}
)";

// Draws the near side of the sphere: intersects the ray through the pixel with the sphere. If the colour is
// faint, draws only the outline.
constexpr const char* shell_fragment_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform float pixel_depth_ratio;
uniform float width_scale;
in vec3 position;
flat in vec3 centre;
flat in float radius;
flat in vec4 colour;
out vec4 result;

void main() {
  vec3 way = normalize(position - eye);
  vec3 from_centre = eye - centre;
  float along = -dot(from_centre, way);
  vec3 nearest = from_centre + along * way;
  float aside = length(nearest);
  float pixel = along / pixel_depth_ratio;
  float half_chord = sqrt(max(radius * radius - aside * aside, 0.0));
  vec3 normal = normalize(nearest - half_chord * way);
  vec4 clip = world_to_clip * vec4(centre + radius * normal, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;

  float within = clamp(0.5 + (radius - aside) / pixel, 0.0, 1.0);
  float outline = clamp(0.75 * width_scale + 0.5 - abs(radius - aside - 0.7 * pixel) / pixel, 0.0, 1.0);
  float facing = max(-dot(normal, way), 0.15);
  bool solid = colour.a > 0.9;
  float shade = solid ? 0.16 + 0.14 * (1.0 - facing) : 0.0;
  float alpha = within * colour.a * max(shade, outline * (solid ? 0.9 : 0.75));
  result = vec4(mix(colour.rgb, 0.8 * colour.rgb, outline) * alpha, alpha);
}
)";

constexpr const char* triangle_vertex_source = R"(
uniform mat4 world_to_clip;
uniform vec3 eye;
uniform float lift;
layout(location = 0) in vec3 corner;
layout(location = 1) in vec4 srgb;
flat out vec4 colour;
void main() {
  colour = srgb;
  gl_Position = world_to_clip * vec4(corner + normalize(eye - corner) * lift, 1.0);
}
)";

constexpr const char* triangle_fragment_source = R"(
flat in vec4 colour;
out vec4 result;
void main() { result = vec4(colour.rgb * colour.a, colour.a); }
)";

// Sets the state and the uniforms that all overlays share, and puts the program in use.
void begin_overlay(const GlFunctions& gl, const Program& program, const FrameView& view) {
  set_pipeline_state(gl, {Depth::test, Blend::premultiplied, Cull::off});
  program.use();
  set_frame_uniforms(program, view);
}

void set_viewport(const Program& program, const FrameView& view) {
  program.set("viewport", Eigen::Vector2f(static_cast<float>(view.viewport.width_px),
                                          static_cast<float>(view.viewport.height_px)));
}

}  // namespace

InstancedQuads::InstancedQuads(const GlFunctions& gl, std::size_t instance_bytes,
                               std::initializer_list<InstanceAttribute> attributes)
    : gl_(&gl),
      instance_bytes_(instance_bytes),
      vertex_array_(make_vertex_array(gl)),
      instances_(make_buffer(gl)) {
  gl.BindVertexArray(vertex_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  GLuint location = 0;
  for (const InstanceAttribute& attribute : attributes) {
    gl.VertexAttribPointer(location, attribute.components, attribute.type,
                           attribute.type == GL_UNSIGNED_BYTE ? GL_TRUE : GL_FALSE,
                           static_cast<GLsizei>(instance_bytes),
                           reinterpret_cast<const void*>(attribute.offset_bytes));
    gl.EnableVertexAttribArray(location);
    gl.VertexAttribDivisor(location, 1);
    ++location;
  }
}

void InstancedQuads::draw(const void* instances, std::size_t count) const {
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, instances_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * instance_bytes_), instances,
                  GL_STREAM_DRAW);
  gl_->DrawArraysInstanced(GL_TRIANGLES, 0, 6, static_cast<GLsizei>(count));
}

Result<LinePass> LinePass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "lines", line_vertex_source, line_fragment_source);
  if (!program) return program.error();
  return LinePass(gl, std::move(program).value());
}

LinePass::LinePass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      quads_(gl, sizeof(OverlayLine),
             {{3, GL_FLOAT, offsetof(OverlayLine, start_m)},
              {3, GL_FLOAT, offsetof(OverlayLine, end_m)},
              {4, GL_UNSIGNED_BYTE, offsetof(OverlayLine, start_colour)},
              {4, GL_UNSIGNED_BYTE, offsetof(OverlayLine, end_colour)},
              {1, GL_FLOAT, offsetof(OverlayLine, width_px)}}) {}

void LinePass::draw(const FrameView& view, const std::vector<OverlayLine>& lines, float lift_m) const {
  if (lines.empty()) return;
  begin_overlay(*gl_, program_, view);
  set_viewport(program_, view);
  program_.set("lift", lift_m);
  program_.set("width_scale", view.interface_scale);
  program_.set("nearest_depth", view.nearest_depth_m);
  quads_.draw(lines);
}

Result<MarkPass> MarkPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "marks", mark_vertex_source, mark_fragment_source);
  if (!program) return program.error();
  return MarkPass(gl, std::move(program).value());
}

MarkPass::MarkPass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      quads_(gl, sizeof(OverlayMark),
             {{3, GL_FLOAT, offsetof(OverlayMark, position_m)},
              {4, GL_UNSIGNED_BYTE, offsetof(OverlayMark, colour)},
              {1, GL_FLOAT, offsetof(OverlayMark, radius_m)},
              {1, GL_FLOAT, offsetof(OverlayMark, minimum_px)},
              {1, GL_FLOAT, offsetof(OverlayMark, shape)}}) {}

void MarkPass::draw(const FrameView& view, const std::vector<OverlayMark>& marks, float lift_m) const {
  if (marks.empty()) return;
  begin_overlay(*gl_, program_, view);
  set_viewport(program_, view);
  program_.set("lift", lift_m);
  program_.set("scale", view.interface_scale);
  program_.set("pixel_depth_ratio", view.pixel_depth_ratio);
  quads_.draw(marks);
}

Result<ShellPass> ShellPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "shells", shell_vertex_source, shell_fragment_source);
  if (!program) return program.error();
  return ShellPass(gl, std::move(program).value());
}

ShellPass::ShellPass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      quads_(gl, sizeof(OverlayShell),
             {{3, GL_FLOAT, offsetof(OverlayShell, centre_m)},
              {1, GL_FLOAT, offsetof(OverlayShell, radius_m)},
              {4, GL_UNSIGNED_BYTE, offsetof(OverlayShell, colour)}}) {}

void ShellPass::draw(const FrameView& view, std::vector<OverlayShell>& shells) const {
  if (shells.empty()) return;
  std::stable_sort(shells.begin(), shells.end(), [&](const OverlayShell& one, const OverlayShell& other) {
    return (one.centre_m - view.eye_m).squaredNorm() > (other.centre_m - view.eye_m).squaredNorm();
  });
  begin_overlay(*gl_, program_, view);
  program_.set("eye_up", view.eye_up);
  program_.set("pixel_depth_ratio", view.pixel_depth_ratio);
  program_.set("width_scale", view.interface_scale);
  quads_.draw(shells);
}

Result<TrianglePass> TrianglePass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "triangles", triangle_vertex_source, triangle_fragment_source);
  if (!program) return program.error();
  return TrianglePass(gl, std::move(program).value());
}

TrianglePass::TrianglePass(const GlFunctions& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      vertex_array_(make_vertex_array(gl)),
      vertices_(make_buffer(gl)) {
  gl.BindVertexArray(vertex_array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  constexpr GLsizei stride = sizeof(OverlayCorner);
  const auto at = [](std::size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, at(offsetof(OverlayCorner, position_m)));
  gl.VertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, at(offsetof(OverlayCorner, colour)));
  gl.EnableVertexAttribArray(0);
  gl.EnableVertexAttribArray(1);
}

void TrianglePass::draw(const FrameView& view, const std::vector<OverlayCorner>& corners,
                        float lift_m) const {
  if (corners.empty()) return;
  begin_overlay(*gl_, program_, view);
  program_.set("lift", lift_m);
  gl_->BindVertexArray(vertex_array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(OverlayCorner)),
                  corners.data(), GL_STREAM_DRAW);
  gl_->DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
}

}  // namespace spoonbill
