// Tests point files in all supported formats, valid and malformed.
#include "engine/exchange/scans/point_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <random>
#include <utility>
#include <variant>

#include "engine/exchange/scans/number_lines.h"
#include "engine/exchange/scans/ply_file.h"

namespace spoonbill {
namespace {

template <class Number>
void put(std::string& bytes, Number number, bool swapped = false) {
  std::string copy(sizeof number, '\0');
  std::memcpy(copy.data(), &number, sizeof number);
  if (swapped) std::reverse(copy.begin(), copy.end());
  bytes += copy;
}

std::string ply_header(const std::string& format, const std::string& count) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement camera 1\nproperty list uchar short a\n" + "element vertex " +
         count +
         "\nproperty uchar red\nproperty double x\nproperty float y\nproperty float z\nproperty float nx\n"
         "property float ny\nproperty float nz\nend_header\n";
}

std::string binary_ply_points(bool big) {
  std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian", "2");
  put(bytes, std::uint8_t{2});
  put(bytes, std::int16_t{7}, big);
  put(bytes, std::int16_t{8}, big);
  for (int k = 0; k < 2; ++k) {
    put(bytes, std::uint8_t{200});
    put(bytes, 1.5 + k, big);
    for (const float value : {-2.25F, 3.0F, 0.0F, 0.0F, 1.0F}) put(bytes, value, big);
  }
  return bytes;
}

void expect_two_points(const Result<PointCloud>& cloud, bool with_normals) {
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2U);
  EXPECT_EQ(cloud->points[0], Vector3(1.5, -2.25, 3.0));
  EXPECT_EQ(cloud->points[1], Vector3(2.5, -2.25, 3.0));
  ASSERT_EQ(cloud->normals.size(), with_normals ? 2U : 0U);
  if (with_normals) {
    EXPECT_EQ(cloud->normals[1], Vector3(0, 0, 1));
  }
}

Result<PointCloud> ply_points(std::string_view bytes) {
  auto content = parse_ply(bytes);
  if (!content) return content.error();
  if (auto* cloud = std::get_if<PointCloud>(&content.value())) return std::move(*cloud);
  return Error{ErrorCode::unsupported, "holds a mesh"};
}

void expect_refusal(const Result<PointCloud>& cloud, const std::string& reason) {
  ASSERT_FALSE(cloud) << "should be refused: " << reason;
  EXPECT_NE(cloud.error().message.find(reason), std::string::npos) << cloud.error().message;
  EXPECT_EQ(cloud.error().message.find('\n'), std::string::npos) << cloud.error().message;
}

TEST(PlyPoints, TextAndBothByteOrders) {
  const std::string text =
      ply_header("ascii", "2") + "2 7 8\n200 1.5 -2.25 3 0 0 1\n200 2.5 -2.25 3e0 0 0 1\n";
  expect_two_points(ply_points(text), true);
  expect_two_points(ply_points(binary_ply_points(false)), true);
  expect_two_points(ply_points(binary_ply_points(true)), true);
}

