#include "engine/collision/surfaces/patch_folds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

constexpr double all_directions = std::numbers::pi;
constexpr double right_angle = 0.5 * std::numbers::pi;

// Of all vectors within `radius` of one.
double half_angle(double length, double radius) {
  return radius < length ? std::asin(radius / length) : all_directions;
}

double angle_between(const Vector3& one, const Vector3& other) {
  return std::atan2(one.cross(other).norm(), one.dot(other));
}

}  // namespace

PatchFolds::Direction PatchFolds::unroll(const KnotVector& knots) {
  Direction direction;
  const std::vector<double>& u = knots.extended_knots();
  const int p = direction.degree = knots.degree();
  const int count = static_cast<int>(u.size()) - p - 1;
  const std::vector<double> breaks = knots.breakpoints();
  for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
    direction.span.push_back(knots.find_span(0.5 * (breaks[b] + breaks[b + 1])));
  }
  for (int i = 0; i < count; ++i) {
    direction.control.push_back(knots.control_index(i, p));
    const double length = i + 1 < count ? u[i + p + 1] - u[i + 1] : 0.0;
    direction.scale.push_back(length > 0.0 ? p / length : 0.0);
  }
  return direction;
}

PatchFolds::PatchFolds(SurfaceLevels& levels)
    : levels_(&levels), u_(unroll(levels.nested().grid.u.knots)), v_(unroll(levels.nested().grid.v.knots)) {
  mixed_.resize(u_.span.size() * v_.span.size());
  steps_.resize(u_.control.size() * v_.control.size());
  cones_.resize(static_cast<std::size_t>(levels.all_cells()));
  taken_at_.assign(cones_.size(), 0);
}

void PatchFolds::begin() {
  ++begun_;
  levels_->bounds().update(levels_->surface().net);
  take_mixed();
}

// S_uv is a B-spline of one degree less in both directions, within its own control points.
void PatchFolds::take_mixed() {
  const ControlNet& net = levels_->surface().net;
  const int rows = static_cast<int>(u_.control.size()), columns = static_cast<int>(v_.control.size());
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j + 1 < columns; ++j) {
      const int here = u_.control[i], next = u_.control[i + 1];
      const Vector3 low = net.point(next, v_.control[j]) - net.point(here, v_.control[j]);
      const Vector3 high = net.point(next, v_.control[j + 1]) - net.point(here, v_.control[j + 1]);
      steps_[i * columns + j] = u_.scale[i] * v_.scale[j] * (high - low).norm();
    }
  }
  for (std::size_t eu = 0; eu < u_.span.size(); ++eu) {
    for (std::size_t ev = 0; ev < v_.span.size(); ++ev) {
      double most = 0.0;
      for (int i = u_.span[eu] - u_.degree; i < u_.span[eu]; ++i) {
        for (int j = v_.span[ev] - v_.degree; j < v_.span[ev]; ++j) {
          most = std::max(most, steps_[i * columns + j]);
        }
      }
      mixed_[eu * v_.span.size() + ev] = most;
    }
  }
}

// About the tangents in the middle of the cell, which change by the second derivatives at most.
PatchFolds::Cones PatchFolds::take_cones(const LevelCell& cell) {
  const Grid& grid = levels_->nested().grid;
  const int step = levels_->step(cell.level), shift = levels_->nested().levels;
  const int eu = cell.i >> shift, ev = cell.j >> shift;
  const double u0 = grid.u.parameters[cell.i], u1 = grid.u.parameters[cell.i + step];
  const double v0 = grid.v.parameters[cell.j], v1 = grid.v.parameters[cell.j + step];
  const double half_u = 0.5 * (u1 - u0), half_v = 0.5 * (v1 - v0);
  const SurfacePoint middle = evaluate(levels_->pieces(), u0 + half_u, v0 + half_v);
  const SurfaceBounds& bounds = levels_->bounds();
  const double mixed = mixed_[static_cast<std::size_t>(eu) * v_.span.size() + static_cast<std::size_t>(ev)];
  // A bulge is an eighth of the second derivative by the square of the side.
  const double radius_u = 8.0 * bounds.bulge(eu, ev, 1.0, 0.0) * half_u + mixed * half_v;
  const double radius_v = 8.0 * bounds.bulge(eu, ev, 0.0, 1.0) * half_v + mixed * half_u;
  const double length_u = middle.du.norm(), length_v = middle.dv.norm();
  return {{middle.du / std::max(length_u, 1e-300), half_angle(length_u, radius_u)},
          {middle.dv / std::max(length_v, 1e-300), half_angle(length_v, radius_v)}};
}

const PatchFolds::Cones& PatchFolds::cones_of(const LevelCell& cell) {
  const int index = levels_->cell_index(cell);
  if (taken_at_[index] != begun_) {
    taken_at_[index] = begun_;
    cones_[index] = take_cones(cell);
  }
  return cones_[index];
}

bool PatchFolds::never_meets_itself(std::span<const LevelCell> cells) {
  SPOONBILL_ASSERT(!cells.empty());
  SPOONBILL_ASSERT_DEBUG(std::all_of(
      cells.begin(), cells.end(), [&](const LevelCell& cell) { return cell.level == cells.front().level; }));
  Cones sum;
  for (const LevelCell& cell : cells) {
    const Cones& cones = cones_of(cell);
    sum.along_u.axis += cones.along_u.axis;
    sum.along_v.axis += cones.along_v.axis;
  }
  for (const LevelCell& cell : cells) {
    const Cones& cones = cones_of(cell);
    sum.along_u.angle = std::max(sum.along_u.angle,
                                 angle_between(sum.along_u.axis, cones.along_u.axis) + cones.along_u.angle);
    sum.along_v.angle = std::max(sum.along_v.angle,
                                 angle_between(sum.along_v.axis, cones.along_v.axis) + cones.along_v.angle);
  }
  if (!(sum.along_u.angle < right_angle && sum.along_v.angle < right_angle)) return false;
  const double between = angle_between(sum.along_u.axis, sum.along_v.axis);
  return std::min(between, std::numbers::pi - between) > sum.along_u.angle + sum.along_v.angle;
}

}  // namespace spoonbill
