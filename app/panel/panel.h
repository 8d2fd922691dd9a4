// The panel: tool, material, fixtures, view and device, in the order of work.
#pragma once

#include <string>
#include <vector>

#include "app/panel/panel_model.h"
#include "app/panel/theme.h"
#include "app/session/request.h"
#include "render/camera.h"

namespace spoonbill {

// The panel's place in a frame of that size and scale, at the left edge below what is already at the top;
// empty where the frame is too small for a panel that can be read.
Rectangle panel_rectangle(int width_px, int height_px, double scale, double top_px = 0.0);

// The same for a picture, in which nobody can scroll: empty where not all of the panel can be seen.
Rectangle picture_panel_rectangle(int width_px, int height_px);

// The interface's scale for a frame of that height: 1 at 720 pixels, in steps of a half.
double panel_scale(int height_px);

// What the person asked for in a frame, and why what they typed was refused; empty where it was not.
struct PanelAnswer {
  std::vector<Request> requests;
  std::string refusal;
};

// Lays the panel out, between InterfaceContext::begin_frame() and end_frame().
PanelAnswer draw_panel(const PanelModel& model, const Theme& theme, const Rectangle& place_px);

}  // namespace spoonbill
