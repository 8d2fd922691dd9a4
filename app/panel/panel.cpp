#include "app/panel/panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "app/panel/rows.h"
#include "app/report/quantity_text.h"
#include "app/session/view_choice.h"

namespace spoonbill {

PanelModel make_panel_model(const SessionFacts& facts, const Snapshot& snapshot, const ViewSettings& view) {
  PanelModel model;
  model.title = facts.title;
  model.time_s = snapshot.time_s();
  model.can_undo = facts.can_undo;
  model.can_redo = facts.can_redo;

  model.tool = facts.tool;
  model.sculpting = facts.sculpting;
  model.has_ground = facts.ground.has_value();
  model.material = facts.material;
  model.region_count = facts.region_count;
  model.mass_kg = facts.mass_kg;
  model.volume_change = snapshot.bodies.empty() ? 0.0 : snapshot.bodies.front().lattice.volume_change;
  for (std::size_t b = 0; b < snapshot.bodies.size(); ++b) {
    const double residual_m = snapshot.bodies[b].residual.largest_m;
    if (residual_m <= model.residual_m) continue;
    model.residual_m = residual_m;
    model.residual_body = static_cast<int>(b);
    model.residual_is_at_limit = snapshot.bodies[b].residual.is_at_limit;
  }
  model.plane_count = static_cast<int>(snapshot.planes.size());
  for (const BodySnapshot& body : snapshot.bodies) {
    if (body.is_rigid) continue;
    if (model.node_count == 0) model.inertia_scale = body.material.inertia_scale;
    const auto& fixed = body.lattice.fixed;
    model.fixed_node_count += static_cast<int>(std::count(fixed.begin(), fixed.end(), std::uint8_t{1}));
    model.node_count += static_cast<int>(fixed.size());
    model.unheld_count += std::count(fixed.begin(), fixed.end(), std::uint8_t{1}) == 0 ? 1 : 0;
  }

  model.overlays = view.overlays;
  model.see_through_body = view.see_through_body;

  model.device = snapshot.device.name;
  model.force_n = snapshot.force_n.norm();
  model.force_limit_n = snapshot.device.force_limit_n;
  model.rate_hz = snapshot.device.nominal_rate_hz;
  model.substeps = snapshot.substeps;
  model.flags = snapshot.flags;
  return model;
}

namespace {

void draw_title(const PanelModel& model, const Theme& theme, PanelAnswer& answer) {
  ImGui::PushFont(theme.fonts.heading);
  ImGui::TextUnformatted(model.title.c_str());
  ImGui::PopFont();
  std::string time = rounded_text(model.time_s, 2, " s");
  if (!model.rate_is_nominal) time += ", " + percent_text(tick_s * model.rate_hz) + " of real time";
  ImGui::TextColored(colour::quiet_ink, "%s", time.c_str());
  if (model.trial || model.task) return;

  const ImGuiStyle& style = ImGui::GetStyle();
  const auto width = [&](const char* name) {
    return ImGui::CalcTextSize(name).x + 2.0F * style.FramePadding.x;
  };
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width("Undo") - style.ItemSpacing.x - width("Redo"));
  ImGui::BeginDisabled(!model.can_undo);
  if (ImGui::Button("Undo")) answer.requests.emplace_back(UndoStroke{});
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!model.can_redo);
  if (ImGui::Button("Redo")) answer.requests.emplace_back(RedoStroke{});
  ImGui::EndDisabled();
}

// Adds the row of a field that has a slider. `text` replaces the text of the value. Returns true if the user
// changed the value.
template <class Object>
bool field_row(const Field<Object>& field, Object& object, std::string& refusal, const char* text = nullptr) {
  const FieldForm& form = field.form;
  if (form.slider.label == nullptr) return false;
  const auto shown = [&](const std::string& value_text) {
    return text == nullptr ? value_text : std::string(text);
  };
  if (const auto number = field.member.template pointer_to<double>()) {
    double& value = object.*number;
    return quantity_row(form, value, shown(quantity_text(form, value)), refusal);
  }
  if (const auto number = field.member.template pointer_to<int>()) {
    int& value = object.*number;
    const char* unit = form.unit == FieldUnit::per_tick ? " per tick" : "";
    return slider_row(form, value, shown(std::to_string(value) + unit));
  }
  return false;
}

template <class Object, class Value>
bool is_field(const Field<Object>& field, Value Object::*member) {
  return field.member.template pointer_to<Value>() == member;
}

// Returns true if the tool's action uses the field. A radius is used only by a sphere.
bool uses_field(const Tool& tool, const Field<Tool>& field) {
  if (find_tool_parameter(tool.action, field.form.name) == nullptr) return false;
  if (is_field(field, &Tool::local_radius_m)) return tool.is_local();
  return tool.kind == ToolKind::sphere || !is_field(field, &Tool::radius_m);
}

