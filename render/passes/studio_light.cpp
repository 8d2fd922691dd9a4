#include "render/passes/studio_light.h"

#include <Eigen/Geometry>

namespace spoonbill {

void set_studio_uniforms(const Program& program, const FrameView& view) {
  const Eigen::Vector3f back = view.eye_right.cross(view.eye_up);
  const Eigen::Vector3f up = Eigen::Vector3f::UnitY();
  const Eigen::AngleAxisf turn(view.studio_turn_rad, up);
  const auto set_direction = [&](const char* name, const Eigen::Vector3f& direction) {
    program.set(name, Eigen::Vector3f(turn * direction.normalized()));
  };
  set_direction("toward_fill", 0.75f * view.eye_right + 0.2f * view.eye_up + 0.6f * back);
  set_direction("toward_rim", 0.75f * up - 0.8f * back - 0.35f * view.eye_right);
  set_direction("toward_strip", 0.9f * view.eye_right + 0.25f * view.eye_up + 0.15f * up);
  const Studio& studio = view.studio;
  program.set("key_colour", studio.key_colour);
  program.set("fill_colour", studio.fill_colour);
  program.set("rim_colour", studio.rim_colour);
  program.set("sky_colour", studio.sky_colour);
  program.set("floor_colour", studio.floor_colour);
  program.set("surroundings", Eigen::Vector4f(studio.floor, studio.horizon, studio.ceiling, studio.strip));
}

const char* const studio_light_glsl = R"(
uniform vec3 eye;
uniform float ground_y;
uniform vec3 toward_fill;
uniform vec3 toward_rim;
uniform vec3 toward_strip;
uniform vec3 key_colour;
uniform vec3 fill_colour;
uniform vec3 rim_colour;
uniform vec3 sky_colour;
uniform vec3 floor_colour;
uniform vec4 surroundings;

struct Look {
  vec3 base;
  float roughness;
  float metalness;
  float translucency;
};

// Reflection of the studio: floor, darker horizon, ceiling, a soft box at the key light and a strip light at the side of
// the eye. Without reflections, only the even light of the surroundings.
vec3 studio_mirror(vec3 r, float roughness) {
  if (!reflects) return vec3(0.5 * (surroundings.x + surroundings.z) * 0.6);
  float w = 0.06 + 0.8 * roughness;
  float up = r.y;
  float v = mix(surroundings.x, surroundings.y, smoothstep(-0.42 - w, 0.0 + w, up));
  v = mix(v, surroundings.z, smoothstep(0.06 - w, 0.42 + w, up));
  float box = smoothstep(0.86 - 0.8 * w, 0.95 + 0.05 * w, dot(r, toward_key));
  float strip = smoothstep(0.80 - 0.7 * w, 0.94 + 0.06 * w, dot(r, toward_strip));
  return vec3(v) * vec3(0.98, 1.0, 1.03) + box * 5.0 * key_colour / (1.0 + 12.0 * roughness) +
         strip * vec3(4.0 * surroundings.w / (1.0 + 8.0 * roughness));
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

// Light that reaches a point after bounces between walls of the colour `base`, from the part of the surroundings that the
// point sees (a fit by Jimenez et al. 2016).
vec3 with_bounces(float visible, vec3 base) {
  vec3 a = 2.0404 * base - 0.3324, b = -4.7951 * base + 0.6417, c = 2.7552 * base + 0.6903;
  return max(vec3(visible), ((visible * a + b) * visible + c) * visible);
}

// Maps light to the range of the picture, with a soft toe and a shoulder that keeps hues (Khronos PBR Neutral, 2024).
vec3 film(vec3 c) {
  const float exposure = 0.72, start = 0.76, desaturation = 0.15;
  c *= exposure;
  float low = min(c.r, min(c.g, c.b));
  c -= low < 0.08 ? low - 6.25 * low * low : 0.04;
  float peak = max(c.r, max(c.g, c.b));
  float over = max(peak - start, 0.0);
  float shown = 1.0 - (1.0 - start) * (1.0 - start) / (over + 1.0 - start);
  vec3 pressed = c * (shown / max(peak, start));
  vec3 bright = mix(vec3(shown), pressed, 1.0 / (desaturation * (peak - shown) + 1.0));
  return peak < start ? c : bright;
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

// `key` is the part of the key light that reaches the point, `sky` the part of the surroundings that it sees.
Lit studio_light(Look look, vec3 p, vec3 n, float key, float sky) {
  vec3 v = normalize(eye - p);
  float nv = clamp(dot(n, v), 0.001, 1.0);
  float nl = dot(n, toward_key);
  float wrap = 0.45 * look.translucency;
  float key_share = max(nl + wrap, 0.0) / (1.0 + wrap);
  float near_floor = exp(-max(p.y - ground_y, 0.0) / 0.012);
  float floor_seen = 1.0 - 0.5 * near_floor;
  vec3 around = with_bounces(sky, look.base);
  vec3 light = mix(floor_colour * floor_seen, sky_colour, 0.5 + 0.5 * n.y) * around;
  light += key_colour * key_share * key + fill_colour * max(dot(n, toward_fill), 0.0) * around +
           rim_colour * max(dot(n, toward_rim), 0.0) * mix(1.0, sky, 0.6);
  // Light that is transmitted from behind the surface.
  float away = clamp(0.5 - 0.5 * nl, 0.0, 1.0);
  light += look.translucency * (1.0 + look.translucency) * key_colour * 0.35 * away * sqrt(away) * (0.4 + 0.6 * key);

  vec3 f0 = mix(vec3(0.04), look.base, look.metalness);
  vec2 share = mirror_share(look.roughness, nv);
  float occlusion = mix(sky, 1.0, 0.25) * mix(1.0, key, 0.5 - 0.3 * look.metalness);
  vec3 mirrored = studio_mirror(reflect(-v, n), look.roughness) * occlusion;
  vec3 mirror = mirrored * (f0 * share.x + share.y);
  mirror += f0 * key_colour * highlight(n, v, toward_key, look.roughness) * max(nl, 0.0) * key * 0.5;
  mirror += f0 * rim_colour * highlight(n, v, toward_rim, look.roughness) * max(dot(n, toward_rim), 0.0) * 0.5;
  return Lit(look.base * (1.0 - look.metalness) * (1.0 - 0.4 * look.translucency) * light, mirror);
}

// Returns the encoded colour of an opaque surface.
vec4 opaque_colour(Lit lit) { return vec4(encode(film(lit.diffuse + lit.mirror)), 1.0); }

// Returns the encoded, premultiplied colour of a translucent surface. Transmitted light belongs to the background;
// reflected light belongs to the surface at any opacity.
vec4 clear_colour(Lit lit, float opacity) {
  vec3 own = lit.diffuse * opacity;
  vec3 gloss = max(encode(film(own + lit.mirror)) - encode(film(own)), 0.0);
  return vec4(encode(film(lit.diffuse)) * opacity + gloss, opacity);
}
)";

}  // namespace spoonbill
