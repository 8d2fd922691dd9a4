#include "engine/collision/stages/pair_stages.h"

#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/collision/stages/contact_stages.h"

namespace spoonbill {

Result<PairStages> PairStages::make(const Surface& first, const Surface& second) {
  auto one = make_nested_grid(first.u, first.v, finest_stage_level);
  if (!one.ok()) return one.error();
  auto other = make_nested_grid(second.u, second.v, finest_stage_level);
  if (!other.ok()) return other.error();
  return PairStages(std::move(one).value(), std::move(other).value());
}

PairStages::PairStages(NestedGrid first, NestedGrid second)
    : first_(std::make_unique<NestedGrid>(std::move(first))),
      second_(std::make_unique<NestedGrid>(std::move(second))),
      proximity_(std::make_unique<SurfaceProximity>(*first_, *second_)) {}

void PairStages::add(const Surface& first, const Surface& second, double margin_m, bool first_closed,
                     bool second_closed, ContactStages& stages) {
  SPOONBILL_ASSERT(margin_m >= 0.0);
  PairQuery query;
  query.first_closed = first_closed;
  query.second_closed = second_closed;
  query.reach_m = margin_m;
  // A new collider does not start from the contacts of an earlier call, so that the search passes through all
  // stages.
  collider_ = std::make_unique<SurfacePairCollider>(*first_, *second_);
  const PairResult result = collider_->collide(first, second, query);
  stages.overflow |= result.overflow;
  add_contacts(first, second, query, result, stages);
  const int number = stages.surfaces;
  stages.surfaces += 2;
  const int level = add_spheres(margin_m, number, stages);
  add_triangles(collider_->cell_pairs().find_within_at_level(margin_m, level), margin_m, number, stages);
}

void PairStages::add_contacts(const Surface& first, const Surface& second, const PairQuery& query,
                              const PairResult& result, ContactStages& stages) {
  const bool near = std::isfinite(result.distance_m);
  if (!result.touching && !near) return;
  proximity_->forget();  // the surfaces may be others than those of the last call
  proximity_->find(first, second, query.reach_m);
  stages.overflow |= proximity_->overflow();
  for (const NearPoint& point : proximity_->first_points()) {
    append(StageContact{contact_at(first, {point.u, point.v, point.point_m, point.gap_m})}, stages.contacts,
           stages);
  }
  const auto add_both = [&](const SurfacePair& pair, double distance) {
    const PairParameters& at = pair.at;
    append(StageContact{contact_at(first, {at.u, at.v, pair.first_m, distance}), true}, stages.contacts,
           stages);
    append(StageContact{contact_at(second, {at.s, at.t, pair.second_m, distance}), true}, stages.contacts,
           stages);
  };
  for (const PairContact& contact : collider_->contacts()) add_both(contact.pair, -contact.depth_m);
  if (!result.touching) add_both(result.nearest, result.distance_m);
}

// Adds the spheres of the cells that the search visits at one level. Returns the children of the kept cells,
// which the search visits at the next level.
std::vector<LevelCell> PairStages::add_level(SurfaceLevels& levels, const std::vector<LevelCell>& visited,
                                             const Marks& kept, int surface, bool is_second,
                                             ContactStages& stages) {
  std::vector<LevelCell> finer;
  for (const LevelCell& cell : visited) {
    const bool is_kept = kept[static_cast<std::size_t>(levels.cell_index(cell))] != 0;
    append(StageSphere{levels.cover(cell), cell, surface, is_second, is_kept}, stages.spheres, stages);
    if (!is_kept || levels.is_finest(cell)) continue;
    const int half = levels.step(cell.level) / 2;
    for (int k = 0; k < 4; ++k) {
      finer.push_back({cell.i + (k >> 1) * half, cell.j + (k & 1) * half, cell.level + 1});
    }
  }
  return finer;
}

// Adds the parameter ranges and, level by level, the spheres. Returns the finest level whose pairs fit the
// capacity, at most finest_stage_level.
int PairStages::add_spheres(double margin_m, int first_surface, ContactStages& stages) {
  SurfaceLevels* const levels[2] = {&collider_->first_levels(), &collider_->second_levels()};
  CellPairs& pairs = collider_->cell_pairs();
  std::vector<LevelCell> visited[2];
  pairs.update();
  ElementMarks within[2] = {ElementMarks(*levels[0]), ElementMarks(*levels[1])};
  pairs.visit_near_elements(margin_m, [&](const CellPair& pair) {
    within[0].mark(pair.first);
    within[1].mark(pair.second);
    return true;
  });
  for (int side = 0; side < 2; ++side) {
    within[side].add_to(stages);
    within[side].visit([&](const LevelCell& element) { visited[side].push_back(element); });
  }
  for (int level = 0;; ++level) {
    Marks kept[2];
    for (int side = 0; side < 2; ++side) {
      kept[side].assign(static_cast<std::size_t>(levels[side]->total_cell_count()), 0);
    }
    for (const CellPair& pair : pairs.find_within_at_level(margin_m, level)) {
      kept[0][static_cast<std::size_t>(levels[0]->cell_index(pair.first))] = 1;
      kept[1][static_cast<std::size_t>(levels[1]->cell_index(pair.second))] = 1;
    }
    for (int side = 0; side < 2; ++side) {
      visited[side] =
          add_level(*levels[side], visited[side], kept[side], first_surface + side, side == 1, stages);
    }
    if (level == finest_stage_level) return level;
    pairs.find_within_at_level(margin_m, level + 1);
    if (pairs.overflow()) return level;
  }
}

void PairStages::add_triangles(const std::vector<CellPair>& pairs, double margin_m, int first_surface,
                               ContactStages& stages) {
  SurfaceLevels* const levels[2] = {&collider_->first_levels(), &collider_->second_levels()};
  // One mark for each triangle of each cell: 1 if it was tested, 2 if it was kept.
  Marks marks[2];
  for (int side = 0; side < 2; ++side) {
    marks[side].assign(static_cast<std::size_t>(2 * levels[side]->total_cell_count()), 0);
  }
  const auto record = [&](int side, const LevelCell& cell, int k, const Triangle& triangle, bool meets) {
    std::uint8_t& mark = marks[side][static_cast<std::size_t>(2 * levels[side]->cell_index(cell) + k)];
    if (mark == 0) ++stages.triangles_tested;
    if (meets && mark != 2) {
      append(StageTriangle{triangle, cell, first_surface + side}, stages.triangles, stages);
    }
    mark = meets || mark == 2 ? 2 : 1;
  };
  for (const CellPair& pair : pairs) {
    const double slack =
        margin_m + triangle_slack(*levels[0], pair.first) + triangle_slack(*levels[1], pair.second);
    const auto first_triangles = cell_triangles(levels[0]->corners(pair.first));
    const auto second_triangles = cell_triangles(levels[1]->corners(pair.second));
    for (int k = 0; k < 4; ++k) {
      const Triangle &one = first_triangles[static_cast<std::size_t>(k >> 1)],
                     &other = second_triangles[static_cast<std::size_t>(k & 1)];
      const bool meet = triangles_meet(one, other, slack);
      record(0, pair.first, k >> 1, one, meet);
      record(1, pair.second, k & 1, other, meet);
    }
  }
}

}  // namespace spoonbill