void draw_tool(const PanelModel& model, const Theme& theme, PanelAnswer& answer) {
  constexpr const char* kinds[] = {"Point", "Sphere", "Solid"};
  Tool tool = model.tool;
  const bool has_reach = tool.action != ToolAction::smooth;
  bool is_local = tool.reach == ToolReach::local, holds = tool.sideways == ToolGlide::hold;
  const std::array<HeadingSwitch, 2> switches = {{{"Local", &is_local}, {"Hold", &holds}}};
  const RowGroup group("Tool", theme, std::span(switches).first(has_reach ? 2 : 0));
  const ToolReach reach = is_local ? ToolReach::local : ToolReach::whole;
  const ToolGlide sideways = holds ? ToolGlide::hold : ToolGlide::slide;
  bool changed = reach != tool.reach || sideways != tool.sideways;
  tool.reach = reach;
  tool.sideways = sideways;
  if (!group) return;
  int kind = static_cast<int>(tool.kind);
  int action = static_cast<int>(tool.action);
  changed |= choice_row("Kind", kind, std::span(kinds).first(tool.body ? 3 : 2));
  changed |= choice_row("Action", action, tool_action_labels);
  tool.kind = static_cast<ToolKind>(kind);
  tool.action = static_cast<ToolAction>(action);
  if (model.press && tool.action == ToolAction::push) {
    PressSettings press = *model.press;
    if (field_row(fields_of<PressSettings>.front(), press, answer.refusal)) answer.press = press;
  }
  for (const Field<Tool>& field : fields_of<Tool>) {
    const bool offered = uses_field(tool, field);
    // The two share a place: a local stroke moves the material itself, without substeps.
    if (is_field(field, &Tool::local_radius_m) ? !offered
                                               : tool.is_local() && is_field(field, &Tool::substeps))
      continue;
    ImGui::BeginDisabled(!offered);
    changed |= field_row(field, tool, answer.refusal, offered ? nullptr : "-");
    ImGui::EndDisabled();
  }
  if (changed) answer.requests.emplace_back(Command(SetTool{tool}));
}

bool draw_presets(const PanelModel& model, Material& material) {
  bool changed = false;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(colour::quiet_ink, "Preset");
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-FLT_MIN);
  if (!ImGui::BeginCombo("##Preset", material.name.c_str())) return false;
  for (const Material& preset : model.presets) {
    if (ImGui::Selectable(preset.name.c_str(), preset.name == material.name)) {
      material = preset;
      changed = true;
    }
  }
  ImGui::EndCombo();
  return changed;
}

std::string after_touch_text(const Material& material) {
  if (material.plastic) return "plastic";
  if (!(material.relaxing_fraction > 0.0)) return "elastic";
  return "creep, " + rounded_text(material.relaxation_time_s, 0, " s");
}

// Requests the material, or reports why its values are inconsistent.
void request_material(Material material, PanelAnswer& answer) {
  if (Status checked = check_material(material); !checked.ok()) {
    answer.refusal = checked.error().message;
    return;
  }
  answer.requests.emplace_back(Command(SetMaterial{std::move(material)}));
}

// Returns the mass, by how much strokes of local reach have changed the volume, and the number of regions
// with a material or friction of their own. They share a row, because the window is small.
std::string mass_text(const PanelModel& model) {
  std::string mass = grams_text(model.mass_kg);
  constexpr double least_shown = 5e-4;
  if (std::abs(model.volume_change) > least_shown) {
    mass += (model.volume_change > 0.0 ? ", volume +" : ", volume ") + percent_text(model.volume_change);
  }
  if (model.region_count == 0) return mass;
  return mass + ", " + std::to_string(model.region_count) +
         (model.region_count == 1 ? " region" : " regions");
}

void draw_material(const PanelModel& model, const Theme& theme, PanelAnswer& answer) {
  const RowGroup group("Material", theme);
  if (!group) return;
  Material material = model.material;
  Sculpting sculpting = model.sculpting;
  bool changed = draw_presets(model, material);
  for (const Field<Material>& field : fields_of<Material>) {
    changed |= field_row(field, material, answer.refusal);
  }
  bool sculpting_changed = field_row(field_of(&Sculpting::drag_per_s), sculpting, answer.refusal);
  sculpting_changed |=
      switch_row("Responds", slowness_text(model.inertia_scale), "real time", sculpting.real_time);
  sculpting_changed |=
      switch_row("After touch", after_touch_text(material), "no ringing", sculpting.is_critically_damped);
  fact_row("Mass", mass_text(model));
  if (changed) request_material(std::move(material), answer);
  if (sculpting_changed) answer.requests.emplace_back(Command(SetSculpting{sculpting}));
}

