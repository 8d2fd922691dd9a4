#include "app/study/study_design_parts.h"

#include <algorithm>

#include "app/report/quantity_text.h"
#include "app/study/page_parts.h"
#include "app/study/sampled_cases.h"
#include "engine/base/text.h"

namespace spoonbill {
namespace {

std::string interval_text(const FactorRange& one) {
  const bool is_angle = one.factor == StudyFactor::tilt || one.factor == StudyFactor::pitch;
  return number_text(one.range.low) + " to " + number_text(one.range.high) + (is_angle ? "°" : "");
}

std::string ranges_text(const std::vector<FactorRange>& ranges) {
  std::string text;
  for (const FactorRange& one : ranges) {
    text += (text.empty() ? "" : "; ") + factor_text(one.factor) + " from " + interval_text(one);
  }
  return text;
}

// Bars of the first and total index of each factor, with a line of one standard error to both sides.
// Estimates from few cases may lie far outside of 0 to 1; bars and lines end a little beyond.
std::string index_bars(const SensitivitySummary& sensitivity) {
  constexpr double left_px = 130.0, width_px = 520.0, row_px = 34.0, top_px = 22.0;
  constexpr double largest = 1.1;
  const auto x = [&](double value) { return left_px + width_px * std::clamp(value, 0.0, largest) / largest; };
  const auto px = [](double value) { return decimals_text(value, 1); };
  const double rows = static_cast<double>(sensitivity.indices.size());
  std::string text = "<div class=scroll><svg viewBox=\"0 0 " + px(left_px + width_px + 20.0) + " " +
                     px(top_px + rows * row_px + 4.0) + "\" role=img aria-label=\"Sobol indices\">";
  for (double tick = 0.0; tick <= largest; tick += 0.2) {
    text += "<line class=grid x1=" + px(x(tick)) + " x2=" + px(x(tick)) + " y1=" + px(top_px) +
            " y2=" + px(top_px + rows * row_px) + " /><text class=centred x=" + px(x(tick)) + " y=14>" +
            decimals_text(tick, 1) + "</text>";
  }
  double y = top_px + 4.0;
  const auto bar = [&](const char* kind, double value, double error, double at) {
    text += std::string("<rect class=") + kind + " x=" + px(left_px) + " y=" + px(at) +
            " width=" + px(x(value) - left_px) + " height=11 /><line class=axis x1=" + px(x(value - error)) +
            " x2=" + px(x(value + error)) + " y1=" + px(at + 5.5) + " y2=" + px(at + 5.5) + " />";
  };
  for (std::size_t k = 0; k < sensitivity.indices.size(); ++k) {
    const SobolIndex& index = sensitivity.indices[k];
    text += "<text class=at-end x=" + px(left_px - 8.0) + " y=" + px(y + 16.0) + ">" +
            html(factor_text(sensitivity.ranges[k].factor)) + "</text>";
    bar("total", index.total, index.total_error, y);
    bar("first", index.first, index.first_error, y + 12.0);
    y += row_px;
  }
  return text + "</svg></div>\n";
}

}  // namespace

std::string factor_text(StudyFactor factor) {
  if (factor == StudyFactor::tilt) return "tilt";
  if (factor == StudyFactor::pitch) return "pitch";
  std::string text = study_factor_names[static_cast<std::size_t>(factor)];
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

std::string grid_part(const StudyPlan& plan, const StudySummary& summary) {
  if (!plan.is_full_grid) return {};
  std::string text = section("grid", "All combinations");
  text +=
      "<p>Numbers are factors on the usual size or stiffness, but for the pitch. Rows with an empty cell "
      "under "
      "\"varied\" are as usual.</p>\n";
  PageTable table("combined",
                  {"spoon", "food", "friction", "varied", "holds", "best tilt", "within the wrist's range"});
  for (const SeriesSummary& series : summary.series) {
    if (series.series.is_for_claim || series.tilts.empty()) continue;
    const StudyCase& base = series.series.base;
    table.row().text(base.spoon).text(base.food).number(base.friction, number_text(base.friction));
    table.text(variation_text(base));
    add_holding(series, plan, table);
  }
  return text + table.finish() + "</section>\n";
}

std::string sample_part(const StudyPlan& plan, const CaseResults& results) {
  if (plan.sample.count == 0) return {};
  std::vector<StudyCase> cases = list_design_cases(plan);
  Json points = Json::array();
  std::size_t not_judged = 0;
  for (StudyCase& one : cases) {
    const CaseResult* const result = find_result(one, results);
    if (!result) continue;
    if (!is_judged(*result)) {
      ++not_judged;
      continue;
    }
    Json point = {{"label", case_key(one)},
                  {"verdict", name_of(result->verdict)},
                  {"margin", 1e3 * result->margin_m},
                  {"outside", 100.0 * result->outside_kg / result->food_kg},
                  {"force", result->largest_contact_n}};
    for (const FactorRange& range : plan.sample.ranges) {
      point[study_factor_names[static_cast<std::size_t>(range.factor)]] = factor_of(one, range.factor);
    }
    points.push_back(point);
  }
  std::string text = section("sample", "Drawn cases");
  text += "<p>" + std::to_string(cases.size()) + " cases of " + html(plan.spoons.front().name) + " with " +
          html(plan.foods.front().name) + ", drawn as a " +
          (plan.sample.method == SampleMethod::sobol ? "Sobol sequence" : "Latin hypercube") + " from " +
          html(ranges_text(plan.sample.ranges)) + "." +
          (not_judged > 0 ? " Not judged: " + std::to_string(not_judged) + "." : "") + "</p>\n";
  text += "<div class=controls><label>Along <select id=sample-factor>";
  for (const FactorRange& range : plan.sample.ranges) {
    text += std::string("<option value=") + study_factor_names[static_cast<std::size_t>(range.factor)] + ">" +
            html(factor_text(range.factor)) + "</option>";
  }
  text +=
      "</select></label> <label>Quantity <select id=sample-quantity><option value=margin>margin of the "
      "centre of "
      "mass to the rim, mm</option><option value=outside>mass outside the rim, %</option><option "
      "value=force>largest contact force, N</option></select></label></div><div class=scroll><svg "
      "id=sample-plot viewBox=\"0 0 760 340\" role=img aria-label=\"A quantity against a "
      "factor\"></svg></div>\n";
  return text + data_element("sample-data", points) + "</section>\n";
}

std::string sensitivity_part(const StudyPlan& plan, const StudySummary& summary) {
  if (!summary.sensitivity) return {};
  const SensitivitySummary& sensitivity = *summary.sensitivity;
  std::string text = section("sensitivity", "What the margin depends on");
  text +=
      "<p>How much of the variance of the margin each factor explains: alone (first) and with all its "
      "interactions (total). These are Sobol indices by the estimator of Jansen (1999), from " +
      std::to_string(plan.sensitivity.count) + " x (" + std::to_string(sensitivity.ranges.size()) +
      " + 2) cases of " + html(plan.spoons.front().name) + " with " + html(plan.foods.front().name) +
      "; errors are standard errors. The margin is the distance of the centre of mass from the rim at the "
      "end, "
      "at most zero where the food has left.";
  if (sensitivity.dropped > 0) {
    text +=
        " " + std::to_string(sensitivity.dropped) + " rows have a case that was not judged and are left out.";
  }
  text += "</p>\n";
  if (sensitivity.indices.empty()) {
    return text + "<p>Too few rows were judged for indices.</p></section>\n";
  }
  text += index_bars(sensitivity);
  PageTable table("indices", {"factor", "from", "first", "error", "total", "error"});
  for (std::size_t k = 0; k < sensitivity.indices.size(); ++k) {
    const SobolIndex& index = sensitivity.indices[k];
    table.row().text(factor_text(sensitivity.ranges[k].factor)).text(interval_text(sensitivity.ranges[k]));
    table.number(index.first, 3)
        .number(index.first_error, 3)
        .number(index.total, 3)
        .number(index.total_error, 3);
  }
  return text + table.finish() + "</section>\n";
}

}  // namespace spoonbill
