#include "app/report/check_facts.h"

#include <cmath>

#include "app/report/closing_text.h"
#include "app/report/quantity_text.h"
#include "engine/number_text.h"
#include "engine/study/shell_mass.h"

namespace spoonbill {
namespace {

Json numbers(const Vector3& vector) {
  return Json::array({vector.x(), vector.y(), vector.z()});
}

std::string place_text(const Vector3& point_m) {
  const auto text = [](double metres) {
    // Without the sign of a zero.
    const std::string in_mm = millimetres_text(std::round(1e4 * metres) / 1e4 + 0.0);
    return in_mm.substr(0, in_mm.find(' '));
  };
  return "(" + text(point_m.x()) + ", " + text(point_m.y()) + ", " + text(point_m.z()) + ") mm";
}

Json place_json(const CurvaturePlace& place) {
  return {{"per_m", place.curvature_per_m},
          {"u", place.u},
          {"v", place.v},
          {"point_m", numbers(place.position_m)}};
}

// Null where the surface is nowhere curved that way.
Json radius_json(double curvature_per_m) {
  return curvature_per_m > 0.0 ? Json(1.0 / curvature_per_m) : Json(nullptr);
}

void add_radius(FactSheet& facts, const char* label, double curvature_per_m, const CurvaturePlace& place) {
  // Flatter than a kilometre is flat.
  if (!(curvature_per_m > 1e-3)) return;
  facts.add(label, short_length_text(1.0 / curvature_per_m) + " at " + place_text(place.position_m), "",
            nullptr);
}

Json curvature_facts(FactSheet& facts, const CurvatureRange& range) {
  add_radius(facts, "  Smallest convex radius", range.largest.curvature_per_m, range.largest);
  add_radius(facts, "  Smallest hollow radius", -range.smallest.curvature_per_m, range.smallest);
  return {{"smallest", place_json(range.smallest)}, {"largest", place_json(range.largest)}};
}

void add_thickness(FactSheet& facts, const SurfaceCheck& check, Json& json) {
  if (!check.thinnest) return;
  const Thickness& thin = *check.thinnest;
  facts.add("  Thinnest", short_length_text(thin.thickness_m) + " at " + place_text(thin.position_m), "",
            nullptr);
  json["smallest_thickness_m"] = thin.thickness_m;
  json["thinnest"] = {{"u", thin.u},
                      {"v", thin.v},
                      {"point_m", numbers(thin.position_m)},
                      {"opposite_u", thin.opposite_u},
                      {"opposite_v", thin.opposite_v},
                      {"opposite_m", numbers(thin.opposite_m)}};
}

void add_mass(FactSheet& facts, const Body& body, double volume_m3, const Vector3& middle_m, Json& json) {
  const double mass_kg = volume_m3 * body.material.density_kg_per_m3;
  facts.add("  Volume", volume_text(volume_m3), "", nullptr);
  facts.add("  Mass", grams_text(mass_kg) + ", all of it taken as " + body.material.name, "", nullptr);
  facts.add("  Centre of mass", place_text(middle_m), "", nullptr);
  json["volume_m3"] = volume_m3;
  json["mass_kg"] = mass_kg;
  json["centre_of_mass_m"] = numbers(middle_m);
}

void add_content(FactSheet& facts, const Body& body, const SurfaceCheck& check, Json& json) {
  facts.add("  Area", area_text(check.mass.area_m2), "", nullptr);
  json["area_m2"] = check.mass.area_m2;
  if (body.shell_thickness_m) {
    const ShellMass shell = shell_mass(body.surface, *body.shell_thickness_m);
    json["shell_thickness_m"] = *body.shell_thickness_m;
    return add_mass(facts, body, shell.volume_m3, shell.middle_m, json);
  }
  if (check.closing.closedness != Closedness::solid) return;
  json["normals_outward"] = check.mass.volume_m3 > 0.0;
  add_mass(facts, body, std::abs(check.mass.volume_m3), check.mass.middle_m, json);
  add_thickness(facts, check, json);
}

void add_places(const SurfaceCheck& check, Json& json) {
  json["self_intersections"] = Json::array();
  for (const SelfMeeting& meeting : check.self_meetings) {
    json["self_intersections"].push_back({{"u", meeting.u},
                                          {"v", meeting.v},
                                          {"other_u", meeting.other_u},
                                          {"other_v", meeting.other_v},
                                          {"depth_m", meeting.depth_m},
                                          {"point_m", numbers(meeting.position_m)}});
  }
  json["self_intersections_complete"] = check.self_meetings_complete;
  json["degenerate"] = Json::array();
  for (const BadSpot& spot : check.bad_spots) {
    json["degenerate"].push_back(
        {{"u", spot.u}, {"v", spot.v}, {"folds", spot.folds}, {"point_m", numbers(spot.position_m)}});
  }
}

}  // namespace

std::vector<std::string> problems_of(const Body& body, const SurfaceCheck& check) {
  std::vector<std::string> problems;
  const bool solid = check.closing.closedness == Closedness::solid;
  if (!solid && !body.shell_thickness_m) {
    problems.push_back("open by " + short_length_text(check.closing.gap_m) +
                       ", and no shell with a thickness");
  }
  if (solid && !(check.mass.volume_m3 > 0.0)) problems.emplace_back("its normals point inwards");
  if (!check.self_meetings.empty()) {
    problems.push_back("passes through itself in " + std::to_string(check.self_meetings.size()) +
                       " places, one at " + place_text(check.self_meetings[0].position_m));
  }
  if (!check.self_meetings_complete) {
    problems.emplace_back("may pass through itself: too many places are near each other to be searched");
  }
  if (!check.bad_spots.empty()) {
    const BadSpot& spot = check.bad_spots[0];
    problems.push_back(std::string(spot.folds ? "folds over" : "has no area") + " at " +
                       place_text(spot.position_m));
  }
  const double sharpest = check.curvature.largest.curvature_per_m;
  if (body.shell_thickness_m && *body.shell_thickness_m * sharpest >= 1.0) {
    problems.push_back("its shell is thicker than its smallest convex radius, " +
                       short_length_text(1.0 / sharpest));
  }
  return problems;
}

Json add_check_facts(FactSheet& facts, const Body& body, const SurfaceCheck& check) {
  const std::vector<std::string> problems = problems_of(body, check);
  Json json = {{"name", body.name}, {"sound", problems.empty()}, {"problems", problems}};
  facts.add("Body", body.name + ": " + (problems.empty() ? "sound" : "not sound"), "", nullptr);
  for (const std::string& problem : problems) facts.add("  Problem", problem, "", nullptr);
  facts.add("  Surface", closing_text(check.closing), "", nullptr);
  json["closedness"] = name_of(check.closing.closedness);
  json["gap_m"] = check.closing.gap_m;
  add_content(facts, body, check, json);
  json["curvature"] = curvature_facts(facts, check.curvature);
  json["smallest_convex_radius_m"] = radius_json(check.curvature.largest.curvature_per_m);
  json["smallest_concave_radius_m"] = radius_json(-check.curvature.smallest.curvature_per_m);
  json["bending"] = check.bending;
  facts.add("  Bending", number_text(std::round(100.0 * check.bending) / 100.0) + " (a ball has 25.13)", "",
            nullptr);
  add_places(check, json);
  return json;
}

}  // namespace spoonbill
