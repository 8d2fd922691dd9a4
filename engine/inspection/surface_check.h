// Checks that a surface bounds a body properly, and measures its shape for reports. The checks are
// deterministic, may run on any thread, and are too slow for a tick.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/inspection/curvature.h"
#include "engine/inspection/mass_properties.h"
#include "engine/inspection/thickness.h"

namespace spoonbill {

// Edges no farther apart than this, in metres, coincide.
inline constexpr double closing_tolerance_m = 1e-6;

enum class Closedness {
  solid,  // bounds a body: closed in one direction, and closed or ending in poles in the other
  tube,   // closed in one direction, open in the other
  sheet,  // open in both directions
};

// Distances between the two ends of one direction. All are 0 in a periodic direction.
struct EdgeGap {
  double apart_m = 0.0;  // largest distance between corresponding points of the ends
  double first_width_m = 0.0, last_width_m = 0.0;  // extent of the edge at each end; 0 for a pole
};

struct Closing {
  Closedness closedness = Closedness::sheet;
  EdgeGap u, v;
  // Width of the gap that keeps the surface from being closed: 0 for a solid, and for a tube the width of its
  // widest open end. For a sheet it is the smaller of two values. The first value is the distance between the
  // ends of u or the width of the widest end of v, whichever is larger. The second is the same with u and v
  // exchanged.
  double gap_m = 0.0;
};

// Measures how nearly a surface is closed, from samples of its edges. Trims are ignored.
Closing find_closing(const Surface& surface);

// A point, other than a pole, at which du x dv vanishes; or a point within a smooth part of the surface at
// which du x dv flips.
struct SurfaceDefect {
  double u = 0.0, v = 0.0;
  Vector3 position_m = Vector3::Zero();
  bool folds = false;  // true if du x dv flips, false if it vanishes
};

struct SelfIntersection {
  double u = 0.0, v = 0.0, other_u = 0.0, other_v = 0.0, depth_m = 0.0;
  Vector3 position_m = Vector3::Zero();
};

struct SurfaceCheck {
  // How nearly the surface is closed, ignoring trims; all other members refer to the area within the trims.
  Closing closing;
  bool is_trimmed = false;
  EnclosedMass mass;  // the volume and its centre are valid only if encloses() is true
  CurvatureRange curvature;
  double bending = 0.0;  // result of compute_bending_energy()
  std::vector<SurfaceDefect> surface_defects;
  std::vector<SelfIntersection> self_intersections;
  bool self_intersections_complete = true;  // false if there are too many intersections to search them all
  std::optional<Thickness> thinnest = {};   // set only if encloses() is true and the volume is positive

  // Returns whether the surface bounds a body by itself.
  bool encloses() const { return closing.closedness == Closedness::solid && !is_trimmed; }
};

// Checks a surface. Edges shorter than collapsed_edge_fraction of its size count as points. Returns nothing
// if `progress` stopped the check.
std::optional<SurfaceCheck> check_surface(const Surface& surface, const TrimmedArea& area = {},
                                          const Progress& progress = {});

}  // namespace spoonbill
