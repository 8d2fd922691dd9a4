#include "app/study/study_page.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "app/report/quantity_text.h"
#include "app/study/case_trial.h"
#include "app/study/page_parts.h"
#include "app/study/spoon_measures.h"
#include "app/study/study_design_parts.h"
#include "app/study/study_tables.h"
#include "engine/base/assert.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

std::string answer_part(const StudyPlan& plan, const StudySummary& summary) {
  std::string text = section("answer", "At which tilts the food holds");
  text +=
      "<p>A positive tilt lifts the front of the rim, the end away from the handle. The best tilt is the "
      "centre of the longest range that holds. The last column is the part of that range within the "
      "wrist's " +
      range_text(plan.wrist_deg) + " (" + html(plan.wrist_source) +
      "; ulnar is negative), if the spoon tilts as the wrist deviates.</p>\n";
  PageTable table("best", {"spoon", "food", "friction", "holds", "best tilt", "within the wrist's range"});
  for (const SeriesSummary& series : summary.series) {
    if (series.series.varied || series.series.is_for_claim || series.tilts.empty()) continue;
    const StudyCase& base = series.series.base;
    table.row().text(base.spoon).text(base.food).number(base.friction, number_text(base.friction));
    add_holding(series, plan, table);
  }
  return text + table.finish() + "</section>\n";
}

std::string strip_label(const SeriesSummary& series) {
  return series.series.base.spoon + ", " + series_label(series.series);
}

// Returns whether a series is drawn. A full grid has too many for pictures; its table has all.
bool is_drawn(const StudyPlan& plan, const SeriesSummary& series) {
  return !series.tilts.empty() && !(plan.is_full_grid && series.series.varied);
}

// A strip for each series that is drawn: the verdict at each tilt, up to halfway to the next.
std::string strips_part(const StudyPlan& plan, const StudySummary& summary) {
  constexpr double row_px = 22.0, width_px = 620.0, top_px = 26.0, letter_px = 6.2;
  double low = infinity, high = -infinity;
  std::size_t rows = 0, longest = 0;
  for (const SeriesSummary& series : summary.series) {
    if (!is_drawn(plan, series)) continue;
    ++rows;
    longest = std::max(longest, strip_label(series).size());
    low = std::min(low, series.tilts.front().tilt_deg);
    high = std::max(high, series.tilts.back().tilt_deg);
  }
  if (rows == 0) return {};
  const double left_px = letter_px * static_cast<double>(longest) + 16.0;
  const double scale = width_px / std::max(high - low, 1.0);
  const auto x = [&](double tilt_deg) { return left_px + (tilt_deg - low) * scale; };
  const auto px = [](double value) { return decimals_text(value, 1); };
  std::string text = section("verdicts", "Verdicts");
  text +=
      "<p><span class=\"badge holds\">holds</span> settled, under 1 % of the mass outside the rim. <span "
      "class=\"badge overhangs\">overhangs</span> settled, more outside. <span class=\"badge "
      "leaves\">leaves</span> the centre of mass is outside, or 1 % of the mass is outside and below the "
      "rim. <span class=\"badge undecided\">undecided</span> not settled in time, or a repeat "
      "disagrees.</p>\n";
  text += "<div class=scroll><svg viewBox=\"0 0 " + px(left_px + width_px + 10.0) + " " +
          px(top_px + row_px * static_cast<double>(rows) + 6.0) +
          "\" role=img aria-label=\"Verdicts by tilt\">";
  for (double tilt = std::ceil(low / 10.0) * 10.0; tilt <= high; tilt += 10.0) {
    text += "<text x=" + px(x(tilt)) + " y=16 class=centred>" + degrees(tilt) + "</text>";
  }
  double y = top_px;
  for (const SeriesSummary& series : summary.series) {
    if (!is_drawn(plan, series)) continue;
    text += "<text x=" + px(left_px - 8.0) + " y=" + px(y + 14.0) + " class=at-end>" +
            html(strip_label(series)) + "</text>";
    for (std::size_t k = 0; k < series.tilts.size(); ++k) {
      const JudgedTilt& tilt = series.tilts[k];
      const double from = k == 0 ? tilt.tilt_deg : 0.5 * (series.tilts[k - 1].tilt_deg + tilt.tilt_deg);
      const double to =
          k + 1 == series.tilts.size() ? tilt.tilt_deg : 0.5 * (tilt.tilt_deg + series.tilts[k + 1].tilt_deg);
      const bool is_failed = !is_judged(*tilt.result);
      const char* const name = is_failed ? "failed" : name_of(tilt.verdict);
      text += std::string("<rect class=") + name + " x=" + px(x(from)) + " y=" + px(y) +
              " width=" + px(std::max(x(to) - x(from), 1.0)) + " height=" + px(row_px - 4.0) + "><title>" +
              degrees(tilt.tilt_deg) + ": " + (is_failed ? html(tilt.result->failure) : name) +
              "</title></rect>";
    }
    // A letter at the start of each run of equal verdicts, for readers who do not see the colours.
    for (std::size_t k = 0; k < series.tilts.size(); ++k) {
      const JudgedTilt& tilt = series.tilts[k];
      if (k > 0 && series.tilts[k - 1].verdict == tilt.verdict) continue;
      std::size_t last = k;
      while (last + 1 < series.tilts.size() && series.tilts[last + 1].verdict == tilt.verdict) ++last;
      const double from = x(tilt.tilt_deg), to = x(series.tilts[last].tilt_deg);
      if (to - from < 10.0) continue;
      text += std::string("<text class=\"centred ") +
              (tilt.verdict == Verdict::overhangs ? "dark" : "inside") + "\" x=" + px(0.5 * (from + to)) +
              " y=" + px(y + 13.0) + ">" +
              (to - from > 70.0 ? name_of(tilt.verdict) : std::string(1, *name_of(tilt.verdict))) + "</text>";
    }
    y += row_px;
  }
  return text + "</svg></div></section>\n";
}

