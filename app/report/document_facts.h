// What there is to say about a document, its material and the simulation made from it.
#pragma once

#include <optional>

#include "app/report/fact_sheet.h"
#include "engine/exchange/document.h"
#include "engine/simulation/simulation.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Names the unit of the file's lengths and the size found.
void add_document_facts(FactSheet& facts, const Document& document);

// The surface's extents along x, y and z.
void add_size_fact(FactSheet& facts, const Surface& surface);

// How many loops trim a body's surface, and how much of its area they take away; nothing of an untrimmed one.
void add_trim_facts(FactSheet& facts, const Body& body);

void add_material_facts(FactSheet& facts, const Material& material);

// What the body's regions are made of, where it has any.
void add_region_facts(FactSheet& facts, const Body& body);

// Young's modulus over the wanted one and Poisson's ratio along x, y and z, of each body: what the cells
// achieve that step it.
void add_elasticity_facts(FactSheet& facts, const Simulation& simulation);

// Of the snapshot of a simulation that has just been built.
void add_simulation_facts(FactSheet& facts, const Snapshot& snapshot);

// How good the lattice's cells are, and what a feature map made of them where there was one.
void add_cell_facts(FactSheet& facts, const LatticeMesh& mesh, const std::optional<FeatureMapReport>& map);

}  // namespace spoonbill
