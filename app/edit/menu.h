// Keys and menu of the window: the table of key bindings, the menu bar and the list of keys.
#pragma once

#include <span>
#include <vector>

#include "app/edit/mouse.h"
#include "app/panel/interface_context.h"
#include "engine/scene/tool.h"
#include "render/view_settings.h"

namespace spoonbill {

// Actions of keys and menu items.
enum class EditAction {
  show_keys,
  new_document,
  new_shape,
  open,
  save,
  save_as,
  export_model,
  undo,
  redo,
  cancel,
  cut_force,
  allow_force,
  toggle_symmetry,
  toggle_reach,
  toggle_touch,
  toggle_recording,
  screenshot,
  window_screenshot,
  place_plane,
  remove_planes,
  keep_shape,
  frame_model,
  view_front,
  view_right,
  view_top,
  view_perspective,
  choose_tool,
  quit,
};

// A key, its action, and the texts that the list of keys shows for them. The keys of tools come from the
// table `tool_actions`.
struct KeyBinding {
  EditAction action;
  int key;  // a key code of GLFW (GLFW_KEY_...)
  bool ctrl;
  bool shift;
  const char* chord;  // text that is shown for the key, such as "Ctrl+S"
  const char* text;
  // The following members are used only if `action` is choose_tool.
  ToolKind kind = ToolKind::sphere;
  ToolAction tool_action = ToolAction::push;
};

// Returns all bindings in the order of the list of keys.
std::span<const KeyBinding> key_bindings();

// An input by the mouse, with or without a key held, as the list of keys describes it.
struct HeldInput {
  const char* chord;
  const char* text;
};
std::span<const HeldInput> held_inputs();

// State that the menu shows.
struct MenuState {
  bool can_undo = false;
  bool can_redo = false;
  bool recording = false;
  bool symmetric = false;
  bool force_on = true;
  int plane_count = 0;
  NavigationPreset navigation = NavigationPreset::rhino;
  Overlays overlays;
  bool see_through_body = false;
};

// The choices that the user made in the menu in one frame, and the height of the menu bar.
struct MenuChoice {
  std::vector<EditAction> actions;
  NavigationPreset navigation;
  Overlays overlays;
  bool see_through_body;
  float height_px = 0.0F;
};

// Draws the menu bar, between begin_frame() and end_frame().
MenuChoice draw_menu(const MenuState& state);

// Draws the list of keys over the picture. Returns false when the user closes it.
bool draw_keys(const Theme& theme);

}  // namespace spoonbill
