#include "engine/collision/solids/solid_polish.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "engine/base/assert.h"
#include "engine/collision/solids/smallest_largest.h"

namespace spoonbill {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int most_steps = 60, most_restarts = 2;
// Of the solid's size: a step that gains less is not worth its work.
constexpr double least_gain = 1e-12;
// The way on either side over which the gradient's differences are taken, of the solid's size and at most.
constexpr double difference_share = 1e-5, longest_difference_m = 1e-5;
// A gradient that turns by more over that way has passed an edge: it says nothing of the curvature.
constexpr double edge_turn = 0.2;
// Of faces that differ by less, the newer one counts: they are one.
constexpr double same_face = 0.9995;
// Of curvature, by the solid's size: flat directions get no endless step.
constexpr double least_curvature = 1e-6;

// One face of the solid as seen along the surface from the parameters `at`, to the second order.
struct Face {
  Vector2d at;
  double distance;
  Vector3 gradient;
  Vector2d slope;
  Matrix2d curvature;

  double value(const Vector2d& there) const {
    const Vector2d way = there - at;
    return distance + slope.dot(way) + 0.5 * way.dot(curvature * way);
  }
};

// The descent. Parameters run on over a periodic seam, so that differences of them stay small.
class Descent {
 public:
  Descent(const Surface& surface, const ToolShape& tool, const SurfaceSpot& from)
      : surface_(surface), tool_(tool), best_(from), at_(from.u, from.v) {
    size_ = tool.made_of->bounds().size();
    if (!(size_ < 1.0)) size_ = 1.0;
    difference_ = std::min(difference_share * size_, longest_difference_m);
  }

  SurfaceSpot run() {
    take_face(at_);
    reach_ = size_;
    for (int step = 0, restarts = 0; step < most_steps; ++step) {
      const Step next = find_step();
      if (next.gain < least_gain * size_ || !move(next.way)) {
        // Faces seen from afar may bar the way: without them a smooth descent goes on.
        if (restarts++ == most_restarts || count_ == 1) break;
        keep_nearest();
      }
      if (reach_ < 1e-13) break;
    }
    return best_;
  }

 private:
  struct Step {
    Vector2d way;  // of the parameters
    double gain;
  };

  // Evaluates the surface there, in the parameters' own units.
  void take_face(const Vector2d& at) {
    const SurfacePoint point =
        evaluate(surface_, surface_.u.into_domain(at.x()), surface_.v.into_domain(at.y()));
    const DistanceSample sample = tool_.at(point.position_m);
    Face face{at, sample.distance_m, sample.gradient, {}, {}};
    face.slope = {sample.gradient.dot(point.du), sample.gradient.dot(point.dv)};
    const Vector3 turn_u = turned(point.position_m, point.du), turn_v = turned(point.position_m, point.dv);
    const double both = 0.5 * (turn_u.dot(point.dv) + turn_v.dot(point.du)) + sample.gradient.dot(point.duv);
    face.curvature << turn_u.dot(point.du) + sample.gradient.dot(point.duu), both, both,
        turn_v.dot(point.dv) + sample.gradient.dot(point.dvv);
    lengths_ = {std::max(point.du.norm(), 1e-9 * size_), std::max(point.dv.norm(), 1e-9 * size_)};
    keep(face, point.position_m);
  }

  // How the gradient turns along a way, by central differences.
  Vector3 turned(const Vector3& from, const Vector3& along) const {
    const double length = along.norm();
    if (!(length > 0.0)) return Vector3::Zero();
    const Vector3 move = (difference_ / length) * along;
    const Vector3 turn = tool_.at(from + move).gradient - tool_.at(from - move).gradient;
    if (turn.norm() > edge_turn) return Vector3::Zero();
    return (0.5 * length / difference_) * turn;
  }

  void keep(const Face& face, const Vector3& point) {
    better_ = face.distance < best_.distance_m;
    int place = count_;
    double nearest = same_face;
    for (int k = 0; k < count_; ++k) {
      if (faces_[k].gradient.dot(face.gradient) <= nearest) continue;
      nearest = faces_[k].gradient.dot(face.gradient);
      place = k;
    }
    new_face_ = place == count_;
    if (!better_ && place == current_ && count_ > 0) return;
    if (place == most_faces) place = farthest();
    faces_[place] = face;
    count_ = std::min(std::max(count_, place + 1), most_faces);
    if (!better_ && count_ > 1) return;
    at_ = face.at;
    current_ = place;
    if (better_) {
      best_ = {surface_.u.into_domain(at_.x()), surface_.v.into_domain(at_.y()), point, face.distance};
    }
  }

