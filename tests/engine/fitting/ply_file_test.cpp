// Tests PLY files as Stanford, MeshLab and VTK write them, and generated files of every form.
#include "engine/exchange/scans/ply_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "engine/exchange/scans/number_lines.h"
#include "engine/exchange/scans/polygon.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/effort.h"

namespace spoonbill {
namespace {

using PlyTriangle = std::array<std::uint32_t, 3>;

FileMesh ply_mesh(const std::string& bytes) {
  auto content = parse_ply(bytes);
  EXPECT_TRUE(content) << content.error().message << "\n" << bytes.substr(0, 800);
  if (!content) return {};
  EXPECT_TRUE(std::holds_alternative<FileMesh>(content.value()));
  auto* mesh = std::get_if<FileMesh>(&content.value());
  return mesh != nullptr ? std::move(*mesh) : FileMesh();
}

void expect_ply_refusal(const std::string& bytes, ErrorCode code) {
  const auto content = parse_ply(bytes);
  ASSERT_FALSE(content) << bytes;
  EXPECT_EQ(content.error().code, code) << content.error().message;
}

const std::string four_vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string corner_rows = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string text_ply(const std::string& elements, const std::string& rows) {
  return "ply\nformat ascii 1.0\nobj_info num_cols 640\n" + elements + "end_header\n" + rows;
}

TEST(PlyFile, UnknownElementsAreSkippedWhereverTheyAre) {
  const std::string camera = "element camera 1\nproperty float view_px\nproperty int viewportx\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string edges = "element edge 1\nproperty list uchar float crease\nproperty uchar red\n";
  for (const auto& [elements, rows] : std::vector<std::pair<std::string, std::string>>{
           {camera + four_vertices + faces + edges, "0.5 640\n" + corner_rows + "3 0 1 2\n2 1 2 9\n"},
           {faces + camera + four_vertices, "3 0 1 2\n0.5 640\n" + corner_rows},
           {edges + faces + four_vertices + camera, "0 7\n3 0 1 2\n" + corner_rows + "1 2\n"}}) {
    const FileMesh mesh = ply_mesh(text_ply(elements, rows));
    EXPECT_EQ(mesh.triangles, std::vector<PlyTriangle>({{0, 1, 2}}));
    ASSERT_EQ(mesh.vertices.size(), 4U);
    EXPECT_EQ(mesh.vertices[2], Vector3(1, 1, 0));
  }
}

TEST(PlyFile, StripsTurnEverySecondTriangleAndBeginAnew) {
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
  const FileMesh mesh = ply_mesh(text_ply(four_vertices + strips, corner_rows + "8 0 1 3 2 -1 1 2 0\n"));
  EXPECT_EQ(mesh.triangles, std::vector<PlyTriangle>({{0, 1, 3}, {3, 1, 2}, {1, 2, 0}}));
  // A triangle with a repeated corner is skipped, but counts for the alternating direction of the strip's
  // triangles.
  const FileMesh joined = ply_mesh(text_ply(four_vertices + strips, corner_rows + "5 0 1 1 3 2\n"));
  EXPECT_EQ(joined.triangles, std::vector<PlyTriangle>({{1, 3, 2}}));
}

TEST(PlyFile, LineEndsAreOfAnySystem) {
  const std::string whole = text_ply(four_vertices + "element face 2\nproperty list uchar int vertex_index\n",
                                     corner_rows + "3 0 1 2 3 0 2 3");
  for (const char* end : {"\n", "\r", "\r\n"}) {
    std::string text;
    for (const char letter : whole) text += letter == '\n' ? std::string(end) : std::string(1, letter);
    EXPECT_EQ(ply_mesh(text).triangles, std::vector<PlyTriangle>({{0, 1, 2}, {0, 2, 3}}));
  }
}

double area_of(const FileMesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3 ab = mesh.vertices[b] - mesh.vertices[a], ac = mesh.vertices[c] - mesh.vertices[a];
    area += 0.5 * ab.cross(ac).norm();
  }
  return area;
}

// As a fan, the triangles of a concave polygon would cover more than its area.
TEST(PlyFile, ConcavePolygonsAreCoveredOnce) {
  const std::string arrow = text_ply(four_vertices + "element face 1\nproperty list uchar int vertex_index\n",
                                     "0 0 0\n2 -1 0\n0 3 0\n-2 -1 0\n4 3 0 1 2\n");
  EXPECT_NEAR(area_of(ply_mesh(arrow)), 6.0, 1e-12);
  Random random(5);
  for (int trial = 0; trial < effort(40); ++trial) {
    // The polygon is star-shaped and in a tilted plane.
    const int count = random.integer(4, 40);
    FileMesh mesh;
    std::vector<std::uint32_t> corners;
    Vector3 area = Vector3::Zero();
    const Vector3 along = Vector3(1, 2, 3).normalized(), across = along.unitOrthogonal();
    for (int k = 0; k < count; ++k) {
      const double angle = 2.0 * M_PI * k / count, radius = random.uniform(0.2, 2.0);
      mesh.vertices.emplace_back(radius * (std::cos(angle) * along + std::sin(angle) * across));
      corners.push_back(static_cast<std::uint32_t>(k));
    }
    for (int k = 0; k < count; ++k) area += 0.5 * mesh.vertices[k].cross(mesh.vertices[(k + 1) % count]);
    cut_polygon(corners, mesh.vertices, mesh.triangles);
    EXPECT_EQ(mesh.triangles.size(), corners.size() - 2);
    EXPECT_NEAR(area_of(mesh), area.norm(), 1e-9);
  }
}

TEST(PlyFile, PolygonsWithoutAreaAreCutToo) {
  const std::vector<Vector3> points(50, Vector3(1, 1, 1));
  std::vector<std::uint32_t> corners(50);
  for (std::uint32_t k = 0; k < 50; ++k) corners[k] = k;
  std::vector<PlyTriangle> triangles;
  cut_polygon(corners, points, triangles);
  EXPECT_EQ(triangles.size(), 48U);
}

TEST(PlyFile, RefusesEachDamage) {
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  for (const char* face : {"3 0 1 4", "3 0 1 4294967296"}) {
    const auto content = parse_ply(text_ply(four_vertices + faces, corner_rows + face));
    EXPECT_FALSE(content) << face;
  }
  expect_ply_refusal(text_ply(four_vertices + faces, corner_rows + "3 0 1 4"), ErrorCode::inconsistent);
  for (const char* face : {"3 0 1 -1", "3 0 1 1.5", "3 0 1 nan", "-1", "2.5 0 1 2", "3 0 1", "3 0 1 x"}) {
    expect_ply_refusal(text_ply(four_vertices + faces, corner_rows + face), ErrorCode::malformed);
  }
  expect_ply_refusal(text_ply(four_vertices + faces, corner_rows + "3 0 1 2\n3 0 2 3"),
                     ErrorCode::inconsistent);
  expect_ply_refusal(text_ply(four_vertices + "element face 1\nproperty uchar red\n", corner_rows + "3"),
                     ErrorCode::missing);
  expect_ply_refusal(text_ply(faces, "3 0 1 2"), ErrorCode::missing);
  expect_ply_refusal(text_ply(four_vertices + four_vertices, corner_rows + corner_rows),
                     ErrorCode::duplicate);
  expect_ply_refusal(text_ply("element vertex 1\nproperty quark x\n", "1"), ErrorCode::unknown);
  expect_ply_refusal("ply\nformat ebcdic 1.0\n" + four_vertices + "end_header\n" + corner_rows,
                     ErrorCode::unsupported);
  std::string many = "5000";
  for (int k = 0; k < 5000; ++k) many += " 0";
  expect_ply_refusal(
      text_ply(four_vertices + "element face 1\nproperty list int int vertex_indices\n", corner_rows + many),
      ErrorCode::too_many);
}

// Writer of random but valid files: any format, line end, order of elements and type of number.
class PlySample {
 public:
  explicit PlySample(Random& random) : random_(&random), format_(random.integer(0, 2)) {
    line_end_ = std::array{"\n", "\r\n", "\r"}[static_cast<std::size_t>(random.integer(0, 2))];
    side_ = random.integer(2, 11);
    for (int k = 0; k < side_ * side_; ++k) {
      mesh.vertices.emplace_back(k % side_, k / side_, random.integer(-9, 9));
    }
    are_strips_ = random.integer(0, 3) == 0;
    for (std::uint32_t k = 0; k + side_ < mesh.vertices.size(); ++k) {
      const std::uint32_t up = k + static_cast<std::uint32_t>(side_);
      if ((k + 1) % static_cast<std::uint32_t>(side_) == 0) continue;
      mesh.triangles.push_back({k, k + 1, up});
      if (are_strips_) mesh.triangles.push_back({up, k + 1, up + 1});
    }
    std::vector<int> order{0, 1, 2, 2};
    for (std::size_t k = order.size() - 1; k > 0; --k) {
      std::swap(order[k], order[static_cast<std::size_t>(random.integer(0, static_cast<int>(k)))]);
    }
    add_line("ply");
    const std::array formats{"ascii", "binary_little_endian", "binary_big_endian"};
    add_line(std::string("format ") + formats[static_cast<std::size_t>(format_)] + " 1.0");
    add_line("comment element vertex 7");
    add_line("obj_info end_header");
    for (const int kind : order) kind == 0 ? add_vertices() : kind == 1 ? add_faces() : add_other();
    add_line("end_header");
    header_bytes = header_.size();
    bytes = header_ + body_;
  }

