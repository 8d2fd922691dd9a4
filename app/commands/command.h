// Declarations of the program's commands, and of options that several commands share. Each function from
// add_new() to add_read_points() declares one command and its options on the root parser. After parsing,
// run() of the returned entry does the work.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/console.h"
#include "engine/base/file.h"
#include "engine/base/processor.h"
#include "engine/base/result.h"

namespace spoonbill {

struct PictureSize;

struct CommandEntry {
  OptionSet parser;
  std::function<Status(Console&)> run;
};

CommandEntry add_new(OptionSet root);
CommandEntry add_fit(OptionSet root);
CommandEntry add_merge(OptionSet root);
CommandEntry add_change(OptionSet root);
CommandEntry add_add(OptionSet root);
CommandEntry add_info(OptionSet root);
CommandEntry add_check(OptionSet root);
CommandEntry add_sample(OptionSet root);
CommandEntry add_collide(OptionSet root);
CommandEntry add_convert(OptionSet root);
CommandEntry add_edit(OptionSet root);
CommandEntry add_record(OptionSet root);
CommandEntry add_replay(OptionSet root);
CommandEntry add_render(OptionSet root);
CommandEntry add_rest(OptionSet root);
CommandEntry add_try(OptionSet root);
CommandEntry add_study(OptionSet root);
CommandEntry add_train(OptionSet root);
CommandEntry add_compare(OptionSet root);
// Internal commands that the program runs as child processes; --help does not list them.
CommandEntry add_read_mesh(OptionSet root);
CommandEntry add_read_points(OptionSet root);

// The variables that the following functions take by reference must exist until the command line has been
// parsed.

// --json: prints one JSON object and nothing else on standard output.
void add_json_option(OptionSet parser, bool& json);

// --out or another option: the document to write. Its name must end in .json; any other ending is a usage
// error, because it would suggest a file of another format.
CommandOption add_document_output(OptionSet parser, std::filesystem::path& out,
                                  const std::string& help = "Document to write (.json)",
                                  const std::string& option = "--out");

// --force: replaces the output even if it is read-only.
void add_force_option(OptionSet parser, OutputOptions& how);

// Returns an error if the output is read-only and may not be replaced. A command calls this function before a
// long computation, so that it fails early. Writing the file repeats the check.
Status check_output(const std::filesystem::path& out, const OutputOptions& how);

// Returns an error if `out` is the file from which the command reads. `option` names the option of `out`.
Status check_is_not_source(const std::filesystem::path& out, const std::filesystem::path& source,
                           const std::string& option);

// Makes the folder of a command's outputs and those above it, unless they exist.
Status make_folder(const std::filesystem::path& folder);

// --log: the file of a RunLog.
void add_log_option(OptionSet parser, std::filesystem::path& log);

// --size: the size of pictures in pixels. `help` begins its description.
void add_size_option(OptionSet parser, Extent& size, const std::string& help);

// How the frames of a replay or a trial are drawn.
struct FrameOptions {
  Extent size{1280, 720};   // in pixels
  std::uint64_t every = 1;  // interval between drawn frames
  bool has_panel = false;

  PictureSize picture_size() const;
};

// --size, --every and --panel.
void add_frame_options(OptionSet parser, FrameOptions& frames);

// --instruction-set: an instruction set that this processor supports; any other is a usage error.
void add_instruction_set_option(OptionSet parser, InstructionSet& set);

}  // namespace spoonbill
