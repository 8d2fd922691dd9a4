#include "render/passes/scene_passes.h"

#include <algorithm>
#include <utility>

#include "engine/base/geometry.h"
#include "render/overlay/overlays.h"
#include "render/passes/material_patterns.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {
namespace {

constexpr float arrow_width_px = 5.0f;
constexpr float smallest_tool_px = 5.0f;
constexpr float stage_arrow_px = 3.0f;
// Distance by which shapes of a contact stage are moved toward the eye, to be in front of the drawn triangles
// of the surface.
constexpr float stage_lift_m = 0.0004f;
constexpr float ghost_translucency = 0.85f;

// Distance by which marks are moved toward the eye, as a fraction of a lattice cell. Marks on a curved
// surface stay in front of its drawn triangles, and marks on the far side stay hidden.
constexpr float lift_fraction_of_cell = 0.4f;
constexpr float lift_without_lattice_m = 0.0002f;

float lift_m(const FrameView& view, const Snapshot& snapshot) {
  const float cell = snapshot.bodies.empty() ? 0.0f : mean_edge_m(snapshot.bodies.front().lattice);
  return std::min(cell > 0.0f ? lift_fraction_of_cell * cell : lift_without_lattice_m, lift_limit_m(view));
}

// Returns the length in metres that covers `pixels` pixels, times the interface scale, at the distance of a
// point.
float pixels_at(const FrameView& view, const Eigen::Vector3f& point_m, float pixels) {
  const float depth = (point_m - view.eye_m).norm();
  return pixels * view.interface_scale * depth / view.pixel_depth_ratio;
}

// Returns a sphere whose shadow approximates that of a solid: the largest ball inside the solid's box, around
// the centre of the box.
ToolSphere ball_in_box(const Box& box, const ToolFrame& frame) {
  const Vector3 centre = frame.origin_m + frame.axes * box.centre();
  return {centre.cast<float>(), static_cast<float>(0.5 * box.extent().minCoeff())};
}

ToolSphere tool_sphere(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings) {
  if (!settings.overlays.tool || is_soft(snapshot.tool)) return {};
  if (const ToolBody* body = rigid_body(snapshot.tool)) {
    return ball_in_box(bounding_box(body->solid), tool_frame(snapshot));
  }
  const Eigen::Vector3f centre = snapshot.tool.proxy.position_m.cast<float>();
  if (snapshot.tool.kind == ToolKind::sphere) return {centre, static_cast<float>(snapshot.tool.radius_m)};
  return {centre, pixels_at(view, centre, smallest_tool_px)};
}

SurfaceDrawing choose_drawing(const BodySnapshot& body, const ViewSettings& settings) {
  SurfaceDrawing drawing;
  drawing.look = find_material_look(body.material.name);
  drawing.reflects = settings.reflections;
  drawing.shows_fixed = settings.overlays.fixed_nodes;
  if (drawing.look.pattern != SurfacePattern::none) drawing.world_to_pattern = find_pattern_frame(body);
  if (settings.see_through_body) {
    drawing.look.translucency = ghost_translucency;
    drawing.look.metalness = 0.0f;
  }
  return drawing;
}

// Gives a soft tool the colour of tools. It has fixed nodes where the hand holds it, which are no part of the
// body that is shaped.
void show_as_tool(SurfaceDrawing& drawing) {
  constexpr Colour colour = palette::tool;
  drawing.look.base_colour = {srgb8_to_linear(colour.r), srgb8_to_linear(colour.g),
                              srgb8_to_linear(colour.b)};
  drawing.shows_fixed = false;
}

Box bounding_box(const ToolSphere& tool) {
  Box box;
  if (tool.radius_m <= 0.0f) return box;
  box.include((tool.centre_m.array() - tool.radius_m).matrix().cast<double>());
  box.include((tool.centre_m.array() + tool.radius_m).matrix().cast<double>());
  return box;
}

}  // namespace

Result<ScenePasses> ScenePasses::make(const GlFunctions& gl) {
  auto ground = GroundPass::make(gl);
  if (!ground) return ground.error();
  auto shadow = ShadowPass::make(gl);
  if (!shadow) return shadow.error();
  auto solid = SolidPass::make(gl);
  if (!solid) return solid.error();
  auto line = LinePass::make(gl);
  if (!line) return line.error();
  auto mark = MarkPass::make(gl);
  if (!mark) return mark.error();
  auto shell = ShellPass::make(gl);
  if (!shell) return shell.error();
  auto triangle = TrianglePass::make(gl);
  if (!triangle) return triangle.error();
  auto resolve = ResolvePass::make(gl);
  if (!resolve) return resolve.error();
  return ScenePasses(Passes{BackgroundPass(gl), std::move(ground).value(), std::move(shadow).value(),
                            SurfacePass(gl), std::move(solid).value(), std::move(line).value(),
                            std::move(mark).value(), std::move(shell).value(), std::move(triangle).value(),
                            std::move(resolve).value(), ToolBuffers(gl)});
}

