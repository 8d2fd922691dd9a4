// The options of the command line. CLI11 parses them, behind this header: it is a library of templates that
// takes a source eight seconds to compile.
//
//   CommandLine line("Shape B-spline surfaces by touch.", "spoonbill");
//   OptionSet info = line.options().add_command("info", "Tell what a file holds");
//   info.add_option("FILE", file, "A document").require();
//   info.add_flag("--json", json, "Print one JSON object");
//   const CommandLine::Parsed parsed = line.parse(arguments);
//
// The targets that options write to, and all that their functions refer to, must live until parse() has
// returned. All calls come from one thread.
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

// One option or positional argument. A handle: copies mean the same option, which its CommandLine owns.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option* option) : option_(option) {}

  // The command line must have it.
  CommandOption require() const;
  // Replaces the kind of value that --help shows.
  CommandOption show_as(const std::string& form) const;
  // A value outside the range is wrong use.
  CommandOption limit(Range<int> range) const;
  CommandOption limit(Range<double> range) const;
  CommandOption limit(Range<std::uint64_t> range) const;
  // Wrong use without the other one, or together with it.
  CommandOption need(CommandOption other) const;
  CommandOption exclude(CommandOption other) const;

 private:
  CLI::Option* option_;
};

// The options of the program or of one command, and the commands below it. A handle, as CommandOption is. A
// name that begins with dashes is an option, any other a positional argument.
class OptionSet {
 public:
  // An error is wrong use; the option's name is put before its message.
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
  CommandOption add_option(const std::string& name, std::optional<double>& value,
                           const std::string& help) const;
  // The function receives the text, or all texts where the option may be given several times.
  CommandOption add_parsed(const std::string& name, const Parse& parse, const std::string& help) const;
  CommandOption add_parsed_list(const std::string& name, const ParseList& parse,
                                const std::string& help) const;

  // An option that was added before.
  CommandOption option(const std::string& name) const;
  // The text below the options that --help shows.
  void set_footer(const std::string& text) const;
  // Not shown by --help.
  void hide() const;
  // One of the commands below must be given.
  void require_command() const;
  // Called once all options have been read, in whichever order they came; an error's whole message is what is
  // said.
  void set_final_check(const std::function<Status()>& check) const;

  std::string name() const;
  // Returns true where the command line named this command; valid after parse().
  bool is_chosen() const;

 private:
  CLI::App* parser_;
};

class CommandLine {
 public:
  enum class Outcome {
    parsed,
    answered,  // --help or --version: `text` is the answer
    wrong_use  // `text` is one line that says what is wrong and where to read on
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
  // What --version prints.
  void set_version(const std::string& text);
  // `arguments` without the program's name.
  Parsed parse(const std::vector<std::string>& arguments);

 private:
  std::unique_ptr<CLI::App> root_;
};

}  // namespace spoonbill
