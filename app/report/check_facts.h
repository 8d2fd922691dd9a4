// The report of the check command: bodies, solids that several bodies bound, and bodies that overlap.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/report/fact_sheet.h"
#include "engine/exchange/cad_model.h"
#include "engine/inspection/solid_check.h"
#include "engine/inspection/surface_check.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// How a body is checked: by itself, or as a face of a closed solid. A face may be open.
enum class CheckedAs { body, face };

// Adds the lines of a body and returns its JSON. `area` is the part of the surface that the trims keep.
Json add_check_facts(FactSheet& facts, const Body& body, CheckedAs as, const TrimmedArea& area,
                     const SurfaceCheck& check);

// Adds the line of two overlapping bodies and returns its JSON.
Json add_meeting_facts(FactSheet& facts, const BodyOverlap& meeting, const Body& first, const Body& second);

// Adds the lines of a closed solid and returns its JSON. `bodies` are all bodies of the document.
Json add_solid_check_facts(FactSheet& facts, const CadSolid& solid, const SolidCheck& check,
                           const std::vector<Body>& bodies);

// Adds a line for each solid with faces that could not be joined, and returns the JSON list of these solids.
// `loose` are the indices of the bodies that belong to no joined solid.
Json add_open_solid_facts(FactSheet& facts, const std::vector<std::size_t>& loose,
                          const std::vector<Body>& bodies);

}  // namespace spoonbill
