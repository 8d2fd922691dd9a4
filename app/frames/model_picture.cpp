#include "app/frames/model_picture.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "app/session/view_choice.h"
#include "engine/base/text.h"
#include "render/camera.h"
#include "render/tessellation/tessellated_surface.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {
namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;
constexpr Range<double> azimuth_range_deg{-360.0, 360.0}, elevation_range_deg{-90.0, 90.0};

// Part of the picture that the model fills in the tighter direction.
constexpr double picture_fraction = 0.8;

constexpr std::array<std::pair<std::string_view, StandardView>, 7> view_names = {{
    {"perspective", StandardView::perspective},
    {"front", StandardView::front},
    {"back", StandardView::back},
    {"left", StandardView::left},
    {"right", StandardView::right},
    {"top", StandardView::top},
    {"bottom", StandardView::bottom},
}};

constexpr std::array<std::pair<std::string_view, bool Overlays::*>, 6> overlay_names = {{
    {"grid", &Overlays::ground_grid},
    {"scale", &Overlays::scale_bar},
    {"legend", &Overlays::legend},
    {"net", &Overlays::control_net},
    {"planes", &Overlays::fixing_planes},
    {"tool", &Overlays::tool},
}};

void append_name(std::string_view name, std::string& list) {
  list += (list.empty() ? "" : ", ") + std::string(name);
}

template <class Names>
std::string list_names(const Names& names) {
  std::string list;
  for (const auto& [name, value] : names) append_name(name, list);
  return list;
}

Result<double> parse_degrees(std::string_view text, Range<double> range_deg, const char* what) {
  double value = 0.0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = parsed.ec == std::errc() && parsed.ptr == text.data() + text.size();
  if (!is_number || !range_deg.contains(value)) {
    return Error{ErrorCode::out_of_range, std::string(what) + " '" + excerpt(text) +
                                              "' must be a number of degrees from " +
                                              std::to_string(static_cast<int>(range_deg.low)) + " to " +
                                              std::to_string(static_cast<int>(range_deg.high))};
  }
  return value;
}

}  // namespace

ViewDirection default_view_direction() {
  return {30.0 * radians_per_degree, 28.0 * radians_per_degree};
}

Result<ViewDirection> parse_view_direction(std::string_view text) {
  for (const auto& [name, view] : view_names) {
    if (text != name) continue;
    const Camera camera = look_from(Camera{}, view);
    return ViewDirection{camera.yaw_rad, camera.pitch_rad};
  }
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos) {
    return Error{ErrorCode::unknown, "'" + excerpt(text) + "' is unknown; choose from " +
                                         list_names(view_names) + ", or give azimuth,elevation in degrees"};
  }
  const auto azimuth_deg = parse_degrees(text.substr(0, comma), azimuth_range_deg, "the azimuth");
  if (!azimuth_deg) return azimuth_deg.error();
  const auto elevation_deg = parse_degrees(text.substr(comma + 1), elevation_range_deg, "the elevation");
  if (!elevation_deg) return elevation_deg.error();
  return ViewDirection{azimuth_deg.value() * radians_per_degree, elevation_deg.value() * radians_per_degree};
}

std::string list_studios() {
  std::string list;
  for (const Studio& studio : studios()) append_name(studio.name, list);
  return list;
}

Result<StudioChoice> parse_studio(std::string_view text) {
  const std::size_t comma = std::min(text.find(','), text.size());
  const Studio* const studio = find_studio(text.substr(0, comma));
  if (studio == nullptr) {
    return Error{ErrorCode::unknown, "'" + excerpt(text) + "' is unknown; choose from " + list_studios() +
                                         ", and add ,DEGREES to turn it"};
  }
  StudioChoice choice{*studio, 0.0};
  if (comma == text.size()) return choice;
  const auto turn_deg = parse_degrees(text.substr(comma + 1), azimuth_range_deg, "the turn");
  if (!turn_deg) return turn_deg.error();
  choice.turn_rad = turn_deg.value() * radians_per_degree;
  return choice;
}

Overlays no_overlays() {
  Overlays overlays;
  for (bool Overlays::*shown : {&Overlays::fixed_nodes, &Overlays::touched_nodes, &Overlays::force,
                                &Overlays::fixing_planes, &Overlays::symmetry_plane, &Overlays::tool,
                                &Overlays::ground_grid, &Overlays::scale_bar, &Overlays::legend}) {
    overlays.*shown = false;
  }
  return overlays;
}

Result<Overlays> parse_picture_overlays(std::string_view text) {
  Overlays overlays = no_overlays();
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view wanted = text.substr(0, comma);
    bool is_known = false;
    for (const auto& [name, shown] : overlay_names) {
      if (wanted != name) continue;
      overlays.*shown = is_known = true;
    }
    if (!is_known) {
      return Error{ErrorCode::unknown,
                   "'" + excerpt(wanted) + "' is unknown; choose from " + list_names(overlay_names)};
    }
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return overlays;
}

