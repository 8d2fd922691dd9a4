// A temporary folder with a small model, a script and a recording for tests of the program, and functions
// that run the program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/exchange/document.h"
#include "engine/exchange/json.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

// Runs the program in this process.
Outcome run(const std::vector<std::string>& arguments);

// Returns true if the exit code is 1 or 2 and the output is exactly one line of error that begins with the
// program's name.
bool is_clean_failure(const Outcome& outcome);

Json json_of(const std::string& text);

// Returns a small handle that is fixed by one plane. Its lattice is coarse, because a loop of fewer than 200
// ticks a second, as a finer one has under a sanitizer, gets no force.
Document held_handle();

class Workplace {
 public:
  Workplace();  // writes model.json, and script.json for it

  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  std::string text(const std::string& name) const { return path(name).string(); }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    return folder_.write(name, content);
  }

  // Records 600 ticks of the script as `name`: the sphere presses twice, and a command undoes the second
  // stroke.
  std::filesystem::path record(const std::string& name) const;

 private:
  TemporaryFolder folder_;
};

}  // namespace spoonbill
