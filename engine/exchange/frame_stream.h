// Frames of bytes between the program and the children that read and write foreign files for it, on one
// machine: eight letters that say what follows, its length in 64 bits, and so many bytes. A child sends
// progress as it likes, then what it was asked for, and last one of ending, mesh, cloud, faces or failure.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "engine/collision/meshes/triangle_mesh.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {

enum class FrameKind : std::uint64_t {
  progress = 0x676f72706c6e7073,  // "spnlprog" in little-endian order: a share in thousandths, as text
  surface = 0x667275736c6e7073,   // "spnlsurf": cad_stream.h
  file = 0x656c69666c6e7073,      // "spnlfile": the text of a CAD file
  solid = 0x646c6f736c6e7073,     // "spnlsold": cad_solid_stream.h
  ending = 0x20646e656c6e7073,    // "spnlend ": what is said of all surfaces together, as JSON
  mesh =
      0x6873656d6c6e7073,  // "spnlmesh": MeshCounts, then vertices and triangles as TriangleMesh holds them
  cloud = 0x64756c636c6e7073,   // "spnlclud": CloudCounts, then points and normals as PointCloud holds them
  faces = 0x656361666c6e7073,   // "spnlface": no cloud but a mesh; no bytes
  failure = 0x6c6961666c6e7073  // "spnlfail": the line that says why there is nothing
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

// Of the frame's content, counts included.
std::uint64_t mesh_frame_bytes(const MeshCounts& counts);
std::uint64_t cloud_frame_bytes(const CloudCounts& counts);

struct FrameHead {
  FrameKind kind = FrameKind::failure;  // perhaps of no known letters
  std::uint64_t bytes = 0;              // that follow
};

struct Frame {
  FrameKind kind;
  std::string content;
};

// The most that a frame's content may be when it is read as a whole.
inline constexpr std::uint64_t frame_bytes_limit = std::uint64_t{1} << 30;
// Of a failure's line, in bytes.
inline constexpr std::size_t longest_failure = 400;
// The failure of a child that has not the memory for its file.
inline constexpr const char* bad_allocation = "bad allocation";

void write_frame(std::ostream& out, FrameKind kind, std::string_view content);
void write_progress(std::ostream& out, double share);
void write_mesh(std::ostream& out, const TriangleMesh& mesh);
void write_cloud(std::ostream& out, const PointCloud& cloud);
// As one line of printable letters, cut to the longest.
void write_failure(std::ostream& out, const std::string& message);

// Whether the letters are those of a kind.
bool is_known(FrameKind kind);

// Reads so many bytes; false when there are fewer.
using ReadBytes = std::function<bool(void* to, std::size_t bytes)>;
// Reads a whole frame. Nothing where the bytes end, are no frame, or a frame of more than the limit.
std::optional<Frame> read_frame(const ReadBytes& read);

}  // namespace spoonbill
