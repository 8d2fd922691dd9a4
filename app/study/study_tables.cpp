#include "app/study/study_tables.h"

#include <algorithm>

#include "app/report/csv_text.h"
#include "app/study/spoon_measures.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

Json series_json(const SeriesSummary& summary, const StudyPlan& plan) {
  Json tilts = Json::array();
  for (const JudgedTilt& tilt : summary.tilts) {
    tilts.push_back(
        {{"tilt_deg", tilt.tilt_deg},
         {"verdict",
          is_judged(*tilt.result) ? Json(verdict_names[static_cast<std::size_t>(tilt.verdict)]) : Json()},
         {"repeated", tilt.is_repeated}});
  }
  Json json = case_to_json(summary.series.base);
  for (const char* const field : {"tilt_deg", "step_division", "refinement"}) json.erase(field);
  json["for_claim"] = summary.series.is_for_claim;
  json["varied"] = summary.series.varied
                       ? Json(study_factor_names[static_cast<std::size_t>(*summary.series.varied)])
                       : Json();
  json["tilts"] = tilts;
  json["holds_deg"] = summary.holds_deg ? Json{summary.holds_deg->low, summary.holds_deg->high} : Json();
  json["open_low"] = summary.is_open_low;
  json["open_high"] = summary.is_open_high;
  json["best_deg"] = summary.holds_deg ? Json(summary.best_deg) : Json();
  json["uncertainty_deg"] = summary.holds_deg ? Json(summary.uncertainty_deg) : Json();
  json["wrist_deg"] = Json();
  if (summary.holds_deg) {
    const WristReading wrist = read_as_wrist(*summary.holds_deg, plan);
    if (wrist.is_within) json["wrist_deg"] = {wrist.common_deg.low, wrist.common_deg.high};
  }
  const ClaimReading claim = read_claim(summary);
  json["claim_reproduced"] =
      claim == ClaimReading::untried ? Json() : Json(claim == ClaimReading::reproduced);
  return json;
}

Json sensitivity_json(const SensitivitySummary& sensitivity) {
  Json factors = Json::array();
  for (std::size_t k = 0; k < sensitivity.indices.size(); ++k) {
    const FactorRange& one = sensitivity.ranges[k];
    const SobolIndex& index = sensitivity.indices[k];
    factors.push_back({{"factor", study_factor_names[static_cast<std::size_t>(one.factor)]},
                       {"range", {one.range.low, one.range.high}},
                       {"first", index.first},
                       {"first_error", index.first_error},
                       {"total", index.total},
                       {"total_error", index.total_error}});
  }
  return {{"factors", factors},
          {"dropped_rows", sensitivity.dropped},
          {"margins_m",
           {{"a", sensitivity.margins_m.a},
            {"b", sensitivity.margins_m.b},
            {"mixed", sensitivity.margins_m.mixed}}}};
}

Json measures_json(const SpoonMeasures& measures) {
  Json grips = Json::array();
  for (const GripMeasure& grip : measures.grips) {
    grips.push_back({{"from_end_m", grip.from_end_m},
                     {"width_m", grip.width_m},
                     {"torque_nm", grip.torque_nm},
                     {"force_n", grip.force_n}});
  }
  return {{"length_m", measures.length_m},
          {"mass_kg", measures.mass_kg},
          {"centre_m", {measures.centre_m.x(), measures.centre_m.y(), measures.centre_m.z()}},
          {"balance_m", measures.balance_m},
          {"grips", grips}};
}

}  // namespace

WristReading read_as_wrist(const Range<double>& holds_deg, const StudyPlan& plan) {
  const Range<double> common{std::max(holds_deg.low, plan.wrist_deg.low),
                             std::min(holds_deg.high, plan.wrist_deg.high)};
  return {common.low <= common.high, common};
}

ClaimReading read_claim(const SeriesSummary& series) {
  const auto at = [&](double tilt_deg) -> const JudgedTilt* {
    const auto found = std::find_if(series.tilts.begin(), series.tilts.end(),
                                    [&](const JudgedTilt& tilt) { return tilt.tilt_deg == tilt_deg; });
    return found == series.tilts.end() || !is_judged(*found->result) ? nullptr : &*found;
  };
  const JudgedTilt *const straight = at(0.0), *const lifted = at(10.0), *const steep = at(20.0);
  if (!straight || !lifted || !steep) return ClaimReading::untried;
  const bool is_reproduced = straight->verdict == Verdict::leaves &&
                             straight->result->side == RimSide::front && lifted->verdict == Verdict::holds &&
                             steep->verdict == Verdict::leaves && steep->result->side == RimSide::back;
  return is_reproduced ? ClaimReading::reproduced : ClaimReading::not_reproduced;
}

