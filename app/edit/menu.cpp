#include "app/edit/menu.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "app/session/view_choice.h"

namespace spoonbill {
namespace {

using Action = EditAction;

constexpr auto before_tools = std::to_array<KeyBinding>({
    {Action::show_keys, GLFW_KEY_F1, false, false, "F1", "List of keys"},
    {Action::open, GLFW_KEY_O, true, false, "Ctrl+O", "Open model"},
    {Action::new_document, GLFW_KEY_N, true, false, "Ctrl+N", "New spoon handle"},
    {Action::new_shape, GLFW_KEY_N, true, true, "Ctrl+Shift+N", "New shape"},
    {Action::save, GLFW_KEY_S, true, false, "Ctrl+S", "Save"},
    {Action::save_as, GLFW_KEY_S, true, true, "Ctrl+Shift+S", "Save as"},
    {Action::export_model, GLFW_KEY_E, true, false, "Ctrl+E", "Export to CAD file or mesh"},
    {Action::undo, GLFW_KEY_Z, true, false, "Ctrl+Z", "Undo stroke"},
    {Action::redo, GLFW_KEY_Z, true, true, "Ctrl+Shift+Z", "Redo stroke"},
    {Action::redo, GLFW_KEY_Y, true, false, "Ctrl+Y", "Redo stroke"},
    {Action::cancel, GLFW_KEY_ESCAPE, false, false, "Esc", "Cancel stroke, or close prompt"},
    {Action::cut_force, GLFW_KEY_SPACE, false, false, "Space", "Force off at once"},
    {Action::allow_force, GLFW_KEY_SPACE, false, true, "Shift+Space", "Force on"},
});

constexpr auto after_tools = std::to_array<KeyBinding>({
    {Action::toggle_symmetry, GLFW_KEY_X, false, false, "X", "Symmetry"},
    {Action::toggle_reach, GLFW_KEY_L, false, false, "L", "Reach: local or whole body"},
    {Action::toggle_touch, GLFW_KEY_H, false, false, "H", "Pressed tool holds or slides"},
    {Action::place_plane, GLFW_KEY_P, false, false, "P", "Fixing plane at the tool"},
    {Action::remove_planes, GLFW_KEY_P, false, true, "Shift+P", "Remove fixing planes"},
    {Action::keep_shape, GLFW_KEY_K, false, false, "K", "Current shape as rest shape"},
    {Action::frame_model, GLFW_KEY_HOME, false, false, "Home", "Whole model"},
    {Action::frame_model, GLFW_KEY_PERIOD, false, false, ".", "Whole model"},
    {Action::view_front, GLFW_KEY_KP_1, false, false, "Num 1", "Front view"},
    {Action::view_right, GLFW_KEY_KP_3, false, false, "Num 3", "Right view"},
    {Action::view_top, GLFW_KEY_KP_7, false, false, "Num 7", "Top view"},
    {Action::view_perspective, GLFW_KEY_KP_5, false, false, "Num 5", "Perspective view"},
    {Action::view_front, GLFW_KEY_F5, false, false, "F5", "Front view"},
    {Action::view_right, GLFW_KEY_F6, false, false, "F6", "Right view"},
    {Action::view_top, GLFW_KEY_F7, false, false, "F7", "Top view"},
    {Action::view_perspective, GLFW_KEY_F8, false, false, "F8", "Perspective view"},
    {Action::screenshot, GLFW_KEY_F12, false, false, "F12", "Screenshot of the scene"},
    {Action::window_screenshot, GLFW_KEY_F12, false, true, "Shift+F12", "Screenshot with the panel"},
    {Action::toggle_recording, GLFW_KEY_F9, false, false, "F9", "Recording"},
    {Action::quit, GLFW_KEY_Q, true, false, "Ctrl+Q", "Quit"},
    {Action::show_keys, GLFW_KEY_SLASH, false, true, "?", "List of keys"},
});

constexpr std::size_t tool_key_count = [] {
  std::size_t count = 0;
  for (const ToolActionRow& row : tool_actions) {
    count += std::count_if(row.keys.begin(), row.keys.end(), [](const ToolKey& key) { return key.key; });
  }
  return count;
}();

// Key bindings of the tools, ordered by key. GLFW's key codes of digits and letters are their ASCII
// characters.
constexpr auto tool_bindings = [] {
  std::array<KeyBinding, tool_key_count> made{};
  auto next = made.begin();
  for (const ToolActionRow& row : tool_actions) {
    for (const ToolKey& key : row.keys) {
      if (key.key == nullptr) continue;
      *next++ = {Action::choose_tool, key.key[0], false, false, key.key, key.help, key.kind, row.action};
    }
  }
  std::sort(made.begin(), made.end(),
            [](const KeyBinding& one, const KeyBinding& other) { return one.key < other.key; });
  return made;
}();

constexpr auto bindings = [] {
  std::array<KeyBinding, before_tools.size() + tool_bindings.size() + after_tools.size()> all{};
  auto next = std::copy(before_tools.begin(), before_tools.end(), all.begin());
  next = std::copy(tool_bindings.begin(), tool_bindings.end(), next);
  std::copy(after_tools.begin(), after_tools.end(), next);
  return all;
}();

constexpr std::array<HeldInput, 8> held_input_table = {{
    {"Left button", "Stroke: press, then drag in the screen plane"},
    {"Wheel during a stroke", "Depth of the stroke, 1 mm per notch"},
    {"Alt during a stroke", "Depth of the stroke: up is away"},
    {"Ctrl+left button", "Inverse action: pull for push, push for pull"},
    {"Shift+left button", "Smoothing"},
    {"F and drag", "Tool radius"},
    {"Shift+F and drag", "Strength: depth of a press, 0.2 to 20 mm"},
    {"Right button", "Orbit; with Shift pan, with Ctrl or the wheel zoom"},
}};

}  // namespace

std::span<const KeyBinding> key_bindings() {
  return bindings;
}

std::span<const HeldInput> held_inputs() {
  return held_input_table;
}

namespace {

const char* find_chord(EditAction action) {
  for (const KeyBinding& binding : key_bindings()) {
    if (binding.action == action) return binding.chord;
  }
  return nullptr;
}

class ActionItems {
 public:
  explicit ActionItems(std::vector<EditAction>& chosen) : chosen_(&chosen) {}
  void operator()(const char* name, EditAction action, bool enabled = true, bool ticked = false) const {
    if (ImGui::MenuItem(name, find_chord(action), ticked, enabled)) chosen_->push_back(action);
  }

