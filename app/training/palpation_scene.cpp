#include "app/training/palpation_scene.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "engine/exchange/document.h"
#include "engine/material/lattice/body_coordinates.h"
#include "engine/material/lattice/body_lattice.h"

namespace spoonbill {
namespace {

constexpr double start_gap_m = 0.01;  // between the finger and the block at the start

// Returns a number from -1 to 1 that is the same with every standard library.
double draw_signed(std::mt19937& random) {
  return 2.0 * static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 1.0;
}

Result<Document> read_block(const Task& task) {
  auto document = read_document(task.block);
  if (!document) return document;
  const std::vector<Body>& bodies = document->scene.bodies;
  if (bodies.size() == 1 && bodies.front().kind == BodyKind::deformable && bodies.front().mesh == nullptr) {
    return document;
  }
  return Error{ErrorCode::unsupported, task.block.string() + ": a block must be one deformable body"};
}

// Returns the number of turns, from -0.5 to 0.5, from one position around a body to another.
double turns_between(double from, double to) {
  const double turns = to - from;
  return turns - std::floor(turns + 0.5);
}

// Returns the region between two depths that has, along and around the body, the nodes within a distance of a
// point.
std::optional<BodyRegion> find_region_about(const Vector3& point_m, double radius_m,
                                            const Range<double>& depth_m, const LatticeMesh& mesh) {
  const std::vector<BodyCoordinates> nodes = find_node_coordinates(mesh);
  double nearest_m = radius_m, around = 0.0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const double distance_m = (mesh.nodes[n] - point_m).norm();
    if (!std::isfinite(nodes[n].along) || distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    around = nodes[n].around;
  }
  Range<double> along{1.0, 0.0}, turns{0.0, 0.0};
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (!std::isfinite(nodes[n].along) || (mesh.nodes[n] - point_m).norm() > radius_m) continue;
    along = {std::min(along.low, nodes[n].along), std::max(along.high, nodes[n].along)};
    const double turn = turns_between(around, nodes[n].around);
    turns = {std::min(turns.low, turn), std::max(turns.high, turn)};
  }
  if (!(along.low < along.high && turns.low < turns.high)) return std::nullopt;
  const auto into_turn = [](double turn) { return turn - std::floor(turn); };
  return BodyRegion{along, {into_turn(around + turns.low), into_turn(around + turns.high)}, depth_m};
}

struct FilledPart {
  double volume_m3 = 0.0;
  Vector3 centre_m = Vector3::Zero();
};

// Returns the cells of a lattice whose centres are in the region.
FilledPart measure_region(const BodyRegion& region, const LatticeMesh& mesh) {
  const std::vector<BodyCoordinates> cells = find_cell_coordinates(mesh);
  FilledPart part;
  for (int k = 0; k + 1 < mesh.count[2]; ++k) {
    for (int i = 0; i + 1 < mesh.count[0]; ++i) {
      for (int j = 0; j + 1 < mesh.count[1]; ++j) {
        if (!mesh.is_filled(i, j, k) || !contains(region, cells[mesh.cell_index(i, j, k)])) continue;
        const CellCorners corners = mesh.cell(i, j, k);
        const double volume_m3 = mesh.cell_fraction(i, j, k) * cell_volume(corners);
        part.volume_m3 += volume_m3;
        for (const Vector3& corner : corners) part.centre_m += volume_m3 / 8.0 * corner;
      }
    }
  }
  if (part.volume_m3 > 0.0) part.centre_m /= part.volume_m3;
  return part;
}

}  // namespace

Result<TrainingScene> make_palpation_scene(const Task& task, std::uint32_t seed) {
  auto document = read_block(task);
  if (!document) return document.error();
  TrainingScene made;
  made.scene = std::move(document->scene);
  Body& block = made.scene.bodies.front();
  const LumpModel& lump = task.lump;
  const Box box = find_bounds(block);
  std::mt19937 random(seed);
  Vector3 wanted_m = box.centre();
  wanted_m.x() += 0.5 * lump.area_m.x() * draw_signed(random);
  wanted_m.z() += 0.5 * lump.area_m.y() * draw_signed(random);
  wanted_m.y() = box.high.y() - lump.depth_m - lump.radius_m;
  const auto mesh = make_body_lattice(block);
  if (!mesh) return mesh.error().in(task.block.string());
  const Range<double> depth_m{lump.depth_m, lump.depth_m + 2.0 * lump.radius_m};
  const auto region = find_region_about(wanted_m, lump.radius_m, depth_m, mesh.value());
  const FilledPart part = region ? measure_region(*region, mesh.value()) : FilledPart();
  // The lump is made of whole cells: its volume may differ from that of the box about a ball.
  const double ball_box_m3 = 8.0 * lump.radius_m * lump.radius_m * lump.radius_m;
  if (!(part.volume_m3 > 0.1 * ball_box_m3 && part.volume_m3 < 3.0 * ball_box_m3)) {
    return Error{ErrorCode::inconsistent,
                 task.block.string() +
                     ": a lump of this size and depth does not fit the cells of the block; "
                     "change radius_mm, depth_mm or area_mm, or give the block more nodes",
                 "lump"};
  }
  Material stiff = block.material;
  stiff.name += " lump";
  stiff.youngs_modulus_pa =
      std::min(lump.stiffness_ratio * stiff.youngs_modulus_pa, youngs_modulus_range_pa.high);
  block.regions.push_back({*region, stiff, std::nullopt});
  made.lump_m = part.centre_m;
  made.start_m = box.centre();
  made.start_m.y() = box.high.y() + lump.tool_radius_m + start_gap_m;
  Tool& tool = made.scene.tool;
  tool = Tool();
  tool.kind = ToolKind::sphere;
  tool.action = ToolAction::push;
  tool.reach = ToolReach::whole;
  tool.radius_m = lump.tool_radius_m;
  made.scene.sculpting.force_scale = 1.0;
  made.scene.symmetry = {};
  made.scene.trial.reset();
  return made;
}

}  // namespace spoonbill
