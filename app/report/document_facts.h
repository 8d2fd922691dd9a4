// What there is to say about a document, its material and the simulation made from it.
#pragma once

#include <vector>

#include "app/report/fact_sheet.h"
#include "engine/base/geometry.h"
#include "engine/exchange/document.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/simulation/simulation.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Names the unit of the file's lengths, the size of all bodies together, and what each body is: "bodies" in
// the JSON, where one that is alone stands in the object itself too. Of more than are sculpted together a
// line each.
void add_document_facts(FactSheet& facts, const Document& document);

// How long along x, y and z.
void add_size_fact(FactSheet& facts, const Box& extent);

void add_material_facts(FactSheet& facts, const Material& material);

// Young's modulus over the wanted one and Poisson's ratio along x, y and z, of each body: what the cells
// achieve that step it.
void add_elasticity_facts(FactSheet& facts, const Simulation& simulation);

// Of the snapshot of a simulation of these bodies that has just been built: "simulated" in the JSON, where
// one that is alone stands in the object itself too.
void add_simulation_facts(FactSheet& facts, const Snapshot& snapshot, const std::vector<Body>& bodies);

// How good the cells of each body's lattice are, and what a feature map made of them where there was one;
// `maps` are in the order of the bodies that ask for one. "cells" in the JSON: a list, of one body an object.
void add_cell_facts(FactSheet& facts, const Simulation& simulation,
                    const std::vector<FeatureMapReport>& maps);

}  // namespace spoonbill
