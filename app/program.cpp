#include "app/program.h"

#include <algorithm>

#include "app/commands/command.h"
#include "app/commands/option_set.h"

namespace spoonbill {
namespace {

const char* const program_description =
    "Spoonbill: shape B-spline surfaces by touch.\n"
    "`spoonbill COMMAND --help` describes a command and its options.";

// Adds all commands, in the order in which --help lists them and their groups.
std::vector<CommandEntry> add_commands(const OptionSet& root) {
  struct Group {
    const char* name;
    std::vector<CommandEntry (*)(OptionSet)> commands;
  };
  const std::vector<Group> groups = {
      {"Make a model", {add_new, add_fit, add_merge, add_change, add_add}},
      {"Look at a model", {add_info, add_render, add_check, add_sample, add_collide}},
      {"Exchange with other programs", {add_convert}},
      {"Sculpt", {add_edit, add_record, add_replay}},
      {"Try a model", {add_try, add_rest, add_study, add_train, add_compare}},
      // Hidden commands, which the program itself runs as child processes.
      {"", {add_read_mesh, add_read_points}},
  };
  std::vector<CommandEntry> entries;
  for (const Group& group : groups) {
    for (const auto add : group.commands) {
      entries.push_back(add(root));
      entries.back().parser.set_group(group.name);
    }
  }
  return entries;
}

// Flushes the output of a command that has succeeded, and returns the exit code.
int finish_output(Console& console) {
  console.out.flush();
  if (console.out) return exit_done;
  console.err << "spoonbill: standard output could not be written\n";
  return exit_failed;
}

int run_command(const CommandEntry& entry, Console& console) {
  const Status status = entry.run(console);
  if (!status) {
    console.err << "spoonbill: " << one_line(status.error().message) << '\n';
    return exit_failed;
  }
  return finish_output(console);
}

}  // namespace

int run_program(const std::vector<std::string>& arguments, Console& console, const std::string& version) {
  CommandLine line(program_description, "spoonbill");
  line.set_version("spoonbill " + version);
  const OptionSet root = line.options();
  root.require_command();
  const std::vector<CommandEntry> commands = add_commands(root);
  const CommandLine::Parsed parsed = line.parse(arguments);
  switch (parsed.outcome) {
    case CommandLine::Outcome::answered:
      console.out << parsed.text;
      return finish_output(console);
    case CommandLine::Outcome::wrong_use:
      console.err << parsed.text;
      return exit_wrong_use;
    case CommandLine::Outcome::parsed:
      break;
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [](const CommandEntry& command) { return command.parser.is_chosen(); });
  return run_command(*chosen, console);
}

}  // namespace spoonbill
