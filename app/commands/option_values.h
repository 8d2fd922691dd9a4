// Values that people write on the command line and in tables: lengths, poses, lists, points. Every error
// quotes the text and shows the expected form.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/files/length_unit.h"
#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/base/text.h"
#include "engine/merging/patch_edge.h"

namespace spoonbill {

struct Extent {
  int width = 0;
  int height = 0;
};

// Width and height of pictures, in pixels.
inline constexpr Range<int> picture_size_range{64, 7680};

// Parses "1280x720", both numbers within the range. The error message shows `example`.
Result<Extent> parse_extent(std::string_view text, Range<int> range, const char* example);

// Parses "10mm,0,0,1,0,0,0": x, y and z within position_range_m, each with a unit unless it is 0, then the
// orientation as a quaternion w,x,y,z of any length but 0.
Result<Pose> parse_pose(std::string_view text);

// Parses "10mm,0,-5mm": x, y and z within position_range_m, each with a unit unless it is 0.
Result<Vector3> parse_position(std::string_view text);

// Parses "x", "y", "z" or a direction of any length but 0, such as "0,1,-1". Returns a unit vector.
Result<Vector3> parse_axis(std::string_view text);

// Parses a factor within the range, or one each for x, y and z: "1.2", "1.2,1,1".
Result<Vector3> parse_scale(std::string_view text, Range<double> range);

// Parses a length within the range, with a unit unless it is 0: "5mm", "0.2in", "2inch".
Result<double> parse_length(std::string_view text, Range<double> range_m);

// Parses an angle within the range, in degrees, with its unit unless it is 0: "10deg".
Result<double> parse_angle_deg(std::string_view text, Range<double> range_deg);

// Parses `count` lengths within the range: "60x40x20mm", "6cmx40mmx20mm". The last length must have a unit. A
// length without a unit has the unit of the next length that has one.
Result<std::vector<double>> parse_lengths(std::string_view text, std::size_t count, Range<double> range_m);

// Parses an order of continuity, from "C0" to "C8"; the highest degree allows no higher order.
Result<int> parse_continuity(const std::string& text);

// Parses "1,3-5": numbers from 1 to 1000, in the given order. Duplicates are removed.
Result<std::vector<int>> parse_number_list(std::string_view text);

// Returns the value of the choice whose word is the text.
template <class Value>
Result<Value> parse_choice(std::string_view text,
                           std::initializer_list<std::pair<const char*, Value>> choices) {
  std::string known;
  for (const auto& choice : choices) {
    if (text == choice.first) return choice.second;
    known += (known.empty() ? "" : ", ") + std::string(choice.first);
  }
  return Error{ErrorCode::unknown, "'" + excerpt(text) + "' is unknown; choose from " + known};
}

// Parses "u_start", "u_end", "v_start" or "v_end".
Result<Side> parse_side(std::string_view text);

// Parses "mm", "cm", "m", "in" or "inch".
Result<LengthUnit> parse_unit(std::string_view text);

// Parses "0,0,0;10,5,0;20,0,0mm": points of three coordinates each. The unit at the end applies to all of
// them.
Result<std::vector<Vector3>> parse_points(const std::string& text);

// A table of lengths in metres, optionally with a leading column of whole numbers named "section".
struct PointTable {
  std::vector<int> sections;                // section of each row; empty if the table has no such column
  std::vector<std::vector<double>> rows_m;  // lengths of each row, one per column
};

// Reads a CSV file of at most 16 MiB and 100,000 rows. The first line has the names of the columns in the
// given order, each with mm, cm, m or in: "x_mm,y_mm,z_mm". Empty lines, lines that begin with # and a byte
// order mark are ignored. The following errors name the line: unexpected columns, a wrong number of values,
// text that is not a number, a length beyond 100 m, too many rows.
Result<PointTable> read_point_table(const std::filesystem::path& file,
                                    const std::vector<std::string>& columns, bool with_section);

// Parses the content of a table as read_point_table() does; `source` names the file in messages.
Result<PointTable> point_table(const std::string& text, const std::string& source,
                               const std::vector<std::string>& columns, bool with_section);

}  // namespace spoonbill