Status ScenePasses::prepare(const Snapshot& snapshot, const ViewSettings& settings) {
  drawings_.clear();
  for (const BodySnapshot& body : snapshot.bodies) {
    drawings_.push_back(choose_drawing(body, settings));
    if (is_tool_body(snapshot, body)) show_as_tool(drawings_.back());
    if (Status made = passes_.surface.prepare(drawings_.back().variant()); !made) return made;
  }
  return {};
}

void ScenePasses::draw_shadows(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings,
                               const BodyMeshes& bodies) {
  if (!settings.shadow) return;
  const ToolSphere tool = tool_sphere(view, snapshot, settings);
  passes_.shadow.draw(view, bodies.buffers(), bodies.bounds(), bounding_box(tool), tool);
}

void ScenePasses::draw(const FrameView& view, const FrameView& scene_view, const Snapshot& snapshot,
                       const ViewSettings& settings, const BodyMeshes& bodies, const RenderTarget& target) {
  const std::vector<PixelArea> areas = scene_area(snapshot, settings, scene_view, bodies.surfaces());
  target.begin_scene(areas);
  draw_scene(scene_view, snapshot, settings, bodies);
  if (settings.is_transparent) {
    target.clear_frame();
  } else {
    passes_.background.draw(view.studio, target);
  }
  draw_ground(view, settings);
  passes_.resolve.draw(target, areas);
  draw_scale_bar(view, settings);
}

void ScenePasses::draw_scene(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings,
                             const BodyMeshes& bodies) {
  const ToolSphere tool = tool_sphere(view, snapshot, settings);
  const ShadowPass* shadow = settings.shadow ? &passes_.shadow : nullptr;
  const auto draw_bodies = [&](bool are_clear) {
    for (std::size_t b = 0; b < bodies.buffers().size(); ++b) {
      if (drawings_[b].look.is_clear() != are_clear) continue;
      passes_.surface.draw(view, bodies.buffers()[b], drawings_[b], tool, shadow);
    }
  };
  draw_bodies(false);
  draw_force(view, snapshot, settings);
  CellLines cells;
  if (settings.overlays.cells) {
    for (const BodySnapshot& body : snapshot.bodies) append_cell_lines(body.lattice, view.eye_m, cells);
  }
  passes_.line.draw(view, cells.far, 0.0f);
  draw_bodies(true);
  passes_.line.draw(view, cells.near, lift_m(view, snapshot));
  draw_rings(view, snapshot, bodies);
  draw_overlays(view, snapshot, settings);
  if (settings.overlays.fixing_planes) draw_planes(view, snapshot, bodies.bounds());
  if (settings.overlays.symmetry_plane) draw_symmetry(view, snapshot, bodies.bounds());
  if (settings.overlays.tool) draw_tools(view, snapshot);
  draw_stage(view, snapshot, settings);
  draw_goal(view, snapshot, settings);
  if (settings.overlays.touched_nodes) draw_touched(view, snapshot);
}

void ScenePasses::draw_ground(const FrameView& view, const ViewSettings& settings) {
  lines_.clear();
  if (settings.overlays.ground_grid) {
    append_ground_grid(settings.camera, view.viewport, settings.ground_y_m, view.studio.ground_line, lines_);
  }
  passes_.line.draw(view, lines_, 0.0f);
  if (settings.shadow) passes_.ground.draw_shadow(view, passes_.shadow);
}

// Draws the scale bar. Must be called after the bodies are drawn, which would otherwise hide it.
void ScenePasses::draw_scale_bar(const FrameView& view, const ViewSettings& settings) {
  if (!settings.overlays.scale_bar) return;
  const auto bar = ground_scale_bar(settings.camera, view.viewport, settings.ground_y_m);
  if (!bar) return;
  lines_.clear();
  append_scale_bar(*bar, settings.camera, view.studio.scale_bar, lines_);
  passes_.line.draw(view, lines_, 0.0f);
}

void ScenePasses::draw_force(const FrameView& view, const Snapshot& snapshot,
                             const ViewSettings& settings) const {
  const auto arrow = force_arrow(snapshot, settings);
  if (!arrow) return;
  const Eigen::Vector3f start = arrow->start_m.cast<float>();
  passes_.solid.draw_arrow(view, start, arrow->tip_m.cast<float>(), pixels_at(view, start, arrow_width_px),
                           palette::force);
}

void ScenePasses::draw_goal(const FrameView& view, const Snapshot& snapshot, const ViewSettings& settings) {
  if (!settings.goal) return;
  lines_.clear();
  marks_.clear();
  append_goal(*settings.goal, lines_, marks_);
  passes_.line.draw(view, lines_, lift_m(view, snapshot));
  passes_.mark.draw(view, marks_, lift_m(view, snapshot));
}

