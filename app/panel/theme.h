// The panel's look: light and quiet, so that the model stays the brightest thing in the picture.
#pragma once

#include <imgui.h>

#include "render/renderer.h"

namespace spoonbill {

// Lengths in pixels at the interface's scale.
struct Metrics {
  float body_px;
  float heading_px;
  float panel_width_px;
  float label_width_px;
  float padding_px;
  float row_gap_px;
};

struct Theme {
  Metrics metrics;
  InterfaceFonts fonts;
};

namespace colour {
inline const ImVec4 ink{0.13F, 0.15F, 0.18F, 1.0F};
inline const ImVec4 quiet_ink{0.42F, 0.45F, 0.49F, 1.0F};
inline const ImVec4 accent{0.16F, 0.42F, 0.60F, 1.0F};
inline const ImVec4 warning{0.74F, 0.30F, 0.06F, 1.0F};
inline const ImVec4 white{1.0F, 1.0F, 1.0F, 1.0F};
}  // namespace colour

Metrics metrics_for(double scale);
void apply_theme(ImGuiStyle& style, const Metrics& metrics);

}  // namespace spoonbill