 private:
  std::vector<EditAction>* chosen_;
};

void draw_file(const MenuState& state, const ActionItems& item) {
  if (!ImGui::BeginMenu("File")) return;
  item("New", EditAction::new_document);
  item("New shape...", EditAction::new_shape);
  item("Open...", EditAction::open);
  item("Save", EditAction::save);
  item("Save as...", EditAction::save_as);
  item("Export...", EditAction::export_model);
  ImGui::Separator();
  item(state.recording ? "Stop recording" : "Start recording", EditAction::toggle_recording);
  item("Screenshot of the scene", EditAction::screenshot);
  item("Screenshot with the panel", EditAction::window_screenshot);
  ImGui::Separator();
  item("Quit", EditAction::quit);
  ImGui::EndMenu();
}

void draw_edit(const MenuState& state, const ActionItems& item) {
  if (!ImGui::BeginMenu("Edit")) return;
  item("Undo stroke", EditAction::undo, state.can_undo);
  item("Redo stroke", EditAction::redo, state.can_redo);
  ImGui::Separator();
  item("Symmetry", EditAction::toggle_symmetry, true, state.symmetric);
  item("Add fixing plane", EditAction::place_plane);
  item("Remove fixing planes", EditAction::remove_planes, state.plane_count > 0);
  item("Keep shape", EditAction::keep_shape);
  ImGui::Separator();
  item(state.force_on ? "Force off" : "Force on",
       state.force_on ? EditAction::cut_force : EditAction::allow_force);
  ImGui::EndMenu();
}

void draw_overlays(MenuChoice& choice) {
  if (!ImGui::BeginMenu("Overlays")) return;
  constexpr std::array<std::pair<const char*, bool Overlays::*>, 12> all = {{
      {"Fixed nodes", &Overlays::fixed_nodes},
      {"Touched nodes", &Overlays::touched_nodes},
      {"Lattice", &Overlays::lattice},
      {"Control net", &Overlays::control_net},
      {"Force", &Overlays::force},
      {"Contact normals", &Overlays::contact_normals},
      {"Fixing planes", &Overlays::fixing_planes},
      {"Symmetry plane", &Overlays::symmetry_plane},
      {"Tool", &Overlays::tool},
      {"Ground grid", &Overlays::ground_grid},
      {"Scale bar", &Overlays::scale_bar},
      {"Legend", &Overlays::legend},
  }};
  for (const auto& [name, member] : all) ImGui::MenuItem(name, nullptr, &(choice.overlays.*member));
  ImGui::MenuItem("See-through body", nullptr, &choice.see_through_body);
  if (ImGui::BeginMenu("Contact stages")) {
    for (const StageChoice& stage : stage_choices) {
      if (ImGui::MenuItem(stage.name, nullptr, stage.is_chosen(choice.overlays))) {
        stage.choose(choice.overlays);
      }
    }
    ImGui::EndMenu();
  }
  ImGui::EndMenu();
}

void draw_view_items(const ActionItems& item, MenuChoice& choice) {
  if (!ImGui::BeginMenu("View")) return;
  item("Whole model", EditAction::frame_model);
  item("Front", EditAction::view_front);
  item("Right", EditAction::view_right);
  item("Top", EditAction::view_top);
  item("Perspective", EditAction::view_perspective);
  ImGui::Separator();
  draw_overlays(choice);
  if (ImGui::BeginMenu("Mouse navigation")) {
    constexpr std::array<const char*, 3> names = {"Rhino", "Blender", "SculptGL"};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto preset = static_cast<NavigationPreset>(i);
      if (ImGui::MenuItem(names[i], nullptr, choice.navigation == preset)) choice.navigation = preset;
    }
    ImGui::EndMenu();
  }
  ImGui::EndMenu();
}

}  // namespace

