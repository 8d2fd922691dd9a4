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
#include "engine/bspline/evaluate.h"
#include "engine/inspection/mass_properties.h"
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

Vector3 find_centre_m(const Body& body) {
  if (body.mesh) {
    const TriangleMesh mesh = find_placed_mesh(body);
    double volume = 0.0;
    Vector3 moment = Vector3::Zero();
    for (const TriangleCorners& corners : mesh.triangles) {
      const Vector3 &a = mesh.vertices_m[corners[0]], &b = mesh.vertices_m[corners[1]],
                    &c = mesh.vertices_m[corners[2]];
      const double six_volumes = a.dot(b.cross(c));
      volume += six_volumes;
      moment += 0.25 * six_volumes * (a + b + c);
    }
    return moment / volume;
  }
  const auto area = make_trimmed_area(body);
  const EnclosedMass mass = area && area.value() ? compute_enclosed_mass(body.surface, *area.value())
                                                 : compute_enclosed_mass(body.surface);
  return std::abs(mass.volume_m3) > 0.0 ? mass.centre_m : mass.area_centre_m;
}

Box find_extent(const Body& body) {
  return body.mesh ? find_bounds(body) : extent_of(body.surface, body.trims);
}

struct WeighedPoint {
  Vector3 position_m;
  double area_m2;  // area for which the point stands, up to a common factor
};

std::vector<WeighedPoint> sample_area(const Body& body) {
  std::vector<WeighedPoint> points;
  if (body.mesh) {
    const TriangleMesh mesh = find_placed_mesh(body);
    for (const TriangleCorners& corners : mesh.triangles) {
      const Vector3 &a = mesh.vertices_m[corners[0]], &b = mesh.vertices_m[corners[1]],
                    &c = mesh.vertices_m[corners[2]];
      points.push_back({(a + b + c) / 3.0, (b - a).cross(c - a).norm()});
    }
    return points;
  }
  constexpr int samples = 100;
  const auto v = uniform_parameters(body.surface.v, samples);
  for (const double at_u : uniform_parameters(body.surface.u, samples)) {
    for (const double at_v : v) {
      const SurfacePoint point = evaluate(body.surface, at_u, at_v);
      points.push_back({point.position_m, point.du.cross(point.dv).norm()});
    }
  }
  return points;
}

// Returns the turn that brings the body's longest direction to the axis, by at most a right angle. The
// longest direction is that of the largest moment of its points.
Result<Quaternion> find_length_turn(const Body& body, const Vector3& axis) {
  const std::vector<WeighedPoint> points = sample_area(body);
  double area_m2 = 0.0;
  Vector3 mean_m = Vector3::Zero();
  for (const WeighedPoint& point : points) {
    area_m2 += point.area_m2;
    mean_m += point.area_m2 * point.position_m;
  }
  mean_m /= area_m2;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const auto& [position_m, weight] : points) {
    moments += weight * (position_m - mean_m) * (position_m - mean_m).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
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

Pose turn_about(const Quaternion& turn, const Vector3& point_m) {
  return {point_m - turn * point_m, turn};
}

// Maps of the points and normals that go along with the only body of a scene.
struct Followers {
  std::function<Vector3(const Vector3&)> point, normal;
};

void move_followers(const Followers& map, Scene& scene) {
  for (FixingPlane& plane : scene.planes) {
    plane.point_m = map.point(plane.point_m);
    plane.normal = map.normal(plane.normal).normalized();
  }
  scene.symmetry.point_m = map.point(scene.symmetry.point_m);
  scene.symmetry.normal = map.normal(scene.symmetry.normal).normalized();
  if (!scene.trial) return;
  scene.trial->point_m = map.point(scene.trial->point_m);
  scene.trial->axis = map.normal(scene.trial->axis).normalized();
}

Followers place_by(const Pose& pose, Body& body) {
  move_body(pose, body);
  return {[pose](const Vector3& point) -> Vector3 { return pose.position_m + pose.orientation * point; },
          [pose](const Vector3& normal) -> Vector3 { return pose.orientation * normal; }};
}

Result<Followers> place(const PlacingRequest& request, const Vector3& about_m, Body& body) {
  switch (request.kind) {
    case PlacingKind::move:
      return place_by({request.vector, Quaternion::Identity()}, body);
    case PlacingKind::rotate: {
      const double angle = request.angle_deg * std::numbers::pi / 180.0;
      return place_by(turn_about(Quaternion(Eigen::AngleAxisd(angle, request.vector)), about_m), body);
    }
    case PlacingKind::scale: {
      const Vector3 factors = request.vector;
      scale_body(factors, about_m, body);
      return Followers{
          [=](const Vector3& point) -> Vector3 { return about_m + factors.cwiseProduct(point - about_m); },
          [=](const Vector3& normal) -> Vector3 { return normal.cwiseQuotient(factors); }};
    }
    case PlacingKind::mirror: {
      const Vector3 axis = request.vector;
      mirror_body(about_m, axis, body);
      const auto turned = [=](const Vector3& normal) -> Vector3 {
        return normal - 2.0 * axis.dot(normal) * axis;
      };
      return Followers{[=](const Vector3& point) -> Vector3 { return about_m + turned(point - about_m); },
                       turned};
    }
    case PlacingKind::align_length: {
      const auto turn = find_length_turn(body, request.vector);
      if (!turn) return turn.error();
      return place_by(turn_about(turn.value(), about_m), body);
    }
    case PlacingKind::align_side:
      break;
  }
  const Vector3& axis = request.vector;
  // The ends along a slanted axis are those of the body turned until the axis is x.
  Body turned = body;
  move_body({Vector3::Zero(), Quaternion::FromTwoVectors(axis, Vector3::UnitX())}, turned);
  const Box box = find_extent(turned);
  const double low = box.low.x(), high = box.high.x();
  const double at = request.side == BoxSide::low    ? low
                    : request.side == BoxSide::high ? high
                                                    : 0.5 * (low + high);
  return place_by({(request.place_m - at) * axis, Quaternion::Identity()}, body);
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
  Body& placed_body = scene.bodies[body];
  const auto followers = place(request, about_m ? *about_m : find_centre_m(placed_body), placed_body);
  if (!followers) return followers.error();
  if (scene.bodies.size() == 1) {
    move_followers(followers.value(), scene);
    return {};
  }
  if (!scene.planes.empty() || scene.symmetry.on || scene.trial) {
    notes.push_back(
        "fixing planes, the plane of symmetry and the trial stay where they are, because the "
        "document has several bodies");
  }
  return {};
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
