// The keys, in one table: what they do and what F1 shows. Those of tools come with their actions.
#pragma once

#include <span>

#include "engine/scene/tool.h"

namespace spoonbill {

enum class EditAction {
  show_keys,
  new_document,
  new_lump,
  open,
  save,
  save_as,
  export_model,
  undo,
  redo,
  cancel,
  toggle_symmetry,
  toggle_recording,
  screenshot,
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

struct KeyBinding {
  EditAction action;
  int key;  // GLFW_KEY_
  bool ctrl;
  bool shift;
  const char* chord;  // as a person reads it
  const char* text;
  // Of choose_tool.
  ToolKind kind = ToolKind::sphere;
  ToolAction tool_action = ToolAction::push;
};

// In the order in which F1 shows them.
std::span<const KeyBinding> key_bindings();

// What the mouse and held keys do, for F1: chord and text.
struct HeldKey {
  const char* chord;
  const char* text;
};
std::span<const HeldKey> held_keys();

}  // namespace spoonbill
