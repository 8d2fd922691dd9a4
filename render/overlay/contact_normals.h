// The contact points' outward normals as short lines. No GL.
#pragma once

#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/overlay/line.h"

namespace spoonbill {

// How far each line stands out: more than half the tool's radius.
double contact_normal_length_m(const ToolSnapshot& tool);

void append_contact_normals(const std::vector<ContactSnapshot>& contacts, double length_m,
                            std::vector<OverlayLine>& lines);

}  // namespace spoonbill
