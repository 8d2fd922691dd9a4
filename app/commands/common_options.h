// Options that several commands have. What they refer to must live until the command line has been read.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/instruction_set.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace spoonbill {

// --json: one JSON object on standard output and nothing else there.
void add_json_option(CLI::App& parser, bool& json);

// --out: the document to write, whose name must end in .json; wrong use otherwise, so that no file of another
// kind is replaced by one.
CLI::Option* add_document_output(CLI::App& parser, std::filesystem::path& out,
                                 const std::string& help = "The document to write (.json)");

// --instruction-set: one that this processor has; wrong use otherwise.
void add_instruction_set_option(CLI::App& parser, InstructionSet& set);

}  // namespace spoonbill
