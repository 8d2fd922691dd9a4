// Where a command writes: facts to `out`, words to the person to `err`. The streams must outlive it.
#pragma once

#include <ostream>
#include <string>

namespace spoonbill {

struct Console {
  std::ostream& out;
  std::ostream& err;
  bool person_watches = false;  // err is a terminal
};

// The text's first line, without what a terminal would obey: messages quote files, whose content may be
// anything.
std::string one_line(const std::string& text);

}  // namespace spoonbill
