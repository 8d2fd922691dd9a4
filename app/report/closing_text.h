// How reports say whether a surface closes.
#pragma once

#include <string>

#include "engine/inspection/surface_check.h"

namespace spoonbill {

const char* name_of(Closedness closedness);        // "solid", "tube", "sheet"
std::string closing_text(const Closing& closing);  // "a tube, open by 12 mm at an end"

}  // namespace spoonbill
