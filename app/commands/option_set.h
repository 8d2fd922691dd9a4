// The options of the command line. Only option_set.cpp includes CLI11, because its templates take eight
// seconds to compile.
//
//   CommandLine line("Shape B-spline surfaces by touch.", "spoonbill");
//   OptionSet info = line.options().add_command("info", "Describe a file");
//   info.add_option("FILE", file, "Document (.json)").require();
//   info.add_flag("--json", json, "Print one JSON object");
//   const CommandLine::Parsed parsed = line.parse(arguments);
//
// The variables that options fill, and everything that the functions passed to add_parsed() refer to, must
// exist until parse() has returned. All calls must come from one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace spoonbill {

// A handle to one option or positional argument. The CommandLine owns the option; copies of the handle refer
// to the same option.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option* option) : option_(option) {}

  // Requires this option: a command line without it is a usage error.
  CommandOption require() const;
  // Sets the name that --help shows for the type of the value.
  CommandOption show_as(const std::string& form) const;
  // Limits the value: a value outside the range is a usage error.
  CommandOption limit(Range<int> range) const;
  CommandOption limit(Range<double> range) const;
  CommandOption limit(Range<std::uint64_t> range) const;
  // Requires another option: this option without the other is a usage error.
  CommandOption need(CommandOption other) const;
  // Forbids another option: both together are a usage error.
  CommandOption exclude(CommandOption other) const;

 private:
  CLI::Option* option_;
};

// A handle to the options and subcommands of the program or of one command. A name that begins with dashes
// is an option, any other a positional argument.
class OptionSet {
 public:
  // Parses one value. An error is a usage error; its message is shown after the option's name.
  using Parse = std::function<Status(const std::string&)>;
  using ParseList = std::function<Status(const std::vector<std::string>&)>;

  explicit OptionSet(CLI::App* parser) : parser_(parser) {}

  OptionSet add_command(const std::string& name, const std::string& description) const;
  CommandOption add_flag(const std::string& name, bool& value, const std::string& help) const;
  CommandOption add_option(const std::string& name, std::string& value, const std::string& help) const;
  CommandOption add_option(const std::string& name, std::filesystem::path& value,
                           const std::string& help) const;
  CommandOption add_option(const std::string& name, std::vector<std::filesystem::path>& value,
                           const std::string& help) const;
  CommandOption add_option(const std::string& name, int& value, const std::string& help) const;
  CommandOption add_option(const std::string& name, std::uint64_t& value, const std::string& help) const;
  CommandOption add_option(const std::string& name, std::optional<int>& value, const std::string& help) const;
  CommandOption add_option(const std::string& name, std::optional<double>& value,
                           const std::string& help) const;
  // Calls `parse` with the text of an option that may be given once.
  CommandOption add_parsed(const std::string& name, const Parse& parse, const std::string& help) const;
  // Calls `parse` with all texts of an option that may be given several times.
  CommandOption add_parsed_list(const std::string& name, const ParseList& parse,
                                const std::string& help) const;

  // Returns an option that has been added to this set.
  CommandOption option(const std::string& name) const;
  // Sets the text that --help shows below the options.
  void set_footer(const std::string& text) const;
  // Sets the heading under which --help lists this command; an empty one hides the command.
  void set_group(const std::string& heading) const;
  // Requires a subcommand: a command line without one is a usage error.
  void require_command() const;
  // Sets a check that runs after all options have been read, whatever their order. A failed check is a usage
  // error, and its message is shown as it is.
  void set_final_check(const std::function<Status()>& check) const;

  std::string name() const;
  // Returns true if the command line named this command. Valid after parse().
  bool is_chosen() const;

 private:
  CLI::App* parser_;
};

// Adds an option. `parse` turns its text into a Result, `store` receives the value, and `form` is the type
// that --help shows.
template <class Parse, class Store>
CommandOption add_parsed_option(OptionSet parser, const std::string& name, const char* form,
                                const Parse& parse, const Store& store, const std::string& help) {
  return parser
      .add_parsed(
          name,
          [=](const std::string& text) -> Status {
            auto value = parse(text);
            if (!value) return value.error();
            store(value.value());
            return {};
          },
          help)
      .show_as(form);
}

class CommandLine {
 public:
  enum class Outcome {
    parsed,
    answered,  // --help or --version: `text` is the answer
    wrong_use  // `text` is one line: what is wrong and which --help to read
  };
  struct Parsed {
    Outcome outcome = Outcome::parsed;
    std::string text;
  };

  CommandLine(const std::string& description, const std::string& name);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  OptionSet options() const;
  // Sets the text that --version prints.
  void set_version(const std::string& text);
  // Parses the arguments, which exclude the program's name.
  Parsed parse(const std::vector<std::string>& arguments);

 private:
  std::unique_ptr<CLI::App> root_;
};

}  // namespace spoonbill
