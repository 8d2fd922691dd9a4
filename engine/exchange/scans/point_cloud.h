// Point clouds as scanners write them, and the readers of their files. Errors of the parse_ functions say
// what is wrong, without the file's name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// Largest number of points that is read from a file.
inline constexpr std::size_t point_limit = 5'000'000;
// Largest size of a file of points, in bytes; enough for point_limit lines of text with colours and normals.
inline constexpr std::size_t point_file_bytes_limit = std::size_t{1} << 30;

struct PointCloud {
  std::vector<Vector3> points;   // in the file's own unit
  std::vector<Vector3> normals;  // one normal for each point, of any length; may be empty
  // Number of points skipped because a coordinate is NaN. Depth cameras write such points.
  std::size_t skipped = 0;
};

// Builder of a cloud from single points, used by the readers. Call begin(), add() for each point, and
// finish().
class PointCollector {
 public:
  // Reserves memory for `count` points. Refused: more points than the limit.
  Status begin(std::uint64_t count, bool with_normals);

  // Appends a point. A point with a NaN coordinate is skipped and counted. Refused: infinite coordinates,
  // more points than the limit.
  Status add(const Vector3& point, const Vector3& normal);

  // Returns the cloud. Refused: a cloud without points.
  Result<PointCloud> finish() &&;

 private:
  PointCloud cloud_;
  std::size_t seen_ = 0;
  bool with_normals_ = false;
};

// Reads the points of a PCD file (version 0.5 to 0.7): text, binary, or binary compressed. The fields
// normal_x, normal_y and normal_z are the normals. Refused: POINTS that are not WIDTH times HEIGHT, fewer or
// more points than the header names.
Result<PointCloud> parse_pcd_points(std::string_view bytes);

// Reads one point from each line: x, y, z separated by blanks, commas or semicolons. Three further columns
// are the normal if they have length 1 in all lines. Between semicolons, "12,5" is a number with a decimal
// comma. Ignored: other columns, comments (#, //) and a byte order mark. One line before the first point may
// name the columns or state the number of points. Refused: a stated number that differs from the number of
// points. Also refused: a comma within a word where blanks separate the words, because it may be a separator
// or a decimal comma.
Result<PointCloud> parse_text_points(std::string_view bytes);

// Reads the `v` lines of an OBJ file. Its `vn` lines are the normals if there is one for each point.
Result<PointCloud> parse_obj_points(std::string_view bytes);
bool obj_has_faces(std::string_view bytes);

// Reads the content of a point file. The ending of the file's name selects the reader; the default is text.
// PLY files, which may hold a mesh, are read by parse_ply() instead. Errors name the file.
Result<PointCloud> points_of(std::string_view bytes, const std::filesystem::path& file);

}  // namespace spoonbill