void ScenePasses::draw_rings(const FrameView& view, const Snapshot& snapshot, const BodyMeshes& bodies) {
  lines_.clear();
  for (const ReachRing& ring : bodies.rings()) append_reach_ring(ring, lines_);
  passes_.line.draw(view, lines_, lift_m(view, snapshot));
}

void ScenePasses::draw_overlays(const FrameView& view, const Snapshot& snapshot,
                                const ViewSettings& settings) {
  const Overlays& on = settings.overlays;
  lines_.clear();
  marks_.clear();
  for (const BodySnapshot& body : snapshot.bodies) {
    if (on.lattice) append_lattice_lines(body.lattice, settings.see_through_body, lines_);
    if (on.control_net && !body.is_mesh()) append_control_net(body.surface, lines_, marks_);
    if (settings.marks_fixed_nodes() && !is_tool_body(snapshot, body))
      append_fixed_marks(body.lattice, settings.see_through_body, marks_);
  }
  if (on.contact_normals) {
    append_contact_normals(snapshot.contacts, contact_normal_length_m(snapshot.tool), lines_);
  }
  const float lift = lift_m(view, snapshot);
  passes_.line.draw(view, lines_, lift);
  passes_.mark.draw(view, marks_, lift);
}

void ScenePasses::draw_planes(const FrameView& view, const Snapshot& snapshot, const Box& body) {
  lines_.clear();
  for (const PlaneSnapshot& plane : snapshot.planes) {
    const PlaneCorners corners = fixing_plane_corners(plane, snapshot.bodies, body);
    std::array<Eigen::Vector3f, 4> pane;
    for (std::size_t i = 0; i < pane.size(); ++i) pane[i] = corners[i].cast<float>();
    passes_.solid.draw_pane(view, pane, palette::fixing_plane);
    append_plane_border(corners, plane, lines_);
  }
  passes_.line.draw(view, lines_, 0.0f);
}

void ScenePasses::draw_symmetry(const FrameView& view, const Snapshot& snapshot, const Box& body) {
  if (!snapshot.symmetric) return;
  lines_.clear();
  append_symmetry_plane(symmetry_plane_corners(snapshot.symmetry, body), lines_);
  passes_.line.draw(view, lines_, 0.0f);
}

void ScenePasses::draw_tools(const FrameView& view, const Snapshot& snapshot) {
  if (is_soft(snapshot.tool)) return;
  draw_tool(view, snapshot.tool, tool_frame(snapshot));
  if (snapshot.symmetric) draw_tool(view, snapshot.tool, mirrored_tool_frame(snapshot));
}

void ScenePasses::draw_tool(const FrameView& view, const ToolSnapshot& tool, const ToolFrame& frame) {
  const Eigen::Vector3f centre = frame.origin_m.cast<float>();
  if (tool.kind == ToolKind::sphere) {
    passes_.solid.draw_glass_sphere(view, centre, static_cast<float>(tool.radius_m), palette::tool);
  } else if (rigid_body(tool) != nullptr && !passes_.tool.empty()) {
    passes_.solid.draw_glass_tool(view, passes_.tool, frame, palette::tool);
  } else {
    passes_.solid.draw_sphere(view, centre, pixels_at(view, centre, smallest_tool_px), palette::tool);
  }
}

// Draws the contact stage. Must be called after the tool is drawn, so that contacts are visible through it.
void ScenePasses::draw_stage(const FrameView& view, const Snapshot& snapshot,
                             const ViewSettings& settings) const {
  StageShapes shapes = stage_shapes(snapshot, settings);
  passes_.triangle.draw(view, shapes.corners, stage_lift_m);
  passes_.line.draw(view, shapes.lines, 1.5F * stage_lift_m);
  passes_.mark.draw(view, shapes.marks, 2.0F * stage_lift_m);
  passes_.shell.draw(view, shapes.shells);
  for (const OverlayArrow& arrow : shapes.arrows) {
    const Eigen::Vector3f start = arrow.start_m.cast<float>();
    passes_.solid.draw_arrow(view, start, arrow.tip_m.cast<float>(), pixels_at(view, start, stage_arrow_px),
                             arrow.colour);
  }
}

// Draws the touched nodes. Must be called after the tool is drawn, which would otherwise tint the nodes
// behind it.
void ScenePasses::draw_touched(const FrameView& view, const Snapshot& snapshot) {
  marks_.clear();
  for (const BodySnapshot& body : snapshot.bodies) append_touched_marks(body.lattice, marks_);
  passes_.mark.draw(view, marks_, lift_m(view, snapshot));
}

}  // namespace spoonbill
