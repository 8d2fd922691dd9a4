// The verdict on food in a bowl: whether it stays.
#pragma once

#include "engine/trial/spill.h"

namespace spoonbill {

// holds: the food has settled, and less than overhang_limit_fraction of its mass is outside the rim.
// overhangs: it has settled, and more is outside.
// leaves: its centre of mass has been outside the rim, or it has spilled (spill_limit_fraction).
// undecided: it has not settled yet.
enum class Verdict { holds, overhangs, leaves, undecided };
inline constexpr const char* verdict_names[] = {"holds", "overhangs", "leaves", "undecided"};
inline constexpr double overhang_limit_fraction = 0.01;

// Judges food that has been inside the rim.
Verdict judge(const Spill& spill, bool is_settled);

}  // namespace spoonbill
