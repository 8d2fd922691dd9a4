// The kinds of shape that `spoonbill new` makes, each a command of its own below it. What they refer to must
// live until the command line has been read.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/result.h"
#include "engine/shapes/exact_shape.h"

namespace CLI {
class App;
}

namespace spoonbill {

struct NewShape {
  ExactShape shape;
  std::optional<double> shell_thickness_m = {};  // of an open one
};

struct NewKind {
  CLI::App* parser;  // owned by the one above it
  std::function<Result<NewShape>()> make;
};

std::vector<NewKind> add_new_kinds(CLI::App& parser);

}  // namespace spoonbill
