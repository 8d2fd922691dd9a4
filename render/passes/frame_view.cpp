#include "render/passes/frame_view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace spoonbill {

namespace {

Eigen::Vector3f toward_key_light(const Vector3& requested) {
  constexpr double lowest_sine = 0.2;
  const bool usable = requested.allFinite() && requested.norm() > 1e-9;
  Vector3 direction = usable ? requested.normalized() : Vector3::UnitY();
  direction.y() = std::max(direction.y(), lowest_sine);
  return direction.normalized().cast<float>();
}

}  // namespace

FrameView make_frame_view(const ViewSettings& settings, int width_px, int height_px) {
  FrameView view;
  const Camera& camera = settings.camera;
  view.viewport = make_viewport(width_px, height_px, settings.panel_px);
  view.world_to_clip = (projection_matrix(camera, view.viewport) * view_matrix(camera)).cast<float>();
  const Eigen::Matrix3d axes = eye_axes(camera);
  view.eye_m = eye_position(camera).cast<float>();
  view.eye_right = axes.col(0).cast<float>();
  view.eye_up = axes.col(1).cast<float>();
  view.toward_key = toward_key_light(settings.toward_key_light);
  view.ground_y_m = static_cast<float>(settings.ground_y_m);
  view.interface_scale = static_cast<float>(settings.interface_scale);
  view.nearest_depth_m = static_cast<float>(0.06 * camera.distance_m);
  view.pixel_depth_ratio = static_cast<float>(pixels_per_metre(camera, view.viewport) * camera.distance_m);
  return view;
}

void set_frame_uniforms(const Program& program, const FrameView& view) {
  program.set("world_to_clip", view.world_to_clip);
  program.set("eye", view.eye_m);
  program.set("toward_key", view.toward_key);
  program.set("ground_y", view.ground_y_m);
  const Eigen::Vector3f back = view.eye_right.cross(view.eye_up);
  const Eigen::Vector3f up = Eigen::Vector3f::UnitY();
  program.set("toward_fill", (0.75f * view.eye_right + 0.2f * view.eye_up + 0.6f * back).normalized().eval());
  program.set("toward_rim", (0.75f * up - 0.8f * back - 0.35f * view.eye_right).normalized().eval());
  program.set("toward_strip", (0.9f * view.eye_right + 0.25f * view.eye_up + 0.15f * up).normalized().eval());
}

const char* const whole_viewport_vertex_glsl = R"(
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
)";

const char* const key_light_glsl = "uniform vec3 toward_key;\n";

const char* const sphere_shadow_glsl = R"(
uniform vec3 tool_centre;
uniform float tool_radius;

float key_past_sphere(vec3 p) {
  if (tool_radius <= 0.0) return 1.0;
  vec3 to_centre = tool_centre - p;
  float along = dot(to_centre, toward_key);
  float beside = sqrt(max(dot(to_centre, to_centre) - along * along, 0.0));
  float soft = max(along, 0.0) * 0.17 + 0.06 * tool_radius;
  float lit = smoothstep(tool_radius - soft, tool_radius + soft, beside);
  return mix(1.0, lit, smoothstep(-0.3 * tool_radius, 0.3 * tool_radius, along));
}

float sky_past_sphere(vec3 p, vec3 n) {
  if (tool_radius <= 0.0) return 1.0;
  vec3 to_centre = tool_centre - p;
  float d2 = max(dot(to_centre, to_centre), 1e-12);
  float facing = clamp(dot(n, to_centre) * inversesqrt(d2) * 0.85 + 0.15, 0.0, 1.0);
  return 1.0 - 0.8 * facing * min(1.0, tool_radius * tool_radius / d2);
}
)";

const char* const studio_light_glsl = R"(
uniform vec3 eye;
uniform float ground_y;
uniform vec3 toward_fill;
uniform vec3 toward_rim;
uniform vec3 toward_strip;

const vec3 key_colour = vec3(1.26, 1.20, 1.12);
const vec3 rim_colour = vec3(0.42, 0.46, 0.52);
const vec3 fill_colour = vec3(0.20, 0.22, 0.25);
const vec3 sky_colour = vec3(0.44, 0.46, 0.49);
const vec3 floor_colour = vec3(0.36, 0.35, 0.34);

struct Look {
  vec3 base;
  float roughness;
  float metalness;
  float translucency;
};

