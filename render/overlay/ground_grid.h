// The ground's grid and the scale bar that lies on it: what tells the size of things. No GL.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/camera.h"
#include "render/overlay/line.h"
#include "render/view_settings.h"

namespace spoonbill {

// Appends lines through multiples of a round length that suits the camera's distance, every fifth stronger,
// fading out around the camera's target.
void append_ground_grid(const Camera& camera, const Viewport& viewport, double ground_y_m,
                        std::vector<OverlayLine>& lines);

// A bar of a round length (1, 2 or 5 times a power of ten), parallel to the picture's lower edge.
struct ScaleBar {
  Vector3 start_m, end_m;
  double length_m = 0.0;

  // "20 mm"
  std::string text() const;
};

// On the ground in the lower middle of the free rectangle; none where the ground is not seen there.
std::optional<ScaleBar> ground_scale_bar(const Camera& camera, const Viewport& viewport, double ground_y_m);

// Appends the bar with a tick at either end.
void append_scale_bar(const ScaleBar& bar, const Camera& camera, std::vector<OverlayLine>& lines);

// The largest of 1, 2, 5 times a power of ten that does not exceed `length`, which must be positive.
double round_length_below(double length);

}  // namespace spoonbill
