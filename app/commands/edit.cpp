#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/edit/editor.h"

namespace spoonbill {
namespace {

constexpr Range<int> window_size_range{320, 7680};

Status edit_model(const EditSettings& settings, Console& console) {
  std::error_code ignored;
  if (std::filesystem::equivalent(settings.recording, settings.model, ignored)) {
    return Error{ErrorCode::inconsistent,
                 settings.recording.string() + ": is the model itself; record to another file", "--record"};
  }
  auto editor = Editor::make(settings);
  if (!editor) return editor.error();
  const LoopFigures figures = editor.value()->figures();
  if (!figures.notice.empty()) console.err << "spoonbill: " << one_line(figures.notice) << '\n';
  return editor.value()->run();
}

}  // namespace

CommandEntry add_edit(OptionSet root) {
  auto settings = std::make_shared<EditSettings>();
  // Tests that control the window from another process set this variable.
  if (const char* log = std::getenv("SPOONBILL_FRAME_LOG")) settings->log = log;
  const OptionSet parser = root.add_command("edit", "Sculpt a model by touch in a window");
  parser.set_footer(
      "The mouse moves the tool: press to push in, drag to bend; F1 shows the keys. A SpaceMouse moves it\n"
      "while spacenavd runs. Without MODEL, the bundled spoon handle opens. The program saves a recovery\n"
      "copy every second and offers it after a crash.\n"
      "Example: spoonbill edit assets/models/spoon-handle.json");
  parser.add_option("MODEL", settings->model, "Document (.json); default: the bundled spoon handle");
  parser
      .add_parsed(
          "--size",
          [settings](const std::string& text) -> Status {
            const auto size = parse_extent(text, window_size_range, "1280x720");
            if (!size) return size.error();
            settings->width = size->width;
            settings->height = size->height;
            return {};
          },
          "Window size in pixels, each from 320 to 7680; default: 1280x720")
      .show_as("WxH");
  parser
      .add_option("--scale", settings->scale,
                  "Scale of the interface, from 1 to 4; default: that of the display")
      .limit(Range<double>{1.0, 4.0});
  parser
      .add_parsed(
          "--quality",
          [settings](const std::string& text) -> Status {
            const auto quality =
                parse_choice<std::optional<FrameQuality>>(text, {{"automatic", std::nullopt},
                                                                 {"full", FrameQuality::full},
                                                                 {"lowest", FrameQuality::coarse}});
            if (!quality) return quality.error();
            settings->quality = quality.value();
            return {};
          },
          "Quality of the frames: full, lowest, or automatic (default), which lowers it to hold 60 Hz")
      .show_as("NAME");
  parser
      .add_parsed(
          "--navigation",
          [settings](const std::string& text) -> Status {
            const auto preset = find_navigation(text);
            if (!preset) return preset.error();
            settings->navigation = preset.value();
            return {};
          },
          "Mouse navigation of the camera: rhino (default), blender or sculptgl")
      .show_as("NAME");
  parser.add_option("--record", settings->recording, "File to which the session is recorded; default: none")
      .show_as("FILE");
  add_instruction_set_option(parser, settings->instruction_set);
  return {parser, [settings](Console& console) { return edit_model(*settings, console); }};
}

}  // namespace spoonbill
