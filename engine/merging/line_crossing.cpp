#include "engine/merging/line_crossing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/dense_matrices.h"
#include "engine/base/geometry.h"
#include "engine/bspline/grid.h"
#include "engine/collision/meshes/triangle.h"
#include "engine/merging/tube_ends.h"

namespace spoonbill {
namespace {

constexpr int cells_in_piece = 6;
constexpr int chords_in_piece = 8;
constexpr int ray_chords = 64;
// Tolerance relative to chords, triangle sides and the surface's size. It ensures that no crossing is lost
// between two triangles or along a border.
constexpr double loose = 1e-9;

struct CurvePoint {
  Vector3 position_m, derivative;
};

Box box_around(const Vector3& a, const Vector3& b) {
  return box_about(std::array{a, b});
}

// Residual at which Newton's method counts as converged, relative to the surface's size. It is well above the
// rounding errors, because a grazing crossing leaves a residual that is larger than these errors.
constexpr double converged_fraction = 1e-10;

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
      boxes.push_back(joined(box_around(points_m_[corner], points_m_[corner + 1]),
                             box_around(points_m_[corner + v_.size()], points_m_[corner + v_.size() + 1])));
    }
  }
  tree_.emplace(boxes, 4);
}

std::vector<CrossingFinder::Start> CrossingFinder::find_starts(const Vector3& from, const Vector3& to) const {
  const Box chord = box_around(from, to);
  const std::size_t columns = v_.size() - 1;
  std::vector<Start> starts;
  const auto check_cell = [&](std::uint32_t cell) {
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
                  for (std::uint32_t k = 0; k < count; ++k) check_cell(tree_->order()[first + k]);
                });
  return starts;
}

// Solves curve(along) = other(u, v) for along, u and v by Newton's method.
template <class Curve>
std::optional<LineCrossing> CrossingFinder::polish(const Curve& curve, double along,
                                                   const Start& start) const {
  double u = start.other_u, v = start.other_v;
  const double reach = tree_->nodes()[0].box.size();
  for (int step = 0; step < 30; ++step) {
    const CurvePoint on_curve = curve(along);
    const SurfacePoint there = evaluate(other_, u, v);
    const Vector3 residual = on_curve.position_m - there.position_m;
    if (residual.norm() <= converged_fraction * reach) return LineCrossing{along, u, v, there.position_m};
    Eigen::Matrix3d slopes;
    slopes << on_curve.derivative, -there.du, -there.dv;
    const Vector3 moved = solve_linear(slopes, -residual);
    if (!moved.allFinite()) return std::nullopt;
    along += moved.x();
    u = other_.u.is_periodic() ? u + moved.y()
                               : std::clamp(u + moved.y(), other_.u.domain_start(), other_.u.domain_end());
    v = other_.v.is_periodic() ? v + moved.z()
                               : std::clamp(v + moved.z(), other_.v.domain_start(), other_.v.domain_end());
  }
  return std::nullopt;
}

std::vector<LineCrossing> CrossingFinder::intersect_line(const Surface& surface, double u) const {
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
    for (const Start& first : find_starts(from, to)) {
      const double v = steps[k - 1] + first.fraction * (steps[k] - steps[k - 1]);
      const auto crossing = polish(curve, v, first);
      if (crossing && crossing->along >= start && crossing->along <= end) crossings.push_back(*crossing);
    }
    from = to;
  }
  drop_repeated(crossings, 1e-7 * (end - start));
  return crossings;
}

std::vector<LineCrossing> CrossingFinder::intersect_ray(const Vector3& from_m, const Vector3& direction,
                                                        double length_m) const {
  SPOONBILL_ASSERT(std::abs(direction.squaredNorm() - 1.0) < 1e-6);
  SPOONBILL_ASSERT(length_m >= 0.0);
  const auto curve = [&](double along) { return CurvePoint{from_m + along * direction, direction}; };
  std::vector<LineCrossing> crossings;
  // The ray is divided into short chords, whose boxes meet few cells.
  const double step = length_m / ray_chords;
  for (int k = 0; k < ray_chords; ++k) {
    for (const Start& start :
         find_starts(from_m + k * step * direction, from_m + (k + 1) * step * direction)) {
      if (const auto crossing = polish(curve, (k + start.fraction) * step, start)) {
        crossings.push_back(*crossing);
      }
    }
  }
  drop_repeated(crossings, 1e-9 * length_m);
  return crossings;
}

