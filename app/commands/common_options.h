// Options that several commands have. What they refer to must live until the command line has been read.
#pragma once

#include "engine/instruction_set.h"

namespace CLI {
class App;
}

namespace spoonbill {

// --json: one JSON object on standard output and nothing else there.
void add_json_option(CLI::App& parser, bool& json);

// --instruction-set: one that this processor has; wrong use otherwise.
void add_instruction_set_option(CLI::App& parser, InstructionSet& set);

}  // namespace spoonbill
