// Where a command writes: facts to `out`, words to the person to `err`. The streams must outlive it.
#pragma once

#include <ostream>

namespace spoonbill {

struct Console {
  std::ostream& out;
  std::ostream& err;
  bool person_watches = false;  // err is a terminal
};

}  // namespace spoonbill
