// The stages of contact as a person chooses them, each level of spheres by itself.
#pragma once

#include <array>

#include "render/view_settings.h"

namespace spoonbill {

struct StageChoice {
  const char* name;
  ContactStage stage;
  int sphere_level;

  bool is_chosen(const Overlays& overlays) const {
    return overlays.contact_stage == stage &&
           (stage != ContactStage::spheres || overlays.sphere_level == sphere_level);
  }
  void choose(Overlays& overlays) const {
    overlays.contact_stage = stage;
    overlays.sphere_level = sphere_level;
  }
};

static_assert(finest_stage_level == 3);
inline constexpr std::array<StageChoice, 8> stage_choices = {{
    {"None", ContactStage::none, 0},
    {"Hulls", ContactStage::hulls, 0},
    {"Spheres, level 0", ContactStage::spheres, 0},
    {"Spheres, level 1", ContactStage::spheres, 1},
    {"Spheres, level 2", ContactStage::spheres, 2},
    {"Spheres, level 3", ContactStage::spheres, 3},
    {"Triangles", ContactStage::triangles, 0},
    {"Contact points", ContactStage::contacts, 0},
}};

}  // namespace spoonbill
