#include "engine/collision/stages/tool_stages.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/stages/contact_stages.h"

namespace spoonbill {
namespace {

// Number of times that a triangle is cut into four parts before it counts as within reach.
constexpr int triangle_cuts = 6;

// Returns false only if no point of the triangle is within `reach_m` of the tool. Tests balls around the
// triangle and around its parts.
bool is_within(const ToolShape& tool, const Triangle& triangle, double reach_m, int cuts) {
  const auto& [a, b, c] = triangle;
  const Vector3 centre = (a + b + c) / 3.0;
  const double radius = std::sqrt(
      std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()}));
  const double distance = tool.distance_within(centre, reach_m + 2.0 * radius);
  if (distance - radius > reach_m) return false;
  if (distance <= reach_m || cuts == 0) return true;
  const Vector3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
  return is_within(tool, {a, ab, ca}, reach_m, cuts - 1) || is_within(tool, {ab, b, bc}, reach_m, cuts - 1) ||
         is_within(tool, {ca, bc, c}, reach_m, cuts - 1) || is_within(tool, {ab, bc, ca}, reach_m, cuts - 1);
}

}  // namespace

Result<ToolStages> ToolStages::make(const KnotVector& u, const KnotVector& v) {
  auto nested = make_nested_grid(u, v, finest_stage_level);
  if (!nested.ok()) return nested.error();
  return ToolStages(std::move(nested).value());
}

ToolStages::ToolStages(NestedGrid nested) : nested_(std::make_unique<NestedGrid>(std::move(nested))) {}

void ToolStages::add(const Surface& surface, const ToolShape& tool, double margin_m, bool closed,
                     ContactStages& stages, std::shared_ptr<const TrimmedArea> trim) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  // A new collider does not start from the contact of an earlier call, so that the search passes through all
  // stages.
  collider_ = std::make_unique<SurfaceCollider>(*nested_, std::move(trim));
  const CollisionResult result = collider_->collide(surface, tool, margin_m, closed);
  stages.overflow |= result.overflow;
  const int number = stages.surfaces++;
  add_spheres(number, stages);
  if (!result.found) return;
  add_triangles(tool, margin_m, number, stages);
  add_contacts(surface, tool, result, stages);
}

void ToolStages::add_spheres(int surface, ContactStages& stages) {
  SurfaceLevels& levels = collider_->levels();
  const std::vector<LevelCell>& visited = collider_->visited_cells();
  const std::vector<LevelCell>& finest = collider_->finest_cells();
  const auto contains = [&](const LevelCell& cell, const LevelCell& other) {
    const int step = levels.step(cell.level);
    return other.i >= cell.i && other.i < cell.i + step && other.j >= cell.j && other.j < cell.j + step;
  };
  ElementMarks within(levels);
  // `finer` is the position in `visited` of the children of the next refined cell. `last` is the position in
  // `finest` of the next finest cell.
  std::size_t finer = 0, last = 0;
  while (finer < visited.size() && visited[finer].level == 0) ++finer;
  for (const LevelCell& cell : visited) {
    if (cell.level == 0) within.mark(cell);
    bool kept = false;
    if (levels.is_finest(cell)) {
      kept = last < finest.size() && finest[last].i == cell.i && finest[last].j == cell.j;
      if (kept) ++last;
    } else {
      while (finer < visited.size() && visited[finer].level == cell.level + 1 &&
             contains(cell, visited[finer])) {
        kept = true;
        ++finer;
      }
    }
    append(StageSphere{levels.cover(cell), cell, surface, false, kept}, stages.spheres, stages);
  }
  within.add_to(stages);
}

void ToolStages::add_triangles(const ToolShape& tool, double margin_m, int surface, ContactStages& stages) {
  SurfaceLevels& levels = collider_->levels();
  for (const LevelCell& cell : collider_->finest_cells()) {
    const PatchCorners at = levels.corners(cell);
    const double reach = margin_m + triangle_slack(levels, cell);
    for (const Triangle& triangle : cell_triangles(at)) {
      ++stages.triangles_tested;
      if (!is_within(tool, triangle, reach, triangle_cuts)) continue;
      append(StageTriangle{triangle, cell, surface}, stages.triangles, stages);
    }
  }
}

void ToolStages::add_contacts(const Surface& surface, const ToolShape& tool, const CollisionResult& result,
                              ContactStages& stages) {
  const Grid& grid = nested_->grid;
  for (const NearSample& sample : collider_->near_samples()) {
    const SurfaceSpot spot{grid.u.parameters[static_cast<std::size_t>(sample.index / grid.columns())],
                           grid.v.parameters[static_cast<std::size_t>(sample.index % grid.columns())],
                           collider_->levels().sample(sample.index), sample.distance_m};
    append(StageContact{contact_at(surface, spot)}, stages.contacts, stages);
  }
  const std::vector<ToolContactRegion>& regions = collider_->find_contact_regions(tool);
  for (const ToolContactRegion& region : regions) {
    append(StageContact{region.deepest, true}, stages.contacts, stages);
  }
  if (regions.empty()) append(StageContact{result.nearest, true}, stages.contacts, stages);
}

}  // namespace spoonbill
