// Points that a person wrote down: a CSV file whose first line names the columns with their unit, "x_mm,y_mm,
// z_mm". Lines that are empty or begin with # say nothing, nor does a byte order mark.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Columns of lengths, in metres, and perhaps one of whole numbers, "section", before them.
struct PointTable {
  std::vector<int> sections;                // one a row; empty without the column
  std::vector<std::vector<double>> rows_m;  // as many lengths in each as columns
};

// At most 16 MiB and 100,000 rows. The columns come in that order, each in mm, cm, m or in ("x_in"). Refused,
// with the line: other columns, rows of another length, what is no number or beyond 100 m.
Result<PointTable> read_point_table(const std::filesystem::path& file,
                                    const std::vector<std::string>& columns, bool with_section);
// The same of its content; `source` names it in messages.
Result<PointTable> point_table(const std::string& text, const std::string& source,
                               const std::vector<std::string>& columns, bool with_section);

// "0,0,0;10,5,0;20,0,0mm": points of three lengths, the last with the unit of all.
Result<std::vector<Vector3>> parse_points(const std::string& text);

}  // namespace spoonbill
