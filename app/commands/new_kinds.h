// The kinds of shape that `spoonbill new` makes, each a command of its own below it. What they refer to must
// live until the command line has been read.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/option_set.h"
#include "engine/base/result.h"
#include "engine/shapes/exact_shape.h"

namespace spoonbill {

struct NewShape {
  ExactShape shape;
  std::optional<double> shell_thickness_m = {};  // of an open one
  double reach_m = 0.0;                          // as of a lump; 0 where it is not known
};

struct NewKind {
  OptionSet parser;
  std::function<Result<NewShape>()> make;
};

// Those of a few sizes: sphere, box, cylinder, cone, plate, torus.
std::vector<NewKind> add_lump_kinds(OptionSet parser);
// Those made from points: tube, lathe, loft.
std::vector<NewKind> add_swept_kinds(OptionSet parser);

// An option that is a length, once the command line has been read.
using Length = std::shared_ptr<std::optional<double>>;
Length add_length(OptionSet parser, const std::string& name, const std::string& help);

}  // namespace spoonbill
