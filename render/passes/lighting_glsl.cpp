#include "render/passes/lighting_glsl.h"

namespace spoonbill {

// The shadow is exact in the middle and softens with the distance to the sphere; the occlusion of the sky is
// the closed form for a sphere above a plane.
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

// The studio as a mirror sees it: pale floor, darker horizon, bright ceiling, a soft box where the key light hangs and
// a strip light at the side of the eye.
vec3 studio_mirror(vec3 r, float roughness) {
  float w = 0.06 + 0.8 * roughness;
  float up = r.y;
  float v = mix(0.62, 0.20, smoothstep(-0.42 - w, 0.0 + w, up));
  v = mix(v, 1.02, smoothstep(0.06 - w, 0.42 + w, up));
  float box = smoothstep(0.86 - 0.8 * w, 0.95 + 0.05 * w, dot(r, toward_key));
  float strip = smoothstep(0.80 - 0.7 * w, 0.94 + 0.06 * w, dot(r, toward_strip));
  return vec3(v) * vec3(0.98, 1.0, 1.03) + box * 1.5 * key_colour / (1.0 + 5.0 * roughness) + strip * vec3(0.5);
}

// Karis 2014: the split-sum of a rough mirror's reflectance, without a table.
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

// Keeps what is brighter than the picture can show from turning flat: 1 - exp(-x) above the knee, by the first terms
// of exp(x)'s series, which is half a step of eight bits away at most.
vec3 shoulder(vec3 c) {
  const float knee = 0.72;
  vec3 x = max(c - knee, 0.0) / (1.0 - knee);
  vec3 grown = 1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0)));
  return min(c, knee) + (1.0 - knee) * (1.0 - 1.0 / grown);
}

// sRGB, its power fitted by roots: a power costs as much as all the rest, and this is never a tenth of a step of
// eight bits away.
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
  // What shines through from behind.
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

// The colour for the picture.
vec4 opaque_colour(Lit lit) { return vec4(encode(shoulder(lit.diffuse + lit.mirror)), 1.0); }

// The same, premultiplied, of what is clear in part. What shines through belongs to the background, what is mirrored
// to the surface however clear it is.
vec4 clear_colour(Lit lit, float opacity) {
  vec3 own = lit.diffuse * opacity;
  vec3 gloss = encode(shoulder(own + lit.mirror)) - encode(shoulder(own));
  return vec4(encode(shoulder(lit.diffuse)) * opacity + gloss, opacity);
}
)";

}  // namespace spoonbill
