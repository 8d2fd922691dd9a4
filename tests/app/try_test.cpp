// Tests the try command.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "engine/inspection/mass_properties.h"
#include "engine/trial/trial.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

const std::string jelly_on_spoon = std::string(SPOONBILL_ASSETS) + "/models/jelly-on-spoon.json";

TEST(Try, TellsWhereTheJellyIs) {
  const Workplace place;
  const Outcome outcome = run({"try", jelly_on_spoon, "--seconds", "0.1", "--json", "--out",
                               place.text("frames"), "--every", "30", "--size", "320x180"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["inertia_scale"], 1.0);
  EXPECT_EQ(facts["inverted_cells"], 0);
  EXPECT_TRUE(facts["settled"].get<bool>());
  EXPECT_TRUE(facts["stopped"].is_null());
  EXPECT_LT(facts["largest_speed_m_per_s"].get<double>(), 1e-3);
  ASSERT_EQ(facts["bodies"].size(), 2u);
  EXPECT_EQ(facts["bodies"][1]["kind"], "fixed");
  const double carried_n = facts["bodies"][0]["contact_force_n"][1].get<double>();
  EXPECT_GT(carried_n, 0.0);
  EXPECT_NEAR(facts["bodies"][1]["contact_force_n"][1].get<double>(), -carried_n, 1e-6 * carried_n);
  EXPECT_NEAR(facts["bodies"][0]["outside_fraction"].get<double>(), 0.0, 1e-3);
  EXPECT_TRUE(facts["bodies"][0]["first_spill_s"].is_null());
  EXPECT_FALSE(facts["bodies"][1].contains("first_spill_s"));  // the bowl does not leave itself
  const double radius_m = facts["bodies"][0]["contact_radius_m"].get<double>();
  EXPECT_GT(radius_m, facts["bodies"][0]["smallest_contact_radius_m"].get<double>());
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(facts["bodies"][1]["contact_radius_m"], 0.0);
  EXPECT_TRUE(std::filesystem::exists(place.path("frames") / "frame-0000.png"));
  // The last frame shows the end, although no frame is due there.
  const auto ticks = facts["ticks"].get<std::uint64_t>();
  const std::uint64_t last = (ticks * 60 + 999) / 1000;
  EXPECT_EQ(facts["frames"].get<std::uint64_t>(), (last - 1) / 30 + 2);
  const std::string name = "frame-" + std::to_string(10000 + last).substr(1) + ".png";
  EXPECT_TRUE(std::filesystem::exists(place.path("frames") / name)) << name;
}

TEST(Try, WarnsOfAContactThatIsTooSmallForItsCells) {
  const Workplace place;
  Document document = read_document(jelly_on_spoon).value();
  document.scene.bodies[0].lattice.counts = {{3, 3, 4}};
  place.write("coarse.json", json_to_page(document_to_json(document)));
  const Outcome outcome = run({"try", place.text("coarse.json"), "--seconds", "0", "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_NE(outcome.err.find("jelly"), std::string::npos);
  EXPECT_NE(outcome.err.find("nodes"), std::string::npos);
  const Json body = json_of(outcome.out)["bodies"][0];
  EXPECT_LT(body["contact_radius_m"].get<double>(), body["smallest_contact_radius_m"].get<double>());
  const Json info = json_of(run({"info", place.text("coarse.json"), "--json"}).out);
  EXPECT_EQ(info["achieved"][0]["smallest_contact_radius_m"], body["smallest_contact_radius_m"]);
}

TEST(Try, DividesTheStep) {
  const Outcome outcome = run({"try", jelly_on_spoon, "--seconds", "0", "--step-division", "2", "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(json_of(outcome.out)["substeps"], 12);
}

// A model without the body that the trial lowers has no trial.
TEST(Try, TheTrialGoesWithItsBodies) {
  const Workplace place;
  const std::string spoon = place.text("spoon.json");
  ASSERT_EQ(run({"convert", jelly_on_spoon, spoon, "--bodies", "2"}).code, exit_done);
  EXPECT_FALSE(read_document(spoon).value().scene.trial.has_value());
  EXPECT_EQ(run({"try", spoon}).code, exit_failed);  // nothing deforms
}

TEST(Try, NamesTheBodyThatNothingBears) {
  const Workplace place;
  Document document = read_document(jelly_on_spoon).value();
  document.scene.bodies.pop_back();
  document.scene.trial->turned_body.clear();
  document.scene.trial->lowering_speed_m_per_s = 1.0;
  document.scene.bodies[0].lattice.counts = {{3, 3, 4}};
  place.write("falls.json", json_to_page(document_to_json(document)));
  const Outcome outcome = run({"try", place.text("falls.json"), "--json"});
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_NE(json_of(outcome.out)["stopped"].get<std::string>().find("jelly"), std::string::npos);
  document.scene.planes = {FixingPlane{Vector3(0.134, 0.0, 0.0), Vector3::UnitX()}};
  place.write("held.json", json_to_page(document_to_json(document)));
  const Outcome held = run({"try", place.text("held.json")});
  EXPECT_EQ(held.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(held)) << held.err;
}

// The fields of a log by column, for each row of a body.
using LogRows = std::vector<std::map<std::string, std::string>>;

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream text(line + ',');
  for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
  return fields;
}

LogRows read_log(const std::filesystem::path& file, const std::string& body) {
  std::ifstream text(file);
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = split(line);
  LogRows rows;
  while (std::getline(text, line)) {
    const std::vector<std::string> fields = split(line);
    EXPECT_EQ(fields.size(), names.size()) << line;
    if (fields.size() != names.size() || fields[2] != body) continue;
    auto& row = rows.emplace_back();
    for (std::size_t f = 0; f < fields.size(); ++f) row[names[f]] = fields[f];
  }
  return rows;
}

double number(const std::map<std::string, std::string>& row, const char* column) {
  return std::stod(row.at(column));
}

// The bundled jelly without its spoon, of a few nodes.
Document coarse_jelly() {
  Document document = read_document(jelly_on_spoon).value();
  document.scene.bodies.pop_back();
  document.scene.trial.reset();
  document.scene.bodies[0].lattice.counts = {{5, 4, 6}};
  return document;
}

// A coarse elastic block falls onto the ground by a millimetre and comes to rest.
TEST(Try, LogsEachTick) {
  const Workplace place;
  Document document = coarse_jelly();
  document.scene.bodies[0].material.relaxing_fraction = 0.0;
  document.scene.ground = Ground{Vector3(0.0, 0.001, 0.0), Vector3::UnitY(), 0.3};
  place.write("block.json", json_to_page(document_to_json(document)));
  const std::filesystem::path log = place.path("run.csv");
  const Outcome outcome =
      run({"try", place.text("block.json"), "--seconds", "0.1", "--log", log.string(), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["log"], log.string());
  const LogRows rows = read_log(log, "jelly");
  ASSERT_EQ(rows.size(), facts["ticks"].get<std::size_t>());
  const auto& first = rows.front();
  const auto& last = rows.back();
  EXPECT_EQ(first.at("tick"), "1");
  EXPECT_EQ(first.at("time_s"), "0.001");
  EXPECT_EQ(first.at("kind"), "deformable");
  EXPECT_TRUE(first.at("qw").empty());
  EXPECT_EQ(number(first, "ground_y_n"), 0.0);
  EXPECT_EQ(number(first, "contact_area_m2"), 0.0);
  EXPECT_NEAR(number(last, "ground_y_n"), facts["bodies"][0]["ground_force_n"][1].get<double>(), 1e-4);
  EXPECT_EQ(number(last, "largest_speed_m_per_s"), facts["largest_speed_m_per_s"].get<double>());
  EXPECT_EQ(number(last, "centre_y_m"), facts["bodies"][0]["centre_of_mass_m"][1].get<double>());
  EXPECT_EQ(number(last, "energy_j"), facts["energy_j"].get<double>());
  EXPECT_LT(number(last, "energy_j"), number(first, "energy_j"));
  EXPECT_GT(number(last, "contact_area_m2"), 1e-5);
  EXPECT_LT(number(last, "contact_area_m2"), 0.028 * 0.022);
  EXPECT_EQ(last.at("inverted_cells"), "0");
  EXPECT_EQ(first.at("phase"), "settling");
  EXPECT_EQ(last.at("phase"), "watching");
}

// A block that a fixing plane holds at one end sags, and the plane bears its weight.
TEST(Try, LogsTheForceOfAFixingPlane) {
  const Workplace place;
  Document document = coarse_jelly();
  const std::vector<double>& x_m = document.scene.bodies[0].surface.net.x;
  const auto [low_m, high_m] = std::minmax_element(x_m.begin(), x_m.end());
  const Vector3 on_plane_m(0.8 * *low_m + 0.2 * *high_m, 0.0, 0.0);
  document.scene.planes = {FixingPlane{on_plane_m, Vector3::UnitX()}};
  place.write("held.json", json_to_page(document_to_json(document)));
  const Outcome outcome =
      run({"try", place.text("held.json"), "--seconds", "0.5", "--log", place.text("run.csv"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json body = json_of(outcome.out)["bodies"][0];
  const LogRows rows = read_log(place.path("run.csv"), "jelly");
  ASSERT_GT(rows.size(), 500u);
  // `try` reports the mean force of the last half second.
  double mean_n = 0.0;
  for (std::size_t r = rows.size() - 500; r < rows.size(); ++r)
    mean_n += number(rows[r], "support_y_n") / 500.0;
  const double weight_n = compute_body_mass(document.scene.bodies[0])->mass_kg() * standard_gravity_m_per_s2;
  EXPECT_NEAR(mean_n, weight_n, 0.01 * weight_n);
  EXPECT_NEAR(mean_n, body["support_force_n"][1].get<double>(), 0.01 * weight_n);
}

TEST(Try, DoesNotWriteTheLogOverItsDocument) {
  const Workplace place;
  const std::string model = place.text("own.json");
  std::filesystem::copy_file(jelly_on_spoon, model);
  EXPECT_EQ(run({"try", model, "--log", model}).code, exit_failed);
  EXPECT_TRUE(read_document(model).ok());
}

// The log of a replay has a row for the tool, with the force on the hand.
TEST(Try, AReplayLogsTheToolToo) {
  const Workplace place;
  const std::string recording = std::string(SPOONBILL_ASSETS) + "/recordings/contact-stages.recording.jsonl";
  const std::filesystem::path log = place.path("run.csv");
  const Outcome outcome = run({"replay", recording, "--no-frames", "--log", log.string(), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const LogRows rows = read_log(log, "tool");
  ASSERT_EQ(rows.size(), json_of(outcome.out)["ticks"].get<std::size_t>());
  const LogRows handle = read_log(log, "handle");
  ASSERT_EQ(handle.size(), rows.size());
  double largest_n = 0.0, largest_on_handle_n = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    largest_n = std::max(largest_n, std::abs(number(rows[r], "contact_y_n")));
    largest_on_handle_n = std::max(largest_on_handle_n, -number(handle[r], "contact_y_n"));
  }
  EXPECT_GT(largest_n, 0.1);
  EXPECT_LE(largest_n, 3.3);
  // The tool presses it down; the force on the hand is scaled by 60.
  EXPECT_NEAR(largest_on_handle_n, largest_n / 60.0, 0.1 * largest_on_handle_n);
  EXPECT_FALSE(rows.front().at("qw").empty());
}

// On a plate, only friction holds the bundled jelly.
TEST(Try, TheJellyStaysOnATiltedPlate) {
  const Outcome outcome = run({"try", std::string(SPOONBILL_ASSETS) + "/models/jelly-on-plate.json", "--tilt",
                               "10deg", "--seconds", "0.3", "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["inverted_cells"], 0);
  const double angle = 10.0 * std::numbers::pi / 180.0;
  const Json& centre = facts["bodies"][0]["centre_of_mass_m"];
  // Its place along the plate, from which it would slide towards negative values.
  const double along_m =
      centre[0].get<double>() * std::cos(angle) + centre[1].get<double>() * std::sin(angle);
  EXPECT_NEAR(along_m, 0.0, 0.001);
  EXPECT_LT(facts["largest_penetration_m"].get<double>(), 2e-4);
}

TEST(Try, RefusesWrongUse) {
  const Workplace place;
  EXPECT_EQ(run({"try", jelly_on_spoon, "--tilt", "10"}).code, exit_wrong_use);
  EXPECT_EQ(run({"try", jelly_on_spoon, "--tilt", "1000deg"}).code, exit_wrong_use);
  EXPECT_EQ(run({"try", jelly_on_spoon, "--seconds", "-1"}).code, exit_wrong_use);
  EXPECT_EQ(run({"try", jelly_on_spoon, "--step-division", "9"}).code, exit_wrong_use);
  EXPECT_EQ(run({"try", place.text("model.json"), "--tilt", "10deg"}).code, exit_failed);
  EXPECT_EQ(run({"try", place.text("missing.json")}).code, exit_failed);
}

}  // namespace
}  // namespace spoonbill
