// The commands of the program. Each add_ function declares its command's options at the root parser; the
// entry's act() does the work once they have been read.
#pragma once

#include <functional>

#include "app/commands/option_set.h"
#include "app/console.h"
#include "engine/base/result.h"

namespace spoonbill {

struct CommandEntry {
  OptionSet parser;
  std::function<Status(Console&)> act;
};

CommandEntry add_replay(OptionSet root);
CommandEntry add_record(OptionSet root);
CommandEntry add_edit(OptionSet root);
CommandEntry add_info(OptionSet root);
CommandEntry add_sample(OptionSet root);
CommandEntry add_collide(OptionSet root);
CommandEntry add_convert(OptionSet root);
CommandEntry add_rest(OptionSet root);
CommandEntry add_merge(OptionSet root);
CommandEntry add_change(OptionSet root);
CommandEntry add_new(OptionSet root);
CommandEntry add_fit(OptionSet root);
CommandEntry add_check(OptionSet root);
// The program's own, not shown.
CommandEntry add_read_mesh(OptionSet root);
CommandEntry add_read_points(OptionSet root);

}  // namespace spoonbill
