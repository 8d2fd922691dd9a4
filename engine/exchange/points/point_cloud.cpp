#include "engine/exchange/points/point_cloud.h"

#include <cmath>

#include "engine/exchange/file_format.h"

namespace spoonbill {
namespace {

Error too_many(std::uint64_t count) {
  return Error{"has " + std::to_string(count) + " points, more than the " + std::to_string(point_limit) +
               " that are read; thin it out"};
}

}  // namespace

Status PointGatherer::expect(std::uint64_t count, bool with_normals) {
  if (count > point_limit) return too_many(count);
  with_normals_ = with_normals;
  cloud_.points.reserve(count);
  if (with_normals) cloud_.normals.reserve(count);
  return {};
}

Status PointGatherer::add(const Vector3& point, const Vector3& normal) {
  ++seen_;
  if (point.hasNaN()) {
    ++cloud_.skipped;
    return {};
  }
  if (!point.allFinite()) {
    return Error{"point " + std::to_string(seen_) + " lies at infinity; remove it or export the scan anew"};
  }
  if (cloud_.points.size() == point_limit) return too_many(seen_);
  cloud_.points.push_back(point);
  if (with_normals_) cloud_.normals.push_back(normal.allFinite() ? normal : Vector3::Zero());
  return {};
}

Result<PointCloud> PointGatherer::done() && {
  if (!cloud_.points.empty()) return std::move(cloud_);
  if (cloud_.skipped > 0) {
    return Error{"all of its " + std::to_string(cloud_.skipped) +
                 " points have a coordinate that is no number; scan it anew"};
  }
  return Error{"has no points"};
}

Result<PointCloud> points_of(std::string_view bytes, const std::filesystem::path& file) {
  const FileFormat format = format_of(file);
  auto cloud = format == FileFormat::ply   ? ply_points(bytes)
               : format == FileFormat::pcd ? pcd_points(bytes)
               : format == FileFormat::obj ? obj_points(bytes)
                                           : text_points(bytes);
  if (!cloud) return Error{file.string() + ": " + cloud.error().message};
  return cloud;
}

}  // namespace spoonbill
