#include "tests/app/workplace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/engine/simulation/handle.h"

namespace spoonbill {
namespace {

const char* const script = R"({
  "spoonbill_script": 1,
  "model": "model.json",
  "steps": [
    {"start_mm": [50, 14, 0]},
    {"command": "place_plane", "point_mm": [20, 0, 0], "normal": [1, 0, 0]},
    {"move_to_mm": [50, 8, 0], "over_s": 0.1},
    {"move_to_mm": [50, 14, 0], "over_s": 0.1},
    {"hold_s": 0.1},
    {"command": "set_overlays", "lattice": true},
    {"move_to_mm": [50, 7, 0], "over_s": 0.1},
    {"move_to_mm": [50, 14, 0], "over_s": 0.1},
    {"command": "undo"},
    {"hold_s": 0.1}
  ]
})";

}  // namespace

Outcome run(const std::vector<std::string>& arguments) {
  std::ostringstream out;
  std::ostringstream err;
  Console console{out, err, false};
  const int code = run_program(arguments, console);
  return {code, out.str(), err.str()};
}

bool is_clean_failure(const Outcome& outcome) {
  return (outcome.code == exit_failed || outcome.code == exit_wrong_use) && outcome.out.empty() &&
         outcome.err.starts_with("spoonbill: ") && outcome.err.ends_with("\n") &&
         std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1;
}

Json json_of(const std::string& text) {
  auto json = parse_json(text, "output");
  EXPECT_TRUE(json) << text;
  return json ? std::move(json).value() : Json();
}

Document held_handle() {
  Document document{"small handle", small_handle(), Json::object()};
  document.scene.bodies[0].lattice = {200, {}};
  document.scene.planes.push_back({Vector3(0.02, 0, 0), Vector3::UnitX()});
  return document;
}

Workplace::Workplace() {
  const Document document{"small handle", small_handle(), Json::object()};
  write("model.json", json_to_page(document_to_json(document)));
  write("script.json", script);
}

std::filesystem::path Workplace::record(const std::string& name) const {
  const Outcome outcome = run({"record", text("script.json"), "--out", text(name)});
  EXPECT_EQ(outcome.code, exit_done) << outcome.err;
  return path(name);
}

}  // namespace spoonbill
