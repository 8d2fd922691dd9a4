#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/edit/editor.h"

namespace spoonbill {
namespace {

constexpr Range<int> window_side_range{320, 7680};

Status edit(const EditSettings& settings, Console& console) {
  std::error_code ignored;
  if (std::filesystem::equivalent(settings.recording, settings.model, ignored)) {
    return Error{settings.recording.string() + ": is the model, record to another file"};
  }
  auto editor = Editor::make(settings);
  if (!editor) return editor.error();
  const LoopFigures figures = editor.value()->figures();
  if (!figures.notice.empty()) console.err << "spoonbill: " << figures.notice << '\n';
  return editor.value()->run();
}

}  // namespace

CommandEntry add_edit(OptionSet root) {
  auto settings = std::make_shared<EditSettings>();
  // For tests that work the window from outside.
  if (const char* log = std::getenv("SPOONBILL_FRAME_LOG")) settings->log = log;
  const OptionSet parser = root.add_command("edit", "Shape a model by touch, in a window");
  parser.set_footer(
      "The mouse holds the tool: press to push in, drag to bend, F1 shows the keys. A SpaceMouse steers it\n"
      "when spacenavd runs. Without a model the bundled spoon handle opens. Work is autosaved every second\n"
      "and offered again after a crash.\n"
      "Example: spoonbill edit assets/models/spoon-handle.json");
  parser.add_option("MODEL", settings->model, "A document (.json)");
  parser
      .add_parsed(
          "--size",
          [settings](const std::string& text) -> Status {
            const auto size = parse_extent(text, window_side_range, "1280x720");
            if (!size) return size.error();
            settings->width = size->width;
            settings->height = size->height;
            return {};
          },
          "The window's size; 1280x720 unless told")
      .show_as("WxH");
  parser.add_option("--scale", settings->scale, "The interface's scale, where the display does not tell it")
      .limit(Range<double>{1.0, 4.0});
  parser
      .add_parsed(
          "--navigation",
          [settings](const std::string& text) -> Status {
            const auto preset = navigation_named(text);
            if (!preset) return preset.error();
            settings->navigation = preset.value();
            return {};
          },
          "How the mouse moves the camera: rhino (default), blender or sculptgl")
      .show_as("NAME");
  parser.add_option("--record", settings->recording, "Record the session from its start").show_as("FILE");
  add_instruction_set_option(parser, settings->instruction_set);
  return {parser, [settings](Console& console) { return edit(*settings, console); }};
}

}  // namespace spoonbill
