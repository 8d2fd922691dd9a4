// Whether a surface bounds a body as it should, and what there is to know of its shape: for reports, not for
// the tick. Deterministic; any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/bspline/surface.h"
#include "engine/study/curvature_range.h"
#include "engine/study/enclosed_mass.h"
#include "engine/study/thickness.h"

namespace spoonbill {

// Edges nearer than this are one.
inline constexpr double closing_tolerance_m = 1e-6;

enum class Closedness {
  solid,  // bounds a body: closed around one direction and by poles or itself along the other
  tube,   // closed around one direction, open along the other
  sheet,  // open both ways
};

// Along one direction: how far apart its two ends are. 0 where it is periodic.
struct EdgeGap {
  double apart_m = 0.0;                            // between the points of both ends that belong together
  double first_width_m = 0.0, last_width_m = 0.0;  // how far from a single point each end is
};

// A place other than a pole where du x dv vanishes, or turns over from one side to the other.
struct BadSpot {
  double u = 0.0, v = 0.0;
  Vector3 position_m = Vector3::Zero();
  bool folds = false;
};

struct SelfMeeting {
  double u = 0.0, v = 0.0, other_u = 0.0, other_v = 0.0, depth_m = 0.0;
  Vector3 position_m = Vector3::Zero();
};

struct SurfaceCheck {
  Closedness closedness = Closedness::sheet;
  EdgeGap u_gap, v_gap;
  // What is missing to a closed surface: 0 for a solid, the width of the widest open end otherwise.
  double gap_m = 0.0;
  EnclosedMass mass;  // volume and middle of a solid only
  CurvatureRange curvature;
  double bending = 0.0;  // see bending_measure()
  std::vector<BadSpot> bad_spots;
  std::vector<SelfMeeting> self_meetings;
  bool self_meetings_complete = true;      // false where there were too many to be searched
  std::optional<Thickness> thinnest = {};  // of a solid
};

SurfaceCheck check_surface(const Surface& surface);

}  // namespace spoonbill
