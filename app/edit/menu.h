// The menu bar of the window. Draws, and returns what was chosen.
#pragma once

#include <vector>

#include "app/edit/key_bindings.h"
#include "app/edit/navigation.h"
#include "app/panel/theme.h"
#include "render/view_settings.h"

namespace spoonbill {

struct MenuState {
  bool can_undo = false;
  bool can_redo = false;
  bool recording = false;
  bool symmetric = false;
  int plane_count = 0;
  NavigationPreset navigation = NavigationPreset::rhino;
  Overlays overlays;
  bool see_through_body = false;
};

struct MenuChoice {
  std::vector<EditAction> actions;
  NavigationPreset navigation;
  Overlays overlays;
  bool see_through_body;
  float height_px = 0.0F;
};

// Between begin_frame() and end_frame().
MenuChoice draw_menu(const MenuState& state);

// The keys of F1, as a window over the picture; false when it was closed.
bool draw_keys(const Theme& theme);

}  // namespace spoonbill