  bool is_text() const { return format_ == 0; }

  FileMesh mesh;
  std::string bytes;
  std::size_t header_bytes = 0;

 private:
  struct Type {
    const char* name;
    NumberType type;
  };

  void add_line(const std::string& text) { header_ += text + line_end_; }

  Type pick(bool can_hold_indices) {
    static constexpr std::array<Type, 16> types{{{"float", NumberType::float32},
                                                 {"double", NumberType::float64},
                                                 {"int", NumberType::int32},
                                                 {"short", NumberType::int16},
                                                 {"int16", NumberType::int16},
                                                 {"int32", NumberType::int32},
                                                 {"float32", NumberType::float32},
                                                 {"float64", NumberType::float64},
                                                 {"char", NumberType::int8},
                                                 {"int8", NumberType::int8},
                                                 // The types above can hold negative numbers, which
                                                 // coordinates need.
                                                 {"uchar", NumberType::uint8},
                                                 {"uint8", NumberType::uint8},
                                                 {"ushort", NumberType::uint16},
                                                 {"uint16", NumberType::uint16},
                                                 {"uint", NumberType::uint32},
                                                 {"uint32", NumberType::uint32}}};
    return types[static_cast<std::size_t>(random_->integer(0, can_hold_indices ? 15 : 9))];
  }

