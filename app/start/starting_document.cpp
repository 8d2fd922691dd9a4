#include "app/start/starting_document.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

// Of the body's mean size: a thumb on a lump of clay.
constexpr double tool_share = 0.15;
// What the hand feels where the tool is pressed in by half its radius, by Hertz (1881): about E r^2 / 2.
constexpr double wanted_force_n = 1.5;

constexpr double held_share = 0.1;
// A body less high than this share of its mean size cannot be held by its foot and be pressed too.
constexpr double flat_share = 0.25;

FixingPlane holding_plane(const Box& box, double middle_size) {
  const Vector3 size = box.extent();
  const int axis = size.y() > flat_share * middle_size ? 1 : 0;
  FixingPlane plane;
  plane.point_m = box.centre();
  plane.point_m[axis] = box.low[axis] + held_share * size[axis];
  plane.normal = Vector3::Unit(axis);
  return plane;
}

// One or two digits that a person would have written.
double rounded_down(double number) {
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return std::floor(number / unit) * unit;
}

}  // namespace

Document starting_document(const std::string& name, Surface surface, const Material& material,
                           std::optional<double> shell_thickness_m) {
  const Box box = bounding_box(surface.net);
  const Vector3 size = box.extent();
  // The middle one: neither the length of a rod nor the thickness of a plate.
  const double middle = size.sum() - size.maxCoeff() - size.minCoeff();
  Document document;
  document.name = name;
  Body body;
  body.name = name;
  body.surface = std::move(surface);
  body.material = material;
  body.shell_thickness_m = shell_thickness_m;
  Scene& scene = document.scene;
  scene.bodies.push_back(std::move(body));
  scene.planes.push_back(holding_plane(box, middle));
  scene.tool.radius_m =
      std::clamp(rounded_down(tool_share * std::max(middle, 1e-4)), 1e-5, tool_radius_range_m.high);
  const double pressed_n = 0.5 * material.youngs_modulus_pa * scene.tool.radius_m * scene.tool.radius_m;
  scene.sculpting.force_scale =
      std::clamp(rounded_down(wanted_force_n / pressed_n), 1e-6, force_scale_range.high);
  return document;
}

}  // namespace spoonbill
