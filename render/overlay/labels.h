// The words in the picture: the force at its arrow, the scale bar's length, and the legend. Laid out without
// GL or ImGui; draw_labels() puts them on a draw list.
#pragma once

#include <imgui.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/overlay/palette.h"
#include "render/view_settings.h"

namespace spoonbill {

enum class LabelSymbol { none, square, disc, diamond, line, arrow, sphere, plane };

struct Label {
  std::string text;
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();  // of the text's anchor
  Eigen::Vector2d anchor = Eigen::Vector2d::Zero();  // in the text's box: 0,0 top left, 0.5,1 bottom middle
  LabelSymbol symbol = LabelSymbol::none;            // drawn left of the text
  Colour colour;                                     // of the symbol
};

struct OverlayLabels {
  std::vector<Label> in_scene;  // force and scale bar
  std::vector<Label> legend;    // one line each, top down; positions are set by draw_labels()
};

// What is on in this frame and, in the legend, also present in the snapshot.
OverlayLabels overlay_labels(const Snapshot& snapshot, const ViewSettings& settings, int width_px,
                             int height_px);

// Draws them with the font, the legend in the lower right corner of the free rectangle. Meant for ImGui's
// background draw list, which lies under the panel.
void draw_labels(const OverlayLabels& labels, const ViewSettings& settings, int width_px, int height_px,
                 ImFont& font, ImDrawList& list);

}  // namespace spoonbill
