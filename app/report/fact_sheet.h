// Facts that a command reports: as aligned lines for a person or as one JSON object for a program.
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "engine/exchange/json.h"

namespace spoonbill {

class FactSheet {
 public:
  // `field` and `value` go to the JSON, `label` and `text` to the lines; an empty field or label leaves that
  // form out.
  void add(const std::string& label, const std::string& text, const std::string& field, Json value);

  void print(std::ostream& out, bool as_json) const;

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
  Json json_ = Json::object();
};

// What is to be said besides: a line each, and the field "remarks", a list of them.
void add_remarks(FactSheet& facts, const std::vector<std::string>& remarks);

}  // namespace spoonbill
