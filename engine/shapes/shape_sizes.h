// What sizes starting shapes may have.
#pragma once

#include <string_view>

#include "engine/base/range.h"
#include "engine/base/result.h"

namespace spoonbill {

inline constexpr Range<double> shape_size_range_m{1e-4, 10.0};
// Of the shortest side that it rounds: sharper edges ask for more control points than a lump has.
inline constexpr double least_rounding_share = 0.01;
// Of that side too, where no rounding is named.
inline constexpr double usual_rounding_share = 0.1;

// Messages give millimetres: "radius is 0.01 mm, must be 0.1 mm to 10000 mm".
Status check_length(std::string_view name, double length_m, Range<double> range_m);
// The same within the range of sizes.
Status check_size(std::string_view name, double size_m);
// The same for a rounding between the least share of a side and `most_m`.
Status check_rounding(std::string_view name, double rounding_m, double side_m, double most_m);

}  // namespace spoonbill
