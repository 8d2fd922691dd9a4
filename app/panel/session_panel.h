// What the panel shows of a session.
#pragma once

#include "app/panel/panel_model.h"
#include "app/session/session.h"

namespace spoonbill {

// `snapshot` must be the session's; `view` is what it is drawn with.
PanelModel panel_of(const Session& session, const Snapshot& snapshot, const ViewSettings& view);

}  // namespace spoonbill