  template <class Number>
  void put_as(double value) {
    const auto number = static_cast<Number>(value);
    std::string copy(sizeof number, '\0');
    std::memcpy(copy.data(), &number, sizeof number);
    if (format_ == 2) std::reverse(copy.begin(), copy.end());
    body_ += copy;
  }

  void put(Type type, double value) {
    if (is_text()) {
      const auto whole = static_cast<long>(value);
      // Numbers of one row may be on several lines, and several rows on one line.
      body_ += std::to_string(whole) + (random_->integer(0, 3) == 0 ? line_end_ : std::string(" "));
      return;
    }
    switch (type.type) {
      case NumberType::int8:
        return put_as<std::int8_t>(value);
      case NumberType::uint8:
        return put_as<std::uint8_t>(value);
      case NumberType::int16:
        return put_as<std::int16_t>(value);
      case NumberType::uint16:
        return put_as<std::uint16_t>(value);
      case NumberType::int32:
        return put_as<std::int32_t>(value);
      case NumberType::uint32:
        return put_as<std::uint32_t>(value);
      case NumberType::float32:
        return put_as<float>(value);
      default:
        return put_as<double>(value);
    }
  }

  void add_vertices() {
    add_line("element vertex " + std::to_string(mesh.vertices.size()));
    const Type x = pick(false), y = pick(false), z = pick(false), red = pick(true);
    add_line(std::string("property ") + red.name + " red");
    add_line(std::string("property ") + z.name + " z");
    add_line(std::string("property ") + x.name + " x");
    add_line(std::string("property ") + y.name + " y");
    for (const Vector3& vertex : mesh.vertices) {
      put(red, 7);
      put(z, vertex.z());
      put(x, vertex.x());
      put(y, vertex.y());
    }
  }

