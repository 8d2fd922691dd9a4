// The contact's stages of the frame that is drawn next, found only while one is shown. One owner, whoever
// draws; its thread.
#pragma once

#include "engine/simulation/snapshot_stages.h"
#include "render/view_settings.h"

namespace spoonbill {

class ShownStages {
 public:
  // Sets settings.stages.
  void fill(const Snapshot& snapshot, ViewSettings& settings) {
    settings.stages = nullptr;
    if (settings.overlays.contact_stage == ContactStage::none) return;
    settings.stages = std::make_shared<const ContactStages>(finder_.find(snapshot));
  }

 private:
  SnapshotStages finder_;
};

}  // namespace spoonbill
