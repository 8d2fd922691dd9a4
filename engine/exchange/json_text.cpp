#include "engine/exchange/json.h"

namespace spoonbill {

namespace {

constexpr std::size_t page_width = 110;
constexpr std::size_t excerpt_limit = 40;

std::string escaped(const std::string& text) {
  return json_to_line(Json(text));
}

// One line with a space after each comma and colon; gives up beyond `width`.
bool append_spaced(const Json& json, std::size_t width, std::string& out) {
  if (json.is_object() || json.is_array()) {
    out += json.is_object() ? '{' : '[';
    bool first = true;
    for (const auto& item : json.items()) {
      if (!first) out += ", ";
      first = false;
      if (json.is_object()) out += escaped(item.key()) + ": ";
      if (!append_spaced(item.value(), width, out)) return false;
    }
    out += json.is_object() ? '}' : ']';
  } else {
    out += json_to_line(json);
  }
  return out.size() <= width;
}

// `before` is what already stands on the first line.
void append_page(const Json& json, std::size_t indent, std::size_t before, std::string& out) {
  std::string line;
  const bool structured = json.is_object() || json.is_array();
  if (!structured || json.empty() || append_spaced(json, page_width - std::min(page_width, before), line)) {
    out += structured ? (json.empty() ? json_to_line(json) : line) : json_to_line(json);
    return;
  }
  const std::string margin(indent + 2, ' ');
  out += json.is_object() ? "{\n" : "[\n";
  bool first = true;
  for (const auto& item : json.items()) {
    if (!first) out += ",\n";
    first = false;
    const std::string name = json.is_object() ? escaped(item.key()) + ": " : "";
    out += margin + name;
    append_page(item.value(), indent + 2, margin.size() + name.size(), out);
  }
  out += "\n" + std::string(indent, ' ') + (json.is_object() ? "}" : "]");
}

}  // namespace

std::string json_to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string json_to_page(const Json& json) {
  std::string page;
  append_page(json, 0, 0, page);
  page += '\n';
  return page;
}

std::string json_excerpt(const Json& json) {
  if (json.is_object()) return "an object";
  if (json.is_array()) return "a list of " + std::to_string(json.size());
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > excerpt_limit) text = text.substr(0, excerpt_limit) + "...";
  return text;
}

}  // namespace spoonbill
