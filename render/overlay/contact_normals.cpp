#include "render/overlay/contact_normals.h"

#include <algorithm>

namespace spoonbill {

double contact_normal_length_m(const ToolSnapshot& tool) {
  return std::max(0.004, 0.6 * tool.radius_m);
}

void append_contact_normals(const std::vector<ContactSnapshot>& contacts, double length_m,
                            std::vector<OverlayLine>& lines) {
  constexpr float width_px = 1.8f;
  for (const ContactSnapshot& contact : contacts) {
    const Vector3 end = contact.point_m + length_m * contact.normal;
    lines.push_back({contact.point_m.cast<float>(), end.cast<float>(), palette::contact_normal,
                     palette::contact_normal, width_px});
  }
}

}  // namespace spoonbill
