#include "app/edit/menu.h"

#include <array>
#include <utility>

#include "app/view/stage_choice.h"

namespace spoonbill {
namespace {

const char* chord_of(EditAction action) {
  for (const KeyBinding& binding : key_bindings()) {
    if (binding.action == action) return binding.chord;
  }
  return nullptr;
}

class ActionItems {
 public:
  explicit ActionItems(std::vector<EditAction>& chosen) : chosen_(&chosen) {}
  void operator()(const char* name, EditAction action, bool enabled = true, bool ticked = false) const {
    if (ImGui::MenuItem(name, chord_of(action), ticked, enabled)) chosen_->push_back(action);
  }

 private:
  std::vector<EditAction>* chosen_;
};

void draw_file(const MenuState& state, const ActionItems& item) {
  if (!ImGui::BeginMenu("File")) return;
  item("New", EditAction::new_document);
  item("New lump...", EditAction::new_lump);
  item("Open...", EditAction::open);
  item("Save", EditAction::save);
  item("Save as...", EditAction::save_as);
  item("Export...", EditAction::export_model);
  ImGui::Separator();
  item(state.recording ? "Stop recording" : "Start recording", EditAction::toggle_recording);
  item("Picture", EditAction::screenshot);
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
  item("Fix behind the tool", EditAction::place_plane);
  item("Remove fixing planes", EditAction::remove_planes, state.plane_count > 0);
  item("Keep shape", EditAction::keep_shape);
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
      {"Plane of symmetry", &Overlays::symmetry_plane},
      {"Tool", &Overlays::tool},
      {"Ground grid", &Overlays::ground_grid},
      {"Scale bar", &Overlays::scale_bar},
      {"Legend", &Overlays::legend},
  }};
  for (const auto& [name, member] : all) ImGui::MenuItem(name, nullptr, &(choice.overlays.*member));
  ImGui::MenuItem("See through the body", nullptr, &choice.see_through_body);
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

void draw_view(const ActionItems& item, MenuChoice& choice) {
  if (!ImGui::BeginMenu("View")) return;
  item("Whole model", EditAction::frame_model);
  item("Front", EditAction::view_front);
  item("Right", EditAction::view_right);
  item("Top", EditAction::view_top);
  item("At an angle", EditAction::view_perspective);
  ImGui::Separator();
  draw_overlays(choice);
  if (ImGui::BeginMenu("Mouse as in")) {
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
  draw_view(item, choice);
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
  const ImVec2 middle(0.5F * (ImGui::GetIO().DisplaySize.x + theme.metrics.panel_width_px),
                      0.5F * ImGui::GetIO().DisplaySize.y);
  ImGui::SetNextWindowPos(middle, ImGuiCond_Always, ImVec2(0.5F, 0.5F));
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
    for (const HeldKey& key : held_keys()) row(key.chord, key.text);
    for (const KeyBinding& binding : key_bindings()) row(binding.chord, binding.text);
    ImGui::EndTable();
  }
  ImGui::End();
  ImGui::PopFont();
  return open;
}

}  // namespace spoonbill
