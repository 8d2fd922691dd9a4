// What a check found of one body.
#pragma once

#include <string>
#include <vector>

#include "app/report/fact_sheet.h"
#include "engine/inspection/solid_check.h"
#include "engine/inspection/surface_check.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Of what has no thickness.
inline constexpr const char* no_walls = "unknown: nowhere do two walls face each other";

// A face of a closed solid need not close.
enum class CheckedAs { body, face };

// What keeps the body from being what it says it is, a line each: none where it is sound.
std::vector<std::string> problems_of(const Body& body, CheckedAs as, const SurfaceCheck& check);

// Lines go to the sheet, the body's JSON is returned.
// `area` is what trims keep of the body's surface.
Json add_check_facts(FactSheet& facts, const Body& body, CheckedAs as, const TrimmedArea& area,
                     const SurfaceCheck& check);

// Of two bodies that are in each other.
Json add_meeting_facts(FactSheet& facts, const BodyOverlap& meeting, const Body& first, const Body& second);

}  // namespace spoonbill
