#include "app/report/check_facts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "app/report/quantity_text.h"
#include "engine/base/text.h"
#include "engine/inspection/mass_properties.h"

namespace spoonbill {
namespace {

// A surface with a radius of curvature above one kilometre counts as flat.
constexpr double least_curvature_per_m = 1e-3;

constexpr const char* no_walls = "unknown: no two walls face each other";

Json curvature_json(const CurvatureExtreme& place) {
  return {{"per_m", place.curvature_per_m},
          {"u", place.u},
          {"v", place.v},
          {"point_m", components_json(place.position_m)}};
}

// Returns the radius of curvature in metres; null if the curvature is negative or counts as flat.
Json radius_json(double curvature_per_m) {
  return curvature_per_m > least_curvature_per_m ? Json(1.0 / curvature_per_m) : Json(nullptr);
}

void add_radius(FactSheet& facts, const char* label, double curvature_per_m, const CurvatureExtreme& place) {
  if (!(curvature_per_m > least_curvature_per_m)) return;
  facts.add(label, short_length_text(1.0 / curvature_per_m) + " at " + position_text(place.position_m), "",
            nullptr);
}

Json curvature_facts(FactSheet& facts, const CurvatureRange& range) {
  add_radius(facts, "  Smallest convex radius", range.largest.curvature_per_m, range.largest);
  add_radius(facts, "  Smallest concave radius", -range.smallest.curvature_per_m, range.smallest);
  return {{"smallest", curvature_json(range.smallest)}, {"largest", curvature_json(range.largest)}};
}

void add_thickness(FactSheet& facts, const SurfaceCheck& check, Json& json) {
  if (!(check.mass.volume_m3 > 0.0)) return;
  if (!check.thinnest) {
    facts.add("  Thinnest", no_walls, "", nullptr);
    json["smallest_thickness_m"] = nullptr;
    return;
  }
  const Thickness& thin = *check.thinnest;
  // A distance that is only rounding error means that the two sides meet.
  const double thickness_m = thin.thickness_m > 1e-12 ? thin.thickness_m : 0.0;
  facts.add("  Thinnest", short_length_text(thickness_m) + " at " + position_text(thin.position_m), "",
            nullptr);
  json["smallest_thickness_m"] = thin.thickness_m;
  json["thinnest"] = {{"u", thin.u},
                      {"v", thin.v},
                      {"point_m", components_json(thin.position_m)},
                      {"opposite_u", thin.opposite_u},
                      {"opposite_v", thin.opposite_v},
                      {"opposite_m", components_json(thin.opposite_m)}};
}

std::string names_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Adds the volume, mass and centre of mass of a body with its material regions. If the regions cannot be
// evaluated, the body's own material is assumed everywhere and the line of the mass states the reason.
void add_mass(FactSheet& facts, const Body& body, double volume_m3, const Vector3& centre_m, Json& json) {
  const BodyMass mass = mass_of_volume(body, volume_m3, centre_m);
  facts.add("  Volume", volume_text(volume_m3), "", nullptr);
  facts.add("  Mass",
            grams_text(mass.mass_kg()) + " of " + names_text(mass.mix.materials) +
                (mass.note.empty() ? "" : ", " + mass.note),
            "", nullptr);
  facts.add("  Centre of mass", position_text(mass.centre_m), "", nullptr);
  json["volume_m3"] = volume_m3;
  json["mass_kg"] = mass.mass_kg();
  json["materials"] = mass.mix.materials;
  json["centre_of_mass_m"] = components_json(mass.centre_m);
}

void add_content(FactSheet& facts, const Body& body, CheckedAs as, const TrimmedArea& area,
                 const SurfaceCheck& check, Json& json) {
  facts.add("  Area", area_text(check.mass.area_m2), "", nullptr);
  json["area_m2"] = check.mass.area_m2;
  if (body.shell_thickness_m) {
    const ShellMass shell = compute_shell_mass(body.surface, *body.shell_thickness_m, area);
    facts.add("  Shell", length_text(*body.shell_thickness_m) + " thick", "", nullptr);
    json["shell_thickness_m"] = *body.shell_thickness_m;
    return add_mass(facts, body, shell.volume_m3, shell.centre_m, json);
  }
  if (!check.encloses() || as == CheckedAs::face) return;
  json["normals_outward"] = check.mass.volume_m3 > 0.0;
  add_mass(facts, body, std::abs(check.mass.volume_m3), check.mass.centre_m, json);
  add_thickness(facts, check, json);
}

void add_faults(const SurfaceCheck& check, Json& json) {
  json["self_intersections"] = Json::array();
  for (const SelfIntersection& meeting : check.self_intersections) {
    json["self_intersections"].push_back({{"u", meeting.u},
                                          {"v", meeting.v},
                                          {"other_u", meeting.other_u},
                                          {"other_v", meeting.other_v},
                                          {"depth_m", meeting.depth_m},
                                          {"point_m", components_json(meeting.position_m)}});
  }
  json["self_intersections_complete"] = check.self_intersections_complete;
  json["degenerate"] = Json::array();
  for (const SurfaceDefect& spot : check.surface_defects) {
    json["degenerate"].push_back(
        {{"u", spot.u}, {"v", spot.v}, {"folds", spot.folds}, {"point_m", components_json(spot.position_m)}});
  }
}

std::vector<std::string> closing_problems(const Body& body, const SurfaceCheck& check) {
  std::vector<std::string> problems;
  const bool closed = check.closing.closedness == Closedness::solid;
  if (check.is_trimmed && !body.shell_thickness_m) {
    problems.emplace_back("open where it is trimmed, and not a shell with a thickness");
  } else if (!closed && !body.shell_thickness_m) {
    problems.push_back("open by " + short_length_text(check.closing.gap_m) +
                       ", and not a shell with a thickness");
  }
  if (check.encloses() && !(check.mass.volume_m3 > 0.0)) problems.emplace_back("its normals point inwards");
  return problems;
}

// Gaps and uncertainties up to this length are rounding errors and are not shown.
constexpr double least_gap_m = 1e-8;

std::string faces_text(std::size_t count) {
  return "solid of " + count_text(count, "face", "faces");
}

// Adds the mass of a solid. If its faces have several materials, the mass is reported as unknown, because
// nothing determines which part of the solid consists of which material.
void add_solid_mass(FactSheet& facts, const CadSolid& solid, const std::vector<Body>& bodies, Json& json) {
  const Material& material = bodies[solid.surface_indices.front()].material;
  const bool is_same =
      std::all_of(solid.surface_indices.begin(), solid.surface_indices.end(), [&](std::size_t body) {
        const Material& other = bodies[body].material;
        return other.name == material.name && other.density_kg_per_m3 == material.density_kg_per_m3;
      });
  if (!is_same) {
    facts.add("  Mass", "unknown: its faces have several materials; give all of them the same material", "",
              nullptr);
    return;
  }
  const double mass_kg = solid.volume_m3 * material.density_kg_per_m3;
  facts.add("  Mass", grams_text(mass_kg) + " of " + material.name, "", nullptr);
  json["mass_kg"] = mass_kg;
  json["materials"] = {material.name};
}

std::vector<std::string> find_solid_problems(const SolidCheck& check) {
  std::vector<std::string> problems;
  if (!check.self_intersections.empty()) {
    const SolidSelfIntersection& deepest = check.self_intersections.front();
    problems.push_back("passes through itself at " + position_text(deepest.position_m) + ", by at least " +
                       short_length_text(deepest.depth_m));
  }
  if (!check.self_intersections_complete) {
    problems.emplace_back(
        "may pass through itself: it is close to itself at more points than could be searched");
  }
  return problems;
}

void add_self_meetings(const SolidCheck& check, Json& json) {
  json["self_intersections"] = Json::array();
  for (const SolidSelfIntersection& meeting : check.self_intersections) {
    json["self_intersections"].push_back(
        {{"depth_m", meeting.depth_m}, {"point_m", components_json(meeting.position_m)}});
  }
  json["self_intersections_complete"] = check.self_intersections_complete;
}

// Adds the smallest wall thickness of a solid and the uncertainty of this thickness. The uncertainty is twice
// the chord error, because the mesh may deviate from the surface on both sides of a wall.
void add_solid_thickness(FactSheet& facts, const CadSolid& solid, const SolidCheck& check, Json& json) {
  if (!check.thinnest) {
    facts.add("  Thinnest", no_walls, "", nullptr);
    json["smallest_thickness_m"] = nullptr;
    return;
  }
  const WallThickness& thin = *check.thinnest;
  const double error_m = 2.0 * solid.chord_error_m;
  const std::string within =
      error_m > least_gap_m ? "; no wall is more than " + short_length_text(error_m) + " thinner" : "";
  facts.add("  Thinnest",
            short_length_text(thin.thickness_m) + " at " + position_text(thin.position_m) + within, "",
            nullptr);
  json["smallest_thickness_m"] = thin.thickness_m;
  json["thickness_error_m"] = error_m;
  json["thinnest"] = {{"point_m", components_json(thin.position_m)},
                      {"opposite_m", components_json(thin.opposite_m)}};
}

// Returns one line for each reason why the body is not sound; none if the body is sound.
std::vector<std::string> find_problems(const Body& body, CheckedAs as, const SurfaceCheck& check) {
  std::vector<std::string> problems =
      as == CheckedAs::face ? std::vector<std::string>() : closing_problems(body, check);
  if (!check.self_intersections.empty()) {
    problems.push_back("passes through itself in " +
                       count_text(check.self_intersections.size(), "place", "places") + ", one at " +
                       position_text(check.self_intersections[0].position_m));
  }
  if (!check.self_intersections_complete) {
    problems.emplace_back(
        "may pass through itself: it is close to itself at more points than could be searched");
  }
  if (!check.surface_defects.empty()) {
    const SurfaceDefect& spot = check.surface_defects[0];
    problems.push_back(std::string(spot.folds ? "folds over" : "has no area") + " at " +
                       position_text(spot.position_m));
  }
  if (!check.curvature.exists && check.surface_defects.empty()) problems.emplace_back("has no area");
  const double sharpest = check.curvature.exists ? check.curvature.largest.curvature_per_m : 0.0;
  if (body.shell_thickness_m && *body.shell_thickness_m * sharpest >= 1.0) {
    problems.push_back("its shell is thicker than its smallest convex radius, " +
                       short_length_text(1.0 / sharpest));
  }
  return problems;
}

}  // namespace

Json add_check_facts(FactSheet& facts, const Body& body, CheckedAs as, const TrimmedArea& area,
                     const SurfaceCheck& check) {
  const std::vector<std::string> problems = find_problems(body, as, check);
  Json json = {{"name", body.name}, {"sound", problems.empty()}, {"problems", problems}};
  facts.add("Body", body.name + ": " + (problems.empty() ? "sound" : "not sound"), "", nullptr);
  for (const std::string& problem : problems) facts.add("  Problem", problem, "", nullptr);
  const std::string trimmed =
      check.is_trimmed ? ", trimmed by " + count_text(body.trims.size(), "loop", "loops") : "";
  facts.add("  Surface", closing_text(check.closing) + trimmed, "", nullptr);
  if (as == CheckedAs::face) facts.add("  Face of", body.solid, "", nullptr);
  json["solid"] = body.solid.empty() ? Json(nullptr) : Json(body.solid);
  json["trim_loops"] = body.trims.size();
  json["closedness"] = name_of(check.closing.closedness);
  json["gap_m"] = check.closing.gap_m;
  add_content(facts, body, as, area, check, json);
  if (check.curvature.exists) {
    json["curvature"] = curvature_facts(facts, check.curvature);
    json["smallest_convex_radius_m"] = radius_json(check.curvature.largest.curvature_per_m);
    json["smallest_concave_radius_m"] = radius_json(-check.curvature.smallest.curvature_per_m);
  }
  json["bending"] = check.bending;
  facts.add("  Bending", number_text(std::round(100.0 * check.bending) / 100.0) + " (a ball has 25.13)", "",
            nullptr);
  add_faults(check, json);
  return json;
}

Json add_meeting_facts(FactSheet& facts, const BodyOverlap& meeting, const Body& first, const Body& second) {
  facts.add("Overlap",
            first.name + " and " + second.name + ", " + short_length_text(meeting.depth_m) + " deep at " +
                position_text(meeting.position_m),
            "", nullptr);
  return {{"a", first.name},
          {"b", second.name},
          {"contained", meeting.contained},
          {"depth_m", meeting.depth_m},
          {"point_m", components_json(meeting.position_m)}};
}

Json add_solid_check_facts(FactSheet& facts, const CadSolid& solid, const SolidCheck& check,
                           const std::vector<Body>& bodies) {
  const std::vector<std::string> problems = find_solid_problems(check);
  Json json = {{"name", solid.name},
               {"closed", true},
               {"sound", problems.empty()},
               {"problems", problems},
               {"bodies", Json::array()}};
  for (const std::size_t body : solid.surface_indices) json["bodies"].push_back(bodies[body].name);
  facts.add("Solid", solid.name + ": closed, " + faces_text(solid.surface_indices.size()), "", nullptr);
  for (const std::string& problem : problems) facts.add("  Problem", problem, "", nullptr);
  if (solid.gap_m > least_gap_m) {
    facts.add("  Gaps", "up to " + short_length_text(solid.gap_m) + " between faces", "", nullptr);
  }
  facts.add("  Area", area_text(solid.area_m2), "", nullptr);
  facts.add("  Volume", volume_text(solid.volume_m3), "", nullptr);
  json["gap_m"] = solid.gap_m;
  json["area_m2"] = solid.area_m2;
  json["volume_m3"] = solid.volume_m3;
  add_solid_mass(facts, solid, bodies, json);
  facts.add("  Centre of mass", position_text(solid.centre_m), "", nullptr);
  json["centre_of_mass_m"] = components_json(solid.centre_m);
  add_solid_thickness(facts, solid, check, json);
  add_self_meetings(check, json);
  return json;
}

Json add_open_solid_facts(FactSheet& facts, const std::vector<std::size_t>& loose,
                          const std::vector<Body>& bodies) {
  std::map<std::string, Json> names;
  for (const std::size_t body : loose) {
    if (!bodies[body].solid.empty()) names[bodies[body].solid].push_back(bodies[body].name);
  }
  Json all = Json::array();
  for (const auto& [name, faces] : names) {
    facts.add("Solid", name + ": not closed, " + faces_text(faces.size()), "", nullptr);
    all.push_back({{"name", name}, {"closed", false}, {"sound", false}, {"bodies", faces}});
  }
  return all;
}

}  // namespace spoonbill
