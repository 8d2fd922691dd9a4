// Swept shapes: tubes along a curve, and lofts through sections.
#pragma once

#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"
#include "engine/shapes/smooth_curve.h"

namespace spoonbill {

// A tube of elliptic section, swept along a curve without twist (double reflection, Wang et al. 2008). At the
// start of the curve, the tube's width is horizontal, or along x if the curve runs vertically. The ends are
// half ellipsoids whose length is the smaller half axis of the section.
struct TubeSize {
  SmoothCurve centre_line;
  double half_width_m = 0.005, half_height_m = 0.005;
};

// Makes a closed tube. Refuses sizes out of range. Refuses a curve that bends too sharply for the section;
// the error states the position of the bend.
Result<ExactShape> tube_shape(const TubeSize& size);

// Sections of a loft. Each section lists its points in order, without repeating the first point. In a loft of
// closed sections, the first or the last section may be a single point, which becomes a pole.
struct LoftSections {
  std::vector<std::vector<Vector3>> sections_m;
  bool closed = true;  // true if every section is a closed curve
  // Height of the caps over the first and last closed section; default: half the section's mean radius. The
  // caps bulge and continue the tangents of the sides, because a flat cap would meet the sides at an edge.
  std::optional<double> cap_m = {};
  bool caps = true;  // true if caps close the ends that are not poles
};

// Makes a surface from a smooth curve through the points of each section, and smooth curves across the
// sections. Reverses sections, and starts closed sections at another point, where this makes successive
// sections match more closely. If both ends of the shape are closed, its normals point outward. Refuses fewer
// than two sections, sections of too few points, successive sections with the same centre, and sizes out of
// range.
Result<ExactShape> loft_shape(LoftSections sections);

}  // namespace spoonbill
