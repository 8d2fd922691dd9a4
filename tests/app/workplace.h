// What the tests of the program work on: a small model, a script and a recording in a folder of their own,
// and the program run as from a shell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/exchange/json.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

// The program in this process.
Outcome run(const std::vector<std::string>& arguments);

// A failure as the command line promises it: exit code 1 or 2 and one line that begins with the program's
// name.
bool is_clean_failure(const Outcome& outcome);

Json json_of(const std::string& text);

class Workplace {
 public:
  Workplace();  // with model.json, and script.json on it

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  std::string text(const std::string& name) const { return path(name).string(); }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    return folder_.write(name, content);
  }

  // Records the script as `name`; 600 ticks in which the sphere presses twice and a command undoes the second
  // stroke.
  std::filesystem::path record(const std::string& name) const;

 private:
  TemporaryFolder folder_;
};

}  // namespace spoonbill
