// Checks that scene and tools share. Each names the field, the value and the range.
#pragma once

#include <string>

#include "engine/pose.h"
#include "engine/range.h"
#include "engine/result.h"

namespace spoonbill {

inline constexpr Range<double> position_range_m{-100.0, 100.0};  // each coordinate

Status check_position(const std::string& field, const Vector3& position_m);
// To 1e-6 of its length: normals arrive as decimals and from arithmetic.
Status check_unit(const std::string& field, const Vector3& vector);

}  // namespace spoonbill
