// What there is to say about a conversion.
#pragma once

#include "app/convert/conversion.h"
#include "app/report/fact_sheet.h"

namespace spoonbill {

void add_conversion_facts(FactSheet& facts, const ConversionReport& report);

// The surfaces of a CAD model alone.
void add_surface_facts(FactSheet& facts, const std::vector<CadSurface>& surfaces);

}  // namespace spoonbill
