#include "render/overlay/symmetry_plane.h"

#include <algorithm>
#include <cmath>

#include "engine/base/geometry.h"
#include "render/overlay/palette.h"

namespace spoonbill {
namespace {

constexpr double overhang_share = 0.12;
constexpr float width_px = 1.4f;
constexpr int dashes_along_longest_side = 24;
// Of a dash and the dot after it, gaps between.
constexpr double dash_share = 0.55;
constexpr double dot_start = 0.72, dot_end = 0.83;

}  // namespace

PlaneCorners symmetry_plane_corners(const PlaneSnapshot& plane, const Box& body) {
  return corners_around(plane, body, overhang_share);
}

void append_symmetry_plane(const PlaneCorners& corners, std::vector<OverlayLine>& lines) {
  const double longest = std::max((corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm());
  if (!(longest > 0.0)) return;
  for (std::size_t side = 0; side < corners.size(); ++side) {
    const Vector3& start = corners[side];
    const Vector3 along = corners[(side + 1) % corners.size()] - start;
    const int dashes =
        std::max(1, static_cast<int>(std::lround(dashes_along_longest_side * along.norm() / longest)));
    const auto add = [&](double from, double to) {
      const Vector3 a = start + from / dashes * along, b = start + to / dashes * along;
      lines.push_back(
          {a.cast<float>(), b.cast<float>(), palette::symmetry_plane, palette::symmetry_plane, width_px});
    };
    for (int dash = 0; dash < dashes; ++dash) {
      add(dash, dash + dash_share);
      add(dash + dot_start, dash + dot_end);
    }
  }
}

}  // namespace spoonbill
