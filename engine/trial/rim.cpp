#include "engine/trial/rim.h"

#include <algorithm>

namespace spoonbill {
namespace {

// Number of points on a rim whose corners are all apart. The two poles of a bowl leave half of them; the
// chords between these are within 0.02 mm of the rim.
constexpr int point_count = 192;
constexpr double coincident_m = 1e-9;
// Smallest area of a usable rim, as a fraction of its squared length.
constexpr double least_area_fraction = 1e-4;

// Writes points along the line; neighbours are further apart than coincident_m.
void sample_line(const Surface& surface, const std::vector<Vector2>& corners, std::vector<Vector3>& points) {
  const int steps = std::max(1, point_count / static_cast<int>(corners.size()));
  const auto at = [&](const Vector2& corner) { return position(surface, corner.x(), corner.y()); };
  points.clear();
  points.reserve(static_cast<std::size_t>(steps) * corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2 &from = corners[k], &to = corners[(k + 1) % corners.size()];
    const bool is_one_point = (at(from) - at(to)).norm() <= coincident_m;
    for (int s = 0; s < (is_one_point ? 1 : steps); ++s) {
      const Vector3 point = at(from + (to - from) * s / steps);
      if (points.empty() || (point - points.back()).norm() > coincident_m) points.push_back(point);
    }
  }
  while (points.size() > 1 && (points.front() - points.back()).norm() <= coincident_m) points.pop_back();
}

}  // namespace

std::optional<Rim> Rim::on_surface(const Surface& surface, const std::vector<Vector2>& corners,
                                   const Vector3& up) {
  Rim rim;
  if (!rim.follow(surface, corners, up)) return std::nullopt;
  return rim;
}

bool Rim::follow(const Surface& surface, const std::vector<Vector2>& corners, const Vector3& up) {
  sample_line(surface, corners, points_m_);
  double length = 0.0;
  Vector3 area = Vector3::Zero();
  centre_m_.setZero();
  for (std::size_t k = 0; k < points_m_.size(); ++k) {
    const Vector3 &a = points_m_[k], &b = points_m_[(k + 1) % points_m_.size()];
    const double chord = (b - a).norm();
    length += chord;
    centre_m_ += chord * 0.5 * (a + b);
    area += 0.5 * (a - points_m_.front()).cross(b - points_m_.front());
  }
  if (!(area.norm() > least_area_fraction * length * length)) return false;
  centre_m_ /= length;
  normal_ = area.normalized();
  if (normal_.dot(up) < 0.0) normal_ = -normal_;
  const Vector3 first = points_m_.front() - centre_m_;
  const Vector3 level = first - normal_.dot(first) * normal_;
  across_ = level.norm() > coincident_m ? Vector3(level.normalized()) : normal_.unitOrthogonal();
  along_ = normal_.cross(across_);
  outline_m_.clear();
  outline_m_.reserve(points_m_.size());
  for (const Vector3& point : points_m_) outline_m_.push_back(projected(point));
  box_m_ = box_about(outline_m_);
  inner_radius_m_ = 0.0;
  inner_radius_m_ = std::max(0.0, margin_m(centre_m_));
  return true;
}

bool Rim::is_outside(const Vector3& point_m) const {
  if (is_well_inside(point_m)) return false;
  const Vector2 point = projected(point_m);
  return box_m_.squared_distance(point) > 0.0 || !is_inside(point, outline_m_);
}

double Rim::margin_m(const Vector3& point_m) const {
  const Vector2 point = projected(point_m);
  double nearest_m = infinity;
  for (std::size_t k = 0; k < outline_m_.size(); ++k) {
    const Vector2 &from = outline_m_[k], &to = outline_m_[(k + 1) % outline_m_.size()];
    const Vector2 side = to - from;
    const double share = std::clamp((point - from).dot(side) / side.squaredNorm(), 0.0, 1.0);
    nearest_m = std::min(nearest_m, (point - from - share * side).norm());
  }
  return is_outside(point_m) ? -nearest_m : nearest_m;
}

}  // namespace spoonbill
