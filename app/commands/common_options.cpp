#include "app/commands/common_options.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>

#include "engine/base/excerpt.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {

void add_json_option(CLI::App& parser, bool& json) {
  parser.add_flag("--json", json, "Print one JSON object instead of lines for people");
}

CLI::Option* add_document_output(CLI::App& parser, std::filesystem::path& out, const std::string& help) {
  const auto take = [&out](const std::string& text) {
    out = text;
    if (format_of(out) == "json") return;
    throw CLI::ValidationError("--out", "'" + excerpt(text) +
                                            "' does not end in .json, as documents do; `spoonbill convert` "
                                            "makes CAD files and meshes of them");
  };
  return parser.add_option_function<std::string>("--out", take, help)->type_name("FILE");
}

void add_instruction_set_option(CLI::App& parser, InstructionSet& set) {
  std::string names;
  for (const InstructionSet available : available_instruction_sets()) {
    names += (names.empty() ? "" : ", ") + std::string(name_of(available));
  }
  const auto choose = [&set, names](const std::string& name) {
    for (const InstructionSet available : available_instruction_sets()) {
      if (name_of(available) != name) continue;
      set = available;
      return;
    }
    throw CLI::ValidationError("--instruction-set",
                               "'" + name + "' is not one that this processor has: " + names);
  };
  parser
      .add_option_function<std::string>("--instruction-set", choose,
                                        "Vector instructions to compute with (" + names +
                                            "); the widest unless told. The result is the same")
      ->type_name("NAME");
}

}  // namespace spoonbill
