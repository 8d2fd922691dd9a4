// The interface's letters: one family in two sizes.
#pragma once

#include <imgui.h>

#include <string>

#include "engine/base/result.h"

namespace spoonbill {

struct InterfaceFonts {
  ImFont* body = nullptr;  // owned by the atlas
  ImFont* heading = nullptr;
};

// Adds both sizes (in pixels) of the TrueType file to the atlas, with the signs that units and labels need
// (Greek letters, powers, degrees, arrows where the font has them). Upload the atlas afterwards. Refused: a
// file that is missing or unreadable; the message names it and the package that has it.
Result<InterfaceFonts> add_interface_fonts(ImFontAtlas& atlas, const std::string& path, float body_px,
                                           float heading_px);

}  // namespace spoonbill
