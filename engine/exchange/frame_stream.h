// Protocol between the program and the child processes that read and write foreign files, on one machine. A
// frame consists of eight letters that name its kind, the length of its content as a 64-bit number, and the
// content. A child sends any number of progress frames, then its results, and finally one frame of kind
// ending, mesh, cloud, faces or failure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "engine/base/result.h"
#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/exchange/scans/point_cloud.h"

namespace spoonbill {

enum class FrameKind : std::uint64_t {
  progress = 0x676f72706c6e7073,  // "spnlprog" in little-endian order: thousandths done, as text
  surface = 0x667275736c6e7073,   // "spnlsurf": a surface of a CAD model (cad_stream.h)
  file = 0x656c69666c6e7073,      // "spnlfile": the text of a CAD file
  solid = 0x646c6f736c6e7073,     // "spnlsold": a joined solid (cad_stream.h)
  ending = 0x20646e656c6e7073,    // "spnlend ": facts about all surfaces together, as JSON
  mesh = 0x6873656d6c6e7073,      // "spnlmesh": MeshCounts, then vertices and triangles as in TriangleMesh
  cloud = 0x64756c636c6e7073,     // "spnlclud": CloudCounts, then points and normals as in PointCloud
  faces = 0x656361666c6e7073,     // "spnlface": empty; the OBJ file contains a mesh instead of a cloud
  failure = 0x6c6961666c6e7073    // "spnlfail": one line, an error's message with an optional code before it
};

struct MeshCounts {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
};

struct CloudCounts {
  std::uint64_t points = 0;
  std::uint64_t normals = 0;
  std::uint64_t skipped = 0;
};

// mesh_frame_bytes() and cloud_frame_bytes() return the size of a frame's content in bytes, including the
// counts.
std::uint64_t mesh_frame_bytes(const MeshCounts& counts);
std::uint64_t cloud_frame_bytes(const CloudCounts& counts);

struct FrameHead {
  FrameKind kind = FrameKind::failure;  // kind as received; may be unknown
  std::uint64_t bytes = 0;              // size of the content
};

struct Frame {
  FrameKind kind;
  std::string content;
};

// Largest content, in bytes, of a frame that read_frame() accepts.
inline constexpr std::uint64_t frame_bytes_limit = std::uint64_t{1} << 30;
// Largest number of bytes in the message of a failure frame; longer messages are cut.
inline constexpr std::size_t failure_bytes_limit = 400;
// Message that a child sends if its memory limit is too small for its file.
inline constexpr const char* bad_allocation = "bad allocation";

void write_frame(std::ostream& out, FrameKind kind, std::string_view content);
// Writes how much of the work is done; `fraction` is from 0 to 1.
void write_progress(std::ostream& out, double fraction);
void write_mesh(std::ostream& out, const TriangleMesh& mesh);
void write_cloud(std::ostream& out, const PointCloud& cloud);

// Writes a message as one line of printable ASCII, cut to failure_bytes_limit.
void write_failure(std::ostream& out, const std::string& message);
// Writes an error's code and message, for parse_failure().
void write_failure(std::ostream& out, const Error& error);
// Converts the content of a failure frame to an error. The code is `process_failed` if the child sent none.
Error parse_failure(std::string_view content);

// Returns true if the value, which may come from another process, is one of the enumerators.
bool is_known(FrameKind kind);

// Reads exactly `bytes` bytes; returns false if fewer are left.
using ReadBytes = std::function<bool(void* to, std::size_t bytes)>;
// Reads a whole frame. Returns nullopt if the bytes end early, are not a frame, or exceed frame_bytes_limit.
std::optional<Frame> read_frame(const ReadBytes& read);

}  // namespace spoonbill
