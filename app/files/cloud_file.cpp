#include "app/files/cloud_file.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "app/files/foreign_file.h"
#include "app/files/mesh_stream.h"
#include "app/process/child_output.h"

namespace spoonbill {
namespace {

const char* const smaller = "thin it out";

Error explain(const std::filesystem::path& file, ChildOutput& child, const MeshReading& reading) {
  return explain_end(file, child.wait(), reading.patience, "cloud", smaller);
}

Error failure_of_reading(const std::filesystem::path& file, ChildOutput& child, std::uint64_t length,
                         const MeshReading& reading) {
  std::string reason(std::min(length, MeshStreamHead::longest_failure), ' ');
  if (!child.read(reason.data(), reason.size())) return explain(file, child, reading);
  if (reason == bad_allocation) {
    return Error{file.string() + ": reading it takes more than " +
                 std::to_string(ChildOutput::memory_limit >> 30) + " GiB; " + smaller};
  }
  std::replace_if(
      reason.begin(), reason.end(), [](char letter) { return letter < ' ' || letter > '~'; }, ' ');
  return Error{file.string() + ": " + reason};
}

bool is_cloud(const MeshStreamHead& head) {
  return head.letters == MeshStreamHead::cloud && head.first_count <= point_limit &&
         (head.second_count == 0 || head.second_count == head.first_count);
}

}  // namespace

Result<std::optional<PointCloud>> read_cloud_file(const std::filesystem::path& file,
                                                  const MeshReading& reading) {
  if (Status status = check_foreign_file(file, point_file_bytes_limit, smaller); !status) {
    return status.error();
  }
  auto child =
      ChildOutput::start({reading.program.string(), "read-points", "--", file.string()}, reading.patience);
  if (!child) return Error{file.string() + ": " + child.error().message};
  MeshStreamHead head;
  if (!child->read(&head, sizeof head)) return explain(file, child.value(), reading);
  if (head.letters == MeshStreamHead::failure) {
    return failure_of_reading(file, child.value(), head.first_count, reading);
  }
  if (head.letters == MeshStreamHead::faces) return std::optional<PointCloud>();
  if (!is_cloud(head)) {
    return Error{file.string() + ": the reader did not answer in its own form; build the program anew"};
  }
  PointCloud cloud;
  std::uint64_t skipped = 0;
  cloud.points.resize(head.first_count);
  cloud.normals.resize(head.second_count);
  if (!child->read(&skipped, sizeof skipped) ||
      !child->read(cloud.points.data(), head.first_count * sizeof(Vector3)) ||
      !child->read(cloud.normals.data(), head.second_count * sizeof(Vector3))) {
    return explain(file, child.value(), reading);
  }
  cloud.skipped = skipped;
  return std::optional(std::move(cloud));
}

}  // namespace spoonbill
