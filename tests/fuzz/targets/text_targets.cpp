// Fuzz targets for readers of text that a person types or writes into tables.
#include <cmath>
#include <string>

#include "app/commands/option_values.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/targets/targets.h"

namespace spoonbill {

void take_values(std::string_view bytes) {
  constexpr Range<double> lengths{1e-9, 10.0};
  const auto length = parse_length(bytes, lengths);
  if (length) {
    must_hold(lengths.contains(length.value()), "lengths are within their range");
  } else {
    must_be_one_line(length.error());
  }
  if (const auto three = parse_lengths(bytes, 3, lengths)) must_hold(three->size() == 3, "three lengths");
  if (const auto pose = parse_pose(bytes)) {
    must_hold(std::abs(pose->orientation.norm() - 1.0) < 1e-9, "orientations are unit");
  }
  const auto extent = parse_extent(bytes, {1, 5000}, "50x50");
  if (extent) must_hold(extent->width >= 1 && extent->height <= 5000, "extents are within their range");
  const auto unit = parse_unit(bytes);
  if (!unit) must_be_one_line(unit.error());
  const auto points = parse_points(std::string(bytes));
  if (!points) must_be_one_line(points.error());
}

void take_table(std::string_view bytes) {
  for (const bool sections : {false, true}) {
    const auto table = point_table(std::string(bytes), "fuzzed", {"x", "y", "z"}, sections);
    if (!table) {
      must_be_one_line(table.error());
      continue;
    }
    for (const auto& row : table->rows_m) {
      must_hold(row.size() == 3, "rows are of three lengths");
      for (const double length_m : row) must_hold(std::isfinite(length_m), "lengths are finite");
    }
  }
}

}  // namespace spoonbill