std::string cases_csv(const CaseResults& results) {
  std::string text =
      "spoon,food,friction,helping,stiffness,bowl_depth,bowl_width,bowl_curvature,pitch_deg,tilt_deg,"
      "laid_after,step_division,refinement,verdict,outside_g,left_g,side,margin_mm,first_spill_s,largest_"
      "contact_n,"
      "motion_s,"
      "nodes,failure\n";
  for (const auto& [key, done] : results) {
    const StudyCase& one = done.study_case;
    const CaseResult& result = done.result;
    std::string line = csv_field(one.spoon) + "," + csv_field(one.food);
    for (const double number : {one.friction, one.helping, one.stiffness, one.bowl.depth, one.bowl.width,
                                one.bowl.curvature, one.pitch_deg, one.tilt_deg}) {
      append_csv_number(line, number);
    }
    line += one.is_laid_after ? ",1" : ",0";
    append_csv_number(line, one.step_division);
    line += "," + std::to_string(one.refinement);
    if (!is_judged(result)) {
      line += ",,,,,,,,,," + csv_field(result.failure);
    } else {
      line += std::string(",") + verdict_names[static_cast<std::size_t>(result.verdict)];
      append_csv_number(line, 1e3 * result.outside_kg);
      append_csv_number(line, 1e3 * result.left_kg);
      line += std::string(",") + (result.side ? rim_side_names[static_cast<std::size_t>(*result.side)] : "");
      append_csv_number(line, 1e3 * result.margin_m);
      if (result.first_spill_s) {
        append_csv_number(line, *result.first_spill_s);
      } else {
        line += ",";
      }
      append_csv_number(line, result.largest_contact_n);
      append_csv_number(line, result.motion_s);
      append_csv_number(line, result.nodes);
      line += ",";
    }
    text += line + "\n";
  }
  return text;
}

Result<Json> study_json(const StudyPlan& plan, const CaseResults& results, const StudySummary& summary,
                        const Bendings& bendings) {
  Json json = {{"spoonbill_study_result", 1}, {"plan", plan_to_json(plan)}, {"cases", results.size()}};
  json["spoons"] = Json::array();
  for (const StudySpoon& spoon : plan.spoons) {
    Json one = {{"name", spoon.name},
                {"bowl_m", {spoon.bowl.length_m, spoon.bowl.width_m, spoon.bowl.depth_m}},
                {"pitch_deg", spoon.bowl.pitch_deg(Vector3::UnitY())}};
    for (const Material& material : plan.materials) {
      const auto measures = measure_spoon(spoon, material, find_food_kg(plan.foods.front()));
      if (!measures) return measures.error();
      Json& of_material = one["materials"][material.name];
      of_material = measures_json(measures.value());
      of_material["bending"] = Json();
      if (const SpoonBending* const bending = find_bending(bendings, spoon.name, material.name)) {
        of_material["bending"] = {
            {"hand_m", bending->hand_m},
            {"own_weight_m", bending->own_weight.drop_m},
            {"with_food_m", bending->with_food.drop_m},
            {"largest_strain", bending->with_food.largest_strain},
            {"largest_stress_pa", bending->with_food.largest_strain * material.youngs_modulus_pa},
            {"yield_stress_pa", find_yield_stress_pa(material)}};
      }
    }
    json["spoons"].push_back(one);
  }
  json["series"] = Json::array();
  for (const SeriesSummary& series : summary.series) json["series"].push_back(series_json(series, plan));
  json["trust"] = {{"repeats", summary.trust.repeats},
                   {"largest_time_change", summary.trust.largest_time_change},
                   {"largest_mass_change", summary.trust.largest_mass_change},
                   {"disagreements", Json::array()}};
  for (const Disagreement& one : summary.trust.disagreements) {
    json["trust"]["disagreements"].push_back(
        {{"case", case_key(one.repeat)},
         {"usual", verdict_names[static_cast<std::size_t>(one.usual)]},
         {"repeated", verdict_names[static_cast<std::size_t>(one.repeated)]}});
  }
  json["sensitivity"] = summary.sensitivity ? sensitivity_json(*summary.sensitivity) : Json();
  json["ratings"] = Json::array();
  for (const SpoonRating& rating : plan.ratings) {
    json["ratings"].push_back(
        {{"spoon", rating.spoon}, {"by", rating.by}, {"rating", rating.rating}, {"note", rating.note}});
  }
  json["failures"] = Json::array();
  for (const DoneCase* const failure : summary.failures) {
    json["failures"].push_back(
        {{"case", case_key(failure->study_case)}, {"failure", failure->result.failure}});
  }
  return json;
}

}  // namespace spoonbill
