#include "app/files/cloud_file.h"

#include <utility>

#include "app/files/foreign_child.h"
#include "engine/base/file.h"

namespace spoonbill {
namespace {

const char* const smaller = "thin it out";

bool is_readable(const CloudCounts& counts) {
  return counts.points <= point_limit && (counts.normals == 0 || counts.normals == counts.points);
}

}  // namespace

Result<std::optional<PointCloud>> read_cloud_file(const std::filesystem::path& file,
                                                  const MeshReading& reading) {
  if (Status status = check_file(file, point_file_bytes_limit, smaller); !status) return status.error();
  auto child =
      ForeignChild::start({file, "cloud", smaller},
                          {reading.program.string(), "read-points", "--", file.string()}, reading.patience);
  if (!child) return child.error();
  const auto head = child->next();
  if (!head) return head.error();
  if (head->kind == FrameKind::faces) return std::optional<PointCloud>();
  CloudCounts counts;
  if (head->kind != FrameKind::cloud || head->bytes < sizeof counts) return child->not_in_form();
  if (Status got = child->read(&counts, sizeof counts); !got) return got.error();
  if (!is_readable(counts) || head->bytes != cloud_frame_bytes(counts)) return child->not_in_form();
  PointCloud cloud;
  cloud.points.resize(counts.points);
  cloud.normals.resize(counts.normals);
  cloud.skipped = counts.skipped;
  if (Status got = child->read(cloud.points); !got) return got.error();
  if (Status got = child->read(cloud.normals); !got) return got.error();
  return std::optional(std::move(cloud));
}

}  // namespace spoonbill
