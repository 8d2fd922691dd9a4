#include <gtest/gtest.h>

#include <random>

#include "app/commands/option_values.h"

namespace spoonbill {
namespace {

Result<PointTable> read(const std::string& text, bool with_section = false) {
  return point_table(text, "points.csv", {"x", "y", "z"}, with_section);
}

TEST(PointTable, ReadsUnitsOfItsColumns) {
  const auto table = read("# a path\nx_mm, y_cm ,z_in\r\n1,2,-1\n\n 1e1,0.5,0\n");
  ASSERT_TRUE(table.ok()) << table.error().message;
  ASSERT_EQ(table->rows_m.size(), 2U);
  EXPECT_DOUBLE_EQ(table->rows_m[0][0], 0.001);
  EXPECT_DOUBLE_EQ(table->rows_m[0][1], 0.02);
  EXPECT_DOUBLE_EQ(table->rows_m[0][2], -0.0254);
  EXPECT_DOUBLE_EQ(table->rows_m[1][0], 0.01);
}

// Some spreadsheets write a byte order mark, and some write plus signs.
TEST(PointTable, ReadsAByteOrderMarkAndPluses) {
  const auto table = read("\xEF\xBB\xBFx_mm,y_mm,z_inch\r\n+1,-2,+1\r\n");
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_DOUBLE_EQ(table->rows_m[0][0], 0.001);
  EXPECT_DOUBLE_EQ(table->rows_m[0][1], -0.002);
  EXPECT_DOUBLE_EQ(table->rows_m[0][2], 0.0254);
  EXPECT_FALSE(read("x_mm,y_mm,z_mm\n+-1,0,0\n").ok());
  EXPECT_FALSE(read("x_mm,y_mm,z_mm\n+,0,0\n").ok());
  EXPECT_FALSE(read("x_mm,y_mm,z_mm\n++1,0,0\n").ok());
}

TEST(PointTable, ReadsSections) {
  const auto table = read("section,x_m,y_m,z_m\n1,0,0,0\n1,0,1,0\n2,5,0,0", true);
  ASSERT_TRUE(table.ok()) << table.error().message;
  EXPECT_EQ(table->sections, (std::vector<int>{1, 1, 2}));
}

TEST(PointTable, SaysWhereAFileIsWrong) {
  const auto refusal = [](const std::string& text, bool with_section = false) {
    const auto table = read(text, with_section);
    EXPECT_FALSE(table.ok()) << text;
    return table.ok() ? Error{ErrorCode::internal, ""} : table.error();
  };
  const auto message = [&](const std::string& text) { return refusal(text).message; };
  EXPECT_EQ(message(""), "points.csv: contains no points");
  EXPECT_EQ(message("x_mm,y_mm,z_mm\n"), "points.csv: contains no points");
  EXPECT_NE(message("1,2,3\n").find("points.csv:1: names the columns"), std::string::npos);
  EXPECT_NE(message("x,y,z\n1,2,3\n").find("x_mm,y_mm,z_mm"), std::string::npos);
  EXPECT_NE(message("x_mm,y_mm,z_mm\n1,2\n").find("points.csv:2: has 2 values"), std::string::npos);
  EXPECT_NE(message("x_mm,y_mm,z_mm\n1,2,3\n1,2,nan\n").find("points.csv:3: z is 'nan'"), std::string::npos);
  for (const char* bad : {"inf", "1e400", "1e9", "", "0x10", "1;2", "\x01", "1 2", "--1"}) {
    EXPECT_NE(message("x_mm,y_mm,z_mm\n0,0," + std::string(bad) + "\n").find("points.csv:2: z is"),
              std::string::npos)
        << bad;
  }
  const Error section = refusal("section,x_mm,y_mm,z_mm\n1.5,0,0,0\n", true);
  EXPECT_EQ(section.code, ErrorCode::malformed);
  EXPECT_EQ(section.field, "section");
  std::string many = "x_m,y_m,z_m\n";
  for (int k = 0; k < 100001; ++k) many += "0,0,0\n";
  EXPECT_EQ(refusal(many).code, ErrorCode::too_many);
  EXPECT_EQ(message(std::string(1000, ',') + "\n\n").find('\n'), std::string::npos);
}

// For any bytes the result is a table or an error of one line.
TEST(PointTable, NothingThatIsReadDoesHarm) {
  std::mt19937 random(3);
  const std::string whole = "section,x_mm,y_mm,z_mm\n1,0,0.5,1e1\n1,-3,4,5\n2,1,1,1\n";
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = whole.substr(0, random() % (whole.size() + 1));
    for (unsigned k = 0; k < random() % 4 && !text.empty(); ++k) {
      text[random() % text.size()] = static_cast<char>(random() % 256);
    }
    const auto table = read(text, true);
    if (table.ok()) {
      EXPECT_EQ(table->sections.size(), table->rows_m.size());
    } else {
      EXPECT_EQ(table.error().message.find('\n'), std::string::npos);
    }
  }
}

TEST(ParsePoints, ReadsALine) {
  const auto points = parse_points("0,0,0;10,5,0; 2e1,0,-1mm");
  ASSERT_TRUE(points.ok()) << points.error().message;
  ASSERT_EQ(points->size(), 3U);
  EXPECT_DOUBLE_EQ(points.value()[2].x(), 0.02);
  for (const char* bad : {"", "mm", "0,0,0;1,1,1", "0,0;1,1,1mm", "0,0,0;;1,1,1mm", "a,b,cmm",
                          "0,0,0;1,1,1km", "0,0,0;1,1,1e400mm", ";;;mm", "0,0,0;1,1,nanmm"}) {
    EXPECT_FALSE(parse_points(bad).ok()) << bad;
  }
}

}  // namespace
}  // namespace spoonbill