std::string plot_part(const StudyPlan& plan, const StudySummary& summary) {
  Json data = Json::array();
  for (const SeriesSummary& series : summary.series) {
    if (!is_drawn(plan, series)) continue;
    Json points = Json::array();
    for (const JudgedTilt& tilt : series.tilts) {
      const CaseResult& result = *tilt.result;
      if (!is_judged(result)) continue;
      points.push_back({{"tilt", tilt.tilt_deg},
                        {"verdict", name_of(tilt.verdict)},
                        {"outside", 100.0 * result.outside_kg / result.food_kg},
                        {"margin", 1e3 * result.margin_m},
                        {"spill", result.first_spill_s ? Json(*result.first_spill_s) : Json()},
                        {"force", result.largest_contact_n}});
    }
    data.push_back(
        {{"spoon", series.series.base.spoon}, {"label", series_label(series.series)}, {"points", points}});
  }
  std::string text = section("quantities", "What happens at each tilt");
  text +=
      "<div class=controls><label>Quantity <select id=quantity><option value=margin>margin of the centre "
      "of mass to the rim, mm</option><option value=outside>mass outside the rim, %</option><option "
      "value=spill>first spill, s after the turn began</option><option value=force>largest contact "
      "force, N</option></select></label> <label>Spoon <select id=spoon>";
  for (const StudySpoon& spoon : plan.spoons) {
    text += "<option value=\"" + html(spoon.name) + "\">" + html(spoon.name) + "</option>";
  }
  text +=
      "</select></label></div><div class=scroll><svg id=plot viewBox=\"0 0 900 340\" role=img "
      "aria-label=\"A quantity against the tilt\"></svg></div>\n";
  return text + data_element("study-data", data) + "</section>\n";
}

