// A scale of colours from dark blue over green to yellow that rises evenly in lightness, so that it reads
// without telling red from green and in grey (viridis; Smith and van der Walt 2015).
#pragma once

#include <array>
#include <cstdint>

namespace spoonbill {

// Red, green and blue at a share of 0 to 1; beyond, as at the ends.
std::array<std::uint8_t, 3> colour_at(double share);

}  // namespace spoonbill
