#include <imgui.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>

#include "render/overlay/overlays.h"
#include "render/tessellation/tool_mesh.h"

namespace spoonbill {
namespace {

std::string newtons_text(double newtons) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), newtons < 10.0 ? "%.2f N" : "%.1f N", newtons);
  return text.data();
}

std::string reach_text(double radius_m) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "local reach, %.1f mm", 1e3 * radius_m);
  return radius_m > 0.0 ? text.data() : "local reach";
}

std::string count_text(const char* what, std::size_t count) {
  return what + (" " + std::to_string(count));
}

std::size_t count_set(const std::vector<std::uint8_t>& flags) {
  return static_cast<std::size_t>(std::count_if(flags.begin(), flags.end(), [](auto f) { return f != 0; }));
}

void add_force(const Snapshot& snapshot, const ViewSettings& settings, const Viewport& viewport,
               std::vector<Label>& labels) {
  const auto arrow = force_arrow(snapshot, settings);
  if (!arrow) return;
  const auto tip = project(settings.camera, viewport, arrow->tip_m);
  const auto start = project(settings.camera, viewport, arrow->start_m);
  if (!tip || !start) return;
  const double gap_px = 7.0 * settings.interface_scale;
  const bool upward = tip->y() <= start->y();
  Label label;
  label.text = newtons_text(arrow->newtons);
  label.position_px = *tip + Eigen::Vector2d(0.0, upward ? -gap_px : gap_px);
  label.anchor = Eigen::Vector2d(0.5, upward ? 1.0 : 0.0);
  labels.push_back(label);
}

void add_scale_bar(const ViewSettings& settings, const Viewport& viewport, std::vector<Label>& labels) {
  if (!settings.overlays.scale_bar) return;
  const auto bar = ground_scale_bar(settings.camera, viewport, settings.ground_y_m);
  if (!bar) return;
  const auto centre = project(settings.camera, viewport, 0.5 * (bar->start_m + bar->end_m));
  if (!centre) return;
  Label label;
  label.text = bar->text();
  label.position_px = *centre + Eigen::Vector2d(0.0, 9.0 * settings.interface_scale);
  label.anchor = Eigen::Vector2d(0.5, 0.0);
  labels.push_back(label);
}

void add_stage(const Snapshot& snapshot, const ViewSettings& settings, const Viewport& viewport,
               std::vector<Label>& labels) {
  const auto caption = stage_caption(settings);
  if (!caption) return;
  const Rectangle& free = viewport.free_px;
  Label label;
  label.text = *caption;
  // The caption begins below the menu, as the panel does.
  const double top = std::max(free.y, settings.panel_px.y);
  label.position_px = {free.x + 0.5 * free.width, top + 18.0 * settings.interface_scale};
  label.anchor = {0.5, 0.0};
  labels.push_back(label);
  // Only the three arrows of the first contact get names, because more names would overlap.
  const std::vector<OverlayArrow> arrows = contact_arrows(snapshot, settings);
  for (std::size_t k = 0; k < std::min<std::size_t>(arrows.size(), 3); ++k) {
    const auto start = project(settings.camera, viewport, arrows[k].start_m);
    const auto tip = project(settings.camera, viewport, arrows[k].tip_m);
    if (!start || !tip || (*tip - *start).norm() < 1.0) continue;
    Label name;
    name.text = arrows[k].name;
    name.position_px = *tip + 12.0 * settings.interface_scale * (*tip - *start).normalized();
    name.anchor = {0.5, 0.5};
    labels.push_back(name);
  }
}

std::string fraction_text(const char* what, std::size_t count, std::size_t all) {
  return count_text(what, count) + " of " + std::to_string(all);
}

using AddToLegend = std::function<void(std::string, LabelSymbol, Colour)>;

