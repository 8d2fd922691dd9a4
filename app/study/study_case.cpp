#include "app/study/study_case.h"

#include "engine/base/text.h"
#include "engine/exchange/field_reader.h"

namespace spoonbill {
namespace {

constexpr Range<double> any_number{-1e9, 1e9};

}  // namespace

double& factor_of(StudyCase& study_case, StudyFactor factor) {
  switch (factor) {
    case StudyFactor::helping:
      return study_case.helping;
    case StudyFactor::stiffness:
      return study_case.stiffness;
    case StudyFactor::depth:
      return study_case.bowl.depth;
    case StudyFactor::width:
      return study_case.bowl.width;
    case StudyFactor::curvature:
      return study_case.bowl.curvature;
    case StudyFactor::pitch:
      return study_case.pitch_deg;
    case StudyFactor::friction:
      return study_case.friction;
    case StudyFactor::tilt:
      break;
  }
  return study_case.tilt_deg;
}

std::string variation_text(const StudyCase& study_case) {
  const StudyCase usual;
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  const auto add_factor = [&](const char* name, double value, double usual_value) {
    if (value != usual_value) add(std::string(name) + " " + number_text(value));
  };
  add_factor("helping", study_case.helping, usual.helping);
  add_factor("stiffness", study_case.stiffness, usual.stiffness);
  add_factor("bowl depth", study_case.bowl.depth, usual.bowl.depth);
  add_factor("bowl width", study_case.bowl.width, usual.bowl.width);
  add_factor("bowl curvature", study_case.bowl.curvature, usual.bowl.curvature);
  if (study_case.pitch_deg != usual.pitch_deg) add("pitch " + number_text(study_case.pitch_deg) + "°");
  if (study_case.is_laid_after) add("laid in after the tilt");
  return text;
}

std::string case_key(const StudyCase& study_case) {
  const std::string variation = variation_text(study_case);
  std::string key = study_case.spoon + " / " + study_case.food + ", friction " +
                    number_text(study_case.friction) + (variation.empty() ? "" : ", " + variation) +
                    ", tilt " + number_text(study_case.tilt_deg) + "°";
  if (study_case.step_division != 1) key += ", steps divided by " + std::to_string(study_case.step_division);
  if (study_case.refinement > 0) key += study_case.refinement == 1 ? ", finer cells" : ", finest cells";
  return key;
}

Json case_to_json(const StudyCase& study_case) {
  return {{"spoon", study_case.spoon},
          {"food", study_case.food},
          {"friction", study_case.friction},
          {"helping", study_case.helping},
          {"stiffness", study_case.stiffness},
          {"bowl_depth", study_case.bowl.depth},
          {"bowl_width", study_case.bowl.width},
          {"bowl_curvature", study_case.bowl.curvature},
          {"pitch_deg", study_case.pitch_deg},
          {"tilt_deg", study_case.tilt_deg},
          {"laid_after", study_case.is_laid_after},
          {"step_division", study_case.step_division},
          {"refinement", study_case.refinement}};
}

Result<StudyCase> case_from_json(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  StudyCase study_case;
  study_case.spoon = reader.text("spoon");
  study_case.food = reader.text("food");
  study_case.friction = reader.number("friction", any_number);
  study_case.helping = reader.number("helping", any_number);
  study_case.stiffness = reader.number("stiffness", any_number);
  study_case.bowl.depth = reader.number("bowl_depth", any_number);
  study_case.bowl.width = reader.number("bowl_width", any_number);
  study_case.bowl.curvature = reader.number("bowl_curvature", any_number);
  study_case.pitch_deg = reader.number("pitch_deg", any_number);
  study_case.tilt_deg = reader.number("tilt_deg", any_number);
  study_case.is_laid_after = reader.boolean("laid_after");
  study_case.step_division = reader.integer("step_division", {1, 8});
  study_case.refinement = reader.integer("refinement", study_refinement_range);
  if (Status status = reader.status(); !status) return status.error();
  return study_case;
}

Json result_to_json(const CaseResult& result) {
  if (!is_judged(result)) return {{"failure", result.failure}};
  return {{"verdict", verdict_names[static_cast<std::size_t>(result.verdict)]},
          {"outside_kg", result.outside_kg},
          {"left_kg", result.left_kg},
          {"food_kg", result.food_kg},
          {"side", result.side ? Json(rim_side_names[static_cast<std::size_t>(*result.side)]) : Json()},
          {"margin_m", result.margin_m},
          {"first_spill_s", result.first_spill_s ? Json(*result.first_spill_s) : Json()},
          {"largest_contact_n", result.largest_contact_n},
          {"motion_s", result.motion_s},
          {"largest_speed_m_per_s", result.largest_speed_m_per_s},
          {"nodes", result.nodes}};
}

Result<CaseResult> result_from_json(const Json& json, const std::string& source) {
  FieldReader reader(json, source);
  CaseResult result;
  if (reader.has("failure")) {
    if (!json["failure"].is_string())
      return Error{ErrorCode::wrong_type, source + ": failure must be a text"};
    result.failure = json["failure"].get<std::string>();
    return result;
  }
  result.verdict = static_cast<Verdict>(reader.choose("verdict", verdict_names));
  result.outside_kg = reader.number("outside_kg", any_number);
  result.left_kg = reader.number("left_kg", any_number);
  result.food_kg = reader.number("food_kg", any_number);
  const auto is_given = [&](const char* field) { return json.contains(field) && !json[field].is_null(); };
  if (is_given("side")) result.side = static_cast<RimSide>(reader.choose("side", rim_side_names));
  result.margin_m = reader.number("margin_m", any_number);
  if (is_given("first_spill_s")) result.first_spill_s = reader.number("first_spill_s", any_number);
  result.largest_contact_n = reader.number("largest_contact_n", any_number);
  result.motion_s = reader.number("motion_s", any_number);
  result.largest_speed_m_per_s = reader.number("largest_speed_m_per_s", any_number);
  result.nodes = reader.integer("nodes", {0, 1000000});
  if (Status status = reader.status(); !status) return status.error();
  return result;
}

}  // namespace spoonbill