TEST(PlyPoints, SkipsAndCountsWhatIsNoNumber) {
  const auto cloud = ply_points(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n1 2 3\nnan 2 3\n4 5 6\n");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 2U);
  EXPECT_EQ(cloud->skipped, 1U);
}

TEST(PlyPoints, RefusesEachDamageWithItsReason) {
  expect_refusal(ply_points("solid thing"), "not a PLY file");
  expect_refusal(ply_points("ply\nformat ascii 1.0\nelement vertex 3\n"), "no end");
  expect_refusal(ply_points(ply_header("ascii", "4000000000")), "cut or damaged");
  expect_refusal(ply_points("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n"
                            "property float y\nproperty float z\nend_header\n1 2 3\n"),
                 "more than the 5000000");
  expect_refusal(ply_points("ply\nformat binary_little_endian 1.0\nelement vertex 4999999\nproperty float x\n"
                            "property float y\nproperty float z\nend_header\n1 2 3\n"),
                 "cut or damaged");
  expect_refusal(ply_points("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                            "property float z\nend_header\n"),
                 "has no points");
  expect_refusal(ply_points("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                            "end_header\n1 2\n"),
                 "no x, y and z");
  expect_refusal(ply_points("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                            "property float z\nend_header\nnan nan nan\n"),
                 "not a number");
  expect_refusal(ply_points("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                            "property float z\nend_header\n1 inf 2\n"),
                 "infinity");
  const std::string whole = binary_ply_points(false);
  expect_refusal(ply_points(std::string_view(whole).substr(0, whole.size() - 1)), "cut or damaged");
}

const std::string pcd_fields = "VERSION .7\nFIELDS x y z rgb\nSIZE 8 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n";

TEST(PcdPoints, TextBinaryAndCompressed) {
  expect_two_points(
      parse_pcd_points("# .PCD v.6\n" + pcd_fields +
                       "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1.5 -2.25 3 9\n2.5 -2.25 3 9\n"),
      false);
  std::string rows = pcd_fields + "WIDTH 1\nHEIGHT 2\nDATA binary\n";
  for (int k = 0; k < 2; ++k) {
    put(rows, 1.5 + k);
    put(rows, -2.25F);
    put(rows, 3.0F);
    put(rows, std::uint32_t{9});
  }
  expect_two_points(parse_pcd_points(rows), false);
  std::string columns;
  for (const double value : {1.5, 2.5}) put(columns, value);
  for (const float value : {-2.25F, -2.25F, 3.0F, 3.0F}) put(columns, value);
  for (int k = 0; k < 2; ++k) put(columns, std::uint32_t{9});
  // The data are LZF without compression: literal runs of up to 32 bytes, each preceded by its length minus
  // one.
  std::string packed;
  for (std::size_t at = 0; at < columns.size(); at += 32) {
    const std::string run = columns.substr(at, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  std::string file = pcd_fields + "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary_compressed\n";
  put(file, static_cast<std::uint32_t>(packed.size()));
  put(file, static_cast<std::uint32_t>(columns.size()));
  expect_two_points(parse_pcd_points(file + packed), false);
  expect_refusal(parse_pcd_points(file + packed.substr(0, 20)), "length");
  std::string broken = packed;
  broken[0] = static_cast<char>(0xff);  // a reference to bytes before the beginning of the output
  expect_refusal(parse_pcd_points(file + broken), "decompressed");
}

TEST(PcdPoints, RefusesEachDamageWithItsReason) {
  expect_refusal(parse_pcd_points("FIELDS x y z\nSIZE 4 4 4\n"), "no DATA");
  expect_refusal(parse_pcd_points("FIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
                 "as many");
  expect_refusal(parse_pcd_points("FIELDS x y z\nSIZE 4 3 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
                 "field y");
  expect_refusal(parse_pcd_points("FIELDS x y w\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
                 "no x, y and z");
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    expect_refusal(parse_pcd_points("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 4000000000\nDATA " +
                                    std::string(data) + "\n1 2 3\n"),
                   "more than the 5000000");
    expect_refusal(parse_pcd_points("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 4999999\nDATA " +
                                    std::string(data) + "\n1 2 3 4 5 6 7 8 9\n"),
                   "cut or damaged");
  }
  expect_refusal(
      parse_pcd_points("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA ascii\n1 2 3\n4 5 six\n"),
      "point 2 of 2");
  expect_refusal(parse_pcd_points("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA zipped\n"), "zipped");
}

TEST(Numbers, OutOfRangeBecomeZeroOrInfinite) {
  const std::string zeros(400, '0');
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(parse_number("1e400"), infinity);
  EXPECT_EQ(parse_number("-1e400"), -infinity);
  EXPECT_EQ(parse_number("1e-400"), 0.0);
  EXPECT_EQ(parse_number("0." + zeros + "1e10"), 0.0);
  EXPECT_EQ(parse_number("1" + zeros + "e-10"), infinity);
  EXPECT_EQ(parse_number("0." + zeros + "1"), 0.0);
  EXPECT_EQ(parse_number("1" + zeros), infinity);
}

TEST(TextPoints, BlanksCommasHeadersAndNormals) {
  expect_two_points(parse_text_points("1.5 -2.25 3\n2.5 -2.25 3\n"), false);
  expect_two_points(parse_text_points("2\n1.5 -2.25 3 255 0 7\n\n2.5 -2.25 3 255 0 7\n"), false);
  expect_two_points(parse_text_points("x, y, z\r\n1.5, -2.25, 3\r\n# a word\r\n2.5, -2.25, 3\r\n"), false);
  expect_two_points(parse_text_points("1.5;-2.25;3;0;0;1\n2.5;-2.25;3;0;0;1"), true);
}

TEST(TextPoints, AHeadingStandsAnywhereBeforeTheFirstPoint) {
  expect_two_points(parse_text_points("# by a scanner\n\nx,y,z\n1.5,-2.25,3\n2.5,-2.25,3\n"), false);
  expect_two_points(parse_text_points("// by a scanner\n2\n1.5 -2.25 3\n2.5 -2.25 3\n"), false);
  expect_refusal(parse_text_points("# by a scanner\nx,y,z\n1.5 -2.25 3\nx,y,z\n2.5 -2.25 3\n"), "line 4");
}

TEST(TextPoints, AByteOrderMarkHidesNoPoint) {
  const std::string mark = "\xEF\xBB\xBF";
  expect_two_points(parse_text_points(mark + "1.5 -2.25 3\n2.5 -2.25 3\n"), false);
  expect_two_points(parse_text_points(mark + "x y z\n1.5 -2.25 3\n2.5 -2.25 3\n"), false);
  expect_two_points(parse_text_points(mark + "# by a scanner\nx y z\n1.5 -2.25 3\n2.5 -2.25 3\n"), false);
  expect_two_points(parse_obj_points(mark + "v 1.5 -2.25 3\nv 2.5 -2.25 3\n"), false);
}

TEST(TextPoints, DecimalCommasStandBetweenSemicolons) {
  expect_two_points(parse_text_points("x;y;z\n1,5;-2,25;3,0\n2,5;-2,25;3\n"), false);
  expect_two_points(parse_text_points("1,5; -2,25; 3,0;\r\n2,5 ; -2,25 ; 3e0 ;\r\n"), false);
  expect_two_points(parse_text_points("1,5;-2,25;3,0;0,0;0,0;1,0\n2,5;-2,25;3,0;0;0;1\n"), true);
}

TEST(TextPoints, CommasThatPartNumbersStay) {
  for (const char* text : {"1.5,-2.25,3\n2.5,-2.25,3\n", "1.5, -2.25, 3 \n2.5 ,-2.25 ,3\n",
                           "1.5,-2.25,3;\n2.5,-2.25,3;\n", "1.5,\t-2.25,\t3,\n 2.5 , -2.25 , 3 , \n"}) {
    expect_two_points(parse_text_points(text), false);
  }
}

// Each line has at least two possible meanings.
TEST(TextPoints, RefusesCommasThatMayPartNumbersOrNot) {
  for (const char* line : {"12,345 67,890 1,234", "12,345\t67,890\t1,234", "12,345, 67,890, 1,234",
                           "1,234.5;2.5;3.5", "1,2,3;4,5,6;7,8,9", "0,5;1.5;2"}) {
    expect_refusal(parse_text_points(std::string("1 2 3\n") + line + "\n"), "line 2 has commas");
    expect_refusal(parse_text_points(std::string(line) + "\n"), "line 1 has commas");
  }
  expect_refusal(parse_obj_points("v 12,345 67,890 1,234\n"), "line 1 is not a point");
  expect_refusal(ply_points("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                            "property float z\nend_header\n1,5 2,5 3,5\n"),
                 "vertex 1 of 1 has '1,5', a number with a comma");
  expect_refusal(
      parse_pcd_points("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1,5 2,5 3,5\n"),
      "point 1 has '1,5', a number with a comma");
}

TEST(TextPoints, RefusesEachDamageWithItsReason) {
  expect_refusal(parse_text_points(""), "has no points");
  expect_refusal(parse_text_points("1 2 3\n4 5\n"), "line 2");
  expect_refusal(parse_text_points("1 2 3\n4 5 6 7\n"), "line 2");
  expect_refusal(parse_text_points("1 2 3\n4 5 seven\n"), "line 2");
  expect_refusal(parse_text_points("a story\nof no\npoints\n"), "line 2");
  expect_refusal(parse_text_points("nan nan nan\n"), "not a number");
  expect_refusal(parse_text_points("1 2 1e999\n"), "infinity");
  EXPECT_TRUE(parse_text_points("1 2 1e-999\n1 2 0." + std::string(400, '0') + "1\n").ok());
}

// A declared count must equal the number of points in every format.
TEST(PointFiles, DeclaredCountsAreChecked) {
  const auto expect_code = [](const Result<PointCloud>& cloud, ErrorCode code) {
    ASSERT_FALSE(cloud);
    EXPECT_EQ(cloud.error().code, code) << cloud.error().message;
  };
  std::string points;
  for (int k = 0; k < 399; ++k) points += std::to_string(k) + " 1 2\n";
  for (const char* count : {"1500", "398", "1e9", "-1", "399.5", "nan"}) {
    expect_code(parse_text_points(std::string(count) + "\n" + points), ErrorCode::inconsistent);
  }
  ASSERT_TRUE(parse_text_points("399\n" + points));
  // Points with a coordinate that is not a number count as points here.
  const auto gaps = parse_text_points("3\n1 2 3\nnan nan nan\n4 5 6\n");
  ASSERT_TRUE(gaps) << gaps.error().message;
  EXPECT_EQ(gaps->skipped, 1U);

  const std::string ply_start = "ply\nformat ascii 1.0\nelement vertex ";
  const std::string ply_end = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  ASSERT_TRUE(ply_points(ply_start + "399" + ply_end + points));
  expect_code(ply_points(ply_start + "398" + ply_end + points), ErrorCode::inconsistent);
  expect_code(ply_points(ply_start + "400" + ply_end + points), ErrorCode::malformed);

  const std::string pcd_start = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS ";
  ASSERT_TRUE(parse_pcd_points(pcd_start + "399\nDATA ascii\n" + points));
  expect_code(parse_pcd_points(pcd_start + "398\nDATA ascii\n" + points), ErrorCode::inconsistent);
  expect_code(parse_pcd_points(pcd_start + "400\nDATA ascii\n" + points), ErrorCode::malformed);
  expect_code(parse_pcd_points(pcd_start + "399\nWIDTH 40\nHEIGHT 10\nDATA ascii\n" + points),
              ErrorCode::inconsistent);
  std::string numbers;
  for (int k = 0; k < 9; ++k) put(numbers, static_cast<float>(k + 1));
  ASSERT_TRUE(parse_pcd_points(pcd_start + "3\nDATA binary\n" + numbers));
  ASSERT_TRUE(parse_pcd_points(pcd_start + "3\nDATA binary\n" + numbers + std::string(4096, '\0')));
  expect_code(parse_pcd_points(pcd_start + "2\nDATA binary\n" + numbers), ErrorCode::inconsistent);
  expect_code(parse_pcd_points(pcd_start + "4\nDATA binary\n" + numbers), ErrorCode::malformed);
}

TEST(ObjPoints, TakesVerticesAndKnowsFaces) {
  expect_two_points(parse_obj_points("# cloud\nv 1.5 -2.25 3\nvn 0 0 1\nv 2.5 -2.25 3\nvn 0 0 1\n"), true);
  EXPECT_FALSE(obj_has_faces("v 1 2 3\nvn 0 0 1\n"));
  EXPECT_TRUE(obj_has_faces("v 1 2 3\nv 1 2 4\nv 2 2 3\nf 1 2 3\n"));
  expect_refusal(parse_obj_points("v 1 2\n"), "line 1");
}

// For arbitrary bytes the result is a cloud or an Error of one line.
TEST(PointFiles, AnyBytesGiveAnAnswer) {
  std::mt19937_64 random(7);
  const std::string text = ply_header("ascii", "2") + "2 7 8\n200 1.5 -2.25 3 0 0 1\n200 2.5 -2.25 3 0 0 1\n";
  const std::string pcd = pcd_fields + "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1.5 -2.25 3 9\n2.5 2 3 9\n";
  for (int round = 0; round < 3000; ++round) {
    std::string bytes = round % 3 == 0 ? text : round % 3 == 1 ? binary_ply_points(round % 2 == 0) : pcd;
    for (int change = 0; change < 3; ++change) {
      const std::size_t place = random() % bytes.size();
      switch (random() % 3) {
        case 0:
          bytes[place] = static_cast<char>(random());
          break;
        case 1:
          bytes.erase(place, 1 + random() % 9);
          break;
        default:
          bytes.insert(place, bytes.substr(random() % bytes.size(), 5));
      }
      if (bytes.empty()) bytes = "p";
    }
    for (const auto& cloud :
         {ply_points(bytes), parse_pcd_points(bytes), parse_text_points(bytes), parse_obj_points(bytes)}) {
      if (cloud) {
        EXPECT_FALSE(cloud->points.empty());
      } else {
        EXPECT_EQ(cloud.error().message.find('\n'), std::string::npos) << cloud.error().message;
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
