// Parts of a body that are made of something else, or are rougher or smoother, than the rest.
#pragma once

#include <optional>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/body_region.h"
#include "engine/scene/material.h"

namespace spoonbill {

// A part of a body that is made of something else, or is rougher or smoother, than the rest. Plain data.
struct MaterialRegion {
  BodyRegion region;
  std::optional<Material> material = {};  // without: what is there stays
  std::optional<double> friction = {};    // without: the material's, or what is there where that stays too
};

inline constexpr Range<int> material_region_count_range{0, 16};

// The message names the field.
Status check_material_region(const MaterialRegion& region);

}  // namespace spoonbill
