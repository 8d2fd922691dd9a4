#include "app/commands/option_values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "engine/base/text.h"
#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

std::optional<int> whole_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

struct NumberAndRest {
  double number = 0.0;
  std::string_view rest;
};

std::optional<NumberAndRest> leading_number(std::string_view text) {
  NumberAndRest result;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.number);
  if (error != std::errc() || !std::isfinite(result.number)) return {};
  result.rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return result;
}

std::optional<double> length_m(std::string_view text) {
  const auto length = leading_number(text);
  if (!length) return {};
  if (length->rest.empty() && length->number == 0.0) return 0.0;
  const auto unit = unit_named(length->rest);
  return unit ? std::optional(length->number * unit->metres) : std::nullopt;
}

std::optional<double> plain_number(std::string_view text) {
  const auto number = leading_number(text);
  return number && number->rest.empty() ? std::optional(number->number) : std::nullopt;
}

// The parts between commas; nothing where they are not as many.
template <std::size_t count>
std::optional<std::array<std::string_view, count>> split(std::string_view text) {
  std::array<std::string_view, count> parts;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (k + 1 == count)) return {};
    parts[k] = text.substr(0, comma);
    if (k + 1 < count) text.remove_prefix(comma + 1);
  }
  return parts;
}

}  // namespace

Result<Extent> parse_extent(std::string_view text, Range<int> range, const char* example) {
  const std::size_t cross = text.find('x');
  const auto width = whole_number(text.substr(0, cross));
  const auto height = cross == std::string_view::npos ? std::nullopt : whole_number(text.substr(cross + 1));
  if (!width || !height || !range.contains(*width) || !range.contains(*height)) {
    return Error{"'" + excerpt(text) + "' is not two numbers like " + example + ", each from " +
                 std::to_string(range.low) + " to " + std::to_string(range.high)};
  }
  return Extent{*width, *height};
}

Result<double> parse_length(std::string_view text, Range<double> range_m) {
  const auto length = length_m(text);
  if (!length) {
    return Error{"'" + excerpt(text) + "' is not a length with a unit, like 5mm (mm, cm, m or in)"};
  }
  if (!range_m.contains(*length)) {
    return Error{"'" + excerpt(text) + "' must be " + length_text(range_m.low) + " to " +
                 length_text(range_m.high)};
  }
  return *length;
}

Result<std::vector<double>> parse_lengths(std::string_view text, std::size_t count, Range<double> range_m) {
  const Error refusal{"'" + excerpt(text) + "' is not " + std::to_string(count) +
                      " lengths with a unit, like " + (count == 2 ? "60x40mm" : "60x40x20mm") +
                      " (mm, cm, m or in)"};
  std::vector<double> lengths(count);
  double unit = 0.0;
  for (std::size_t k = count; k-- > 0;) {
    const std::size_t cross = text.rfind('x');
    if ((cross == std::string_view::npos) != (k == 0)) return refusal;
    const auto length = leading_number(k == 0 ? text : text.substr(cross + 1));
    if (!length) return refusal;
    if (!length->rest.empty()) {
      const auto named = unit_named(length->rest);
      if (!named) return refusal;
      unit = named->metres;
    }
    lengths[k] = length->number * unit;
    if (!(unit > 0.0) || !range_m.contains(lengths[k])) return refusal;
    text = text.substr(0, cross);
  }
  return lengths;
}

Result<Pose> parse_pose(std::string_view text) {
  const Error refusal{
      "'" + excerpt(text, 80) +
      "' is not a pose like 10mm,0,0,1,0,0,0: a position of at most 100 m with units (mm, cm, m "
      "or in), then a quaternion w,x,y,z"};
  const auto parts = split<7>(text);
  if (!parts) return refusal;
  Pose pose;
  for (int axis = 0; axis < 3; ++axis) {
    const auto length = length_m((*parts)[axis]);
    if (!length || !position_range_m.contains(*length)) return refusal;
    pose.position_m[axis] = *length;
  }
  std::array<double, 4> turn{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto number = plain_number((*parts)[3 + k]);
    if (!number) return refusal;
    turn[k] = *number;
  }
  const Quaternion orientation(turn[0], turn[1], turn[2], turn[3]);
  const double length = orientation.coeffs().stableNorm();
  if (!(length > 1e-100 && length < 1e100)) return refusal;
  pose.orientation = Quaternion(orientation.coeffs() / length);
  return pose;
}

Result<int> parse_continuity(const std::string& text) {
  constexpr int highest = max_degree - 1;
  if (text.size() == 2 && (text[0] == 'C' || text[0] == 'c') && text[1] >= '0' && text[1] <= '0' + highest) {
    return text[1] - '0';
  }
  return Error{"'" + excerpt(text) + "' is not a continuity from C0 to C" + std::to_string(highest)};
}

Result<std::vector<int>> parse_places(std::string_view text) {
  constexpr Range<int> range{1, 1000};
  const Error refusal{"'" + excerpt(text) + "' is not a list like 1,3-5 of places from 1 to 1000"};
  std::vector<int> places;
  for (std::string_view rest = text;;) {
    const std::string_view part = rest.substr(0, rest.find(','));
    const std::size_t dash = part.find('-');
    const auto first = whole_number(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : whole_number(part.substr(dash + 1));
    if (!first || !last || !range.contains(*first) || !range.contains(*last) || *last < *first) {
      return refusal;
    }
    for (int place = *first; place <= *last; ++place) {
      if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
    }
    if (part.size() == rest.size()) return places;
    rest.remove_prefix(part.size() + 1);
  }
}

Result<Side> parse_side(std::string_view text) {
  for (const Side side : all_sides) {
    if (text == side_name(side)) return side;
  }
  return Error{"edge '" + excerpt(text) + "' is unknown; choose u_start, u_end, v_start or v_end"};
}

Result<LengthUnit> parse_unit(std::string_view text) {
  if (const auto unit = unit_named(text)) return *unit;
  return Error{"'" + excerpt(text) + "' is not a unit of length: mm, cm, m or in"};
}

}  // namespace spoonbill