void add_stage_legend(const ContactStages& stages, const Overlays& on, const AddToLegend& add) {
  std::size_t active = 0, active_second = 0, rejected = 0, deepest = 0;
  for (const StageSphere& sphere : stages.spheres) {
    if (sphere.cell.level != on.sphere_level) continue;
    ++(!sphere.kept ? rejected : sphere.is_second ? active_second : active);
  }
  for (const StageContact& contact : stages.contacts) deepest += contact.is_deepest ? 1 : 0;
  switch (on.contact_stage) {
    case ContactStage::none:
      break;
    case ContactStage::hulls:
      add("convex hulls", LabelSymbol::line, palette::hull);
      add(fraction_text("elements in range", static_cast<std::size_t>(stages.elements_within),
                        static_cast<std::size_t>(stages.elements)),
          LabelSymbol::line, palette::parameter_range);
      break;
    case ContactStage::spheres:
      add(count_text("spheres kept", active), LabelSymbol::sphere, palette::active_sphere);
      if (active_second > 0) {
        add(count_text("of the other surface", active_second), LabelSymbol::sphere,
            palette::active_second_sphere);
      }
      add(count_text("spheres dropped", rejected), LabelSymbol::sphere, palette::rejected_sphere);
      break;
    case ContactStage::triangles:
      add(fraction_text("triangles that meet", stages.triangles.size(),
                        static_cast<std::size_t>(stages.triangles_tested)),
          LabelSymbol::plane, palette::active_triangle);
      break;
    case ContactStage::contacts:
      add(count_text("contact points", stages.contacts.size()), LabelSymbol::disc, palette::touched_node);
      add("normals", LabelSymbol::line, palette::contact_normal);
      if (deepest > 0) add("tangent along u", LabelSymbol::arrow, palette::tangent_u);
      if (deepest > 0) add("tangent along v", LabelSymbol::arrow, palette::tangent_v);
      break;
  }
  if (stages.overflow) add("not all are shown", LabelSymbol::none, palette::text);
}

std::vector<Label> make_legend(const Snapshot& snapshot, const ViewSettings& settings) {
  const Overlays& on = settings.overlays;
  std::vector<Label> legend;
  const auto add = [&](std::string text, LabelSymbol symbol, Colour colour) {
    colour.a = 255;
    legend.push_back({std::move(text), {}, {}, symbol, colour});
  };
  std::size_t fixed = 0, touched = 0;
  for (const BodySnapshot& body : snapshot.bodies) {
    if (!is_tool_body(snapshot, body)) fixed += count_set(body.lattice.fixed);
    touched += count_set(body.lattice.touched);
  }
  if (on.tool) {
    add(std::string(name_of(snapshot.tool.kind)) + " tool, " + name_of(snapshot.tool.action),
        LabelSymbol::sphere, palette::tool);
    if (snapshot.tool.is_local)
      add(reach_text(snapshot.tool.local_radius_m), LabelSymbol::ring, palette::tool);
  }
  if (force_arrow(snapshot, settings)) add("force on the hand", LabelSymbol::arrow, palette::force);
  if (on.touched_nodes && touched > 0) {
    add(count_text("touched nodes", touched), LabelSymbol::disc, palette::touched_node);
  }
  if (on.fixed_nodes && fixed > 0) {
    add(settings.marks_fixed_nodes() ? count_text("fixed nodes", fixed) : "fixed part", LabelSymbol::square,
        palette::fixed_node);
  }
  if (on.fixing_planes && !snapshot.planes.empty()) {
    add("fixing plane", LabelSymbol::plane, palette::fixing_plane_border);
  }
  if (on.symmetry_plane && snapshot.symmetric) {
    add("plane of symmetry", LabelSymbol::line, palette::symmetry_plane);
  }
  if (on.control_net) add("control net", LabelSymbol::diamond, palette::control_net);
  if (on.cells) add("cell boundaries", LabelSymbol::line, palette::cell_edge);
  if (on.lattice) add("lattice", LabelSymbol::line, palette::lattice);
  if (on.contact_normals && !snapshot.contacts.empty()) {
    add("contact normals", LabelSymbol::line, palette::contact_normal);
  }
  if (settings.stages) add_stage_legend(*settings.stages, on, add);
  return legend;
}

ImU32 packed(Colour colour) {
  return IM_COL32(colour.r, colour.g, colour.b, colour.a);
}

