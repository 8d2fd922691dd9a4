#include "app/commands/command.h"

#include <string>
#include <system_error>

#include "app/frames/frame_painter.h"
#include "engine/base/text.h"
#include "engine/exchange/file_format.h"

namespace spoonbill {

void add_json_option(OptionSet parser, bool& json) {
  parser.add_flag("--json", json, "Print one JSON object instead of lines for people");
}

CommandOption add_document_output(OptionSet parser, std::filesystem::path& out, const std::string& help,
                                  const std::string& option) {
  const auto parse = [&out, option](const std::string& text) -> Status {
    out = text;
    if (format_from_name(out) == FileFormat::document) return {};
    return Error{
        ErrorCode::unsupported,
        "'" + excerpt(text) +
            "' does not end in .json, as documents must; use `spoonbill convert` to write CAD files and "
            "meshes",
        option};
  };
  return parser.add_parsed(option, parse, help).show_as("FILE");
}

void add_force_option(OptionSet parser, OutputOptions& how) {
  parser.add_flag("--force", how.replaces_read_only, "Replace the output even if it is read-only");
}

Status check_output(const std::filesystem::path& out, const OutputOptions& how) {
  return how.replaces_read_only ? Status() : check_replaceable(out);
}

Status check_is_not_source(const std::filesystem::path& out, const std::filesystem::path& source,
                           const std::string& option) {
  std::error_code ignored;
  if (!std::filesystem::equivalent(source, out, ignored)) return {};
  return Error{ErrorCode::inconsistent, out.string() + ": is the source itself; choose another name", option};
}

Status make_folder(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (!std::filesystem::is_directory(folder)) {
    return Error{ErrorCode::unwritable,
                 folder.string() + ": the folder cannot be made: " + failure.message()};
  }
  return {};
}

void add_log_option(OptionSet parser, std::filesystem::path& log) {
  parser
      .add_option(
          "--log", log,
          "CSV file for the poses, forces, contact areas, speeds and energies of the bodies after each "
          "tick; default: none")
      .show_as("FILE");
}

void add_size_option(OptionSet parser, Extent& size, const std::string& help) {
  const auto parse = [](const std::string& text) {
    return parse_extent(text, picture_size_range, "1280x720");
  };
  add_parsed_option(
      parser, "--size", "WxH", parse, [&size](const Extent& parsed) { size = parsed; },
      help + " in pixels, each from 64 to 7680; default: 1280x720");
}

PictureSize FrameOptions::picture_size() const {
  return {size.width, size.height, has_panel};
}

void add_frame_options(OptionSet parser, FrameOptions& frames) {
  add_size_option(parser, frames.size, "Frame size");
  parser.add_flag("--panel", frames.has_panel, "Show the panel beside the scene; it needs 750x700 pixels");
  parser.add_option("--every", frames.every, "Interval between drawn frames; default: 1, range: 1 to 1000000")
      .limit(Range<std::uint64_t>{1, 1000000})
      .show_as("N");
}

void add_instruction_set_option(OptionSet parser, InstructionSet& set) {
  std::string names;
  for (const InstructionSet available : available_instruction_sets()) {
    names += (names.empty() ? "" : ", ") + std::string(name_of(available));
  }
  const auto choose = [&set, names](const std::string& name) -> Status {
    for (const InstructionSet available : available_instruction_sets()) {
      if (name_of(available) != name) continue;
      set = available;
      return {};
    }
    return Error{ErrorCode::unavailable,
                 "'" + excerpt(name) + "' is not an instruction set of this processor; choose from " + names,
                 "--instruction-set"};
  };
  parser
      .add_parsed("--instruction-set", choose,
                  "Vector instructions to compute with: " + names +
                      "; default: the widest. The result is the same for each")
      .show_as("NAME");
}

}  // namespace spoonbill
