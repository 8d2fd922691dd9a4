// The forms that option values take on the command line. Messages say what was given and what is wanted.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/files/length_unit.h"
#include "engine/base/text.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

struct Extent {
  int width = 0;
  int height = 0;
};

// "1280x720", both numbers within the range; the example is what the refusal shows.
Result<Extent> parse_extent(std::string_view text, Range<int> range, const char* example);

// "10mm,0,0,1,0,0,0": x, y and z, each with its unit unless it is 0, within position_range_m; then the turn
// as a quaternion w,x,y,z of any length but 0.
Result<Pose> parse_pose(std::string_view text);

// "5mm", "0.2in", "2inch": a length with its unit, unless it is 0, within the range.
Result<double> parse_length(std::string_view text, Range<double> range_m);

// "60x40x20mm", "6cmx40mmx20mm": so many lengths within the range, the last with its unit, which is that of
// those before it that have none.
Result<std::vector<double>> parse_lengths(std::string_view text, std::size_t count, Range<double> range_m);

// "C2": an order of continuity from C0 to C8, which the highest degree can have.
Result<int> parse_continuity(const std::string& text);

// "1,3-5": places counted from 1, at most 1000 of them, each once and in the order given.
Result<std::vector<int>> parse_places(std::string_view text);

// One of these words, for what it stands for.
template <class Value>
Result<Value> parse_choice(std::string_view text,
                           std::initializer_list<std::pair<const char*, Value>> choices) {
  std::string known;
  for (const auto& choice : choices) {
    if (text == choice.first) return choice.second;
    known += (known.empty() ? "" : ", ") + std::string(choice.first);
  }
  return Error{"'" + excerpt(text) + "' is none of " + known};
}

// "u_start", "u_end", "v_start" or "v_end".
Result<Side> parse_side(std::string_view text);

// "mm", "cm", "m" or "in"; "inch" too.
Result<LengthUnit> parse_unit(std::string_view text);

}  // namespace spoonbill