void draw_symbol(ImDrawList& list, LabelSymbol symbol, Colour colour, ImVec2 c, float r) {
  const ImU32 ink = packed(colour);
  Colour pale = colour;
  pale.a = 60;
  switch (symbol) {
    case LabelSymbol::none:
      break;
    case LabelSymbol::square:
      list.AddRectFilled({c.x - 0.8f * r, c.y - 0.8f * r}, {c.x + 0.8f * r, c.y + 0.8f * r}, ink);
      break;
    case LabelSymbol::disc:
      list.AddCircleFilled(c, 0.9f * r, ink);
      break;
    case LabelSymbol::ring:
      list.AddCircle(c, 0.9f * r, ink, 0, 0.3f * r);
      break;
    case LabelSymbol::diamond:
      list.AddNgonFilled(c, r, ink, 4);
      break;
    case LabelSymbol::line:
      list.AddLine({c.x - 1.2f * r, c.y}, {c.x + 1.2f * r, c.y}, ink, 0.3f * r);
      break;
    case LabelSymbol::sphere:
      list.AddCircleFilled(c, r, packed({colour.r, colour.g, colour.b, 130}));
      list.AddCircle(c, r, ink, 0, 0.25f * r);
      break;
    case LabelSymbol::plane:
      list.AddRectFilled({c.x - r, c.y - r}, {c.x + r, c.y + r}, packed(pale));
      list.AddRect({c.x - r, c.y - r}, {c.x + r, c.y + r}, ink, 0.0f, 0, 0.25f * r);
      break;
    case LabelSymbol::arrow:
      list.AddLine({c.x, c.y + 1.1f * r}, {c.x, c.y - 0.2f * r}, ink, 0.5f * r);
      list.AddTriangleFilled({c.x - 0.75f * r, c.y}, {c.x + 0.75f * r, c.y}, {c.x, c.y - 1.2f * r}, ink);
      break;
  }
}

ImVec2 text_size(ImFont& font, const std::string& text) {
  return font.CalcTextSizeA(font.FontSize, 10000.0f, 0.0f, text.c_str());
}

// Draws text on a pale plate, which keeps it legible over any background.
void draw_in_scene(const Label& label, ImFont& font, float scale, ImDrawList& list) {
  const ImVec2 size = text_size(font, label.text);
  const ImVec2 at(static_cast<float>(label.position_px.x() - label.anchor.x() * size.x),
                  static_cast<float>(label.position_px.y() - label.anchor.y() * size.y));
  const ImVec2 margin(5.0f * scale, 1.0f * scale);
  list.AddRectFilled({at.x - margin.x, at.y - margin.y}, {at.x + size.x + margin.x, at.y + size.y + margin.y},
                     packed({255, 255, 255, 150}), 3.0f * scale);
  list.AddText(&font, font.FontSize, at, packed(palette::text), label.text.c_str());
}

void draw_legend(const std::vector<Label>& legend, const Rectangle& free, ImFont& font, float scale,
                 ImDrawList& list) {
  if (legend.empty()) return;
  const float line_height = font.FontSize * 1.35f, symbol_radius = 0.3f * font.FontSize;
  const float symbol_width = 1.5f * font.FontSize, margin = 0.7f * font.FontSize;
  float text_width = 0.0f;
  for (const Label& label : legend) text_width = std::max(text_width, text_size(font, label.text).x);
  const float width = symbol_width + text_width + 2.0f * margin;
  const float height = line_height * static_cast<float>(legend.size()) + 2.0f * margin;
  const float edge = 16.0f * scale;
  const ImVec2 high(static_cast<float>(free.x + free.width) - edge,
                    static_cast<float>(free.y + free.height) - edge);
  const ImVec2 low(high.x - width, high.y - height);
  list.AddRectFilled(low, high, packed({255, 255, 255, 165}), 5.0f * scale);
  float y = low.y + margin;
  for (const Label& label : legend) {
    const ImVec2 centre(low.x + margin + 0.45f * font.FontSize, y + 0.5f * line_height);
    draw_symbol(list, label.symbol, label.colour, centre, symbol_radius);
    list.AddText(&font, font.FontSize,
                 {low.x + margin + symbol_width, y + 0.5f * (line_height - font.FontSize)},
                 packed(palette::text), label.text.c_str());
    y += line_height;
  }
}

}  // namespace

OverlayLabels overlay_labels(const Snapshot& snapshot, const ViewSettings& settings, int width_px,
                             int height_px) {
  const Viewport viewport = make_viewport(width_px, height_px, settings.panel_px);
  OverlayLabels labels;
  add_force(snapshot, settings, viewport, labels.in_scene);
  add_scale_bar(settings, viewport, labels.in_scene);
  add_stage(snapshot, settings, viewport, labels.in_scene);
  if (settings.overlays.legend) labels.legend = make_legend(snapshot, settings);
  return labels;
}

void draw_labels(const OverlayLabels& labels, const ViewSettings& settings, int width_px, int height_px,
                 ImFont& font, ImDrawList& list) {
  const Viewport viewport = make_viewport(width_px, height_px, settings.panel_px);
  const auto scale = static_cast<float>(settings.interface_scale);
  for (const Label& label : labels.in_scene) draw_in_scene(label, font, scale, list);
  draw_legend(labels.legend, viewport.free_px, font, scale, list);
}

}  // namespace spoonbill
