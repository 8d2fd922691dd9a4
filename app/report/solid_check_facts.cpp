#include "app/report/solid_check_facts.h"

#include <algorithm>
#include <map>
#include <string>

#include "app/report/check_facts.h"
#include "app/report/quantity_text.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

// What rounding alone leaves between faces that meet.
constexpr double least_gap_m = 1e-8;

std::string faces_text(std::size_t count) {
  return "solid of " + count_text(count, "face", "faces");
}

// Nothing of a solid whose faces are of several materials: which is where, nobody says.
void add_mass(FactSheet& facts, const CadSolid& solid, const std::vector<Body>& bodies, Json& json) {
  const Material& material = bodies[solid.places.front()].material;
  const bool is_one = std::all_of(solid.places.begin(), solid.places.end(), [&](std::size_t place) {
    const Material& other = bodies[place].material;
    return other.name == material.name && other.density_kg_per_m3 == material.density_kg_per_m3;
  });
  if (!is_one) {
    facts.add("  Mass", "unknown: its faces are of several materials; give them one", "", nullptr);
    return;
  }
  const double mass_kg = solid.volume_m3 * material.density_kg_per_m3;
  facts.add("  Mass", grams_text(mass_kg) + " of " + material.name, "", nullptr);
  json["mass_kg"] = mass_kg;
  json["materials"] = {material.name};
}

Json numbers(const Vector3& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

std::vector<std::string> problems_of(const SolidCheck& check) {
  std::vector<std::string> problems;
  if (!check.self_intersections.empty()) {
    const SolidSelfIntersection& deepest = check.self_intersections.front();
    problems.push_back("passes through itself at " + position_text(deepest.position_m) + ", by at least " +
                       short_length_text(deepest.depth_m));
  }
  if (!check.self_intersections_complete) {
    problems.emplace_back("may pass through itself: too many places are near each other to be searched");
  }
  return problems;
}

void add_self_meetings(const SolidCheck& check, Json& json) {
  json["self_intersections"] = Json::array();
  for (const SolidSelfIntersection& meeting : check.self_intersections) {
    json["self_intersections"].push_back(
        {{"depth_m", meeting.depth_m}, {"point_m", numbers(meeting.position_m)}});
  }
  json["self_intersections_complete"] = check.self_intersections_complete;
}

// Another wall may seem thicker than it is by what the mesh misses both of its sides by.
void add_thickness(FactSheet& facts, const CadSolid& solid, const SolidCheck& check, Json& json) {
  if (!check.thinnest) {
    facts.add("  Thinnest", no_walls, "", nullptr);
    json["smallest_thickness_m"] = nullptr;
    return;
  }
  const WallThickness& thin = *check.thinnest;
  const double error_m = 2.0 * solid.chord_error_m;
  const std::string within =
      error_m > least_gap_m ? ", nowhere less by more than " + short_length_text(error_m) : "";
  facts.add("  Thinnest", short_length_text(thin.thickness_m) + " at " + position_text(thin.position_m) + within,
            "", nullptr);
  json["smallest_thickness_m"] = thin.thickness_m;
  json["thickness_error_m"] = error_m;
  json["thinnest"] = {{"point_m", numbers(thin.position_m)}, {"opposite_m", numbers(thin.opposite_m)}};
}

}  // namespace

Json add_solid_check_facts(FactSheet& facts, const CadSolid& solid, const SolidCheck& check,
                           const std::vector<Body>& bodies) {
  const std::vector<std::string> problems = problems_of(check);
  Json json = {{"name", solid.name},
               {"closed", true},
               {"sound", problems.empty()},
               {"problems", problems},
               {"bodies", Json::array()}};
  for (const std::size_t place : solid.places) json["bodies"].push_back(bodies[place].name);
  facts.add("Solid", solid.name + ": closed, " + faces_text(solid.places.size()), "", nullptr);
  for (const std::string& problem : problems) facts.add("  Problem", problem, "", nullptr);
  if (solid.gap_m > least_gap_m) {
    facts.add("  Gaps", "up to " + short_length_text(solid.gap_m) + " between faces", "", nullptr);
  }
  facts.add("  Area", area_text(solid.area_m2), "", nullptr);
  facts.add("  Volume", volume_text(solid.volume_m3), "", nullptr);
  json["gap_m"] = solid.gap_m;
  json["area_m2"] = solid.area_m2;
  json["volume_m3"] = solid.volume_m3;
  add_mass(facts, solid, bodies, json);
  facts.add("  Centre of mass", position_text(solid.centre_m), "", nullptr);
  json["centre_of_mass_m"] = numbers(solid.centre_m);
  add_thickness(facts, solid, check, json);
  add_self_meetings(check, json);
  return json;
}

Json add_open_solid_facts(FactSheet& facts, const std::vector<std::size_t>& loose,
                          const std::vector<Body>& bodies) {
  std::map<std::string, Json> names;
  for (const std::size_t place : loose) {
    if (!bodies[place].solid.empty()) names[bodies[place].solid].push_back(bodies[place].name);
  }
  Json all = Json::array();
  for (const auto& [name, faces] : names) {
    facts.add("Solid", name + ": not closed, " + faces_text(faces.size()), "", nullptr);
    all.push_back({{"name", name}, {"closed", false}, {"sound", false}, {"bodies", faces}});
  }
  return all;
}

}  // namespace spoonbill
