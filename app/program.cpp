#include "app/program.h"

#include <algorithm>

#include "app/commands/command.h"
#include "app/commands/option_set.h"

namespace spoonbill {
namespace {

const char* const description =
    "Spoonbill: shape B-spline surfaces by touch.\n"
    "`spoonbill COMMAND --help` tells all about a command.";

int act(const CommandEntry& entry, Console& console) {
  const Status status = entry.act(console);
  if (!status) {
    console.err << "spoonbill: " << one_line(status.error().message) << '\n';
    return exit_failed;
  }
  console.out.flush();
  if (!console.out) {
    console.err << "spoonbill: standard output could not be written\n";
    return exit_failed;
  }
  return exit_done;
}

}  // namespace

int run_program(const std::vector<std::string>& arguments, Console& console, const std::string& version) {
  CommandLine line(description, "spoonbill");
  line.set_version("spoonbill " + version);
  const OptionSet root = line.options();
  root.require_command();
  const std::vector<CommandEntry> commands = {
      add_edit(root),    add_replay(root), add_record(root),  add_info(root),      add_sample(root),
      add_collide(root), add_rest(root),   add_new(root),     add_fit(root),       add_merge(root),
      add_change(root),  add_check(root),  add_convert(root), add_read_mesh(root), add_read_points(root)};
  const CommandLine::Parsed parsed = line.parse(arguments);
  switch (parsed.outcome) {
    case CommandLine::Outcome::answered:
      console.out << parsed.text;
      return exit_done;
    case CommandLine::Outcome::wrong_use:
      console.err << parsed.text;
      return exit_wrong_use;
    case CommandLine::Outcome::parsed:
      break;
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [](const CommandEntry& command) { return command.parser.is_chosen(); });
  return act(*chosen, console);
}

}  // namespace spoonbill
