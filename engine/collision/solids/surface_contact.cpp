#include "engine/collision/solids/surface_contact.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

inline constexpr int max_faces = 6;

struct FacePlane {
  double value;  // value of the plane at a step of zero
  Eigen::Vector2d slope;
};

struct MinimaxStep {
  Eigen::Vector2d step = Eigen::Vector2d::Zero();
  double value = 0.0;                       // value of the model at the step
  std::array<double, max_faces> weights{};  // Lagrange multipliers of the active planes; their sum is 1
};

// Minimises max_i (value_i + slope_i . s) + s . quadratic s / 2 over s. Tries all sets of one, two or three
// planes that may be active at the minimum. The quadratic must be positive definite and `count` from 1 to
// max_faces.
MinimaxStep minimise_largest(const std::array<FacePlane, max_faces>& planes, int count,
                             const Eigen::Matrix2d& quadratic);

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Planes = std::array<FacePlane, max_faces>;

double model(const Planes& planes, int count, const Matrix2d& quadratic, const Vector2d& step) {
  double largest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) largest = std::max(largest, planes[i].value + planes[i].slope.dot(step));
  return largest + 0.5 * step.dot(quadratic * step);
}

// Search for the minimum among candidates. The whole model is evaluated at each candidate, so the candidate
// with the least value is the minimum.
struct Search {
  const Planes& planes;
  int count;
  const Matrix2d& quadratic;
  Matrix2d inverse;
  MinimaxStep best;

  void offer(const Vector2d& step, std::initializer_list<std::pair<int, double>> weights) {
    if (!step.allFinite()) return;
    const double value = model(planes, count, quadratic, step);
    if (!(value < best.value)) return;
    best.step = step;
    best.value = value;
    best.weights.fill(0.0);
    for (const auto& [index, weight] : weights) best.weights[index] = weight;
  }

  void offer_one(int i) { offer(-(inverse * planes[i].slope), {{i, 1.0}}); }

  void offer_two(int i, int j) {
    const Vector2d difference = planes[i].slope - planes[j].slope;
    const double curvature = difference.dot(inverse * difference);
    if (!(curvature > 0.0)) return;
    const double fraction =
        (planes[i].value - planes[j].value - difference.dot(inverse * planes[j].slope)) / curvature;
    if (!(fraction >= 0.0 && fraction <= 1.0)) return;
    offer(-(inverse * (planes[j].slope + fraction * difference)), {{i, fraction}, {j, 1.0 - fraction}});
  }

  void offer_three(int i, int j, int k) {
    Matrix2d difference;
    difference.row(0) = (planes[i].slope - planes[k].slope).transpose();
    difference.row(1) = (planes[j].slope - planes[k].slope).transpose();
    const double determinant = difference.determinant();
    if (!(std::abs(determinant) > 1e-12 * difference.squaredNorm())) return;
    const Matrix2d solve = difference.inverse();
    const Vector2d step =
        solve * Vector2d(planes[k].value - planes[i].value, planes[k].value - planes[j].value);
    const Vector2d weights = -(solve.transpose() * (planes[k].slope + quadratic * step));
    const double last_weight = 1.0 - weights.sum();
    if (!(weights.minCoeff() >= 0.0 && last_weight >= 0.0)) return;
    offer(step, {{i, weights[0]}, {j, weights[1]}, {k, last_weight}});
  }
};

MinimaxStep minimise_largest(const Planes& planes, int count, const Matrix2d& quadratic) {
  SPOONBILL_ASSERT_DEBUG(count >= 1 && count <= max_faces);
  Search search{planes, count, quadratic, quadratic.inverse(), {}};
  search.best.value = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    search.offer_one(i);
    for (int j = i + 1; j < count; ++j) {
      search.offer_two(i, j);
      for (int k = j + 1; k < count; ++k) search.offer_three(i, j, k);
    }
  }
  return search.best;
}

}  // namespace

namespace {

// A derivative shorter than this fraction of the other derivative has no reliable direction.
constexpr double vanishing_fraction = 1e-9;

}  // namespace

Tangents tangents_across(const Vector3& normal, const SurfacePoint& at) {
  const auto in_plane = [&](const Vector3& vector) -> Vector3 {
    return vector - vector.dot(normal) * normal;
  };
  const Vector3 du = in_plane(at.du), dv = in_plane(at.dv);
  Vector3 along = du;
  if (!(du.norm() > vanishing_fraction * dv.norm())) along = dv.cross(normal);
  if (!(along.norm() > 0.0)) along = normal.unitOrthogonal();
  Tangents tangents;
  tangents.u = along.normalized();
  tangents.v = normal.cross(tangents.u);
  // A surface that degenerates to a line or point has no normal; any frame around the tangent is valid.
  if (!(tangents.v.norm() > 0.5)) tangents.v = tangents.u.unitOrthogonal();
  return tangents;
}