namespace {

struct ContactParameters {
  double v, other_u, other_v;
};

// Step of finite differences, relative to the domain.
constexpr double small_step = 1e-6;

// Clamps t to the domain. Returns false if it is outside by more than rounding.
bool clamp_to_domain(const KnotVector& knots, double& t) {
  const double rounding = 1e-9 * knots.domain_length();
  if (knots.is_periodic()) return true;
  if (t < knots.domain_start() - rounding || t > knots.domain_end() + rounding) return false;
  t = std::clamp(t, knots.domain_start(), knots.domain_end());
  return true;
}

// Returns the step of a finite difference at t. It is negative near the end of an open domain.
double step_from(const KnotVector& knots, double t) {
  const double step = small_step * knots.domain_length();
  return !knots.is_periodic() && t + step > knots.domain_end() ? -step : step;
}

class Corner {
 public:
  Corner(const Surface& surface, double u, const Surface& other, BallSides sides)
      : surface_(surface),
        u_(u),
        other_(other),
        sides_(sides),
        pole_at_start_(is_tube(other) && is_pole(other, Side::v_start)),
        pole_at_end_(is_tube(other) && is_pole(other, Side::v_end)) {}

  Vector3 centre_from_surface(double v, double radius_m) const {
    return position(surface_, u_, v) + sides_.of_surface * radius_m * unit_normal(surface_, u_, v);
  }
  Vector3 centre_from_other(double u, double v, double radius_m) const {
    return position(other_, u, v) + sides_.of_other * radius_m * unit_normal(other_, u, v);
  }
  Vector3 residual(const ContactParameters& at, double radius_m) const {
    return centre_from_surface(at.v, radius_m) - centre_from_other(at.other_u, at.other_v, radius_m);
  }
  std::optional<ContactParameters> solve(ContactParameters at, double radius_m) const {
    for (int step = 0; step < 25; ++step) {
      const Vector3 current = residual(at, radius_m);
      if (current.norm() <= 1e-9 * radius_m) return at;
      const double dv = step_from(surface_.v, at.v), du_other = step_from(other_.u, at.other_u),
                   dv_other = step_from(other_.v, at.other_v);
      Eigen::Matrix3d slopes;
      slopes.col(0) = (residual({at.v + dv, at.other_u, at.other_v}, radius_m) - current) / dv;
      slopes.col(1) = (residual({at.v, at.other_u + du_other, at.other_v}, radius_m) - current) / du_other;
      slopes.col(2) = (residual({at.v, at.other_u, at.other_v + dv_other}, radius_m) - current) / dv_other;
      const Vector3 moved = solve_linear(slopes, -current);
      if (!moved.allFinite()) return std::nullopt;
      at = {at.v + moved.x(), at.other_u + moved.y(), at.other_v + moved.z()};
      cross_poles(at);
      if (!clamp_to_domain(surface_.v, at.v) || !clamp_to_domain(other_.u, at.other_u) ||
          !clamp_to_domain(other_.v, at.other_v)) {
        return std::nullopt;
      }
    }
    return std::nullopt;
  }

 private:
  // Moves parameters that are beyond a pole to the opposite side of that pole.
  void cross_poles(ContactParameters& at) const {
    const double start = other_.v.domain_start(), end = other_.v.domain_end();
    const bool before = pole_at_start_ && at.other_v < start, behind = pole_at_end_ && at.other_v > end;
    if (!before && !behind) return;
    at.other_v = 2.0 * (before ? start : end) - at.other_v;
    at.other_u += 0.5 * other_.u.domain_length();
  }

  const Surface& surface_;
  double u_;
  const Surface& other_;
  BallSides sides_;
  bool pole_at_start_, pole_at_end_;
};

}  // namespace

std::optional<BallContact> ball_contact(const Surface& surface, double u, const Surface& other,
                                        const LineCrossing& crossing, BallSides sides, double radius_m) {
  SPOONBILL_ASSERT(radius_m > 0.0);
  SPOONBILL_ASSERT(std::abs(sides.of_surface) == 1 && std::abs(sides.of_other) == 1);
  const Corner corner(surface, u, other, sides);
  constexpr int steps = 8;
  std::optional<ContactParameters> at = ContactParameters{crossing.along, crossing.other_u, crossing.other_v};
  for (int k = 1; at && k <= steps; ++k) at = corner.solve(*at, radius_m * k / steps);
  if (!at) return std::nullopt;
  return BallContact{at->v, at->other_u, at->other_v, corner.centre_from_surface(at->v, radius_m)};
}

}  // namespace spoonbill
