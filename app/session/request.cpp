#include "app/session/request.h"

#include <algorithm>
#include <array>
#include <utility>

#include "app/view/view_choice.h"
#include "engine/exchange/document.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {
namespace {

constexpr std::size_t longest_mark_name = 64;

bool may_stand_in_a_mark(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

struct PlainRequest {
  const char* name;
  Request request;
};

const std::array<PlainRequest, 3>& plain_requests() {
  static const std::array<PlainRequest, 3> all = {
      {{"undo", UndoStroke{}}, {"redo", RedoStroke{}}, {"cancel_stroke", CancelStroke{}}}};
  return all;
}

Result<Request> read_mark(const TimedCommand& timed, FileMarkKind kind) {
  FieldReader reader(timed.command, timed.origin);
  reader.ignore("command");
  MarkFile mark{kind, reader.text("name")};
  if (reader.status() && mark_name_of(mark.name) != mark.name) {
    reader.refuse("name", "must have 1 to 64 letters, digits, - and _");
  }
  reader.finish();
  if (!reader.status()) return reader.status().error();
  return Request(std::move(mark));
}

Result<Request> read_view_command(const TimedCommand& timed) {
  ViewChoice scratch;
  if (Status read = apply_view_command(timed.command, timed.origin, scratch); !read) return read.error();
  return Request(ChangeView{timed.command});
}

Result<Request> read_simulation_command(const TimedCommand& timed) {
  auto command = command_from_json(timed.command, timed.origin);
  if (!command) return command.error();
  return Request(std::move(command).value());
}

struct JsonOf {
  Json operator()(const Command& command) const { return command_to_json(command); }
  Json operator()(const UndoStroke&) const { return {{"command", "undo"}}; }
  Json operator()(const RedoStroke&) const { return {{"command", "redo"}}; }
  Json operator()(const CancelStroke&) const { return {{"command", "cancel_stroke"}}; }
  Json operator()(const ChangeView& change) const { return change.command; }
  Json operator()(const MarkFile& mark) const {
    return {{"command", mark.kind == FileMarkKind::document ? "save" : "screenshot"}, {"name", mark.name}};
  }
};

}  // namespace

Result<Request> request_from_json(const TimedCommand& timed) {
  if (is_simulation_command(timed.command)) return read_simulation_command(timed);
  if (is_view_command(timed.command)) return read_view_command(timed);
  FieldReader reader(timed.command, timed.origin);
  const std::string name = reader.text("command");
  if (!reader.status()) return reader.status().error();
  if (name == "save") return read_mark(timed, FileMarkKind::document);
  if (name == "screenshot") return read_mark(timed, FileMarkKind::picture);
  for (const PlainRequest& plain : plain_requests()) {
    if (name != plain.name) continue;
    reader.finish();
    if (!reader.status()) return reader.status().error();
    return plain.request;
  }
  reader.refuse("command", "is " + json_excerpt(Json(name)) +
                               ", must be one of save, screenshot, undo, redo, cancel_stroke, set_camera, "
                               "set_overlays, " +
                               simulation_command_names());
  return reader.status().error();
}

Json request_to_json(const Request& request) {
  return std::visit(JsonOf{}, request);
}

std::string mark_name_of(const std::string& text) {
  std::string name = text.substr(0, longest_mark_name);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return !may_stand_in_a_mark(c); }, '-');
  return name.empty() ? "unnamed" : name;
}

}  // namespace spoonbill