SurfaceContact contact_at(const Surface& surface, const SurfaceSpot& spot) {
  SurfaceContact contact;
  contact.u = spot.u;
  contact.v = spot.v;
  contact.point_m = spot.point_m;
  contact.depth_m = -spot.distance_m;
  contact.normal = unit_normal(surface, spot.u, spot.v);
  const Tangents tangents = tangents_across(contact.normal, evaluate(surface, spot.u, spot.v));
  contact.tangent_u = tangents.u;
  contact.tangent_v = tangents.v;
  return contact;
}

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int max_contact_steps = 60, max_restarts = 2;
// Smallest decrease of the distance for which a step is worthwhile, as a fraction of the solid's size.
constexpr double least_depth_gain = 1e-12;
// A central difference of the gradient uses two points. Half the distance between them is difference_fraction
// of the solid's size, but at most longest_difference_m.
constexpr double difference_fraction = 1e-5, longest_difference_m = 1e-5;
// Largest change of the gradient at which the difference counts as a curvature. At a larger change, an edge
// of the solid is between the two points.
constexpr double edge_change = 0.2;
// Two gradients count as gradients of the same face if the cosine of the angle between them is above this.
// Only one expansion of a face is stored.
constexpr double same_face = 0.9995;
// Least curvature, multiplied by the solid's size. It limits the step in flat directions.
constexpr double least_curvature = 1e-6;

// Second-order expansion of the distance to one face of the solid, as a function of the surface parameters,
// around `at`.
struct ShapeFace {
  Vector2d at;
  double distance;
  Vector3 gradient;
  Vector2d slope;
  Matrix2d curvature;

  double value(const Vector2d& there) const {
    const Vector2d offset = there - at;
    return distance + slope.dot(offset) + 0.5 * offset.dot(curvature * offset);
  }
};

// State of a descent. Its parameters may continue beyond a periodic seam, so that their differences stay
// small.
class Descent {
 public:
  Descent(const Surface& surface, const ToolShape& tool, const SurfaceSpot& from)
      : surface_(surface), tool_(tool), best_(from), at_(from.u, from.v) {
    size_ = tool.distance_field->bounds().size();
    if (!(size_ < 1.0)) size_ = 1.0;
    difference_ = std::min(difference_fraction * size_, longest_difference_m);
  }

  SurfaceSpot run() {
    evaluate_face(at_);
    reach_ = size_;
    for (int step = 0, restarts = 0; step < max_contact_steps; ++step) {
      const Step next = find_step();
      if (next.gain < least_depth_gain * size_ || !try_step(next.offset)) {
        // Expansions at distant parameters may block the step. They are dropped, and the descent may then
        // continue smoothly.
        if (restarts++ == max_restarts || count_ == 1) break;
        drop_other_faces();
      }
      if (reach_ < 1e-13) break;
    }
    return best_;
  }

 private:
  struct Step {
    Vector2d offset;  // change of the parameters
    double gain;
  };

  // Stores the second-order expansion, at the given parameters, of the distance to the nearest face of the
  // solid.
  void evaluate_face(const Vector2d& at) {
    const SurfacePoint point =
        evaluate(surface_, surface_.u.into_domain(at.x()), surface_.v.into_domain(at.y()));
    const DistanceSample sample = tool_.at(point.position_m);
    ShapeFace face{at, sample.distance_m, sample.gradient, {}, {}};
    face.slope = {sample.gradient.dot(point.du), sample.gradient.dot(point.dv)};
    const Vector3 change_u = gradient_change(point.position_m, point.du),
                  change_v = gradient_change(point.position_m, point.dv);
    const double both =
        0.5 * (change_u.dot(point.dv) + change_v.dot(point.du)) + sample.gradient.dot(point.duv);
    face.curvature << change_u.dot(point.du) + sample.gradient.dot(point.duu), both, both,
        change_v.dot(point.dv) + sample.gradient.dot(point.dvv);
    lengths_ = {std::max(point.du.norm(), 1e-9 * size_), std::max(point.dv.norm(), 1e-9 * size_)};
    store_face(face, point.position_m);
  }

  // Returns the change of the gradient per unit of a parameter, by central differences. `along` is the
  // derivative of the surface by this parameter. Returns zero if an edge of the solid is between the two
  // points of the difference.
  Vector3 gradient_change(const Vector3& from, const Vector3& along) const {
    const double length = along.norm();
    if (!(length > 0.0)) return Vector3::Zero();
    const Vector3 displacement = (difference_ / length) * along;
    const Vector3 change = tool_.at(from + displacement).gradient - tool_.at(from - displacement).gradient;
    if (change.norm() > edge_change) return Vector3::Zero();
    return (0.5 * length / difference_) * change;
  }

  void store_face(const ShapeFace& face, const Vector3& point) {
    better_ = face.distance < best_.distance_m;
    int index = count_;
    double nearest = same_face;
    for (int k = 0; k < count_; ++k) {
      if (faces_[k].gradient.dot(face.gradient) <= nearest) continue;
      nearest = faces_[k].gradient.dot(face.gradient);
      index = k;
    }
    new_face_ = index == count_;
    if (!better_ && index == current_ && count_ > 0) return;
    if (index == max_faces) index = find_farthest_face();
    faces_[index] = face;
    count_ = std::min(std::max(count_, index + 1), max_faces);
    if (!better_ && count_ > 1) return;
    at_ = face.at;
    current_ = index;
    if (better_) {
      best_ = {surface_.u.into_domain(at_.x()), surface_.v.into_domain(at_.y()), point, face.distance};
    }
  }

