#include "engine/exchange/old_documents.h"

#include <cstddef>
#include <initializer_list>
#include <utility>

#include "engine/exchange/field_reader.h"
#include "engine/scene/material.h"
#include "engine/scene/scene.h"
#include "engine/scene/tool.h"

namespace spoonbill {

namespace {

constexpr Range<int> iterations_range{1, 8};
constexpr Range<double> old_damping_range_per_s{0.0, 1000.0};
constexpr Range<double> old_flow_rate_range_per_s{0.0, 1000.0};
constexpr Range<double> damping_ratio_range{0.0, 2.0};
constexpr Range<double> loss_factor_range{0.0, 4.0};
constexpr double fastest_vibration_rad_per_s = 1500.0;

constexpr double damping_time_for(double damping_ratio, int iterations) {
  return 2.0 * damping_ratio / (fastest_vibration_rad_per_s * iterations);
}

static_assert(damping_time_for(damping_ratio_range.high, iterations_range.low) <= damping_time_range_s.high);
static_assert(old_flow_rate_range_per_s.high * iterations_range.high <= flow_rate_range_per_s.high);
static_assert(old_damping_range_per_s.high * iterations_range.high <= drag_range_per_s.high);
static_assert(iterations_range.high <= tool_substeps_range.high);

// Replaces a field by another one at the same position in the object.
void replace_field(Json& object, const std::string& old_name, const std::string& name, Json value) {
  Json replaced = Json::object();
  for (auto& item : object.items()) {
    if (item.key() == old_name) {
      replaced[name] = std::move(value);
    } else {
      replaced[item.key()] = std::move(item.value());
    }
  }
  object = std::move(replaced);
}

// Refuses the current fields: an old file must have only the former ones, because the former and the current
// fields measure time differently.
void refuse_new_fields(FieldReader& reader, std::initializer_list<const char*> fields) {
  for (const char* field : fields) {
    if (!reader.has(field)) continue;
    reader.refuse(field, "is a field of document version 3; this file has the fields of version 2",
                  ErrorCode::unknown);
  }
}

double read_damping_ratio(FieldReader& reader) {
  if (!reader.has("loss_factor")) return reader.number("damping_ratio", damping_ratio_range);
  if (reader.has("damping_ratio")) {
    reader.refuse("loss_factor", "is another name for damping_ratio; leave one of them out",
                  ErrorCode::duplicate);
  }
  return reader.number("loss_factor", loss_factor_range) / 2.0;
}

// In the convert_ functions below, `reader` reads the JSON that the function then changes.

void convert_material(FieldReader reader, Json& material, int iterations) {
  refuse_new_fields(reader, {"damping_time_s"});
  const char* damping_name = reader.has("loss_factor") ? "loss_factor" : "damping_ratio";
  const double damping_ratio = read_damping_ratio(reader);
  const double flow_rate_per_s = reader.number("flow_rate_per_s", old_flow_rate_range_per_s);
  if (!reader.status().ok()) return;
  material["flow_rate_per_s"] = number_to_json(iterations * flow_rate_per_s);
  replace_field(material, damping_name, "damping_time_s",
                number_to_json(damping_time_for(damping_ratio, iterations)));
}

void convert_sculpting(FieldReader reader, Json& sculpting, int iterations) {
  refuse_new_fields(reader, {"drag_per_s", "real_time", "step_division"});
  const double damping_per_s = reader.number("damping_per_s", old_damping_range_per_s);
  if (!reader.status().ok()) return;
  replace_field(sculpting, "damping_per_s", "drag_per_s", number_to_json(iterations * damping_per_s));
}

// Calls `convert` with the reader and the JSON of an inner object. Does nothing if the field is missing or
// not an object; the reader of current documents then reports it.
template <class Convert>
void convert_inner(FieldReader& reader, Json& outer, const char* field, const Convert& convert) {
  if (outer.contains(field) && outer[field].is_object()) convert(reader.inner(field), outer[field]);
}

// Calls `convert` with the reader and the JSON of each object in a list. Other items are skipped.
template <class Convert>
void convert_items(FieldReader& reader, Json& outer, const char* field, const Convert& convert) {
  if (!outer.contains(field) || !outer[field].is_array()) return;
  std::size_t index = 0;
  for (Json& item : outer[field]) {
    if (item.is_object()) convert(reader.element(item, field, index), item);
    ++index;
  }
}

void convert_body(FieldReader reader, Json& body, int iterations) {
  const auto convert = [&](FieldReader inner, Json& material) {
    convert_material(std::move(inner), material, iterations);
  };
  convert_inner(reader, body, "material", convert);
  convert_items(reader, body, "regions", [&](FieldReader region_reader, Json& region) {
    convert_inner(region_reader, region, "material", convert);
  });
}

// Converts a tool and its soft material. Returns the value of the former field "iterations"; after a problem,
// default_old_iterations.
int convert_tool(FieldReader reader, Json& tool) {
  refuse_new_fields(reader, {"substeps"});
  const int iterations = reader.integer("iterations", iterations_range);
  if (!reader.status().ok()) return default_old_iterations;
  convert_inner(reader, tool, "soft", [&](FieldReader soft_reader, Json& soft) {
    convert_inner(soft_reader, soft, "material", [&](FieldReader inner, Json& material) {
      convert_material(std::move(inner), material, iterations);
    });
  });
  replace_field(tool, "iterations", "substeps", iterations);
  return iterations;
}

bool is_old_material(const Json& material) {
  return material.is_object() && (material.contains("damping_ratio") || material.contains("loss_factor"));
}

}  // namespace

bool is_old_document(const Json& document) {
  if (!document.is_object()) return false;
  const auto version = document.find("spoonbill_document");
  return version != document.end() && version->is_number_integer() && *version <= newest_old_document_version;
}

Result<Json> convert_old_document(const Json& document, const std::string& source) {
  Json converted = document;
  FieldReader reader(converted, source);
  if (!reader.status().ok()) return reader.status().error();
  int iterations = default_old_iterations;
  convert_inner(reader, converted, "tool", [&](FieldReader tool_reader, Json& tool) {
    iterations = convert_tool(std::move(tool_reader), tool);
  });
  const auto convert = [&](FieldReader body_reader, Json& body) {
    convert_body(std::move(body_reader), body, iterations);
  };
  convert_inner(reader, converted, "body", convert);
  convert_items(reader, converted, "other_bodies", convert);
  convert_inner(reader, converted, "sculpting", [&](FieldReader sculpting_reader, Json& sculpting) {
    convert_sculpting(std::move(sculpting_reader), sculpting, iterations);
  });
  if (!reader.status().ok()) return reader.status().error();
  return converted;
}

Status convert_old_material(Json& material, const std::string& source) {
  if (!is_old_material(material)) return {};
  FieldReader reader(material, source);
  convert_material(reader, material, default_old_iterations);
  return reader.status();
}

Status OldCommands::convert(Json& command, const std::string& source) {
  if (!command.is_object()) return {};
  const auto is_named = [&](const char* name) {
    const auto found = command.find("command");
    return found != command.end() && *found == name;
  };
  FieldReader reader(command, source);
  if (is_named("set_tool") && command.contains("iterations")) {
    iterations_ = convert_tool(reader, command);
  } else if (is_named("set_material") && is_old_material(command)) {
    convert_material(reader, command, iterations_);
  } else if (is_named("set_sculpting") && command.contains("damping_per_s")) {
    convert_sculpting(reader, command, iterations_);
  }
  return reader.status();
}

}  // namespace spoonbill
