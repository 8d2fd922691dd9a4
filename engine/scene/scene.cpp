#include "engine/scene/scene.h"

namespace spoonbill {
namespace {

Status check_in_domain(const std::string& field, double parameter, const KnotVector& knots) {
  return check_range(field, parameter, Range<double>{knots.domain_start(), knots.domain_end()});
}

// Points are on the surface. What else is wrong with a load is said where it is put on the lattice.
Status check_point(const Load& load, std::size_t place, const Surface& surface) {
  const auto* point = std::get_if<PointLoad>(&load);
  if (point == nullptr) return {};
  const std::string name = "loads[" + std::to_string(place) + "]: ";
  if (Status status = check_in_domain(name + "u", point->u, surface.u); !status.ok()) return status;
  return check_in_domain(name + "v", point->v, surface.v);
}

}  // namespace

Status check_body_count(const Scene& scene) {
  const auto count = static_cast<int>(scene.bodies.size());
  if (count <= sculpted_body_count_range.high) return check_range("bodies", count, sculpted_body_count_range);
  return Error{"holds " + std::to_string(count) + " bodies, and at most " +
               std::to_string(sculpted_body_count_range.high) +
               " are sculpted together; choose some with `spoonbill convert MODEL OUT.json --bodies 1,3-5`"};
}

Status check_symmetry(const Symmetry& symmetry) {
  return check_fields("symmetry: ", symmetry);
}

Result<std::shared_ptr<const TrimmedArea>> trim_of(const Body& body) {
  std::shared_ptr<const TrimmedArea> trim;
  if (body.trims.empty()) return trim;
  Result<TrimmedArea> area = TrimmedArea::make(body.surface.u, body.surface.v, body.trims);
  if (!area.ok()) return area.error();
  trim = std::make_shared<const TrimmedArea>(std::move(area).value());
  return trim;
}

Status check_loads(const Body& body) {
  if (Status status = check_range("loads", static_cast<int>(body.loads.size()), load_count_range);
      !status.ok()) {
    return status;
  }
  for (std::size_t l = 0; l < body.loads.size(); ++l) {
    if (Status status = check_point(body.loads[l], l, body.surface); !status.ok()) return status;
  }
  return check_range("supports", static_cast<int>(body.supports.size()), support_count_range);
}

Status check_together(const Tool& tool, const Symmetry& symmetry) {
  if (tool.kind != ToolKind::solid || !tool.body->soft) return {};
  if (!row_of(tool.action).with_soft_tool) {
    return Error{"tool: a soft one can only push; make it rigid to pull"};
  }
  if (symmetry.on) return Error{"tool: a soft one has no mirror image; make it rigid or turn symmetry off"};
  return {};
}

Status check_sculpting(const Sculpting& sculpting) {
  return check_fields("sculpting: ", sculpting);
}

}  // namespace spoonbill