  void add_faces() {
    const Type count = pick(true), index = pick(!are_strips_), flag = pick(true);
    const std::size_t rows = are_strips_ ? 1 : mesh.triangles.size();
    // A strip of the whole mesh can have more corners than a length of one byte can state.
    const Type length = are_strips_ ? Type{"uint", NumberType::uint32} : count;
    add_line((are_strips_ ? "element tristrips " : "element face ") + std::to_string(rows));
    add_line(std::string("property list ") + length.name + " " + index.name + " vertex_indices");
    add_line(std::string("property ") + flag.name + " flags");
    if (!are_strips_) {
      for (const PlyTriangle& corners : mesh.triangles) {
        put(length, 3);
        for (const std::uint32_t corner : corners) put(index, corner);
        put(flag, 1);
      }
      return;
    }
    put(length, 2.5 * static_cast<double>(mesh.triangles.size()));
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 2) {
      const PlyTriangle &first = mesh.triangles[t], &second = mesh.triangles[t + 1];
      for (const std::uint32_t corner : {first[0], first[1], first[2], second[2]}) put(index, corner);
      put(index, -1);
    }
    put(flag, 1);
  }

  void add_other() {
    const int rows = random_->integer(0, 4);
    const Type count = pick(true), number = pick(true), single = pick(true);
    add_line("element other" + std::to_string(++others_) + " " + std::to_string(rows));
    add_line(std::string("property ") + single.name + " x");
    const bool has_list = random_->integer(0, 1) == 0;
    if (has_list) add_line(std::string("property list ") + count.name + " " + number.name + " y");
    for (int row = 0; row < rows; ++row) {
      put(single, 5);
      if (!has_list) continue;
      const int length = random_->integer(0, 6);
      put(count, length);
      for (int k = 0; k < length; ++k) put(number, k);
    }
  }

  Random* random_;
  int format_ = 0, side_ = 0, others_ = 0;
  bool are_strips_ = false;
  std::string line_end_, header_, body_;
};

TEST(PlyFile, GeneratedFilesAreReadAsTheyWereMade) {
  Random random(11);
  for (int trial = 0; trial < random_cases(400, 20'000); ++trial) {
    SCOPED_TRACE(trial);
    const PlySample sample(random);
    const FileMesh mesh = ply_mesh(sample.bytes);
    ASSERT_EQ(mesh.vertices, sample.mesh.vertices) << sample.bytes.substr(0, sample.header_bytes);
    ASSERT_EQ(mesh.triangles, sample.mesh.triangles) << sample.bytes.substr(0, sample.header_bytes);
    if (sample.is_text()) {
      EXPECT_FALSE(parse_ply(sample.bytes + " 1"));
    } else {
      // The file is refused if it is cut off at a random byte, and if it has extra bytes after its last row.
      const int kept =
          random.integer(static_cast<int>(sample.header_bytes), static_cast<int>(sample.bytes.size()) - 1);
      EXPECT_FALSE(parse_ply(std::string_view(sample.bytes).substr(0, static_cast<std::size_t>(kept))));
      EXPECT_FALSE(parse_ply(sample.bytes + "surplus"));
    }
  }
}

}  // namespace
}  // namespace spoonbill
