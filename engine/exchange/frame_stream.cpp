#include "engine/exchange/frame_stream.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace spoonbill {
namespace {

template <class T>
void write_raw(std::ostream& out, const T* data, std::size_t count) {
  out.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
}

void write_head(std::ostream& out, FrameKind kind, std::uint64_t bytes) {
  const FrameHead head{kind, bytes};
  write_raw(out, &head, 1);
}

// Character that precedes the error code in the content of a failure frame: "#4 message".
constexpr char code_mark = '#';

}  // namespace

std::uint64_t mesh_frame_bytes(const MeshCounts& counts) {
  return sizeof counts + counts.vertices * sizeof(Vector3) + counts.triangles * sizeof(TriangleCorners);
}

std::uint64_t cloud_frame_bytes(const CloudCounts& counts) {
  return sizeof counts + (counts.points + counts.normals) * sizeof(Vector3);
}

void write_frame(std::ostream& out, FrameKind kind, std::string_view content) {
  write_head(out, kind, content.size());
  write_raw(out, content.data(), content.size());
  out.flush();
}

void write_progress(std::ostream& out, double fraction) {
  write_frame(out, FrameKind::progress,
              std::to_string(static_cast<int>(1000.0 * std::clamp(fraction, 0.0, 1.0))));
}

void write_mesh(std::ostream& out, const TriangleMesh& mesh) {
  const MeshCounts counts{mesh.vertices_m.size(), mesh.triangles.size()};
  write_head(out, FrameKind::mesh, mesh_frame_bytes(counts));
  write_raw(out, &counts, 1);
  write_raw(out, mesh.vertices_m.data(), mesh.vertices_m.size());
  write_raw(out, mesh.triangles.data(), mesh.triangles.size());
  out.flush();
}

void write_cloud(std::ostream& out, const PointCloud& cloud) {
  const CloudCounts counts{cloud.points.size(), cloud.normals.size(), cloud.skipped};
  write_head(out, FrameKind::cloud, cloud_frame_bytes(counts));
  write_raw(out, &counts, 1);
  write_raw(out, cloud.points.data(), cloud.points.size());
  write_raw(out, cloud.normals.data(), cloud.normals.size());
  out.flush();
}

void write_failure(std::ostream& out, const std::string& message) {
  std::string line = message.substr(0, failure_bytes_limit);
  std::replace_if(
      line.begin(), line.end(), [](char letter) { return letter < ' ' || letter > '~'; }, ' ');
  write_frame(out, FrameKind::failure, line);
}

void write_failure(std::ostream& out, const Error& error) {
  write_failure(out, code_mark + std::to_string(static_cast<int>(error.code)) + " " + error.message);
}

Error parse_failure(std::string_view content) {
  int code = -1;
  if (content.starts_with(code_mark)) {
    const char* end = content.data() + content.size();
    const auto [after, problem] = std::from_chars(content.data() + 1, end, code);
    const bool is_code = problem == std::errc() && code >= 0 && code <= static_cast<int>(ErrorCode::internal);
    if (is_code && after != end && *after == ' ') {
      const auto length = static_cast<std::size_t>(after + 1 - content.data());
      return Error{static_cast<ErrorCode>(code), std::string(content.substr(length))};
    }
  }
  return Error{ErrorCode::process_failed, std::string(content)};
}

bool is_known(FrameKind kind) {
  constexpr std::array kinds{FrameKind::progress, FrameKind::surface, FrameKind::file,
                             FrameKind::solid,    FrameKind::ending,  FrameKind::mesh,
                             FrameKind::cloud,    FrameKind::faces,   FrameKind::failure};
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

std::optional<Frame> read_frame(const ReadBytes& read) {
  FrameHead head;
  if (!read(&head, sizeof head) || !is_known(head.kind) || head.bytes > frame_bytes_limit) return {};
  Frame frame{head.kind, std::string(head.bytes, '\0')};
  if (!read(frame.content.data(), frame.content.size())) return {};
  return frame;
}

}  // namespace spoonbill
