#include "engine/shapes/swept_tube.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "engine/base/number_text.h"
#include "engine/base/place_text.h"
#include "engine/shapes/shape_sizes.h"

namespace spoonbill {

namespace {

constexpr int frames = 2048;
// Of the radius of the bend: nearer, the inside of the tube all but folds.
constexpr double most_of_bend = 0.98;

struct SweepFrame {
  Vector3 place, along, across;  // unit

  Vector3 up() const { return along.cross(across); }
};

Vector3 reflected(const Vector3& vector, const Vector3& by) {
  const double squared = by.squaredNorm();
  return squared > 0.0 ? Vector3(vector - 2.0 / squared * by.dot(vector) * by) : vector;
}

// The frame at another place near by, turned as little as may be.
SweepFrame carried(const SweepFrame& from, const Vector3& place, const Vector3& along) {
  const Vector3 way = place - from.place;
  const Vector3 across = reflected(from.across, way), tangent = reflected(from.along, way);
  SweepFrame to{place, along, reflected(across, along - tangent)};
  to.across = (to.across - to.across.dot(along) * along).normalized();
  return to;
}

class SweptTube {
 public:
  SweptTube(const TubeSize& size) : size_(size), end_m_(std::min(size.half_width_m, size.half_height_m)) {
    const Vector3 along = tangent(0.0);
    const Vector3 level = along.cross(Vector3::UnitY());
    SweepFrame frame{size.middle.at(0.0), along,
                     level.norm() > 1e-6 ? Vector3(level.normalized()) : Vector3(Vector3::UnitX())};
    frame.across = (frame.across - frame.across.dot(along) * along).normalized();
    frames_.push_back(frame);
    for (int k = 1; k <= frames; ++k) {
      const double t = size.middle.end() * k / frames;
      frames_.push_back(carried(frames_.back(), size.middle.at(t), tangent(t)));
    }
  }

  double cap_m() const { return 0.5 * std::numbers::pi * end_m_; }
  double length_m() const { return size_.middle.end() + 2.0 * cap_m(); }

  SweepFrame frame_at(double t) const {
    const double step = size_.middle.end() / frames;
    const auto k = static_cast<std::size_t>(std::clamp(std::floor(t / step), 0.0, frames - 1.0));
    return carried(frames_[k], size_.middle.at(t), tangent(t));
  }

  Vector3 at(double u, double v) const {
    const double distance = v * length_m() - cap_m(), end = size_.middle.end();
    const SweepFrame frame = frame_at(std::clamp(distance, 0.0, end));
    const double beyond = distance < 0.0 ? distance : distance > end ? distance - end : 0.0;
    const double angle = beyond / end_m_;
    const double wide = v <= 0.0 || v >= 1.0 ? 0.0 : std::cos(angle), around = 2.0 * std::numbers::pi * u;
    return frame.place +
           wide * (size_.half_width_m * std::cos(around) * frame.across +
                   size_.half_height_m * std::sin(around) * frame.up()) +
           end_m_ * std::sin(angle) * frame.along;
  }

  // How far the section reaches towards the middle of the bend, over its radius.
  double share_of_bend(double t) const {
    const Vector3 first = size_.middle.first_derivative(t), second = size_.middle.second_derivative(t);
    const double speed = first.squaredNorm();
    const Vector3 bend = (second - second.dot(first) / speed * first) / speed;
    const SweepFrame frame = frame_at(t);
    return std::hypot(size_.half_width_m * bend.dot(frame.across),
                      size_.half_height_m * bend.dot(frame.up()));
  }

 private:
  Vector3 tangent(double t) const { return size_.middle.first_derivative(t).normalized(); }

  TubeSize size_;
  double end_m_;
  std::vector<SweepFrame> frames_;
};

}  // namespace

Result<ExactShape> tube_shape(const TubeSize& size) {
  if (Status status = check_size("half the tube's width", size.half_width_m); !status) return status.error();
  if (Status status = check_size("half the tube's height", size.half_height_m); !status) {
    return status.error();
  }
  if (Status status = check_size("the tube's length", size.middle.end()); !status) return status.error();
  const auto tube = std::make_shared<const SweptTube>(size);
  double worst = 0.0, sharpest = 0.0;
  for (int k = 0; k <= frames; ++k) {
    const double t = size.middle.end() * k / frames, share = tube->share_of_bend(t);
    if (share > worst) sharpest = t;
    worst = std::max(worst, share);
  }
  if (worst > most_of_bend) {
    return Error{"the tube folds where its line bends most sharply, at " +
                 place_text(size.middle.at(sharpest)) + ": make its section at most " +
                 number_text(std::max(1.0, std::floor(100.0 * most_of_bend / worst))) +
                 " % as wide, or the bend wider"};
  }
  ExactShape shape;
  shape.u.periodic = true;
  const double cap = tube->cap_m() / tube->length_m();
  shape.v.breaks = {0.0, cap, 1.0 - cap, 1.0};
  shape.pole_at_start = shape.pole_at_end = true;
  shape.at = [tube](double u, double v) { return tube->at(u, v); };
  return shape;
}

}  // namespace spoonbill
