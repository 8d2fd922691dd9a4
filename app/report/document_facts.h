// Reports on documents, CAD surfaces, materials and the simulation of a document.
#pragma once

#include <string>
#include <vector>

#include "app/console.h"
#include "app/report/fact_sheet.h"
#include "engine/base/geometry.h"
#include "engine/bspline/trim_loop.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/document.h"
#include "engine/material/lattice/feature_map.h"
#include "engine/simulation/simulation.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Returns "deformable", "fixed", "rigid", or "rigid, held by a hand".
std::string kind_text(const Body& body);

// Returns the box around the surface. For a trimmed surface it is the box around the area that the loops
// keep, accurate to about a thousandth of its size; invalid loops are ignored.
Box extent_of(const Surface& surface, const std::vector<TrimLoop>& trims = {});

// Adds the name, the unit of the file, the size of all bodies together and each body. In the JSON the bodies
// are the list "bodies", and the members of a single body are also at the top level. With more bodies than
// can be sculpted together, each body has only one line.
void add_document_facts(FactSheet& facts, const Document& document);

// Adds the size of the box along x, y and z.
void add_size_fact(FactSheet& facts, const Box& extent);

void add_material_facts(FactSheet& facts, const Material& material);

// Adds each surface of a CAD model, and the size of all surfaces together.
void add_surface_facts(FactSheet& facts, const std::vector<CadSurface>& surfaces);

// Adds the unit of a file; `declared` is false if the file does not name one.
void add_unit_facts(FactSheet& facts, const std::string& unit, bool declared);

// Adds what the cells of each body achieve: Young's modulus along x, y and z as a fraction of the material's,
// Poisson's ratio, and the smallest radius of a contact whose force they resolve.
void add_elasticity_facts(FactSheet& facts, const Simulation& simulation);

// Adds the lattice, mass and solver of each body. `snapshot` shows the initial state of a simulation of these
// bodies. In the JSON these facts are the list "simulated", and the members of a single body are also at the
// top level.
void add_simulation_facts(FactSheet& facts, const Snapshot& snapshot, const std::vector<Body>& bodies);

// Adds the quality of the cells of each lattice. A feature map distributes the nodes inside a body evenly;
// for a body with a feature map, also adds the quality without the map. `maps` are the reports of the bodies
// that have a feature map, in the order of the bodies. "cells" in the JSON is a list, or an object if
// there is only one body.
void add_cell_facts(FactSheet& facts, const Simulation& simulation,
                    const std::vector<FeatureMapReport>& maps);

// A progress bar for the computation of feature maps (see add_cell_facts()), which also collects their
// reports. The console must outlive the bar, and the bar must outlive the result of watch().
class MapProgress {
 public:
  explicit MapProgress(Console& console, bool is_forced = false);

  FeatureMapWatch watch();
  // The reports of the finished maps, in the order of the bodies that have one.
  const std::vector<FeatureMapReport>& reports() const { return reports_; }

 private:
  ProgressBar bar_;
  std::vector<FeatureMapReport> reports_;
};

}  // namespace spoonbill
