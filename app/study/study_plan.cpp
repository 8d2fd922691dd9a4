#include "app/study/study_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/exchange/document.h"
#include "engine/exchange/field_reader.h"
#include "engine/simulation/simulation.h"

namespace spoonbill {
namespace {

constexpr int study_version = 1;
// Number of the way in which cases are run; grows when the same case would have another result.
constexpr int study_method = 3;
constexpr std::size_t study_file_limit_bytes = std::size_t{1} << 20;

// Reads a list of numbers, ascending if `is_ascending`.
std::vector<double> read_numbers(FieldReader& reader, const char* field, Range<double> range,
                                 Range<int> count, bool is_ascending = true) {
  std::vector<double> numbers;
  const Json& list = reader.list(field, count);
  for (std::size_t k = 0; list.is_array() && k < list.size(); ++k) {
    if (!list[k].is_number()) {
      reader.refuse(field, "must be a list of numbers", ErrorCode::wrong_type);
      return {};
    }
    const double number = list[k].get<double>();
    if (!range.contains(number)) {
      reader.refuse(field, "has " + number_text(number) + ", must be from " + number_text(range.low) +
                               " to " + number_text(range.high));
      return {};
    }
    if (is_ascending && !numbers.empty() && number <= numbers.back()) {
      reader.refuse(field,
                    "must ascend, but " + number_text(number) + " follows " + number_text(numbers.back()),
                    ErrorCode::inconsistent);
      return {};
    }
    numbers.push_back(number + 0.0);  // which makes -0 a 0
  }
  return numbers;
}

StudyPlan usual_plan() {
  StudyPlan plan;
  for (int tilt = -30; tilt <= 30; tilt += 5) plan.tilts_deg.push_back(tilt);
  plan.frictions = {0.02, 0.1, 0.3};
  plan.variations = {{StudyFactor::helping, {0.8, 1.2}},   {StudyFactor::stiffness, {0.5, 2.0}},
                     {StudyFactor::depth, {0.7, 1.4}},     {StudyFactor::width, {0.85, 1.2}},
                     {StudyFactor::curvature, {0.7, 1.4}}, {StudyFactor::pitch, {-10.0, 10.0}}};
  plan.frame_tilts_deg = {0.0, 10.0, 20.0};
  plan.wrist_source = "radial deviation while feeding, Safaee-Rad et al. 1990";
  return plan;
}

Range<double> factor_range(StudyFactor factor) {
  switch (factor) {
    case StudyFactor::pitch:
      return {-45.0, 45.0};
    case StudyFactor::stiffness:
      return {0.01, 100.0};
    case StudyFactor::friction:
      return study_friction_range;
    case StudyFactor::tilt:
      return study_tilt_range_deg;
    default:
      return bowl_factor_range;
  }
}

// Returns the first name that two of a list have.
template <class Named>
std::optional<std::string> find_repeated_name(const std::vector<Named>& list) {
  std::set<std::string> names;
  for (const Named& named : list) {
    if (!names.insert(named.name).second) return named.name;
  }
  return std::nullopt;
}

void read_variations(FieldReader reader, StudyPlan& plan) {
  plan.variations.clear();
  for (std::size_t k = 0; k < std::size(study_factor_names); ++k) {
    const char* const name = study_factor_names[k];
    const auto factor = static_cast<StudyFactor>(k);
    // Frictions and tilts have lists of their own.
    if (factor == StudyFactor::friction || factor == StudyFactor::tilt || !reader.has(name)) continue;
    plan.variations.push_back({factor, read_numbers(reader, name, factor_range(factor), {0, 50})});
  }
  reader.finish();
}

std::vector<FactorRange> read_ranges(FieldReader reader) {
  std::vector<FactorRange> ranges;
  for (std::size_t k = 0; k < std::size(study_factor_names); ++k) {
    const char* const name = study_factor_names[k];
    if (!reader.has(name)) continue;
    const auto factor = static_cast<StudyFactor>(k);
    const std::vector<double> ends = read_numbers(reader, name, factor_range(factor), {2, 2});
    if (ends.size() == 2) ranges.push_back({factor, {ends[0], ends[1]}});
  }
  reader.finish();
  return ranges;
}

void read_sample(FieldReader reader, StudySample& sample) {
  sample.method = static_cast<SampleMethod>(reader.choose("method", sample_method_names));
  sample.count = reader.integer("count", sample_count_range);
  if (sample.method == SampleMethod::latin_hypercube && reader.has("seed")) {
    sample.seed = static_cast<std::uint32_t>(
        reader.unsigned_integer("seed", std::numeric_limits<std::uint32_t>::max()));
  }
  sample.ranges = read_ranges(reader.inner("ranges"));
  if (sample.ranges.empty()) reader.refuse("ranges", "must have a range of at least one factor");
  reader.finish();
}

void read_sensitivity(FieldReader reader, SensitivityPlan& sensitivity) {
  sensitivity.count = reader.integer("count", sensitivity_count_range);
  if (reader.has("ranges")) {
    sensitivity.ranges = read_ranges(reader.inner("ranges"));
    if (sensitivity.ranges.empty()) reader.refuse("ranges", "must have a range of at least one factor");
  }
  reader.finish();
}

// Returns the ranges that the lists of tilts, frictions and variations of a plan span, of more than one
// value.
std::vector<FactorRange> find_spanned_ranges(const StudyPlan& plan) {
  std::vector<FactorRange> ranges;
  const auto add = [&](StudyFactor factor, const std::vector<double>& values, std::optional<double> usual) {
    Range<double> range{infinity, -infinity};
    const auto include = [&](double value) {
      range = {std::min(range.low, value), std::max(range.high, value)};
    };
    for (const double value : values) include(value);
    if (usual) include(*usual);
    if (range.low < range.high) ranges.push_back({factor, range});
  };
  StudyCase usual;
  for (const StudyVariation& variation : plan.variations) {
    add(variation.factor, variation.values, factor_of(usual, variation.factor));
  }
  add(StudyFactor::friction, plan.frictions, std::nullopt);
  add(StudyFactor::tilt, plan.tilts_deg, std::nullopt);
  return ranges;
}

Json ranges_to_json(const std::vector<FactorRange>& ranges) {
  Json json = Json::object();
  for (const FactorRange& one : ranges) {
    json[study_factor_names[static_cast<std::size_t>(one.factor)]] = {one.range.low, one.range.high};
  }
  return json;
}

Status read_study(const std::filesystem::path& file, StudyPlan& plan) {
  const auto text = read_file(file, study_file_limit_bytes);
  if (!text) return text.error();
  const std::string source = file.string();
  const auto json = parse_json(text.value(), source);
  if (!json) return json.error();
  FieldReader reader(json.value(), source);
  reader.version("spoonbill_study", study_version);
  if (reader.has("tilts_deg")) {
    plan.tilts_deg = read_numbers(reader, "tilts_deg", study_tilt_range_deg, {1, 500});
  }
  if (reader.has("frictions")) {
    plan.frictions = read_numbers(reader, "frictions", study_friction_range, {1, 50});
  }
  if (reader.has("usual_friction")) {
    plan.usual_friction = reader.number("usual_friction", study_friction_range);
  }
  if (reader.has("vary")) read_variations(reader.inner("vary"), plan);
  if (reader.has("grid")) {
    plan.is_full_grid = reader.choice<bool>("grid", {{"one_at_a_time", false}, {"full", true}});
  }
  if (reader.has("sample")) read_sample(reader.inner("sample"), plan.sample);
  if (reader.has("sensitivity")) read_sensitivity(reader.inner("sensitivity"), plan.sensitivity);
  if (reader.has("claim")) plan.tries_claim = reader.boolean("claim");
  if (reader.has("repeats")) plan.repeats = reader.boolean("repeats");
  if (reader.has("frames_deg")) {
    plan.frame_tilts_deg = read_numbers(reader, "frames_deg", study_tilt_range_deg, {0, 20});
  }
  if (reader.has("wrist_deg")) {
    const std::vector<double> range = read_numbers(reader, "wrist_deg", {-90.0, 90.0}, {2, 2});
    if (range.size() == 2) plan.wrist_deg = {range[0], range[1]};
    plan.wrist_source = "as given in the study file";
  }
  if (reader.has("materials")) {
    plan.materials.clear();
    const Json& list = reader.list("materials", {1, 10});
    for (std::size_t k = 0; list.is_array() && k < list.size(); ++k) {
      auto material = list[k].is_string() ? read_named_material(list[k].get<std::string>())
                                          : Result<Material>(Error{ErrorCode::wrong_type, ""});
      if (!material) {
        reader.refuse("materials", "must be names of materials that come with the program",
                      ErrorCode::missing);
        break;
      }
      plan.materials.push_back(std::move(material).value());
    }
  }
  if (reader.has("ratings")) {
    const Json& list = reader.list("ratings", {0, 1000});
    for (std::size_t k = 0; list.is_array() && k < list.size() && reader.status().ok(); ++k) {
      FieldReader one = reader.element(list[k], "ratings", k);
      SpoonRating& rating = plan.ratings.emplace_back();
      rating.spoon = one.text("spoon");
      rating.rating = one.integer("rating", rating_range);
      if (one.has("by")) rating.by = one.text("by");
      if (one.has("note")) rating.note = one.text("note");
      one.finish();
    }
  }
  if (reader.has("foods")) {
    plan.foods.clear();
    const Json& list = reader.list("foods", {1, 20});
    for (std::size_t k = 0; list.is_array() && k < list.size() && reader.status().ok(); ++k) {
      auto food = read_food(reader.element(list[k], "foods", k), file.parent_path());
      if (!food) return reader.status().ok() ? food.error().in(source) : reader.status();
      plan.foods.push_back(std::move(food).value());
    }
    if (const auto name = find_repeated_name(plan.foods)) {
      reader.refuse("foods", "two foods have the name \"" + excerpt(*name) + "\"", ErrorCode::duplicate);
    }
  }
  reader.finish();
  return reader.status();
}

std::uint64_t hash_shape(const Body& body) {
  StateHash hash;
  for (const KnotVector* const knots : {&body.surface.u, &body.surface.v}) {
    for (const double knot : knots->knots()) hash.add(knot);
  }
  for (const std::vector<double>* const list :
       {&body.surface.net.x, &body.surface.net.y, &body.surface.net.z}) {
    hash.add(list->data(), list->size());
  }
  for (const Vector2& corner : body.rim) {
    hash.add(corner.x());
    hash.add(corner.y());
  }
  return hash.value();
}

}  // namespace

Result<StudyPlan> make_study_plan(const std::vector<std::filesystem::path>& spoons,
                                  const std::filesystem::path& file, const StudyChoices& choices) {
  StudyPlan plan = usual_plan();
  if (!file.empty()) {
    if (Status read = read_study(file, plan); !read) return read.error();
  }
  if (choices.is_full_grid) plan.is_full_grid = *choices.is_full_grid;
  if (choices.sensitivity_count > 0) plan.sensitivity.count = choices.sensitivity_count;
  if (plan.sensitivity.count > 0 && plan.sensitivity.ranges.empty()) {
    plan.sensitivity.ranges = find_spanned_ranges(plan);
    if (plan.sensitivity.ranges.empty()) {
      return Error{ErrorCode::inconsistent,
                   file.string() +
                       ": no factor of this study has more than one value for a sensitivity "
                       "analysis; give it \"ranges\"",
                   "sensitivity"};
    }
  }
  if (plan.foods.empty()) {
    auto foods = read_usual_foods();
    if (!foods) return foods.error();
    plan.foods = std::move(foods).value();
  }
  const bool has_materials = !plan.materials.empty();
  for (const char* const name : {"polypropylene", "steel-304"}) {
    if (has_materials) break;
    auto material = read_named_material(name);
    if (!material) return material.error();
    plan.materials.push_back(std::move(material).value());
  }
  for (const std::filesystem::path& spoon : spoons) {
    auto read = read_spoon(spoon);
    if (!read) return read.error();
    plan.spoons.push_back(std::move(read).value());
  }
  if (const auto name = find_repeated_name(plan.spoons)) {
    return Error{ErrorCode::duplicate, "two spoons have the name \"" + excerpt(*name) + "\"; rename a file"};
  }
  for (const SpoonRating& rating : plan.ratings) {
    if (std::none_of(plan.spoons.begin(), plan.spoons.end(),
                     [&](const StudySpoon& spoon) { return spoon.name == rating.spoon; })) {
      return Error{
          ErrorCode::unknown,
          file.string() + ": ratings: no spoon of this study has the name \"" + excerpt(rating.spoon) + "\"",
          "ratings"};
    }
  }
  return plan;
}

std::vector<std::string> find_large_foods(const StudyPlan& plan) {
  std::vector<std::string> lines;
  for (const StudySpoon& spoon : plan.spoons) {
    for (const StudyFood& food : plan.foods) {
      const Vector3 size_m = bounding_box(food.body.surface.net).extent();
      if (size_m.x() <= spoon.bowl.length_m && size_m.z() <= spoon.bowl.width_m) continue;
      lines.push_back("\"" + food.name + "\" of " + short_length_text(size_m.x()) + " by " +
                      short_length_text(size_m.z()) + " is larger than the bowl of \"" + spoon.name + "\", " +
                      short_length_text(spoon.bowl.length_m) + " by " +
                      short_length_text(spoon.bowl.width_m) + ", and lies on its rim");
    }
  }
  return lines;
}

Json plan_to_json(const StudyPlan& plan) {
  Json json = {{"method", study_method}};
  for (const StudySpoon& spoon : plan.spoons) {
    json["spoons"].push_back({{"name", spoon.name}, {"shape", hash_shape(spoon.body)}});
  }
  for (const StudyFood& food : plan.foods) {
    json["foods"].push_back({{"name", food.name},
                             {"shape", hash_shape(food.body)},
                             {"material", material_to_json(food.body.material)}});
  }
  json["tilts_deg"] = plan.tilts_deg;
  json["frictions"] = plan.frictions;
  json["usual_friction"] = plan.usual_friction;
  json["vary"] = Json::object();
  for (const StudyVariation& variation : plan.variations) {
    json["vary"][study_factor_names[static_cast<std::size_t>(variation.factor)]] = variation.values;
  }
  if (plan.is_full_grid) json["grid"] = "full";
  if (plan.sample.count > 0) {
    json["sample"] = {{"method", sample_method_names[static_cast<std::size_t>(plan.sample.method)]},
                      {"count", plan.sample.count},
                      {"seed", plan.sample.seed},
                      {"ranges", ranges_to_json(plan.sample.ranges)}};
  }
  if (plan.sensitivity.count > 0) {
    json["sensitivity"] = {{"count", plan.sensitivity.count},
                           {"ranges", ranges_to_json(plan.sensitivity.ranges)}};
  }
  json["claim"] = plan.tries_claim;
  json["repeats"] = plan.repeats;
  return json;
}

const std::string& find_first_of_shape(const StudyPlan& plan, const std::string& spoon) {
  const auto named = std::find_if(plan.spoons.begin(), plan.spoons.end(),
                                  [&](const StudySpoon& one) { return one.name == spoon; });
  SPOONBILL_ASSERT(named != plan.spoons.end());
  const auto is_same = [&](const StudySpoon& one) {
    const Surface &a = one.body.surface, &b = named->body.surface;
    return a.u.knots() == b.u.knots() && a.v.knots() == b.v.knots() && a.net.x == b.net.x &&
           a.net.y == b.net.y && a.net.z == b.net.z && one.bowl.rim == named->bowl.rim;
  };
  return std::find_if(plan.spoons.begin(), plan.spoons.end(), is_same)->name;
}

}  // namespace spoonbill
