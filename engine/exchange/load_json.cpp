// Regions, loads and supports as JSON fields.
#include <type_traits>
#include <variant>

#include "engine/base/text.h"
#include "engine/exchange/field_json.h"
#include "engine/exchange/length.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {
namespace {

constexpr double deepest_m = 1.0;

Range<double> read_shares(FieldReader& reader, const char* field) {
  const Json& list = reader.list(field, {2, 2});
  Range<double> shares{0.0, 1.0};
  if (!reader.status().ok()) return shares;
  for (const auto& [place, share] : {std::pair{0u, &shares.low}, std::pair{1u, &shares.high}}) {
    if (list[place].is_number()) *share = list[place].get<double>();
    const bool fits = list[place].is_number() && *share >= 0.0 && *share <= 1.0;
    if (!fits) reader.refuse(field, "is " + json_excerpt(list) + ", must be two numbers from 0 to 1");
  }
  return shares;
}

// One length: from there inwards.
Range<double> read_depths(FieldReader& reader) {
  const Json& list = reader.list("depth_mm", {1, 2});
  Range<double> depths = BodyRegion().depth_m;
  if (!reader.status().ok()) return depths;
  bool fits = true;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::optional<double> depth = length_from_json(list[i]);
    fits &= depth && *depth >= 0.0 && *depth <= deepest_m;
    if (fits) (i == 0 ? depths.low : depths.high) = *depth;
  }
  if (!fits) {
    reader.refuse("depth_mm", "is " + json_excerpt(list) + ", must be one or two numbers from 0 to " +
                                  number_text(1e3 * deepest_m));
  }
  return depths;
}

void refuse_by(const Status& status, FieldReader& reader) {
  if (!status.ok() && reader.status().ok()) reader.refuse(status.error().message);
}

}  // namespace

BodyRegion read_region(FieldReader reader) {
  BodyRegion region;
  if (reader.has("along")) region.along = read_shares(reader, "along");
  if (reader.has("around")) region.around = read_shares(reader, "around");
  if (reader.has("depth_mm")) region.depth_m = read_depths(reader);
  refuse_by(check_region(region), reader);
  for (const char* field : {"along", "around", "depth_mm"}) reader.ignore(field);
  reader.finish();
  return region;
}

Json region_to_json(const BodyRegion& region) {
  const BodyRegion whole;
  Json json = Json::object();
  const auto add = [&](const char* field, const Range<double>& shares, const Range<double>& all) {
    if (shares.low == all.low && shares.high == all.high) return;
    json[field] = Json::array({number_to_json(shares.low), number_to_json(shares.high)});
  };
  add("along", region.along, whole.along);
  add("around", region.around, whole.around);
  if (region.depth_m.high != whole.depth_m.high) {
    json["depth_mm"] = Json::array({length_to_json(region.depth_m.low), length_to_json(region.depth_m.high)});
  } else if (region.depth_m.low != whole.depth_m.low) {
    json["depth_mm"] = Json::array({length_to_json(region.depth_m.low)});
  }
  return json;
}

Load read_load(FieldReader& reader, const Surface& surface) {
  Load load = make_kind<Load>(reader.choose("kind", kind_names<Load>));
  const auto read = [&]<class Kind>(Kind& of) {
    if constexpr (std::is_same_v<Kind, PointLoad>) {
      reader.number("u", {surface.u.domain_start(), surface.u.domain_end()});
      reader.number("v", {surface.v.domain_start(), surface.v.domain_end()});
    } else {
      of.region = read_region(reader.inner("region"));
    }
    read_fields(reader, of);
  };
  std::visit(read, load);
  return load;
}

Json load_to_json(const Load& load) {
  const auto write = []<class Kind>(const Kind& of) {
    Json json{{"kind", kind_name<Kind>}};
    if constexpr (!std::is_same_v<Kind, PointLoad>) json["region"] = region_to_json(of.region);
    add_fields(of, json);
    return json;
  };
  return std::visit(write, load);
}

Support read_support(FieldReader& reader) {
  Support support{read_region(reader.inner("region"))};
  if (reader.has("motion")) {
    FieldReader motion = reader.inner("motion");
    support.motion = read_fields<SupportMotion>(motion);
    motion.finish();
  }
  reader.ignore("motion");
  refuse_by(check_support(support), reader);
  return support;
}

Json support_to_json(const Support& support) {
  Json json;
  json["region"] = region_to_json(support.region);
  if (support.motion) add_fields(*support.motion, json["motion"]);
  return json;
}

}  // namespace spoonbill