std::string pictures_part(const std::vector<StudyPicture>& pictures) {
  if (pictures.empty()) return {};
  std::string text = section("pictures", "Pictures") + "<div class=pictures>";
  for (const StudyPicture& picture : pictures) {
    const StudyCase& shown = picture.study_case;
    const std::string what = shown.spoon + ", " + shown.food + ", friction " + number_text(shown.friction) +
                             ", tilt " + degrees(shown.tilt_deg) + ": " + picture.verdict;
    if (picture.png.empty()) {
      text += "<figure><figcaption>" + html(what) + "</figcaption></figure>";
      continue;
    }
    if (!picture.video.empty()) {
      text += "<figure><video controls loop muted playsinline aria-label=\"" + html(what) +
              "\" poster=\"data:image/png;base64," + base64(picture.png) + "\" src=\"data:video/mp4;base64," +
              base64(picture.video) + "\"></video><figcaption>" + html(what) + "</figcaption></figure>";
      continue;
    }
    text += "<figure><img alt=\"" + html(what) + "\" src=\"data:image/png;base64," + base64(picture.png) +
            "\"><figcaption>" + html(what) + "</figcaption></figure>";
  }
  return text + "</div></section>\n";
}

std::string bending_table(const StudyPlan& plan, const Bendings& bendings) {
  if (bendings.empty()) return {};
  std::string text =
      "<p>Held level in the rear third of the handle, the front of the rim drops, under the weight of "
      "the spoon and with the food. The stress is the largest strain times Young's modulus, with the food; "
      "beside it is the stress at which the material yields or breaks. Parts thinner than a cell of the "
      "lattice are too stiff in bending.</p>\n";
  PageTable table("bending",
                  {"spoon", "material", "held, mm", "drop by its weight, mm", "with the food, mm",
                   "largest strain, %", "stress, MPa", "yields at, MPa", "stress of the yield stress, %"});
  for (const StudySpoon& spoon : plan.spoons) {
    for (const Material& material : plan.materials) {
      const SpoonBending* const bending = find_bending(bendings, spoon.name, material.name);
      if (!bending) continue;
      const double strain = bending->with_food.largest_strain;
      const double stress_pa = strain * material.youngs_modulus_pa;
      table.row().text(spoon.name).text(material.name).number(1e3 * bending->hand_m, 0);
      table.number(1e3 * bending->own_weight.drop_m, 4).number(1e3 * bending->with_food.drop_m, 4);
      table.number(100.0 * strain, 4).number(1e-6 * stress_pa, 3);
      const double yield_pa = find_yield_stress_pa(material);
      if (yield_pa > 0.0) {
        table.number(1e-6 * yield_pa, 1).number(100.0 * stress_pa / yield_pa, 2);
      } else {
        table.text("not known").text("");
      }
    }
  }
  text += table.finish() + "<ul>";
  for (const Material& material : plan.materials) {
    text += "<li>" + html(material.name) + ": " + html(material.source) +
            (material.yield_source.empty() ? "" : " Yield: " + html(material.yield_source)) + "</li>";
  }
  return text + "</ul>\n";
}

