// What there is to say about a conversion.
#pragma once

#include <string>
#include <vector>

#include "app/convert/conversion.h"
#include "app/report/fact_sheet.h"

namespace spoonbill {

void add_conversion_facts(FactSheet& facts, const ConversionReport& report);

void add_unit_facts(FactSheet& facts, const std::string& unit, bool declared);
// The size of all, and each.
void add_surface_facts(FactSheet& facts, const std::vector<CadSurface>& surfaces);

}  // namespace spoonbill
