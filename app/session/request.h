// Requests: everything that a person at the panel or keys, a script or a recording may ask of a session
// between two ticks. Plain values, with one JSON form each:
//   the simulation's commands (engine/exchange/document.h)     the view's (app/view/view_choice.h)
//   {"command": "undo"}    {"command": "redo"}    {"command": "cancel_stroke"}
//   {"command": "save", "name": "bent"}           the document as it is then
//   {"command": "screenshot", "name": "bent"}     the next frame
// A replay writes the last two as saved-NAME.json and picture-NAME.png into its own output folder, whatever
// file they went to when they were recorded. Names have 1 to 64 letters, digits, - and _.
#pragma once

#include <string>
#include <variant>

#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/scene/scene.h"
#include "haptic/recording.h"

namespace spoonbill {

struct UndoStroke {};
struct RedoStroke {};
struct CancelStroke {};

// One of the view's commands, known to be valid.
struct ChangeView {
  Json command;
};

enum class FileMarkKind { document, picture };
struct MarkFile {
  FileMarkKind kind = FileMarkKind::document;
  std::string name;
};

using Request = std::variant<Command, UndoStroke, RedoStroke, CancelStroke, ChangeView, MarkFile>;

// An error names the command's origin and the field.
Result<Request> request_from_json(const TimedCommand& timed);
Json request_to_json(const Request& request);

// A name as above, made from any text, such as a file's.
std::string mark_name_of(const std::string& text);

}  // namespace spoonbill