Result<std::string> hand_part(const StudyPlan& plan, const Bendings& bendings) {
  const double food_kg = find_food_kg(plan.foods.front());
  std::string text = section("hand", "In the hand");
  text +=
      "<p>Weight and balance are exact integrals over the surface. The torque is that of the spoon, held "
      "level with " +
      grams_text(food_kg) +
      " of food over the centre of the rim, about the hand. The force is the torque divided by a skin "
      "friction of " +
      number_text(skin_friction) +
      " (smooth vinyl, Buchholz et al. 1988) and the width of the handle: a measure for ranking, not a "
      "measured force. Its shares are of grip forces in early rheumatoid arthritis (TIRA 2005): the "
      "upper bound of the weakest group, 114 N, and the lower bounds of the others, 116, 214 and 328 "
      "N.</p>\n";
  PageTable table("measures",
                  {"spoon", "material", "weight, g", "balance from the end, mm", "of length, mm",
                   "hand at, mm", "width, mm", "torque, N mm", "force, N", "of 114 / 116 / 214 / 328 N"});
  for (const StudySpoon& spoon : plan.spoons) {
    for (const Material& material : plan.materials) {
      auto measures = measure_spoon(spoon, material, food_kg);
      if (!measures) return measures.error();
      const auto begin_row = [&] {
        table.row().text(spoon.name).text(material.name).number(1e3 * measures->mass_kg, 1);
        table.number(1e3 * measures->balance_m, 1).number(1e3 * measures->length_m, 1);
      };
      for (const GripMeasure& grip : measures->grips) {
        begin_row();
        table.number(1e3 * grip.from_end_m, 0).number(1e3 * grip.width_m, 1).number(1e3 * grip.torque_nm, 2);
        table.number(grip.force_n, 2);
        std::string shares;
        for (const double group_n : grip_groups_n) {
          shares += (shares.empty() ? "" : " / ") + decimals_text(100.0 * grip.force_n / group_n, 1);
        }
        table.number(grip.force_n, shares + " %");
      }
      if (!measures->grips.empty()) continue;
      begin_row();
      table.text("no handle");
      for (int k = 0; k < 4; ++k) table.text("");
    }
  }
  return text + table.finish() + bending_table(plan, bendings) + "</section>\n";
}

std::string ratings_part(const StudyPlan& plan) {
  if (plan.ratings.empty()) return {};
  std::string text = section("ratings", "What people think of them");
  text += "<p>Ratings from 1 (bad) to 7 (good), as given in the study file.</p>\n";
  PageTable table("rated", {"spoon", "rating", "by", "note"});
  for (const SpoonRating& rating : plan.ratings) {
    table.row().text(rating.spoon).number(rating.rating, 0).text(rating.by).long_text(rating.note);
  }
  return text + table.finish() + "</section>\n";
}

std::string factors_part(const StudyPlan& plan, const StudySummary& summary) {
  if (plan.variations.empty() || plan.is_full_grid) return {};
  std::string text = section("factors", "One thing at a time");
  text += "<p>" + html(plan.spoons.front().name) + " with " + html(plan.foods.front().name) +
          " at a friction of " + number_text(plan.usual_friction) +
          ". Numbers are factors on the usual size or stiffness, but for the pitch. The first row is as "
          "usual.</p>\n";
  PageTable table("varied", {"varied", "holds", "best tilt", "within the wrist's range"});
  for (const SeriesSummary& series : summary.series) {
    const StudyCase& base = series.series.base;
    const bool is_usual = !series.series.varied && !series.series.is_for_claim &&
                          base.spoon == plan.spoons.front().name && base.food == plan.foods.front().name &&
                          base.friction == plan.usual_friction;
    if (!(series.series.varied || is_usual) || series.tilts.empty()) continue;
    table.row().text(is_usual ? "nothing" : variation_text(series.series.base));
    add_holding(series, plan, table);
  }
  return text + table.finish() + "</section>\n";
}