  int farthest() const {
    int result = current_ == 0 ? 1 : 0;
    for (int k = 0; k < count_; ++k) {
      if (k != current_ && (faces_[k].at - at_).squaredNorm() > (faces_[result].at - at_).squaredNorm()) {
        result = k;
      }
    }
    return result;
  }

  void keep_nearest() {
    faces_[0] = faces_[current_];
    weights_.fill(0.0);
    weights_[0] = 1.0;
    current_ = 0;
    count_ = 1;
  }

  // In lengths along du and dv, so that a step has a size. Bent the wrong way, a direction counts as bent the
  // right way.
  Matrix2d quadratic() const {
    Matrix2d sum = Matrix2d::Zero();
    for (int k = 0; k < count_; ++k) sum += weights_[k] * faces_[k].curvature;
    const Vector2d scale = lengths_.cwiseInverse();
    sum = scale.asDiagonal() * sum * scale.asDiagonal();
    if (!sum.allFinite()) sum.setZero();
    Eigen::SelfAdjointEigenSolver<Matrix2d> parts;
    parts.computeDirect(sum);
    const Vector2d bent = parts.eigenvalues().cwiseAbs().cwiseMax(least_curvature / size_);
    return parts.eigenvectors() * bent.asDiagonal() * parts.eigenvectors().transpose();
  }

  // Whether a parameter stands at an open end of its domain and would leave it.
  bool is_barred(int axis, double way) const {
    const KnotVector& knots = axis == 0 ? surface_.u : surface_.v;
    if (knots.is_periodic()) return false;
    return way > 0.0 ? at_[axis] >= knots.domain_end() : at_[axis] <= knots.domain_start();
  }

  Step find_step() {
    std::array<FacePlane, most_faces> planes;
    const double here = best_.distance_m;
    const Vector2d scale = lengths_.cwiseInverse();
    for (int k = 0; k < count_; ++k) {
      const Face& face = faces_[k];
      const Vector2d slope = face.slope + face.curvature * (at_ - face.at);
      // No face reaches over the distance, which is their largest where a minimum can lie on an edge.
      planes[k] = {k == current_ ? 0.0 : std::min(face.value(at_) - here, 0.0), scale.cwiseProduct(slope)};
    }
    Matrix2d bend = quadratic();
    SmallestLargest found = smallest_largest(planes, count_, bend);
    for (int axis = 0; axis < 2; ++axis) {
      if (!is_barred(axis, found.step[axis])) continue;
      for (int k = 0; k < count_; ++k) planes[k].slope[axis] = 0.0;
      bend(0, 1) = bend(1, 0) = 0.0;
      found = smallest_largest(planes, count_, bend);
      found.step[axis] = 0.0;
    }
    weights_ = found.weights;
    const double length = found.step.norm();
    const double share = length > reach_ ? reach_ / length : 1.0;
    return {share * scale.cwiseProduct(found.step), -found.value};
  }

  // Goes the way as far as the domain lasts; false where nothing was gained nor learned.
  bool move(const Vector2d& way) {
    Vector2d there = at_ + way;
    const KnotVector* knots[2] = {&surface_.u, &surface_.v};
    for (int axis = 0; axis < 2; ++axis) {
      if (knots[axis]->is_periodic()) continue;
      there[axis] = std::clamp(there[axis], knots[axis]->domain_start(), knots[axis]->domain_end());
    }
    if (!there.allFinite() || there == at_) return false;
    const double length = lengths_.cwiseProduct(there - at_).norm(), before = best_.distance_m;
    const Vector2d lengths = lengths_;
    take_face(there);
    if (better_) {
      reach_ = std::max(reach_, 2.0 * length);
      return before - best_.distance_m > least_gain * size_;
    }
    lengths_ = lengths;
    reach_ = (new_face_ ? 0.7 : 0.3) * length;
    return true;
  }

  const Surface& surface_;
  const ToolShape& tool_;
  SurfaceSpot best_;
  Vector2d at_;  // of the best
  Vector2d lengths_ = Vector2d::Ones();
  double size_ = 1.0, difference_ = 1e-6, reach_ = 1.0;
  std::array<Face, most_faces> faces_;
  std::array<double, most_faces> weights_{1.0};
  int count_ = 0, current_ = 0;
  bool better_ = false, new_face_ = false;
};

}  // namespace

SurfaceSpot polished_on_solid(const Surface& surface, const ToolShape& tool, const SurfaceSpot& from) {
  SPOONBILL_ASSERT(tool.is_solid() && tool.made_of != nullptr);
  return Descent(surface, tool, from).run();
}

}  // namespace spoonbill
