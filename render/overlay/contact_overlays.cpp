#include <algorithm>
#include <array>

#include "engine/base/geometry.h"
#include "render/overlay/overlays.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {
namespace {

constexpr float hull_width_px = 1.2f;
constexpr float range_width_px = 2.4f;
constexpr float triangle_edge_width_px = 1.0f;
constexpr float normal_width_px = 1.3f;
constexpr float contact_radius_m = 0.00015f;
constexpr double short_normal = 0.6;  // relative length of a normal that is not at a deepest contact
constexpr std::size_t maximum_arrows = 24;

void add_line(const Vector3& start, const Vector3& end, Colour colour, float width_px,
              std::vector<OverlayLine>& lines) {
  lines.push_back({start.cast<float>(), end.cast<float>(), colour, colour, width_px});
}

void add_hulls(const ContactStages& stages, StageShapes& shapes) {
  for (const StageLine& line : stages.hulls) {
    add_line(line.start_m, line.end_m, palette::hull, hull_width_px, shapes.lines);
  }
  for (const StageLine& line : stages.ranges) {
    add_line(line.start_m, line.end_m, palette::parameter_range, range_width_px, shapes.lines);
  }
}

void add_spheres(const ContactStages& stages, int level, StageShapes& shapes) {
  for (const StageSphere& sphere : stages.spheres) {
    if (sphere.cell.level != level) continue;
    const Colour active = sphere.is_second ? palette::active_second_sphere : palette::active_sphere;
    shapes.shells.push_back({sphere.cover.centre.cast<float>(), static_cast<float>(sphere.cover.radius),
                             sphere.kept ? active : palette::rejected_sphere});
  }
}

void add_triangles(const ContactStages& stages, StageShapes& shapes) {
  for (const StageTriangle& triangle : stages.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 &from = triangle.corners[k], &to = triangle.corners[(k + 1) % 3];
      shapes.corners.push_back({from.cast<float>(), palette::active_triangle});
      add_line(from, to, palette::triangle_edge, triangle_edge_width_px, shapes.lines);
    }
  }
}

void add_contacts(const ContactStages& stages, double length, StageShapes& shapes) {
  for (const StageContact& contact : stages.contacts) {
    const Vector3& point = contact.at.point_m;
    shapes.marks.push_back({point.cast<float>(), palette::touched_node, contact_radius_m, 2.0f,
                            static_cast<float>(MarkShape::disc)});
    if (contact.is_deepest) continue;
    add_line(point, point + short_normal * length * contact.at.normal, palette::contact_normal,
             normal_width_px, shapes.lines);
  }
}

bool is_shown(const ViewSettings& settings) {
  return settings.stages && settings.overlays.contact_stage != ContactStage::none;
}

// Returns the point at which a ray from the tool's centre leaves the bounding box of a rigid solid tool, or
// the ball of a round tool. For a soft tool, returns the tool's position.
Vector3 find_arrow_start(const Snapshot& snapshot, const Vector3& direction) {
  const ToolSnapshot& tool = snapshot.tool;
  const ToolBody* body = rigid_body(tool);
  if (body != nullptr) return find_exit_point(bounding_box(body->solid), tool_frame(snapshot), direction);
  if (is_soft(tool)) return tool.proxy.position_m;
  return tool.proxy.position_m + tool.radius_m * direction;
}

}  // namespace

StageShapes stage_shapes(const Snapshot& snapshot, const ViewSettings& settings) {
  StageShapes shapes;
  if (!is_shown(settings)) return shapes;
  const ContactStages& stages = *settings.stages;
  switch (settings.overlays.contact_stage) {
    case ContactStage::none:
      break;
    case ContactStage::hulls:
      add_hulls(stages, shapes);
      break;
    case ContactStage::spheres:
      add_spheres(stages, settings.overlays.sphere_level, shapes);
      break;
    case ContactStage::triangles:
      add_triangles(stages, shapes);
      break;
    case ContactStage::contacts:
      add_contacts(stages, contact_normal_length_m(snapshot.tool), shapes);
      shapes.arrows = contact_arrows(snapshot, settings);
      break;
  }
  return shapes;
}

