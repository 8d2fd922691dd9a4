#include "engine/material/statics/pressed_skin.h"

#include <algorithm>

#include "engine/base/assert.h"

namespace spoonbill {

void PressedSkin::press(const BodySkin& skin, std::size_t triangle, double pressure_pa) {
  SPOONBILL_ASSERT(triangle < skin.triangles.size());
  of_skin_.resize(skin.points.size(), -1);
  Pressed pressed{{}, pressure_pa};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t of_skin = skin.triangles[triangle][c];
    if (of_skin_[of_skin] < 0) {
      of_skin_[of_skin] = static_cast<int>(points_.size());
      points_.push_back(skin.points[of_skin]);
      at_m_.emplace_back(Vector3::Zero());
      force_n_.emplace_back(Vector3::Zero());
    }
    pressed.points[c] = static_cast<std::uint32_t>(of_skin_[of_skin]);
  }
  triangles_.push_back(pressed);
}

std::vector<int> PressedSkin::nodes() const {
  std::vector<int> nodes;
  nodes.reserve(8 * points_.size());
  for (const CellPoint& point : points_) nodes.insert(nodes.end(), point.nodes.begin(), point.nodes.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void PressedSkin::press_points() {
  for (const Pressed& pressed : triangles_) {
    const Vector3 &a = at_m_[pressed.points[0]], &b = at_m_[pressed.points[1]], &c = at_m_[pressed.points[2]];
    const Vector3 each_n = -pressed.pressure_pa / 6.0 * (b - a).cross(c - a);
    for (const std::uint32_t point : pressed.points) force_n_[point] += each_n;
  }
}

}  // namespace spoonbill
