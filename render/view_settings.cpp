#include "render/view_settings.h"

#include <algorithm>

#include "engine/base/geometry.h"

namespace spoonbill {

double interface_scale_for(int height_px) {
  constexpr double reference_height_px = 720.0;
  return std::max(1.0, height_px / reference_height_px);
}

double ground_below(const Box& model) {
  if (model.is_empty()) return 0.0;
  constexpr double gap_share = 0.01;
  return model.low.y() - gap_share * model.size();
}

}  // namespace spoonbill
