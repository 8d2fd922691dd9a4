// Options that several commands have. What they refer to must live until the command line has been read.
#pragma once

#include <filesystem>
#include <string>

#include "app/commands/option_set.h"
#include "engine/base/processor.h"

namespace spoonbill {

// --json: one JSON object on standard output and nothing else there.
void add_json_option(OptionSet parser, bool& json);

// --out: the document to write, whose name must end in .json; wrong use otherwise, so that no file of another
// kind is replaced by one.
CommandOption add_document_output(OptionSet parser, std::filesystem::path& out,
                                  const std::string& help = "The document to write (.json)");

// --instruction-set: one that this processor has; wrong use otherwise.
void add_instruction_set_option(OptionSet parser, InstructionSet& set);

}  // namespace spoonbill
