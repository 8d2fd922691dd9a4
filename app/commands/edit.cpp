#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "app/commands/command.h"
#include "app/commands/common_options.h"
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

CommandEntry add_edit(CLI::App& root) {
  auto settings = std::make_shared<EditSettings>();
  CLI::App* parser = root.add_subcommand("edit", "Shape a model by touch, in a window");
  parser->footer(
      "The mouse holds the tool: press to push in, drag to bend, F1 shows the keys. A SpaceMouse steers it\n"
      "when spacenavd runs. Without a model the bundled spoon handle opens. Work is autosaved every second\n"
      "and offered again after a crash.\n"
      "Example: spoonbill edit assets/models/spoon-handle.json");
  parser->add_option("MODEL", settings->model, "A document (.json)");
  parser
      ->add_option_function<std::string>(
          "--size",
          [settings](const std::string& text) {
            const auto size = parse_extent(text, window_side_range, "1280x720");
            if (!size) throw CLI::ValidationError("--size", size.error().message);
            settings->width = size->width;
            settings->height = size->height;
          },
          "The window's size; 1280x720 unless told")
      ->type_name("WxH");
  parser->add_option("--scale", settings->scale, "The interface's scale, where the display does not tell it")
      ->check(CLI::Range(1.0, 4.0).description(""));
  parser
      ->add_option_function<std::string>(
          "--navigation",
          [settings](const std::string& text) {
            const auto preset = navigation_named(text);
            if (!preset) throw CLI::ValidationError("--navigation", preset.error().message);
            settings->navigation = preset.value();
          },
          "How the mouse moves the camera: rhino (default), blender or sculptgl")
      ->type_name("NAME");
  parser->add_option("--record", settings->recording, "Record the session from its start")->type_name("FILE");
  add_instruction_set_option(*parser, settings->instruction_set);
  return {parser, [settings](Console& console) { return edit(*settings, console); }};
}

}  // namespace spoonbill