std::string trust_part(const StudyPlan& plan, const CaseResults& results, const StudySummary& summary) {
  const TrustSummary& trust = summary.trust;
  std::string text = section("trust", "How far to trust it");
  if (!plan.repeats) {
    text += "<p>Nothing was repeated, because the study file says so.</p>\n";
  } else {
    text +=
        "<p>At each change of verdict, the cases on both sides were repeated with half the step and with "
        "finer cells: " +
        std::to_string(trust.repeats) + " repeats. The verdict differs in " +
        std::to_string(trust.disagreements.size()) +
        " of them. Where finer cells give another verdict, the finest cells decide: with the same "
        "verdict as the finer ones, it counts; all other tilts with different verdicts are undecided. "
        "Where both spill, the time of the first spill differs by at most " +
        decimals_text(100.0 * trust.largest_time_change, 1) +
        " %; the overhanging mass of food that does not yield by at most " +
        decimals_text(100.0 * trust.largest_mass_change, 1) +
        " percentage points. Where the food yields, its verdict and the time of its first spill are to "
        "be trusted, the grams are not.</p>\n";
  }
  if (!trust.disagreements.empty()) {
    PageTable table("disagreements", {"repeat", "usual", "repeated"});
    for (const Disagreement& one : trust.disagreements) {
      table.row().text(case_key(one.repeat)).verdict(one.usual).verdict(one.repeated);
    }
    text += table.finish();
  }
  std::set<std::string> undecided;
  for (const auto& [key, done] : results) {
    if (is_judged(done.result) && done.result.verdict == Verdict::undecided) undecided.insert(key);
  }
  if (!undecided.empty()) {
    text += "<p>Not settled within " + number_text(case_motion_s) + " s:</p><ul>";
    for (const std::string& key : undecided) text += "<li>" + html(key) + "</li>";
    text += "</ul>\n";
  }
  if (!summary.failures.empty()) {
    text += "<p>Not judged:</p>\n";
    PageTable table("failures", {"case", "why"});
    for (const DoneCase* const failure : summary.failures) {
      table.row().text(case_key(failure->study_case)).long_text(failure->result.failure);
    }
    text += table.finish();
  }
  return text + "</section>\n";
}

std::string claim_part(const StudySummary& summary) {
  std::string text = section("claim", "The claim of the paper");
  text +=
      "<p>Pungotra et al. (2013) report that jelly on a spoon held straight spills over the front, stays "
      "with the front lifted by 10°, and spills over the back at 20°. They state no data of the gelatin, "
      "the helping or the bowl. Food that yields under 0.3 of the pressure of its own height is a "
      "liquid, which a trial does not judge.</p>\n";
  PageTable table("claims", {"spoon", "setting", "0°", "10°", "20°", "reading"});
  int tried = 0, reproduced = 0;
  for (const SeriesSummary& series : summary.series) {
    const ClaimReading reading = read_claim(series);
    if (reading == ClaimReading::untried) continue;
    ++tried;
    reproduced += reading == ClaimReading::reproduced;
    table.row().text(series.series.base.spoon).text(series_label(series.series));
    for (const double tilt : {0.0, 10.0, 20.0}) {
      const auto at = std::find_if(series.tilts.begin(), series.tilts.end(),
                                   [&](const JudgedTilt& one) { return one.tilt_deg == tilt; });
      std::string words = name_of(at->verdict);
      if (at->verdict == Verdict::leaves && at->result->side) {
        words += std::string(" over the ") + rim_side_names[static_cast<std::size_t>(*at->result->side)];
      }
      table.text(words);
    }
    table.text(reading == ClaimReading::reproduced ? "reproduced" : "not reproduced");
  }
  if (tried == 0) return text + "<p>Not tried: the study has no tilts of 0°, 10° and 20°.</p></section>\n";
  return text + "<p>Reproduced in " + std::to_string(reproduced) + " of " + std::to_string(tried) +
         " series.</p>\n" + table.finish() + "</section>\n";
}

