// What a body cannot take along when its surface becomes another.
#pragma once

#include <string>
#include <vector>

#include "engine/simulation/scene.h"

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

}  // namespace spoonbill
