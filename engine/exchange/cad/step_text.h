// The letters of STEP files (ISO 10303-21, 6.4.3): ASCII, all others as hexadecimal digits.
#pragma once

#include <string>
#include <string_view>

namespace spoonbill {

// Letters of UTF-8 beyond ASCII, which stand in strings alone, as \X2\....\X0\ or \X4\........\X0\.
std::string step_text_in_ascii(std::string_view text);

}  // namespace spoonbill