ShownModel join_models(std::span<const ShownModel> models) {
  ShownModel joined;
  for (const ShownModel& model : models) {
    const auto append = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
    append(model.snapshot.bodies, joined.snapshot.bodies);
    append(model.snapshot.planes, joined.snapshot.planes);
    append(model.notes, joined.notes);
    if (!joined.ground) joined.ground = model.ground;
  }
  if (!models.empty()) joined.snapshot.tool = models.front().snapshot.tool;
  return joined;
}

void show_material(const std::string& name, ShownModel& model) {
  for (BodySnapshot& body : model.snapshot.bodies) body.material.name = name;
}

namespace {

// Number of points of each body that are fitted into the picture.
constexpr std::size_t fitted_point_count = 200'000;

// The part of a model that its pictures show.
struct Subject {
  // Vertices of the drawn triangles: all of them, or every n-th corner of a large body; corners of the box
  // around the tool if it is shown. A trimmed face does not reach to its control points.
  std::vector<Vector3> points_m;
  Box box;  // around the bodies
};

// Returns the box around the tool at the origin.
Box find_tool_box(const ToolSnapshot& tool) {
  if (const ToolBody* const body = rigid_body(tool)) return bounding_box(body->solid);
  const double radius_m = tool.kind == ToolKind::sphere ? tool.radius_m : 0.0;
  return {Vector3::Constant(-radius_m), Vector3::Constant(radius_m)};
}

void append_tool_corners(const ToolSnapshot& tool, std::vector<Vector3>& points_m) {
  const Box box = find_tool_box(tool);
  for (int k = 0; k < 8; ++k) points_m.push_back(tool.proxy.position_m + box.corner(k));
}

Subject find_subject(const Snapshot& snapshot, bool has_tool) {
  constexpr int pieces = 4;
  Subject subject;
  for (const BodySnapshot& body : snapshot.bodies) {
    TessellatedSurface drawn;
    if (body.is_mesh()) {
      drawn.update(body.mesh);
    } else if (!check_net(body.surface) ||
               !drawn.update(body.surface, uniform_sampling_level(body.surface, pieces))) {
      continue;
    }
    const GridSamples<float>& at = drawn.samples();
    const std::size_t stride = 1 + drawn.indices().size() / fitted_point_count;
    for (std::size_t i = 0; i < drawn.indices().size(); i += stride) {
      const std::uint32_t v = drawn.indices()[i];
      subject.points_m.emplace_back(at.x[v], at.y[v], at.z[v]);
    }
    if (const Box one = drawn.bounds(); !one.is_empty()) subject.box.join(one);
  }
  if (has_tool) append_tool_corners(snapshot.tool, subject.points_m);
  return subject;
}

ViewSettings make_view_of(const Subject& subject, const ShownModel& model, const PictureSettings& picture) {
  ViewSettings view;
  view.camera.yaw_rad = picture.direction.yaw_rad;
  view.camera.pitch_rad = picture.direction.pitch_rad;
  view.camera = frame(view.camera, subject.points_m, make_viewport(picture.width_px, picture.height_px, {}),
                      picture_fraction);
  view.interface_scale = interface_scale_for(picture.height_px);
  view.overlays = picture.overlays;
  view.studio = picture.studio.studio;
  view.studio_turn_rad = picture.studio.turn_rad;
  view.keep_level = false;
  view.is_transparent = picture.is_transparent;
  view.ground_y_m = choose_ground_y_m(level_height_m(model.ground), std::nullopt, ground_below(subject.box));
  return view;
}

}  // namespace

void rest_tool_on_top(ShownModel& model) {
  const std::vector<Vector3> points_m = find_subject(model.snapshot, false).points_m;
  if (points_m.empty()) return;
  const auto is_lower = [](const Vector3& a, const Vector3& b) { return a.y() < b.y(); };
  ToolSnapshot& tool = model.snapshot.tool;
  const Box box = find_tool_box(tool);
  const Vector3 foot(box.centre().x(), box.low.y(), box.centre().z());
  tool.device.position_m = *std::max_element(points_m.begin(), points_m.end(), is_lower) - foot;
  tool.proxy = tool.device;
}

ViewSettings make_picture_view(const ShownModel& model, const PictureSettings& picture) {
  return make_view_of(find_subject(model.snapshot, picture.overlays.tool), model, picture);
}

std::vector<ViewSettings> make_turntable(const ShownModel& model, const PictureSettings& picture, int count) {
  const Subject subject = find_subject(model.snapshot, picture.overlays.tool);
  std::vector<ViewSettings> views;
  PictureSettings turned = picture;
  double distance_m = 0.0;
  for (int k = 0; k < count; ++k) {
    turned.direction.yaw_rad = picture.direction.yaw_rad + 2.0 * std::numbers::pi * k / count;
    views.push_back(make_view_of(subject, model, turned));
    distance_m = std::max(distance_m, views.back().camera.distance_m);
  }
  Box framed;
  for (const Vector3& point_m : subject.points_m) framed.include(point_m);
  for (ViewSettings& view : views) {
    if (!framed.is_empty()) view.camera.target_m = framed.centre();
    view.camera.distance_m = distance_m;
  }
  return views;
}

}  // namespace spoonbill
