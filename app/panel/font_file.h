// Where Debian keeps the interface's font (fonts-roboto-unhinted).
#pragma once

namespace spoonbill {

inline constexpr const char* font_file =
    "/usr/share/fonts/truetype/roboto/unhinted/RobotoTTF/Roboto-Regular.ttf";

}  // namespace spoonbill
