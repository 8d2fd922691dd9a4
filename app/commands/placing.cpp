#include "app/commands/placing.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "app/commands/option_values.h"
#include "app/report/document_facts.h"
#include "engine/base/text.h"
#include "engine/bspline/quadrature.h"
#include "engine/inspection/mass_properties.h"
#include "engine/inspection/surface_check.h"
#include "engine/scene/place_body.h"

namespace spoonbill {
namespace {

constexpr Range<double> scale_range{1e-3, 1e3};

using ParseWord = Status (*)(const std::string& word, PlacingRequest& request);

struct Placing {
  PlacingKind kind;
  const char *first, *second;  // first words; `second` is null if the kind has only one
  std::vector<ParseWord> words;
  const char *form, *description;
};

template <class Value, class Target>
Status store(Result<Value> parsed, Target& target) {
  if (!parsed) return parsed.error();
  target = std::move(parsed).value();
  return {};
}

Status parse_move(const std::string& word, PlacingRequest& request) {
  return store(parse_position(word), request.vector);
}

Status parse_axis_word(const std::string& word, PlacingRequest& request) {
  return store(parse_axis(word), request.vector);
}

Status parse_turn(const std::string& word, PlacingRequest& request) {
  return store(parse_angle_deg(word, placement_angle_range_deg), request.angle_deg);
}

Status parse_factors(const std::string& word, PlacingRequest& request) {
  return store(parse_scale(word, scale_range), request.vector);
}

Status parse_box_side(const std::string& word, PlacingRequest& request) {
  return store(parse_choice<BoxSide>(
                   word, {{"low", BoxSide::low}, {"centre", BoxSide::centre}, {"high", BoxSide::high}}),
               request.side);
}

Status parse_place(const std::string& word, PlacingRequest& request) {
  return store(parse_length(word, position_range_m), request.place_m);
}

const std::vector<Placing>& all_placings() {
  static const std::vector<Placing> placings{
      {PlacingKind::move, "move", nullptr, {parse_move}, "10mm,0,0", "move along x, y and z"},
      {PlacingKind::rotate,
       "rotate",
       nullptr,
       {parse_axis_word, parse_turn},
       "y 30deg",
       "turn about an axis: x, y, z or a direction such as 0,1,1"},
      {PlacingKind::scale, "scale", nullptr, {parse_factors}, "1.2", "scale, or 1.2,1,1 for x, y and z"},
      {PlacingKind::mirror, "mirror", nullptr, {parse_axis_word}, "x", "mirror along an axis"},
      {PlacingKind::align_length,
       "align",
       "length",
       {parse_axis_word},
       "length x",
       "turn the body's longest direction to an axis"},
      {PlacingKind::align_side,
       "align",
       nullptr,
       {parse_axis_word, parse_box_side, parse_place},
       "y low 0",
       "move the low or high end or the centre of the body's box"}};
  return placings;
}

std::string example_of(const Placing& placing) {
  return std::string(placing.first) + " " + placing.form;
}

// The bodies that a placing moves.
using Placed = std::vector<Body*>;

TrimmedArea find_area(const Body& body) {
  const auto area = make_trimmed_area(body);
  return area && area.value() ? *area.value() : TrimmedArea();
}

// Moments of areas or volumes, from which centres and directions follow.
struct Moments {
  double size = 0.0;                                 // area or volume
  Vector3 first = Vector3::Zero();                   // integral of the position
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // integral of the position times its transpose

