// The forms that option values take on the command line. Messages say what was given and what is wanted.
#pragma once

#include <string>
#include <string_view>

#include "engine/range.h"
#include "engine/result.h"

namespace spoonbill {

struct Extent {
  int width = 0;
  int height = 0;
};

// "1280x720", both numbers within the range.
Result<Extent> parse_extent(std::string_view text, Range<int> range);

}  // namespace spoonbill