// Reflection of the studio: pale floor, darker horizon, bright ceiling, a soft box at the key light and a strip light at
// the side of the eye.
vec3 studio_mirror(vec3 r, float roughness) {
  float w = 0.06 + 0.8 * roughness;
  float up = r.y;
  float v = mix(0.62, 0.20, smoothstep(-0.42 - w, 0.0 + w, up));
  v = mix(v, 1.02, smoothstep(0.06 - w, 0.42 + w, up));
  float box = smoothstep(0.86 - 0.8 * w, 0.95 + 0.05 * w, dot(r, toward_key));
  float strip = smoothstep(0.80 - 0.7 * w, 0.94 + 0.06 * w, dot(r, toward_strip));
  return vec3(v) * vec3(0.98, 1.0, 1.03) + box * 1.5 * key_colour / (1.0 + 5.0 * roughness) + strip * vec3(0.5);
}

// Split-sum reflectance of a rough mirror, by an analytic fit instead of a table (Karis 2014).
vec2 mirror_share(float roughness, float nv) {
  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
  return vec2(-1.04, 1.04) * a + r.zw;
}

float highlight(vec3 n, vec3 v, vec3 l, float roughness) {
  vec3 h = normalize(v + l);
  float nh = max(dot(n, h), 0.0);
  float a2 = max(roughness * roughness, 0.012);
  a2 *= a2;
  float d = nh * nh * (a2 - 1.0) + 1.0;
  float lh = max(dot(l, h), 0.1);
  return a2 / (4.0 * d * d * lh * lh * (roughness + 0.5));
}

// Compresses highlights beyond the range of the picture: 1 - exp(-x) above the knee, with the first terms of the series
// of exp(x). The error is at most half a step of eight bits.
vec3 shoulder(vec3 c) {
  const float knee = 0.72;
  vec3 x = max(c - knee, 0.0) / (1.0 - knee);
  vec3 grown = 1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0)));
  return min(c, knee) + (1.0 - knee) * (1.0 - 1.0 / grown);
}

// Encodes to sRGB with a fit by roots, because a power costs as much as the rest of the shader. The error is below a
// tenth of a step of eight bits.
vec3 encode(vec3 c) {
  vec3 root2 = sqrt(max(c, vec3(0.0031308)));
  vec3 root4 = sqrt(root2);
  vec3 bright = 0.5545041 * root2 + 0.9000026 * root4 - 0.4887426 * sqrt(root4) + 0.0344366;
  return mix(12.92 * c, bright, step(0.0031308, c));
}

struct Lit {
  vec3 diffuse;
  vec3 mirror;
};

Lit studio_light(Look look, vec3 p, vec3 n, float key, float sky) {
  vec3 v = normalize(eye - p);
  float nv = clamp(dot(n, v), 0.001, 1.0);
  float nl = dot(n, toward_key);
  float wrap = 0.45 * look.translucency;
  float key_share = max(nl + wrap, 0.0) / (1.0 + wrap);
  float near_floor = exp(-max(p.y - ground_y, 0.0) / 0.012);
  float floor_seen = 1.0 - 0.6 * near_floor;
  vec3 ambient = mix(floor_colour * floor_seen, sky_colour, 0.5 + 0.5 * n.y) * sky;
  vec3 light = ambient + key_colour * key_share * key + fill_colour * max(dot(n, toward_fill), 0.0) * sky +
               rim_colour * max(dot(n, toward_rim), 0.0);
  // Light that is transmitted from behind the surface.
  float away = clamp(0.5 - 0.5 * nl, 0.0, 1.0);
  light += look.translucency * key_colour * 0.35 * away * sqrt(away) * (0.4 + 0.6 * key);

  vec3 f0 = mix(vec3(0.04), look.base, look.metalness);
  vec2 share = mirror_share(look.roughness, nv);
  float occlusion = mix(sky, 1.0, 0.25) * (0.5 + 0.5 * key);
  vec3 mirrored = studio_mirror(reflect(-v, n), look.roughness) * occlusion;
  vec3 mirror = mirrored * (f0 * share.x + share.y);
  mirror += f0 * key_colour * highlight(n, v, toward_key, look.roughness) * max(nl, 0.0) * key * 0.5;
  mirror += f0 * rim_colour * highlight(n, v, toward_rim, look.roughness) * max(dot(n, toward_rim), 0.0) * 0.5;
  return Lit(look.base * (1.0 - look.metalness) * (1.0 - 0.4 * look.translucency) * light, mirror);
}

// Returns the encoded colour of an opaque surface.
vec4 opaque_colour(Lit lit) { return vec4(encode(shoulder(lit.diffuse + lit.mirror)), 1.0); }

// Returns the encoded, premultiplied colour of a translucent surface. Transmitted light belongs to the background;
// reflected light belongs to the surface at any opacity.
vec4 clear_colour(Lit lit, float opacity) {
  vec3 own = lit.diffuse * opacity;
  vec3 gloss = encode(shoulder(own + lit.mirror)) - encode(shoulder(own));
  return vec4(encode(shoulder(lit.diffuse)) * opacity + gloss, opacity);
}
)";

}  // namespace spoonbill
