#include "app/panel/panel_model.h"

#include <algorithm>

namespace spoonbill {

PanelModel make_panel_model(const Snapshot& snapshot, const PanelSettings& settings) {
  PanelModel model;
  model.title = settings.title;
  model.time_s = snapshot.time_s();
  model.can_undo = settings.can_undo;
  model.can_redo = settings.can_redo;

  model.tool = settings.scene.tool;
  model.sculpting = settings.scene.sculpting;
  model.material = settings.scene.body.material;
  model.felt_youngs_modulus_pa = snapshot.material.felt_youngs_modulus_pa;
  model.mass_kg = snapshot.material.mass_kg;

  const auto& fixed = snapshot.lattice.fixed;
  model.plane_count = static_cast<int>(snapshot.planes.size());
  model.fixed_node_count = static_cast<int>(std::count(fixed.begin(), fixed.end(), std::uint8_t{1}));
  model.node_count = static_cast<int>(fixed.size());

  model.overlays = settings.view.overlays;
  model.see_through_body = settings.view.see_through_body;

  model.device = snapshot.device.name;
  model.force_n = snapshot.force_n.norm();
  model.force_limit_n = snapshot.device.force_limit_n;
  model.rate_hz = snapshot.device.nominal_rate_hz;
  model.substeps = snapshot.substeps;
  model.flags = snapshot.flags;
  return model;
}

}  // namespace spoonbill
