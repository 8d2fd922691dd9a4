// The commands of the program. Each add_ function declares its command's options at the root parser; the
// entry's act() does the work once they have been read.
#pragma once

#include <functional>

#include "app/console.h"
#include "engine/base/result.h"

namespace CLI {
class App;
}

namespace spoonbill {

struct CommandEntry {
  CLI::App* parser;  // owned by the root parser
  std::function<Status(Console&)> act;
};

CommandEntry add_replay(CLI::App& root);
CommandEntry add_record(CLI::App& root);
CommandEntry add_edit(CLI::App& root);
CommandEntry add_info(CLI::App& root);
CommandEntry add_sample(CLI::App& root);
CommandEntry add_collide(CLI::App& root);
CommandEntry add_convert(CLI::App& root);
CommandEntry add_rest(CLI::App& root);
CommandEntry add_merge(CLI::App& root);
CommandEntry add_change(CLI::App& root);
CommandEntry add_new(CLI::App& root);
CommandEntry add_fit(CLI::App& root);
CommandEntry add_check(CLI::App& root);
// The program's own, not shown.
CommandEntry add_read_mesh(CLI::App& root);
CommandEntry add_read_points(CLI::App& root);

}  // namespace spoonbill
