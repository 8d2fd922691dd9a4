// What there is to say about the contact of two surfaces.
#pragma once

#include <vector>

#include "app/report/fact_sheet.h"
#include "engine/collision/surface_pair_collider.h"

namespace spoonbill {

// Surfaces that touch have a depth, the deepest contact's, and contacts; others the distance between their
// nearest points.
void add_contact_facts(FactSheet& facts, const PairResult& result, const std::vector<PairContact>& contacts);

}  // namespace spoonbill
