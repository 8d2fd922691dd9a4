#include "render/passes/material_patterns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <utility>

namespace spoonbill {
namespace {

// The mean of points in rows, and the sums of what the later half of the rows, and of each row, has beyond
// the mean minus what the earlier half has. They turn with the points.
struct Spread {
  Vector3 mean_m = Vector3::Zero(), along_rows = Vector3::Zero(), along_columns = Vector3::Zero();
};

template <class Points>
Spread find_spread(const Points& points, std::size_t rows) {
  Spread spread;
  const std::size_t count = points.x.size();
  const std::size_t columns = std::max<std::size_t>(1, count / std::max<std::size_t>(1, rows));
  const auto at = [&](std::size_t i) { return Vector3(points.x[i], points.y[i], points.z[i]); };
  for (std::size_t i = 0; i < count; ++i) spread.mean_m += at(i) / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 beyond = at(i) - spread.mean_m;
    spread.along_rows += 2 * (i / columns) < count / columns ? Vector3(-beyond) : beyond;
    spread.along_columns += 2 * (i % columns) < columns ? Vector3(-beyond) : beyond;
  }
  return spread;
}

// The direction of the columns must be so much longer to become the x axis of the pattern, because the axes
// change places there, which shows where a body deforms through it.
constexpr double longer = 1.5;

}  // namespace

Eigen::Matrix4f find_pattern_frame(const BodySnapshot& body) {
  const Spread spread =
      body.is_mesh()
          ? find_spread(body.mesh, 16)
          : find_spread(body.surface,
                        static_cast<std::size_t>(std::max(1, body.surface.u.control_point_count())));
  Vector3 along = spread.along_rows, across = spread.along_columns;
  if (across.norm() > longer * along.norm()) std::swap(along, across);
  if (!along.allFinite() || !(along.norm() > 0.0)) along = Vector3::UnitX();
  along.normalize();
  across -= across.dot(along) * along;
  if (!across.allFinite() || !(across.norm() > 1e-9)) across = along.unitOrthogonal();
  across.normalize();
  Eigen::Matrix4d to_pattern = Eigen::Matrix4d::Identity();
  to_pattern.block<1, 3>(0, 0) = along.transpose();
  to_pattern.block<1, 3>(1, 0) = along.cross(across).transpose();
  to_pattern.block<1, 3>(2, 0) = across.transpose();
  if (spread.mean_m.allFinite()) {
    to_pattern.block<3, 1>(0, 3) = -to_pattern.block<3, 3>(0, 0) * spread.mean_m;
  }
  return to_pattern.cast<float>();
}

namespace {

constexpr const char* noise_glsl = R"(
uniform mat4 world_to_pattern;

struct Skin {
  vec3 base;
  vec3 normal;
  float visible;
};

float random_at(ivec3 cell) {
  uvec3 q = uvec3(cell) * uvec3(1597334677u, 3812015801u, 2798796415u);
  uint h = (q.x ^ q.y ^ q.z) * 1597334677u;
  h = (h ^ (h >> 15)) * 2246822519u;
  return float((h ^ (h >> 13)) & 0xffffffu) / 16777215.0;
}

// Smooth noise from 0 to 1 that changes over a length of 1, and its gradient.
vec4 noise_and_slope(vec3 p) {
  vec3 low = floor(p), f = p - low;
  vec3 t = f * f * (3.0 - 2.0 * f), dt = 6.0 * f * (1.0 - f);
  ivec3 c = ivec3(low);
  vec4 near = vec4(random_at(c), random_at(c + ivec3(1, 0, 0)), random_at(c + ivec3(0, 1, 0)), random_at(c + ivec3(1, 1, 0)));
  vec4 far = vec4(random_at(c + ivec3(0, 0, 1)), random_at(c + ivec3(1, 0, 1)), random_at(c + ivec3(0, 1, 1)),
                  random_at(c + ivec3(1, 1, 1)));
  vec4 layer = mix(near, far, t.z), beyond = far - near;
  vec2 row = mix(layer.xy, layer.zw, t.y), across = layer.zw - layer.xy, behind = mix(beyond.xy, beyond.zw, t.y);
  return vec4(mix(row.x, row.y, t.x), dt.x * (row.y - row.x), dt.y * mix(across.x, across.y, t.x),
              dt.z * mix(behind.x, behind.y, t.x));
}

float noise(vec3 p) { return noise_and_slope(p).x; }

// Returns 1 for details of this size in mm that the picture resolves, 0 for those that would flicker.
float resolved(vec3 p_mm, float size_mm) {
  return 1.0 - smoothstep(0.25, 0.6, sqrt(length(dFdx(p_mm)) * length(dFdy(p_mm))) / size_mm);
}

// Changes the skin as the pattern does.
Skin coloured(Skin skin, vec3 p_mm);

Skin patterned(Skin skin, vec3 position) {
  return coloured(skin, 1e3 * (world_to_pattern * vec4(position, 1.0)).xyz);
}

)";

