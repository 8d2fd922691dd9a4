#include "render/passes/shell_pass.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "render/gl/pipeline_state.h"

namespace spoonbill {
namespace {

// A square across the way from the eye to the centre, as large as the sphere seems there.
constexpr const char* vertex_source = R"(
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

// The near half of the sphere, by the ray through the pixel. A faint colour is drawn as outline alone.
constexpr const char* fragment_source = R"(
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

}  // namespace

Result<ShellPass> ShellPass::make(const GlFunctions& gl) {
  auto program = Program::make(gl, "shells", vertex_source, fragment_source);
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
  set_pipeline_state(*gl_, {Depth::test, Blend::premultiplied, Cull::off});
  program_.use();
  set_frame_uniforms(program_, view);
  program_.set("eye_up", view.eye_up);
  program_.set("pixel_depth_ratio", view.pixel_depth_ratio);
  program_.set("width_scale", view.interface_scale);
  quads_.draw(shells);
}

}  // namespace spoonbill
