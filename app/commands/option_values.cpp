#include "app/commands/option_values.h"

#include <charconv>
#include <optional>

namespace spoonbill {
namespace {

std::optional<int> whole_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

}  // namespace

Result<Extent> parse_extent(std::string_view text, Range<int> range) {
  const std::size_t cross = text.find('x');
  const auto width = whole_number(text.substr(0, cross));
  const auto height = cross == std::string_view::npos ? std::nullopt : whole_number(text.substr(cross + 1));
  if (!width || !height || !range.contains(*width) || !range.contains(*height)) {
    return Error{"'" + std::string(text.substr(0, 40)) + "' is not a size like 1280x720 with sides from " +
                 std::to_string(range.low) + " to " + std::to_string(range.high)};
  }
  return Extent{*width, *height};
}

}  // namespace spoonbill
