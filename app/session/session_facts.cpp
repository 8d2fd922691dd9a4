#include "app/session/session_facts.h"

namespace spoonbill {

void write_facts(const Session& session, SessionFacts& facts) {
  const Scene& scene = session.simulation.scene();
  facts.title = session.title;
  facts.tool = scene.tool;
  facts.material = scene.bodies[0].material;
  facts.region_count = static_cast<int>(scene.bodies[0].regions.size());
  facts.sculpting = scene.sculpting;
  facts.symmetry = scene.symmetry;
  facts.can_undo = session.history.can_undo();
  facts.can_redo = session.history.can_redo();
  facts.in_stroke = session.history.in_stroke();
}

}  // namespace spoonbill
