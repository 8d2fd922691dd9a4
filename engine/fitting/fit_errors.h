// How far a fitted surface and its data are from each other, both ways.
#pragma once

#include <vector>

#include "engine/fitting/fit_points.h"
#include "engine/fitting/fit_surface.h"

namespace spoonbill {

struct Deviation {
  double max_m = 0.0, p95_m = 0.0, mean_m = 0.0;  // p95: that of which one in twenty is farther
};
// Zeros of none.
Deviation deviation_of(std::vector<double> distances_m);

struct FitErrors {
  // Of every point given but strays, or of points all over a mesh, from the surface point nearest to it; and
  // with the strays, of which a mesh has none.
  Deviation data_to_surface, all_to_surface;
  std::size_t strays = 0;  // points of no trust: off the surface, unlike those around them
  // Of samples of the surface, four by four a span, from the plane of the scan's points around the nearest
  // one, or from that point where they do not reach as far.
  Deviation surface_to_data;
  double unseen_share = 0.0;  // of these samples: where the scan has no points, left out above
  // For pictures: where each of these points lies, in space and on the surface, its distance, and whether it
  // is a stray.
  std::vector<Vector3> places_m;
  std::vector<Vector2> uv;
  std::vector<double> distance_m;
  std::vector<bool> is_stray;
};

FitErrors measure_errors(const FittedSurface& fit, const FitPoints& points);

}  // namespace spoonbill
