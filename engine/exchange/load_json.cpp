// Regions, loads, supports and the ground as JSON fields.
#include "engine/base/number_text.h"
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

Vector3 read_limited(FieldReader& reader, const char* field, double limit) {
  Vector3 vector = reader.vector(field, {-limit, limit});
  if (vector.norm() > limit) reader.refuse(field, "must be no longer than " + number_text(limit));
  return vector;
}

void refuse_by(const Status& status, FieldReader& reader) {
  if (!status.ok() && reader.status().ok()) reader.refuse(status.error().message);
}

SupportMotion read_motion(FieldReader reader) {
  SupportMotion motion;
  motion.kind = reader.choice(
      "kind", {std::pair{"ramp", MotionKind::ramp}, std::pair{"oscillation", MotionKind::oscillation}});
  motion.way_m = reader.position_m("way_mm", {-way_limit_m, way_limit_m});
  if (motion.way_m.norm() > way_limit_m) {
    reader.refuse("way_mm", "must be no longer than " + number_text(1e3 * way_limit_m));
  }
  if (motion.kind == MotionKind::ramp) {
    motion.duration_s = reader.number("duration_s", motion_duration_range_s);
  } else {
    motion.frequency_hz = reader.number("frequency_hz", motion_frequency_range_hz);
  }
  reader.finish();
  return motion;
}

Json motion_to_json(const SupportMotion& motion) {
  Json json;
  const bool ramp = motion.kind == MotionKind::ramp;
  json["kind"] = ramp ? "ramp" : "oscillation";
  json["way_mm"] = position_to_json(motion.way_m);
  json[ramp ? "duration_s" : "frequency_hz"] = number_to_json(ramp ? motion.duration_s : motion.frequency_hz);
  return json;
}

enum class LoadKind { pressure, force, point };

struct FieldsOfLoad {
  Json operator()(const PressureLoad& load) const {
    Json json{{"kind", "pressure"}};
    json["region"] = region_to_json(load.region);
    json["pressure_pa"] = number_to_json(load.pressure_pa);
    return json;
  }
  Json operator()(const ForceLoad& load) const {
    Json json{{"kind", "force"}};
    json["region"] = region_to_json(load.region);
    json["force_n"] = vector_to_json(load.force_n);
    json["shared_by"] = load.shared_by == ForceShare::surface ? "surface" : "volume";
    return json;
  }
  Json operator()(const PointLoad& load) const {
    Json json{{"kind", "point"}};
    json["u"] = number_to_json(load.u);
    json["v"] = number_to_json(load.v);
    json["force_n"] = vector_to_json(load.force_n);
    return json;
  }
};

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
  const auto kind =
      reader.choice("kind", {std::pair{"pressure", LoadKind::pressure}, std::pair{"force", LoadKind::force},
                             std::pair{"point", LoadKind::point}});
  if (kind == LoadKind::point) {
    PointLoad load;
    load.u = reader.number("u", {surface.u.domain_start(), surface.u.domain_end()});
    load.v = reader.number("v", {surface.v.domain_start(), surface.v.domain_end()});
    load.force_n = read_limited(reader, "force_n", force_limit_n);
    return load;
  }
  const BodyRegion region = read_region(reader.inner("region"));
  if (kind == LoadKind::pressure) {
    return PressureLoad{region, reader.number("pressure_pa", pressure_range_pa)};
  }
  ForceLoad load{region, read_limited(reader, "force_n", force_limit_n)};
  load.shared_by = reader.choice(
      "shared_by", {std::pair{"surface", ForceShare::surface}, std::pair{"volume", ForceShare::volume}});
  return load;
}

Json load_to_json(const Load& load) {
  return std::visit(FieldsOfLoad{}, load);
}

Support read_support(FieldReader& reader) {
  Support support{read_region(reader.inner("region"))};
  if (reader.has("motion")) support.motion = read_motion(reader.inner("motion"));
  reader.ignore("motion");
  refuse_by(check_support(support), reader);
  return support;
}

Json support_to_json(const Support& support) {
  Json json;
  json["region"] = region_to_json(support.region);
  if (support.motion) json["motion"] = motion_to_json(*support.motion);
  return json;
}

Ground read_ground(FieldReader& reader) {
  Ground ground;
  ground.point_m = reader.position_m("point_mm", position_range_m);
  ground.normal = reader.direction("normal");
  ground.friction = reader.number("friction", ground_friction_range);
  return ground;
}

void add_ground(const Ground& ground, Json& json) {
  json["point_mm"] = position_to_json(ground.point_m);
  json["normal"] = vector_to_json(ground.normal);
  json["friction"] = number_to_json(ground.friction);
}

}  // namespace spoonbill
