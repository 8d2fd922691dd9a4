#include "app/program.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

#include "app/commands/command.h"
#include "app/version.h"
#include "engine/base/excerpt.h"

namespace spoonbill {
namespace {

const char* const description =
    "Spoonbill: shape B-spline surfaces by touch.\n"
    "`spoonbill COMMAND --help` tells all about a command.";

// Without what a terminal would obey: messages quote files, whose content may be anything.
std::string first_line(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  for (std::size_t k = 0; k < line.size(); ++k) {
    const auto letter = static_cast<unsigned char>(line[k]);
    const bool is_wide_control =
        letter == 0xc2 && k + 1 < line.size() && static_cast<unsigned char>(line[k + 1]) < 0xa0;
    if (letter < ' ' || letter == 127) line[k] = '?';
    if (is_wide_control) line.replace(k, 2, "?");
  }
  return line;
}

// As a person would say it.
std::string complaint(const CLI::App& parser, const CLI::ParseError& error) {
  const std::string text = first_line(error.what());
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && parser.get_require_subcommand_min() > 0) {
    const std::vector<std::string> words = parser.remaining();
    return words.empty() ? "a command is missing" : "'" + excerpt(words.front()) + "' is no command";
  }
  const std::size_t twice = text.find(": At Most 1 required but received");
  return twice == std::string::npos ? text : text.substr(0, twice) + " is given more than once";
}

int explain_wrong_use(const CLI::App& root, const CLI::ParseError& error, Console& console) {
  const CLI::App* parser = &root;
  std::string command = "spoonbill";
  while (!parser->get_subcommands().empty()) {
    parser = parser->get_subcommands().front();
    command += " " + parser->get_name();
  }
  console.err << "spoonbill: " << complaint(*parser, error) << "; see `" << command << " --help`\n";
  return exit_wrong_use;
}

// Their names say what they are; that they are text says nothing.
void hide_types_of_positionals(CLI::App& parser) {
  for (CLI::Option* option : parser.get_options({})) {
    if (option->get_positional()) option->type_name("");
  }
  for (CLI::App* command : parser.get_subcommands({})) hide_types_of_positionals(*command);
}

int act(const CommandEntry& entry, Console& console) {
  const Status status = entry.act(console);
  if (!status) {
    console.err << "spoonbill: " << first_line(status.error().message) << '\n';
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

int run_program(const std::vector<std::string>& arguments, Console& console) {
  CLI::App root(description, "spoonbill");
  root.set_version_flag("--version", std::string("spoonbill ") + version);
  root.require_subcommand(1);
  const std::vector<CommandEntry> commands = {
      add_edit(root),    add_replay(root), add_record(root),  add_info(root),      add_sample(root),
      add_collide(root), add_rest(root),   add_new(root),     add_fit(root),       add_merge(root),
      add_change(root),  add_check(root),  add_convert(root), add_read_mesh(root), add_read_points(root)};
  hide_types_of_positionals(root);
  try {
    root.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::Success& request) {  // --help, --version
    root.exit(request, console.out, console.err);
    return exit_done;
  } catch (const CLI::ParseError& error) {
    return explain_wrong_use(root, error, console);
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(),
                                   [](const CommandEntry& command) { return command.parser->parsed(); });
  return act(*chosen, console);
}

}  // namespace spoonbill
