#include "app/commands/option_set.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <sstream>
#include <type_traits>

#include "app/console.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

// Returns the message of CLI11's error, reworded in the style of the program.
std::string wrong_use_text(const CLI::App& parser, const CLI::ParseError& error) {
  const std::string text = one_line(error.what());
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && parser.get_require_subcommand_min() > 0) {
    const std::vector<std::string> words = parser.remaining();
    return words.empty() ? "a command is missing" : "'" + excerpt(words.front()) + "' is not a command";
  }
  const std::size_t twice = text.find(": At Most 1 required but received");
  return twice == std::string::npos ? text : text.substr(0, twice) + " is given more than once";
}

std::string explain_wrong_use(const CLI::App& root, const CLI::ParseError& error) {
  const CLI::App* parser = &root;
  std::string command = root.get_name();
  while (!parser->get_subcommands().empty()) {
    parser = parser->get_subcommands().front();
    command += " " + parser->get_name();
  }
  return root.get_name() + ": " + wrong_use_text(*parser, error) + "; see `" + command + " --help`\n";
}

// Removes the type after the name of positional arguments in --help: "FILE", not "FILE TEXT".
void hide_types_of_positionals(CLI::App& parser) {
  for (CLI::Option* option : parser.get_options({})) {
    if (option->get_positional()) option->type_name("");
  }
  for (CLI::App* command : parser.get_subcommands({})) hide_types_of_positionals(*command);
}

template <class Text>
std::function<void(const Text&)> throwing(const std::string& name,
                                          const std::function<Status(const Text&)>& parse) {
  return [name, parse](const Text& text) {
    const Status status = parse(text);
    if (!status) throw CLI::ValidationError(name, status.error().message);
  };
}

// Returns a check that a text is a number in the range.
template <class Number>
CLI::Validator within(Range<Number> range) {
  const auto check = [range](const std::string& text) -> std::string {
    const std::string limits =
        number_text(static_cast<double>(range.low)) + " to " + number_text(static_cast<double>(range.high));
    Number number{};
    if (!CLI::detail::lexical_cast(text, number)) {
      const char* const kind = std::is_integral_v<Number> ? "whole number" : "number";
      return "'" + excerpt(text) + "' is not a " + kind + ", which must be from " + limits;
    }
    const bool is_within = range.low <= number && number <= range.high;
    return is_within ? std::string() : text + " is outside the range " + limits;
  };
  return CLI::Validator("").operation([check](std::string& text) { return check(text); });
}

}  // namespace

CommandOption CommandOption::require() const {
  option_->required();
  return *this;
}
CommandOption CommandOption::show_as(const std::string& form) const {
  option_->type_name(form);
  return *this;
}
CommandOption CommandOption::limit(Range<int> range) const {
  option_->check(within(range));
  return *this;
}
CommandOption CommandOption::limit(Range<double> range) const {
  option_->check(within(range));
  return *this;
}
CommandOption CommandOption::limit(Range<std::uint64_t> range) const {
  option_->check(within(range));
  return *this;
}
CommandOption CommandOption::need(CommandOption other) const {
  option_->needs(other.option_);
  return *this;
}
CommandOption CommandOption::exclude(CommandOption other) const {
  option_->excludes(other.option_);
  return *this;
}

OptionSet OptionSet::add_command(const std::string& name, const std::string& description) const {
  return OptionSet(parser_->add_subcommand(name, description));
}
CommandOption OptionSet::add_flag(const std::string& name, bool& value, const std::string& help) const {
  return CommandOption(parser_->add_flag(name, value, help));
}
CommandOption OptionSet::add_option(const std::string& name, std::string& value,
                                    const std::string& help) const {
  return CommandOption(parser_->add_option(name, value, help));
}
CommandOption OptionSet::add_option(const std::string& name, std::filesystem::path& value,
                                    const std::string& help) const {
  return CommandOption(parser_->add_option(name, value, help));
}
CommandOption OptionSet::add_option(const std::string& name, std::vector<std::filesystem::path>& value,
                                    const std::string& help) const {
  return CommandOption(parser_->add_option(name, value, help));
}
CommandOption OptionSet::add_option(const std::string& name, int& value, const std::string& help) const {
  return CommandOption(parser_->add_option(name, value, help));
}
CommandOption OptionSet::add_option(const std::string& name, std::uint64_t& value,
                                    const std::string& help) const {
  return CommandOption(parser_->add_option(name, value, help));
}
CommandOption OptionSet::add_option(const std::string& name, std::optional<int>& value,
                                    const std::string& help) const {
  return CommandOption(parser_->add_option(name, value, help));
}
CommandOption OptionSet::add_option(const std::string& name, std::optional<double>& value,
                                    const std::string& help) const {
  return CommandOption(parser_->add_option(name, value, help));
}
CommandOption OptionSet::add_parsed(const std::string& name, const Parse& parse,
                                    const std::string& help) const {
  return CommandOption(parser_->add_option_function<std::string>(name, throwing(name, parse), help));
}
CommandOption OptionSet::add_parsed_list(const std::string& name, const ParseList& parse,
                                         const std::string& help) const {
  return CommandOption(
      parser_->add_option_function<std::vector<std::string>>(name, throwing(name, parse), help));
}

CommandOption OptionSet::option(const std::string& name) const {
  return CommandOption(parser_->get_option(name));
}
void OptionSet::set_footer(const std::string& text) const {
  parser_->footer(text);
}
void OptionSet::set_group(const std::string& heading) const {
  parser_->group(heading);
}
void OptionSet::require_command() const {
  parser_->require_subcommand(1);
}
void OptionSet::set_final_check(const std::function<Status()>& check) const {
  parser_->final_callback([check] {
    const Status status = check();
    if (!status) throw CLI::ValidationError(status.error().message);
  });
}
std::string OptionSet::name() const {
  return parser_->get_name();
}
bool OptionSet::is_chosen() const {
  return parser_->parsed();
}

CommandLine::CommandLine(const std::string& description, const std::string& name)
    : root_(std::make_unique<CLI::App>(description, name)) {}

CommandLine::~CommandLine() = default;

OptionSet CommandLine::options() const {
  return OptionSet(root_.get());
}

void CommandLine::set_version(const std::string& text) {
  root_->set_version_flag("--version", text);
}

CommandLine::Parsed CommandLine::parse(const std::vector<std::string>& arguments) {
  hide_types_of_positionals(*root_);
  try {
    root_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::Success& request) {  // thrown for --help and --version
    std::ostringstream answer;
    root_->exit(request, answer, answer);
    return {Outcome::answered, answer.str()};
  } catch (const CLI::ParseError& error) {
    return {Outcome::wrong_use, explain_wrong_use(*root_, error)};
  }
  return {Outcome::parsed, ""};
}

}  // namespace spoonbill
