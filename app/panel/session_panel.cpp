#include "app/panel/session_panel.h"

#include <algorithm>

namespace spoonbill {

PanelModel panel_of(const SessionFacts& facts, const Snapshot& snapshot, const ViewSettings& view) {
  PanelModel model;
  model.title = facts.title;
  model.time_s = snapshot.time_s();
  model.can_undo = facts.can_undo;
  model.can_redo = facts.can_redo;

  model.tool = facts.tool;
  model.sculpting = facts.sculpting;
  model.material = facts.material;
  model.region_count = facts.region_count;
  model.effective_youngs_modulus_pa = snapshot.bodies.front().material.effective_youngs_modulus_pa;
  model.implicit_nodes = snapshot.bodies.front().material.implicit_nodes;
  for (std::size_t b = 0; b < snapshot.bodies.size(); ++b) {
    const double residual_m = snapshot.bodies[b].residual.largest_m;
    if (residual_m <= model.residual_m) continue;
    model.residual_m = residual_m;
    model.residual_body = static_cast<int>(b);
  }
  model.plane_count = static_cast<int>(snapshot.planes.size());
  for (const BodySnapshot& body : snapshot.bodies) {
    const auto& fixed = body.lattice.fixed;
    model.mass_kg += body.material.mass_kg;
    model.fixed_node_count += static_cast<int>(std::count(fixed.begin(), fixed.end(), std::uint8_t{1}));
    model.node_count += static_cast<int>(fixed.size());
  }

  model.overlays = view.overlays;
  model.see_through_body = view.see_through_body;

  model.device = snapshot.device.name;
  model.force_n = snapshot.force_n.norm();
  model.force_limit_n = snapshot.device.force_limit_n;
  model.rate_hz = snapshot.device.nominal_rate_hz;
  model.substeps = snapshot.substeps;
  model.flags = snapshot.flags;
  return model;
}

}  // namespace spoonbill
