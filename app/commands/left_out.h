// What a body cannot take along when its surface becomes another.
#pragma once

#include <string>
#include <vector>

#include "engine/inspection/surface_check.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// Regions, loads and supports are told as shares of the surface as it was; a remark names the body that had
// any.
inline void leave_out_shares(Body& body, std::vector<std::string>& remarks) {
  if (!body.regions.empty() || !body.loads.empty() || !body.supports.empty()) {
    remarks.push_back("regions, loads and supports of \"" + body.name +
                      "\" were left out: they are told as shares of the surface as it was");
  }
  body.regions.clear();
  body.loads.clear();
  body.supports.clear();
}

// A thickness belongs to what is open. Where the surface closed or opened, a remark says what became of it.
inline void settle_thickness(Body& body, const Surface& before, std::vector<std::string>& remarks) {
  const bool was_solid = find_closing(before).closedness == Closedness::solid;
  const bool solid = find_closing(body.surface).closedness == Closedness::solid;
  if (solid == was_solid) return;
  if (solid && body.shell_thickness_m) {
    body.shell_thickness_m.reset();
    remarks.push_back("the shell thickness of \"" + body.name + "\" was left out: it is a solid now");
  } else if (!solid && !body.shell_thickness_m) {
    remarks.push_back("\"" + body.name +
                      "\" is open: it can be sculpted once its file tells a shell_thickness_mm");
  }
}

}  // namespace spoonbill
