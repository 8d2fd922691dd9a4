// What the panel shows, as plain data. Taken from a snapshot and the settings once a frame; the panel never
// sees the simulation.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/simulation/snapshot.h"
#include "render/view_settings.h"

namespace spoonbill {

struct PanelModel {
  std::string title;
  double time_s = 0.0;
  bool can_undo = false;
  bool can_redo = false;

  Tool tool;
  Sculpting sculpting;
  Material material;
  int region_count = 0;           // of what is not of that material
  std::vector<Material> presets;  // to choose from

  double effective_youngs_modulus_pa = 0.0;
  int implicit_nodes = 0;  // 0: springs, stepped explicitly
  double mass_kg = 0.0;
  int plane_count = 0;
  int fixed_node_count = 0;
  int node_count = 0;

  double residual_m = 0.0;  // how far the surface stays behind its lattice, of the body that does so most
  int residual_body = 0;    // which it is, in the scene

  Overlays overlays;
  bool see_through_body = false;

  std::string device;
  double force_n = 0.0;
  double force_limit_n = 0.0;
  double rate_hz = 0.0;
  bool rate_is_nominal = true;  // lock-step has no clock to measure by
  int substeps = 0;
  std::uint32_t flags = tick_flag_none;
  std::string safety_text;   // why the hand feels less than the material asks, a line each
  std::string drawing_text;  // what is left out of the picture
};

}  // namespace spoonbill
