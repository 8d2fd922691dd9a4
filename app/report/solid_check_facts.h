// What a check found of solids that several bodies bound, each as a face.
#pragma once

#include <vector>

#include "app/report/fact_sheet.h"
#include "engine/exchange/cad_model.h"
#include "engine/inspection/solid_check.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Lines go to the sheet, the solid's JSON is returned. `bodies` are all of the document, among which its
// places are.
Json add_solid_check_facts(FactSheet& facts, const CadSolid& solid, const SolidCheck& check,
                           const std::vector<Body>& bodies);

// Of each solid some of whose faces are joined to none.
Json add_open_solid_facts(FactSheet& facts, const std::vector<std::size_t>& loose,
                          const std::vector<Body>& bodies);

}  // namespace spoonbill
