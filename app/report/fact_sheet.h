// The results of a command, printed as aligned lines for people or as one JSON object for programs.
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// Returns the three components of a vector as a list.
Json components_json(const Vector3& vector);
// Returns them in millimetres.
Json millimetres_json(const Vector3& vector_m);

class FactSheet {
 public:
  // Adds a line of `label` and `text`, and a JSON member `field` with `value`. An empty label omits the line,
  // an empty field omits the member.
  void add(const std::string& label, const std::string& text, const std::string& field, Json value);

  void print(std::ostream& out, bool as_json) const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
  Json json_ = Json::object();
};

// Adds one line per note, and all of them as the list "remarks" in the JSON.
void add_notes(FactSheet& facts, const std::vector<std::string>& notes);

}  // namespace spoonbill