std::string cases_part(const CaseResults& results) {
  std::string text = section("cases", "All cases");
  text +=
      "<p class=note>Click a heading to sort. The margin is the distance of the centre of mass from the "
      "rim. The first spill is in seconds after the turn began; a negative time is before it.</p>\n";
  PageTable table(
      "all", {"spoon", "food", "friction", "varied", "tilt", "repeat", "verdict", "outside, g", "left, g",
              "over the", "margin, mm", "first spill, s", "largest force, N", "motion, s", "nodes"});
  for (const auto& [key, done] : results) {
    const StudyCase& one = done.study_case;
    const CaseResult& result = done.result;
    table.row()
        .text(one.spoon)
        .text(one.food)
        .number(one.friction, number_text(one.friction))
        .text(variation_text(one));
    table.number(one.tilt_deg, degrees(one.tilt_deg));
    table.text(one.refinement == 2     ? "finest cells"
               : one.refinement == 1   ? "finer cells"
               : one.step_division > 1 ? "half the step"
                                       : "");
    if (!is_judged(result)) {
      table.text("not judged");
      for (int k = 0; k < 8; ++k) table.text("");
      continue;
    }
    table.verdict(result.verdict).number(1e3 * result.outside_kg, 2).number(1e3 * result.left_kg, 2);
    table.text(result.side ? rim_side_names[static_cast<std::size_t>(*result.side)] : "");
    table.number(1e3 * result.margin_m, 1);
    if (result.first_spill_s) {
      table.number(*result.first_spill_s, 2);
    } else {
      table.text("");
    }
    table.number(result.largest_contact_n, 3).number(result.motion_s, 2).number(result.nodes, 0);
  }
  return text + table.finish() + "</section>\n";
}

std::string method_part(const StudyPlan& plan) {
  std::string text = section("method", "How it was found");
  text +=
      "<p>Each case is a trial under gravity with true weights and stiffness: the food is lowered level "
      "over the centre of the rim, comes to rest for at most " +
      number_text(case_settling_s) +
      " s, and the spoon tilts at 30 degrees a second about the axis across the rim. A case ends when "
      "the food's centre of mass stays within " +
      number_text(1e3 * case_rest_distance_m) + " mm for " + number_text(case_rest_s) +
      " s, when the food has left, or after " + number_text(case_motion_s) +
      " s. The rim is the ridge around the bowl; outside is beyond it along the normal of its plane, "
      "which turns with the spoon.</p>\n<ul>";
  for (const StudyFood& food : plan.foods) {
    const Vector3 size = bounding_box(food.body.surface.net).extent();
    const Material& material = food.body.material;
    text += "<li>" + html(food.name) + ": " + html(size_text(size)) + ", " + grams_text(find_food_kg(food)) +
            ", Young's modulus " + number_text(1e-3 * material.youngs_modulus_pa) + " kPa" +
            (material.plastic
                 ? ", yields at " +
                       number_text(std::round(material.youngs_modulus_pa * material.yield_strain)) + " Pa"
                 : ", elastic") +
            ". Material: " + html(material.name) +
            (material.source.empty() ? "" : ", " + html(material.source)) + "</li>";
  }
  for (const StudySpoon& spoon : plan.spoons) {
    text += "<li>" + html(spoon.name) + ": bowl " +
            html(size_text({spoon.bowl.length_m, spoon.bowl.depth_m, spoon.bowl.width_m})) +
            " (length, depth, width), pitch " + degrees(spoon.bowl.pitch_deg(Vector3::UnitY())) + "</li>";
  }
  return text + "</ul></section>\n";
}

}  // namespace

Result<std::string> make_study_page(const StudyPlan& plan, const CaseResults& results,
                                    const StudySummary& summary, const Bendings& bendings,
                                    const std::vector<StudyPicture>& pictures) {
  const auto hand = hand_part(plan, bendings);
  if (!hand) return hand.error();
  std::string names;
  for (const StudySpoon& spoon : plan.spoons) names += (names.empty() ? "" : ", ") + spoon.name;
  std::string page = "<p>" + html(names) + ". " + std::to_string(results.size()) + " cases.</p>\n";
  page += answer_part(plan, summary) + strips_part(plan, summary) + plot_part(plan, summary) +
          pictures_part(pictures);
  page += hand.value() + ratings_part(plan) + factors_part(plan, summary) + grid_part(plan, summary) +
          sample_part(plan, results) + sensitivity_part(plan, summary) + trust_part(plan, results, summary);
  page += claim_part(summary) + cases_part(results) + method_part(plan);
  return make_page("Does the food stay on " + names + "?", "Does the food stay on the spoon?", page);
}

}  // namespace spoonbill
