#include "render/view_settings.h"

#include <algorithm>

namespace spoonbill {

double interface_scale_for(int height_px) {
  constexpr double reference_height_px = 720.0;
  return std::max(1.0, height_px / reference_height_px);
}

double ground_below(const BoundingBox& model) {
  if (model.empty()) return 0.0;
  constexpr double gap_share = 0.01;
  return model.low_m.y() - gap_share * (model.high_m - model.low_m).norm();
}

}  // namespace spoonbill
