// Points as scanners write them, and what their files share.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"

namespace spoonbill {

// As many as are read of one file.
inline constexpr std::size_t point_limit = 5'000'000;
// Of a file of them: five million lines of numbers with colours and normals.
inline constexpr std::size_t point_file_bytes_limit = std::size_t{1} << 30;

struct PointCloud {
  std::vector<Vector3> points;   // in the file's own unit
  std::vector<Vector3> normals;  // as many, as they stand in the file; or none
  std::size_t skipped = 0;       // points of which a coordinate is no number, as depth cameras give them
};

// Takes points one by one. The Errors of readers say what is wrong, without the file's name.
class PointGatherer {
 public:
  // Refused: more points than the limit.
  Status expect(std::uint64_t count, bool with_normals);

  // What is NaN is skipped and counted. Refused: infinities, more points than the limit.
  Status add(const Vector3& point, const Vector3& normal);

  // Refused: no point at all.
  Result<PointCloud> done() &&;

 private:
  PointCloud cloud_;
  std::size_t seen_ = 0;
  bool with_normals_ = false;
};

// A PLY file's vertices: text or binary of either byte order; x, y, z and perhaps nx, ny, nz of any type.
// Faces are passed over. Refused: no such vertices, a file that ends before its last one.
Result<PointCloud> ply_points(std::string_view bytes);
// How many faces the header of a PLY file promises; 0 where there is no such header.
std::uint64_t ply_face_count(std::string_view bytes);

// A PCD file's points (version 0.5 to 0.7): text, binary, or binary compressed; normal_x, normal_y, normal_z
// are its normals.
Result<PointCloud> pcd_points(std::string_view bytes);

// A point a line: x, y, z between blanks, commas or semicolons; then, where three further columns have the
// length 1 throughout, a normal. Between semicolons "12,5" is a number with a decimal comma. Other columns
// are passed over, as are comments (#, //), a byte order mark, and before the first point one line of words
// or of one number, the count. Refused: commas within words between blanks, which may part numbers or be
// decimal.
Result<PointCloud> text_points(std::string_view bytes);

// The `v` lines of an OBJ file, whose `vn` lines are normals where there are as many.
Result<PointCloud> obj_points(std::string_view bytes);
bool obj_has_faces(std::string_view bytes);

// By the ending of the name. Each Error names the file.
Result<PointCloud> points_of(std::string_view bytes, const std::filesystem::path& file);

}  // namespace spoonbill