  int find_farthest_face() const {
    int result = current_ == 0 ? 1 : 0;
    for (int k = 0; k < count_; ++k) {
      if (k != current_ && (faces_[k].at - at_).squaredNorm() > (faces_[result].at - at_).squaredNorm()) {
        result = k;
      }
    }
    return result;
  }

  void drop_other_faces() {
    faces_[0] = faces_[current_];
    weights_.fill(0.0);
    weights_[0] = 1.0;
    current_ = 0;
    count_ = 1;
  }

  // Returns the weighted mean of the curvature matrices of the faces, with lengths along du and dv as
  // variables. Negative eigenvalues are replaced by their absolute values.
  Matrix2d quadratic() const {
    Matrix2d sum = Matrix2d::Zero();
    for (int k = 0; k < count_; ++k) sum += weights_[k] * faces_[k].curvature;
    const Vector2d scale = lengths_.cwiseInverse();
    sum = scale.asDiagonal() * sum * scale.asDiagonal();
    if (!sum.allFinite()) sum.setZero();
    Eigen::SelfAdjointEigenSolver<Matrix2d> eigen;
    eigen.computeDirect(sum);
    const Vector2d curvatures = eigen.eigenvalues().cwiseAbs().cwiseMax(least_curvature / size_);
    return eigen.eigenvectors() * curvatures.asDiagonal() * eigen.eigenvectors().transpose();
  }

  // Returns true if a parameter is at an open end of its domain and the step would leave the domain.
  bool is_barred(int axis, double offset) const {
    const KnotVector& knots = axis == 0 ? surface_.u : surface_.v;
    if (knots.is_periodic()) return false;
    return offset > 0.0 ? at_[axis] >= knots.domain_end() : at_[axis] <= knots.domain_start();
  }

  Step find_step() {
    std::array<FacePlane, max_faces> planes;
    const double here = best_.distance_m;
    const Vector2d scale = lengths_.cwiseInverse();
    for (int k = 0; k < count_; ++k) {
      const ShapeFace& face = faces_[k];
      const Vector2d slope = face.slope + face.curvature * (at_ - face.at);
      // If a minimum can be on an edge of the solid, the distance is the maximum over the faces. The
      // expansions of all faces except the current one are therefore limited to the current distance.
      planes[k] = {k == current_ ? 0.0 : std::min(face.value(at_) - here, 0.0), scale.cwiseProduct(slope)};
    }
    Matrix2d curvature = quadratic();
    MinimaxStep found = minimise_largest(planes, count_, curvature);
    for (int axis = 0; axis < 2; ++axis) {
      if (!is_barred(axis, found.step[axis])) continue;
      for (int k = 0; k < count_; ++k) planes[k].slope[axis] = 0.0;
      curvature(0, 1) = curvature(1, 0) = 0.0;
      found = minimise_largest(planes, count_, curvature);
      found.step[axis] = 0.0;
    }
    weights_ = found.weights;
    const double length = found.step.norm();
    const double fraction = length > reach_ ? reach_ / length : 1.0;
    return {fraction * scale.cwiseProduct(found.step), -found.value};
  }

  // Moves by the step, but stays within the domain. If the distance does not decrease, reduces the length of
  // later steps instead. Returns false if the domain leaves no room to move or the decrease is negligible.
  bool try_step(const Vector2d& offset) {
    Vector2d there = at_ + offset;
    const KnotVector* knots[2] = {&surface_.u, &surface_.v};
    for (int axis = 0; axis < 2; ++axis) {
      if (knots[axis]->is_periodic()) continue;
      there[axis] = std::clamp(there[axis], knots[axis]->domain_start(), knots[axis]->domain_end());
    }
    if (!there.allFinite() || there == at_) return false;
    const double length = lengths_.cwiseProduct(there - at_).norm(), before = best_.distance_m;
    const Vector2d lengths = lengths_;
    evaluate_face(there);
    if (better_) {
      reach_ = std::max(reach_, 2.0 * length);
      return before - best_.distance_m > least_depth_gain * size_;
    }
    lengths_ = lengths;
    reach_ = (new_face_ ? 0.7 : 0.3) * length;
    return true;
  }

  const Surface& surface_;
  const ToolShape& tool_;
  SurfaceSpot best_;
  Vector2d at_;  // parameters of the best point
  Vector2d lengths_ = Vector2d::Ones();
  double size_ = 1.0, difference_ = 1e-6, reach_ = 1.0;
  std::array<ShapeFace, max_faces> faces_;
  std::array<double, max_faces> weights_{1.0};
  int count_ = 0, current_ = 0;
  bool better_ = false, new_face_ = false;
};

}  // namespace

SurfaceSpot polish_on_solid(const Surface& surface, const ToolShape& tool, const SurfaceSpot& from) {
  SPOONBILL_ASSERT(tool.is_solid() && tool.distance_field != nullptr);
  return Descent(surface, tool, from).run();
}

}  // namespace spoonbill