// Returns the text for the largest distance of a surface from the deformed lattice that it follows.
std::string residual_text(double residual_m, bool is_at_limit) {
  return rounded_text(1e3 * residual_m, 3, is_at_limit ? " mm, most knots" : " mm error");
}

// States what happens to bodies without fixed nodes, and offers to let them move freely.
void draw_unheld(const PanelModel& model, PanelAnswer& answer) {
  if (model.unheld_count == 0) return;
  Sculpting sculpting = model.sculpting;
  const char* const place = keeps_place(sculpting, model.has_ground) ? "kept in place" : "moves";
  if (switch_row("Unfixed", place, "free", sculpting.free)) {
    answer.requests.emplace_back(Command(SetSculpting{sculpting}));
  }
}

void draw_fixtures(const PanelModel& model, const Theme& theme, PanelAnswer& answer) {
  const RowGroup group("Fixtures", theme);
  if (!group) return;
  fact_row("Fixed nodes", std::to_string(model.fixed_node_count) + " of " + std::to_string(model.node_count) +
                              ", " + std::to_string(model.plane_count) +
                              (model.plane_count == 1 ? " plane" : " planes"));
  draw_unheld(model, answer);
  ImGui::BeginDisabled(!(model.residual_m > 0.0));
  if (button_row("Surface", residual_text(model.residual_m, model.residual_is_at_limit), "Add knots")) {
    answer.requests.emplace_back(Command(RefineKnots{model.residual_body}));
  }
  ImGui::EndDisabled();
}

bool draw_stage(Overlays& overlays) {
  std::vector<const char*> names;
  int chosen = 0;
  for (const StageChoice& choice : stage_choices) {
    if (choice.is_chosen(overlays)) chosen = static_cast<int>(names.size());
    names.push_back(choice.name);
  }
  if (!list_row("Contact", chosen, names)) return false;
  stage_choices.at(static_cast<std::size_t>(chosen)).choose(overlays);
  return true;
}

void draw_view(const PanelModel& model, const Theme& theme, PanelAnswer& answer) {
  const RowGroup group("View", theme);
  if (!group) return;
  Overlays overlays = model.overlays;
  bool see_through = model.see_through_body;
  bool changed = false;
  const auto pair = [&](const char* left, bool& left_on, const char* right, bool& right_on) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    changed |= ImGui::Checkbox(left, &left_on);
    ImGui::TableNextColumn();
    ImGui::SetCursorPosX(0.5F * theme.metrics.panel_width_px);
    changed |= ImGui::Checkbox(right, &right_on);
  };
  pair("Fixed nodes", overlays.fixed_nodes, "Touched nodes", overlays.touched_nodes);
  pair("Lattice", overlays.lattice, "Control net", overlays.control_net);
  pair("See through", see_through, "Fixing planes", overlays.fixing_planes);
  // Short labels share a row, which saves space.
  pair("Force", overlays.force, "Cells", overlays.cells);
  ImGui::SameLine();
  ImGui::SetCursorPosX(0.71F * theme.metrics.panel_width_px);
  changed |= ImGui::Checkbox("Legend", &overlays.legend);
  changed |= draw_stage(overlays);
  if (changed) answer.requests.emplace_back(ChangeView{overlays_command(overlays, see_through)});
}

void draw_flags(const PanelModel& model) {
  for (const std::string& text : flag_texts(model.flags)) {
    ImGui::TextColored(colour::warning, "%s", text.c_str());
  }
}

void draw_device(const PanelModel& model, const Theme& theme, PanelAnswer& answer) {
  {
    const RowGroup group(("Device: " + model.device).c_str(), theme);
    if (!group) return;
    Sculpting sculpting = model.sculpting;
    const double fraction = model.force_limit_n > 0.0 ? model.force_n / model.force_limit_n : 0.0;
    const std::string text = rounded_text(model.force_n, 2, "") + " of " + newtons_text(model.force_limit_n);
    bool on = model.force_on.value_or(true);
    if (!model.force_on) {
      gauge_row("Force", fraction, text);
    } else if (gauge_switch_row("Force", fraction, text, "on", on)) {
      answer.requests.emplace_back(SwitchForce{on});
    }
    if (field_row(field_of(&Sculpting::force_scale), sculpting, answer.refusal)) {
      answer.requests.emplace_back(Command(SetSculpting{sculpting}));
    }
    fact_row("Rate", rounded_text(model.rate_hz, 0, model.rate_is_nominal ? " Hz (nominal)" : " Hz") + ", " +
                         std::to_string(model.substeps) + (model.substeps == 1 ? " substep" : " substeps"));
  }
  draw_flags(model);
  ImGui::PushTextWrapPos(0.0F);
  if (!model.safety_text.empty()) ImGui::TextColored(colour::warning, "%s", model.safety_text.c_str());
  if (!model.drawing_text.empty()) ImGui::TextColored(colour::quiet_ink, "%s", model.drawing_text.c_str());
  ImGui::PopTextWrapPos();
}