std::vector<OverlayArrow> contact_arrows(const Snapshot& snapshot, const ViewSettings& settings) {
  std::vector<OverlayArrow> arrows;
  if (!is_shown(settings) || settings.overlays.contact_stage != ContactStage::contacts) return arrows;
  const double length = contact_normal_length_m(snapshot.tool);
  for (const StageContact& contact : settings.stages->contacts) {
    if (!contact.is_deepest || arrows.size() >= maximum_arrows) continue;
    const SurfaceContact& at = contact.at;
    const auto add = [&](const Vector3& direction, Colour colour, const char* name) {
      arrows.push_back({at.point_m, at.point_m + length * direction, colour, name});
    };
    add(at.normal, palette::contact_normal, "n");
    add(at.tangent_u, palette::tangent_u, "u");
    add(at.tangent_v, palette::tangent_v, "v");
  }
  return arrows;
}

std::optional<std::string> stage_caption(const ViewSettings& settings) {
  if (!is_shown(settings)) return std::nullopt;
  const std::string level = std::to_string(settings.overlays.sphere_level);
  switch (settings.overlays.contact_stage) {
    case ContactStage::none:
      return std::nullopt;
    case ContactStage::hulls:
      return "Hulls of the control points, and the range of parameters they leave";
    case ContactStage::spheres:
      return settings.overlays.sphere_level < finest_stage_level
                 ? "Spheres of level " + level + ": what meets is refined, the rest dropped"
                 : "Spheres of level " + level + ", the last: what meets becomes triangles";
    case ContactStage::triangles:
      return "Triangles of the last level that meet";
    case ContactStage::contacts:
      return "Contact points with normals; where deepest, tangents along u and v";
  }
  return std::nullopt;
}

Box bounding_box(const StageShapes& shapes) {
  Box box;
  const auto include = [&](const Eigen::Vector3f& point) { box.include(point.cast<double>()); };
  for (const OverlayLine& line : shapes.lines) {
    include(line.start_m);
    include(line.end_m);
  }
  for (const OverlayShell& shell : shapes.shells) {
    include((shell.centre_m.array() - shell.radius_m).matrix());
    include((shell.centre_m.array() + shell.radius_m).matrix());
  }
  for (const OverlayCorner& corner : shapes.corners) include(corner.position_m);
  for (const OverlayMark& mark : shapes.marks) include(mark.position_m);
  for (const OverlayArrow& arrow : shapes.arrows) box.include(arrow.tip_m);
  return box;
}

double contact_normal_length_m(const ToolSnapshot& tool) {
  return std::max(0.004, 0.6 * tool.radius_m);
}

void append_contact_normals(const std::vector<ContactSnapshot>& contacts, double length_m,
                            std::vector<OverlayLine>& lines) {
  constexpr float width_px = 1.8f;
  for (const ContactSnapshot& contact : contacts) {
    const Vector3 end = contact.point_m + length_m * contact.normal;
    lines.push_back({contact.point_m.cast<float>(), end.cast<float>(), palette::contact_normal,
                     palette::contact_normal, width_px});
  }
}

std::optional<ForceArrow> force_arrow(const Snapshot& snapshot, const ViewSettings& settings) {
  constexpr double smallest_n = 0.005;
  const double newtons = snapshot.force_n.norm();
  if (!settings.overlays.force || !(newtons >= smallest_n)) return std::nullopt;
  constexpr double longest_m = 0.060;
  // Smallest length of an arrow: an arrow shorter than its head would have no shaft.
  constexpr double shortest_m = 0.006;
  const double maximum_m = std::max(longest_m, 5.0 * snapshot.tool.radius_m);
  const double length_m = std::clamp(newtons * settings.arrow_m_per_n, shortest_m, maximum_m);
  const Vector3 direction = snapshot.force_n / newtons;
  const Vector3 start = find_arrow_start(snapshot, direction);
  return ForceArrow{start, start + length_m * direction, newtons};
}

}  // namespace spoonbill
