#include "engine/merging/line_crossing.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/bspline/grid.h"
#include "engine/collision/meshes/triangle.h"

namespace spoonbill {

namespace {

constexpr int cells_in_piece = 6;
constexpr int chords_in_piece = 8;
constexpr int ray_chords = 64;
// Of a chord, of a triangle's sides and of the whole surface's size, so that nothing slips through between
// two or beside a border that the line runs along.
constexpr double loose = 1e-9;

struct CurvePoint {
  Vector3 position_m, derivative;
};

Box bounding_box(const Vector3& a, const Vector3& b) {
  return box_about(std::array{a, b});
}

// Newton leaves rounding alone, which at a grazing crossing is more.
constexpr double converged_share = 1e-10;

void drop_repeated(std::vector<LineCrossing>& crossings, double nearness) {
  std::sort(crossings.begin(), crossings.end(),
            [](const LineCrossing& a, const LineCrossing& b) { return a.along < b.along; });
  const auto same = [&](const LineCrossing& a, const LineCrossing& b) {
    return b.along - a.along <= nearness;
  };
  crossings.erase(std::unique(crossings.begin(), crossings.end(), same), crossings.end());
}

}  // namespace

CrossingFinder::CrossingFinder(const Surface& other)
    : other_(other),
      u_(nested_parameters(other.u, cells_in_piece, 0).parameters),
      v_(nested_parameters(other.v, cells_in_piece, 0).parameters) {
  points_m_ = sample_grid_points(other, u_, v_).points_m;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i + 1 < u_.size(); ++i) {
    for (std::size_t j = 0; j + 1 < v_.size(); ++j) {
      const std::size_t corner = i * v_.size() + j;
      boxes.push_back(joined(bounding_box(points_m_[corner], points_m_[corner + 1]),
                             bounding_box(points_m_[corner + v_.size()], points_m_[corner + v_.size() + 1])));
    }
  }
  tree_.emplace(boxes, 4);
}

std::vector<CrossingFinder::Start> CrossingFinder::of_chord(const Vector3& from, const Vector3& to) const {
  const Box chord = bounding_box(from, to);
  const std::size_t columns = v_.size() - 1;
  std::vector<Start> starts;
  const auto look_at = [&](std::uint32_t cell) {
    const std::size_t i = cell / columns, j = cell % columns, corner = i * v_.size() + j;
    const Vector3 &low = points_m_[corner], &high = points_m_[corner + v_.size() + 1];
    const Vector3 &right = points_m_[corner + v_.size()], &up = points_m_[corner + 1];
    const double du = u_[i + 1] - u_[i], dv = v_[j + 1] - v_[j];
    const auto is_on_chord = [](const auto& met) {
      return met && met->along >= -loose && met->along <= 1.0 + loose;
    };
    if (const auto met = intersect_line_triangle(from, to - from, low, right, up, loose); is_on_chord(met)) {
      starts.push_back({met->along, u_[i] + met->to_b * du, v_[j] + met->to_c * dv});
    }
    if (const auto met = intersect_line_triangle(from, to - from, high, up, right, loose); is_on_chord(met)) {
      starts.push_back({met->along, u_[i + 1] - met->to_b * du, v_[j + 1] - met->to_c * dv});
    }
  };
  const double reach = loose * tree_->nodes()[0].box.size();
  tree_->search([&](std::uint32_t node) { return tree_->nodes()[node].box.is_near(chord, reach); },
                [](std::uint32_t, std::uint32_t) { return false; },
                [&](std::uint32_t first, std::uint32_t count) {
                  for (std::uint32_t k = 0; k < count; ++k) look_at(tree_->order()[first + k]);
                });
  return starts;
}

// Newton on curve(along) = other(u, v).
template <class Curve>
std::optional<LineCrossing> CrossingFinder::polished(const Curve& curve, double along,
                                                     const Start& start) const {
  double u = start.other_u, v = start.other_v;
  const double reach = tree_->nodes()[0].box.size();
  for (int step = 0; step < 30; ++step) {
    const CurvePoint on_curve = curve(along);
    const SurfacePoint there = evaluate(other_, u, v);
    const Vector3 apart = on_curve.position_m - there.position_m;
    if (apart.norm() <= converged_share * reach) return LineCrossing{along, u, v, there.position_m};
    Eigen::Matrix3d slopes;
    slopes << on_curve.derivative, -there.du, -there.dv;
    const Vector3 moved = slopes.partialPivLu().solve(-apart);
    if (!moved.allFinite()) return std::nullopt;
    along += moved.x();
    u = other_.u.is_periodic() ? u + moved.y()
                               : std::clamp(u + moved.y(), other_.u.domain_start(), other_.u.domain_end());
    v = other_.v.is_periodic() ? v + moved.z()
                               : std::clamp(v + moved.z(), other_.v.domain_start(), other_.v.domain_end());
  }
  return std::nullopt;
}

std::vector<LineCrossing> CrossingFinder::of_line(const Surface& surface, double u) const {
  const std::vector<double> steps = nested_parameters(surface.v, chords_in_piece, 0).parameters;
  const double start = surface.v.domain_start(), end = surface.v.domain_end();
  const auto curve = [&](double v) {
    const SurfacePoint point = evaluate(surface, u, std::clamp(v, start, end));
    return CurvePoint{point.position_m, point.dv};
  };
  std::vector<LineCrossing> crossings;
  Vector3 from = position(surface, u, steps[0]);
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const Vector3 to = position(surface, u, steps[k]);
    for (const Start& first : of_chord(from, to)) {
      const double v = steps[k - 1] + first.share * (steps[k] - steps[k - 1]);
      const auto crossing = polished(curve, v, first);
      if (crossing && crossing->along >= start && crossing->along <= end) crossings.push_back(*crossing);
    }
    from = to;
  }
  drop_repeated(crossings, 1e-7 * (end - start));
  return crossings;
}

std::vector<LineCrossing> CrossingFinder::of_ray(const Vector3& from_m, const Vector3& direction,
                                                 double length_m) const {
  SPOONBILL_ASSERT(std::abs(direction.squaredNorm() - 1.0) < 1e-6);
  SPOONBILL_ASSERT(length_m >= 0.0);
  const auto curve = [&](double along) { return CurvePoint{from_m + along * direction, direction}; };
  std::vector<LineCrossing> crossings;
  // Short ones, whose boxes hold few cells.
  const double step = length_m / ray_chords;
  for (int k = 0; k < ray_chords; ++k) {
    for (const Start& start : of_chord(from_m + k * step * direction, from_m + (k + 1) * step * direction)) {
      if (const auto crossing = polished(curve, (k + start.share) * step, start)) {
        crossings.push_back(*crossing);
      }
    }
  }
  drop_repeated(crossings, 1e-9 * length_m);
  return crossings;
}

}  // namespace spoonbill