void draw_trial(const PanelModel& model, const TrialRows& trial, const Theme& theme) {
  if (const RowGroup group("Trial", theme); group) {
    fact_row("Phase", trial.phase);
    if (!trial.tilt.empty()) fact_row("Tilt", trial.tilt);
    fact_row("Speed", rounded_text(1e3 * trial.largest_speed_m_per_s, 2, " mm/s") +
                          (trial.is_settled ? ", settled" : ", moving"));
    fact_row("Overlap", rounded_text(1e3 * trial.largest_overlap_m, 3, " mm at most"));
    fact_row("Inverted", count_text(static_cast<std::size_t>(trial.inverted_cells), "cell", "cells"));
    fact_row("Substeps", std::to_string(model.substeps) + " per tick");
    fact_row("Responds", slowness_text(model.inertia_scale));
  }
  if (const RowGroup group("Bodies", theme); group) {
    for (const TrialRows::BodyRow& body : trial.bodies) fact_row(body.name.c_str(), body.text);
  }
  draw_flags(model);
}

void draw_task_rows(const char* heading, const std::vector<TaskRows::Row>& rows, const Theme& theme) {
  if (rows.empty()) return;
  const RowGroup group(heading, theme);
  if (!group) return;
  for (const TaskRows::Row& row : rows) {
    if (row.fraction) {
      gauge_row(row.name.c_str(), *row.fraction, row.text);
    } else {
      fact_row(row.name.c_str(), row.text);
    }
  }
}

void draw_task(const PanelModel& model, const TaskRows& task, const Theme& theme) {
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(task.note.c_str());
  ImGui::PopTextWrapPos();
  draw_task_rows("Task", task.goal, theme);
  draw_task_rows("Spoon", task.spoon, theme);
  draw_task_rows(("Hand: " + task.hand_name).c_str(), task.hand, theme);
  const double fraction = model.force_limit_n > 0.0 ? model.force_n / model.force_limit_n : 0.0;
  const std::string text = rounded_text(model.force_n, 2, "") + " of " + newtons_text(model.force_limit_n);
  draw_task_rows(("Device: " + model.device).c_str(), {{"Force", text, fraction}}, theme);
  ImGui::PushTextWrapPos(0.0F);
  if (!model.safety_text.empty()) ImGui::TextColored(colour::warning, "%s", model.safety_text.c_str());
  ImGui::PopTextWrapPos();
}

}  // namespace

double panel_scale(int height_px) {
  return std::max(1.0, std::round(2.0 * height_px / 720.0) / 2.0);
}

Rectangle panel_rectangle(int width_px, int height_px, double scale, double top_px) {
  constexpr double smallest_height_px = 400.0;
  const double width = metrics_for(scale).panel_width_px;
  if (height_px < smallest_height_px * scale || width_px < 2.5 * width) return {};
  return {0.0, top_px, width, height_px - top_px};
}

Rectangle picture_panel_rectangle(int width_px, int height_px) {
  constexpr int smallest_height_px = 700;
  if (height_px < smallest_height_px) return {};
  return panel_rectangle(width_px, height_px, panel_scale(height_px));
}

PanelAnswer draw_panel(const PanelModel& model, const Theme& theme, const Rectangle& area_px) {
  PanelAnswer answer;
  ImGui::SetNextWindowPos(ImVec2(static_cast<float>(area_px.x), static_cast<float>(area_px.y)));
  ImGui::SetNextWindowSize(ImVec2(static_cast<float>(area_px.width), static_cast<float>(area_px.height)));
  ImGui::PushFont(theme.fonts.body);
  ImGui::Begin("Panel", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  draw_title(model, theme, answer);
  if (model.trial) {
    draw_trial(model, *model.trial, theme);
  } else if (model.task) {
    draw_task(model, *model.task, theme);
  } else {
    draw_tool(model, theme, answer);
    draw_material(model, theme, answer);
    draw_fixtures(model, theme, answer);
    draw_view(model, theme, answer);
    draw_device(model, theme, answer);
  }
  ImGui::End();
  ImGui::PopFont();
  return answer;
}

}  // namespace spoonbill
