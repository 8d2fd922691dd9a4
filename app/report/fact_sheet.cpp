#include "app/report/fact_sheet.h"

#include <algorithm>

#include "engine/base/text.h"

namespace spoonbill {

Json components_json(const Vector3& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

Json millimetres_json(const Vector3& vector_m) {
  return components_json(1e3 * vector_m);
}

void FactSheet::add(const std::string& label, const std::string& text, const std::string& field, Json value) {
  if (!label.empty()) lines_.emplace_back(label, text);
  if (!field.empty()) json_[field] = std::move(value);
}

void FactSheet::print(std::ostream& out, bool as_json) const {
  if (as_json) {
    out << escaped(json_to_line(json_)) << '\n';
    return;
  }
  std::size_t width = 0;
  for (const auto& [label, text] : lines_) width = std::max(width, label.size());
  for (const auto& [label, text] : lines_) {
    out << escaped(label) << std::string(width - label.size() + 2, ' ') << escaped(text) << '\n';
  }
}

void add_notes(FactSheet& facts, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) facts.add("Note", note, "", nullptr);
  facts.add("", "", "remarks", notes);
}

}  // namespace spoonbill
