// What the panel needs of a session beside the snapshot: settings and what can be undone. Plain data; copied
// from the thread that ticks to the one that draws.
#pragma once

#include <string>
#include <vector>

#include "app/session/session.h"
#include "engine/scene/scene.h"

namespace spoonbill {

struct SessionFacts {
  std::string title;
  Tool tool;
  Material material;
  int region_count = 0;  // of the first body, as the material is
  Sculpting sculpting;
  Symmetry symmetry;
  bool can_undo = false;
  bool can_redo = false;
  bool in_stroke = false;
};

// Allocates only where a text is longer than the one before.
void write_facts(const Session& session, SessionFacts& facts);

}  // namespace spoonbill
