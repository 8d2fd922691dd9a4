#include "engine/fitting/voxels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

std::uint64_t direction_of(const Vector3& normal) {
  if (normal.isZero()) return 6;
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::uint64_t>(axis) * 2 + (normal[axis] < 0.0 ? 1 : 0);
}

std::vector<std::uint64_t> keys_of(const Scan& scan, double side_m) {
  constexpr double most = (1 << 20) - 1;
  const Vector3 low = box_about(scan.points_m).low;
  std::vector<std::uint64_t> keys(scan.points_m.size());
  for (std::size_t p = 0; p < keys.size(); ++p) {
    std::uint64_t key = scan.has_normals() ? direction_of(scan.normals[p]) : 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double cell = std::clamp((scan.points_m[p][axis] - low[axis]) / side_m, 0.0, most);
      key = key << 20 | static_cast<std::uint64_t>(cell);
    }
    keys[p] = key;
  }
  return keys;
}

}  // namespace

double size_of(const std::vector<Vector3>& points_m) {
  if (points_m.empty()) return 0.0;
  return box_about(points_m).size();
}

VoxelGroups group_by_voxels(const Scan& scan, double side_m) {
  SPOONBILL_ASSERT(side_m > 0.0);
  const std::vector<std::uint64_t> keys = keys_of(scan, side_m);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(keys.size());
  for (std::uint32_t p = 0; p < keys.size(); ++p) order[p] = {keys[p], p};
  std::sort(order.begin(), order.end());
  VoxelGroups groups;
  groups.group_of.resize(keys.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || order[k].first != order[k - 1].first) ++groups.count;
    groups.group_of[order[k].second] = static_cast<std::uint32_t>(groups.count - 1);
  }
  return groups;
}

double voxel_side_for(const Scan& scan, std::size_t groups) {
  SPOONBILL_ASSERT(groups >= 1);
  const double size = size_of(scan.points_m);
  double side = 1.5 * size / std::sqrt(static_cast<double>(groups));
  // The number of cells that a surface meets goes with the inverse square of their side.
  for (int round = 0; round < 12; ++round) {
    const double ratio = static_cast<double>(group_by_voxels(scan, side).count) / static_cast<double>(groups);
    if (ratio > 0.9 && ratio < 1.1) break;
    if (ratio < 0.9 && side < 1e-4 * size) break;  // there are not as many places
    side *= std::clamp(std::sqrt(ratio), 0.3, 3.0);
  }
  while (group_by_voxels(scan, side).count > groups + groups / 4) side *= 1.2;
  return side;
}

Scan middles_of(const Scan& scan, const VoxelGroups& groups) {
  SPOONBILL_ASSERT(groups.group_of.size() == scan.points_m.size());
  Scan middles;
  middles.points_m.assign(groups.count, Vector3::Zero());
  if (scan.has_normals()) middles.normals.assign(groups.count, Vector3::Zero());
  std::vector<double> counts(groups.count, 0.0);
  for (std::size_t p = 0; p < scan.points_m.size(); ++p) {
    const std::uint32_t group = groups.group_of[p];
    middles.points_m[group] += scan.points_m[p];
    if (scan.has_normals()) middles.normals[group] += scan.normals[p];
    counts[group] += 1.0;
  }
  for (std::size_t g = 0; g < groups.count; ++g) middles.points_m[g] /= counts[g];
  for (Vector3& normal : middles.normals) {
    if (!normal.isZero()) normal.normalize();
  }
  return middles;
}

}  // namespace spoonbill