  void add(const Vector3& position_m, double weight) {
    size += weight;
    first += weight * position_m;
    second += weight * position_m * position_m.transpose();
  }
};

Moments find_area_moments(const Placed& bodies) {
  Moments moments;
  for (const Body* const body : bodies) {
    if (!body->mesh) {
      visit_area(body->surface, find_area(*body), [&](const SurfacePoint& point, double weight) {
        moments.add(point.position_m, weight * point.du.cross(point.dv).norm());
      });
      continue;
    }
    const TriangleMesh mesh = find_placed_mesh(*body);
    for (const TriangleCorners& corners : mesh.triangles) {
      const Vector3 &a = mesh.vertices_m[corners[0]], &b = mesh.vertices_m[corners[1]],
                    &c = mesh.vertices_m[corners[2]];
      const double area_m2 = 0.5 * (b - a).cross(c - a).norm();
      // The rule with the midpoints of the three sides is exact for second moments.
      for (const Vector3& midpoint :
           {Vector3(0.5 * (a + b)), Vector3(0.5 * (b + c)), Vector3(0.5 * (c + a))}) {
        moments.add(midpoint, area_m2 / 3.0);
      }
    }
  }
  return moments;
}

// Returns the centre of the volume of one closed body, or that of the area.
Vector3 find_centre_m(const Placed& bodies) {
  const Body& body = *bodies.front();
  if (bodies.size() == 1 && body.mesh) {
    Moments volume;
    const TriangleMesh mesh = find_placed_mesh(body);
    const Vector3& origin_m = mesh.vertices_m.front();
    for (const TriangleCorners& corners : mesh.triangles) {
      const Vector3 a = mesh.vertices_m[corners[0]] - origin_m, b = mesh.vertices_m[corners[1]] - origin_m,
                    c = mesh.vertices_m[corners[2]] - origin_m;
      volume.add(0.25 * (a + b + c), a.dot(b.cross(c)));
    }
    return origin_m + volume.first / volume.size;
  }
  if (bodies.size() == 1 && body.trims.empty() &&
      find_closing(body.surface).closedness == Closedness::solid) {
    return compute_enclosed_mass(body.surface).centre_m;
  }
  const Moments area = find_area_moments(bodies);
  return area.first / area.size;
}

// Returns the turn that brings the longest direction to the axis, by at most a right angle. The longest
// direction is that of the largest second moment of the area.
Result<Quaternion> find_length_turn(const Placed& bodies, const Vector3& axis) {
  const Moments area = find_area_moments(bodies);
  const Vector3 centre_m = area.first / area.size;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(area.second / area.size -
                                                              centre_m * centre_m.transpose());
  const Vector3 sizes = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  constexpr double clearly_longer = 1.02;
  if (!(sizes[2] > clearly_longer * sizes[1])) {
    return Error{ErrorCode::degenerate,
                 "align length: the body is about as long in two directions; turn it with rotate"};
  }
  Vector3 length = solver.eigenvectors().col(2);
  if (length.dot(axis) < 0.0) length = -length;
  return Quaternion::FromTwoVectors(length, axis);
}

// Returns how far the bodies reach along a direction.
Range<double> find_reach(const Placed& bodies, const Vector3& direction) {
  const Pose turned{Vector3::Zero(), Quaternion::FromTwoVectors(direction, Vector3::UnitX())};
  Box box;
  for (const Body* const body : bodies) {
    Body copy = *body;
    move_body(turned, copy);
    box.join(copy.mesh ? find_bounds(copy) : extent_of(copy.surface, copy.trims));
  }
  return {box.low.x(), box.high.x()};
}

Pose turn_about(const Quaternion& turn, const Vector3& point_m) {
  return {point_m - turn * point_m, turn};
}

// Maps of what goes along with the only body of a scene.
struct Followers {
  std::function<Vector3(const Vector3&)> point, normal, axis;
};

void move_followers(const Followers& map, Scene& scene) {
  for (FixingPlane& plane : scene.planes) {
    plane.point_m = map.point(plane.point_m);
    plane.normal = map.normal(plane.normal).normalized();
  }
  if (scene.symmetry.on) {
    scene.symmetry.point_m = map.point(scene.symmetry.point_m);
    scene.symmetry.normal = map.normal(scene.symmetry.normal).normalized();
  }
  if (!scene.trial) return;
  scene.trial->point_m = map.point(scene.trial->point_m);
  scene.trial->axis = map.axis(scene.trial->axis).normalized();
}

Followers place_by(const Pose& pose, const Placed& bodies) {
  for (Body* const body : bodies) move_body(pose, *body);
  const auto turned = [pose](const Vector3& direction) -> Vector3 { return pose.orientation * direction; };
  return {[pose](const Vector3& point) -> Vector3 { return pose.position_m + pose.orientation * point; },
          turned, turned};
}

Followers scale_by(const Vector3& factors, const Vector3& about_m, const Placed& bodies) {
  for (Body* const body : bodies) scale_body(factors, about_m, *body);
  return {[=](const Vector3& point) -> Vector3 { return about_m + factors.cwiseProduct(point - about_m); },
          [=](const Vector3& normal) -> Vector3 { return normal.cwiseQuotient(factors); },
          [=](const Vector3& axis) -> Vector3 { return factors.cwiseProduct(axis); }};
}

Followers mirror_by(const Vector3& normal, const Vector3& about_m, const Placed& bodies) {
  for (Body* const body : bodies) mirror_body(about_m, normal, *body);
  const auto turned = [=](const Vector3& direction) -> Vector3 {
    return direction - 2.0 * normal.dot(direction) * normal;
  };
  return {[=](const Vector3& point) -> Vector3 { return about_m + turned(point - about_m); }, turned,
          // A mirrored turn goes the other way about the mirrored axis.
          [=](const Vector3& axis) -> Vector3 { return -turned(axis); }};
}

Result<Followers> place(const PlacingRequest& request, const Vector3& about_m, const Placed& bodies) {
  const Vector3& axis = request.vector;
  switch (request.kind) {
    case PlacingKind::move:
      return place_by({request.vector, Quaternion::Identity()}, bodies);
    case PlacingKind::rotate: {
      const double angle = request.angle_deg * std::numbers::pi / 180.0;
      return place_by(turn_about(Quaternion(Eigen::AngleAxisd(angle, axis)), about_m), bodies);
    }
    case PlacingKind::scale:
      return scale_by(request.vector, about_m, bodies);
    case PlacingKind::mirror:
      return mirror_by(axis, about_m, bodies);
    case PlacingKind::align_length: {
      const auto turn = find_length_turn(bodies, axis);
      if (!turn) return turn.error();
      return place_by(turn_about(turn.value(), about_m), bodies);
    }
    case PlacingKind::align_side:
      break;
  }
  const auto [low, high] = find_reach(bodies, axis);
  const double at = request.side == BoxSide::low    ? low
                    : request.side == BoxSide::high ? high
                                                    : 0.5 * (low + high);
  return place_by({(request.place_m - at) * axis, Quaternion::Identity()}, bodies);
}

// Returns the body with the others of its solid, whose faces move together.
Placed find_placed(std::vector<Body>& bodies, std::size_t index) {
  Placed placed{&bodies[index]};
  for (Body& body : bodies) {
    const bool is_same_solid = !body.solid.empty() && body.solid == bodies[index].solid;
    if (is_same_solid && &body != placed.front()) placed.push_back(&body);
  }
  return placed;
}

}  // namespace

bool is_placing(const std::vector<std::string>& words) {
  return !words.empty() && std::any_of(all_placings().begin(), all_placings().end(),
                                       [&](const Placing& placing) { return words[0] == placing.first; });
}

Result<PlacingRequest> parse_placing(const std::vector<std::string>& words) {
  std::string forms;
  for (const Placing& placing : all_placings()) {
    if (words[0] != placing.first) continue;
    forms += (forms.empty() ? "" : " or ") + example_of(placing);
    const std::size_t begin = placing.second == nullptr ? 1 : 2;
    const bool fits = placing.second == nullptr || (words.size() > 1 && words[1] == placing.second);
    if (!fits || words.size() != begin + placing.words.size()) continue;
    PlacingRequest request{placing.kind};
    for (std::size_t k = 0; k < placing.words.size(); ++k) {
      if (Status parsed = placing.words[k](words[begin + k], request); !parsed) return parsed.error();
    }
    return request;
  }
  return Error{ErrorCode::malformed, "'" + words[0] + "' must have the form: " + forms};
}

Status place_body(const PlacingRequest& request, const std::optional<Vector3>& about_m, std::size_t body,
                  Scene& scene, std::vector<std::string>& notes) {
  const Placed placed = find_placed(scene.bodies, body);
  const auto followers = place(request, about_m ? *about_m : find_centre_m(placed), placed);
  if (!followers) return followers.error();
  if (placed.size() > 1) {
    notes.push_back("the " + std::to_string(placed.size()) + " faces of the solid \"" +
                    scene.bodies[body].solid + "\" were placed together");
  }
  if (scene.bodies.size() == placed.size()) {
    move_followers(followers.value(), scene);
  } else if (!scene.planes.empty() || scene.symmetry.on || scene.trial) {
    notes.push_back(
        "fixing planes, the plane of symmetry and the trial stay where they are, because the document has "
        "other "
        "bodies");
  }
  return {};
}

bool takes_point(PlacingKind kind) {
  return kind != PlacingKind::move && kind != PlacingKind::align_side;
}

std::string placing_names() {
  std::string names, last;
  for (const Placing& placing : all_placings()) {
    if (placing.first == last) continue;
    last = placing.first;
    names += (names.empty() ? "" : ", ") + last;
  }
  return names;
}

std::string list_placings() {
  std::string text;
  for (const Placing& placing : all_placings()) {
    std::string left = "  " + example_of(placing);
    left.resize(std::max<std::size_t>(left.size() + 2, 24), ' ');
    text += left + placing.description + "\n";
  }
  return text;
}

}  // namespace spoonbill