MenuChoice draw_menu(const MenuState& state) {
  MenuChoice choice{{}, state.navigation, state.overlays, state.see_through_body};
  if (!ImGui::BeginMainMenuBar()) return choice;
  const ActionItems item(choice.actions);
  draw_file(state, item);
  draw_edit(state, item);
  draw_view_items(item, choice);
  if (ImGui::BeginMenu("Help")) {
    item("Keys", EditAction::show_keys);
    ImGui::EndMenu();
  }
  choice.height_px = ImGui::GetWindowSize().y;
  ImGui::EndMainMenuBar();
  return choice;
}

bool draw_keys(const Theme& theme) {
  bool open = true;
  ImGui::PushFont(theme.fonts.body);
  const ImVec2 centre(0.5F * (ImGui::GetIO().DisplaySize.x + theme.metrics.panel_width_px),
                      0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(centre, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  ImGui::Begin("Keys", &open,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
  if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
    const auto row = [](const char* chord, const char* text) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextColored(colour::accent, "%s", chord);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(text);
    };
    for (const HeldInput& key : held_inputs()) row(key.chord, key.text);
    for (const KeyBinding& binding : key_bindings()) row(binding.chord, binding.text);
    ImGui::EndTable();
  }
  ImGui::End();
  ImGui::PopFont();
  return open;
}

}  // namespace spoonbill