// The reliefs of patterns are vec4: the height of the skin above its mean in mm, and its gradient.
constexpr const char* relief_glsl = R"(
vec4 noise_relief(vec3 p_mm, vec3 per_mm, float height_mm) {
  vec4 n = noise_and_slope(p_mm * per_mm);
  return height_mm * vec4(n.x, n.yzw * per_mm);
}

// Tilts a normal as the relief does.
vec3 embossed(vec4 relief, vec3 n) {
  vec3 slope = transpose(mat3(world_to_pattern)) * relief.yzw;
  return normalize(n - slope + n * dot(n, slope));
}
)";

constexpr const char* plain_glsl = R"(
struct Skin {
  vec3 base;
  vec3 normal;
  float visible;
};
Skin patterned(Skin skin, vec3 position) { return skin; }
)";

// Modelling clay: smeared by fingers.
constexpr const char* smeared_glsl = R"(
Skin coloured(Skin skin, vec3 p) {
  vec4 relief = noise_relief(p, vec3(0.22, 0.3, 0.3), 0.16) +
                noise_relief(p, vec3(0.9, 1.1, 1.1), 0.035 * resolved(p, 0.9));
  skin.base *= 0.92 + 0.9 * relief.x;
  skin.normal = embossed(relief, skin.normal);
  return skin;
}
)";

// Beech: faint rings around the trunk, and the short dark flecks of its rays.
constexpr const char* grain_glsl = R"(
Skin coloured(Skin skin, vec3 p) {
  float sway = 3.0 * noise(p * vec3(0.018, 0.07, 0.07)) + 0.5 * noise(p * vec3(0.06, 0.3, 0.3));
  float trunk = length(vec2(p.y + 26.0, 0.55 * p.z + 14.0)) + sway;
  float ring = fract(trunk / 2.4);
  float late = smoothstep(0.15, 0.85, ring) * (1.0 - smoothstep(0.90, 1.0, ring));
  float fibre = noise(p * vec3(0.12, 3.2, 3.2)) * resolved(p, 0.3);
  float fleck = smoothstep(0.62, 0.72, noise(p * vec3(0.5, 2.0, 2.0) + 57.0)) * resolved(p, 0.6);
  skin.base *= mix(vec3(1.06, 1.06, 1.05), vec3(0.80, 0.73, 0.66), late * 0.5) * (1.0 - 0.10 * fibre);
  skin.base *= 1.0 - fleck * vec3(0.26, 0.34, 0.40);
  return skin;
}
)";

// Foam: round open cells, one in each cube of a grid, smaller or larger by chance.
constexpr const char* pores_glsl = R"(
Skin coloured(Skin skin, vec3 p) {
  const float cube_mm = 1.1, depth_mm = 0.35;
  vec3 q = p / cube_mm;
  ivec3 base = ivec3(floor(q - 0.5));
  float deepest = 0.0;
  vec3 slope = vec3(0.0);
  for (int k = 0; k < 8; ++k) {
    ivec3 cube = base + ivec3(k & 1, (k >> 1) & 1, k >> 2);
    float chance = random_at(cube);
    vec3 centre = vec3(cube) + 0.5 + 0.5 * (vec3(chance, fract(7.0 * chance), fract(31.0 * chance)) - 0.5);
    float width = 0.08 + 0.3 * fract(3.0 * chance), far = max(length(q - centre), 1e-6);
    float t = clamp((far - 0.16) / width, 0.0, 1.0);
    float depth = 1.0 - t * t * (3.0 - 2.0 * t);
    if (depth > deepest) {
      deepest = depth;
      slope = 6.0 * t * (1.0 - t) / (width * far) * (q - centre);
    }
  }
  float seen = resolved(p, cube_mm), pore = deepest * seen;
  skin.base *= 1.0 - 0.45 * pore;
  skin.visible *= 1.0 - 0.6 * pore;
  skin.normal = embossed(depth_mm * seen * vec4(-deepest, slope / cube_mm), skin.normal);
  return skin;
}
)";

// Brushed metal: fine marks along the body.
constexpr const char* brushed_glsl = R"(
Skin coloured(Skin skin, vec3 p) {
  vec4 relief = noise_relief(p, vec3(0.05, 0.9, 0.9), 0.045 * resolved(p, 0.9)) +
                noise_relief(p + 31.0 / vec3(0.14, 3.6, 3.6), vec3(0.14, 3.6, 3.6), 0.012 * resolved(p, 0.28));
  skin.base *= 0.88 + 4.0 * relief.x;
  skin.normal = embossed(relief, skin.normal);
  return skin;
}
)";

std::string with_noise(const char* pattern) {
  return std::string(noise_glsl) + pattern;
}

std::string with_relief(const char* pattern) {
  return std::string(noise_glsl) + relief_glsl + pattern;
}

}  // namespace

std::string pattern_glsl(SurfacePattern pattern) {
  switch (pattern) {
    case SurfacePattern::none:
      break;
    case SurfacePattern::smeared:
      return with_relief(smeared_glsl);
    case SurfacePattern::grain:
      return with_noise(grain_glsl);
    case SurfacePattern::pores:
      return with_relief(pores_glsl);
    case SurfacePattern::brushed:
      return with_relief(brushed_glsl);
  }
  return plain_glsl;
}

}  // namespace spoonbill
