#include "app/edit/key_bindings.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace spoonbill {
namespace {

using Action = EditAction;

constexpr auto before_tools = std::to_array<KeyBinding>({
    {Action::show_keys, GLFW_KEY_F1, false, false, "F1", "Show or hide these keys"},
    {Action::open, GLFW_KEY_O, true, false, "Ctrl+O", "Open a model"},
    {Action::new_document, GLFW_KEY_N, true, false, "Ctrl+N", "Begin anew with the spoon handle"},
    {Action::new_lump, GLFW_KEY_N, true, true, "Ctrl+Shift+N", "Begin anew with a lump"},
    {Action::save, GLFW_KEY_S, true, false, "Ctrl+S", "Save"},
    {Action::save_as, GLFW_KEY_S, true, true, "Ctrl+Shift+S", "Save under another name"},
    {Action::export_model, GLFW_KEY_E, true, false, "Ctrl+E", "Export to a CAD file or a mesh"},
    {Action::undo, GLFW_KEY_Z, true, false, "Ctrl+Z", "Undo the last stroke"},
    {Action::redo, GLFW_KEY_Z, true, true, "Ctrl+Shift+Z", "Redo it"},
    {Action::redo, GLFW_KEY_Y, true, false, "Ctrl+Y", "Redo it"},
    {Action::cancel, GLFW_KEY_ESCAPE, false, false, "Esc", "Cancel the stroke, or close what is open"},
});

constexpr auto after_tools = std::to_array<KeyBinding>({
    {Action::toggle_symmetry, GLFW_KEY_X, false, false, "X", "Symmetry on or off"},
    {Action::place_plane, GLFW_KEY_P, false, false, "P", "Fix the model behind a plane at the tool"},
    {Action::remove_planes, GLFW_KEY_P, false, true, "Shift+P", "Remove the fixing planes"},
    {Action::keep_shape, GLFW_KEY_K, false, false, "K", "Keep this shape as the rest shape"},
    {Action::frame_model, GLFW_KEY_HOME, false, false, "Home", "Show the whole model"},
    {Action::frame_model, GLFW_KEY_PERIOD, false, false, ".", "Show the whole model"},
    {Action::view_front, GLFW_KEY_KP_1, false, false, "Num 1", "From the front"},
    {Action::view_right, GLFW_KEY_KP_3, false, false, "Num 3", "From the right"},
    {Action::view_top, GLFW_KEY_KP_7, false, false, "Num 7", "From the top"},
    {Action::view_perspective, GLFW_KEY_KP_5, false, false, "Num 5", "At an angle"},
    {Action::view_front, GLFW_KEY_F5, false, false, "F5", "From the front"},
    {Action::view_right, GLFW_KEY_F6, false, false, "F6", "From the right"},
    {Action::view_top, GLFW_KEY_F7, false, false, "F7", "From the top"},
    {Action::view_perspective, GLFW_KEY_F8, false, false, "F8", "At an angle"},
    {Action::screenshot, GLFW_KEY_F12, false, false, "F12", "Write a picture"},
    {Action::toggle_recording, GLFW_KEY_F9, false, false, "F9", "Start or stop recording"},
    {Action::quit, GLFW_KEY_Q, true, false, "Ctrl+Q", "Quit"},
    {Action::show_keys, GLFW_KEY_SLASH, false, true, "?", "Show or hide these keys"},
});

constexpr std::size_t tool_key_count = [] {
  std::size_t count = 0;
  for (const ToolActionRow& row : tool_actions) {
    count += std::count_if(row.keys.begin(), row.keys.end(), [](const ToolKey& key) { return key.key; });
  }
  return count;
}();

// In the order of their keys; GLFW names digits and letters by their characters.
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

constexpr std::array<HeldKey, 7> held = {{
    {"Left button", "Stroke: press in, drag along the screen"},
    {"Wheel, pressed", "Deeper, or nearer"},
    {"Ctrl, pressed", "Pull instead of push, and the reverse"},
    {"Shift, pressed", "Smooth what strokes have done"},
    {"F and drag", "Tool radius"},
    {"Shift+F and drag", "Strength: how deep a press goes"},
    {"Right button", "Turn the camera; Shift pans, Ctrl or wheel zooms"},
}};

}  // namespace

std::span<const KeyBinding> key_bindings() {
  return bindings;
}

std::span<const HeldKey> held_keys() {
  return held;
}

}  // namespace spoonbill
