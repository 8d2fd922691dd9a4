// What the panel shows of a session.
#pragma once

#include "app/panel/panel_model.h"
#include "app/session/session_facts.h"

namespace spoonbill {

// `snapshot` must be the session's, of the same tick; `view` is what it is drawn with.
PanelModel panel_of(const SessionFacts& facts, const Snapshot& snapshot, const ViewSettings& view);

}  // namespace spoonbill
