#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "engine/exchange/json.h"

namespace spoonbill {
namespace {

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value);
}

void expect_kept(double metres) {
  const Json written = length_to_json(metres);
  const auto text = parse_json(json_to_line(written), "length");
  ASSERT_TRUE(text.ok());
  const auto read = length_from_json(text.value());
  ASSERT_TRUE(read.has_value()) << json_to_line(written);
  EXPECT_EQ(bits(*read), bits(metres)) << json_to_line(written);
}

TEST(Length, KeepsEveryBit) {
  std::mt19937_64 random(1);
  int quoted = 0;
  const int count = 200000;
  for (int i = 0; i < count; ++i) {
    const double mantissa = 1.0 + static_cast<double>(random() >> 12) / 4503599627370496.0;
    const double metres =
        std::ldexp(mantissa, static_cast<int>(random() % 40) - 34) * (random() % 2 == 0 ? 1 : -1);
    expect_kept(metres);
    quoted += length_to_json(metres).is_string() ? 1 : 0;
  }
  EXPECT_LT(quoted, count / 40);
  EXPECT_GT(quoted, 0);
}

TEST(Length, KeepsWhatIsHardlyThere) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 20000; ++i) {
    const double mantissa = 1.0 + static_cast<double>(random() >> 12) / 4503599627370496.0;
    expect_kept(std::ldexp(mantissa, -1 - static_cast<int>(random() % 1073)));
  }
}

TEST(Length, KeepsTheEdges) {
  for (const double metres :
       {0.0, -0.0, 5e-324, 1e-300, 100.0, -100.0, 0.1, 1.0 / 3.0, 2.2250738585072014e-308}) {
    expect_kept(metres);
  }
}

TEST(Length, WritesWhatAPersonWouldWrite) {
  EXPECT_EQ(json_to_line(length_to_json(0.008)), "8");
  EXPECT_EQ(json_to_line(length_to_json(0.0123)), "12.3");
  EXPECT_EQ(json_to_line(length_to_json(-1e-6 / 1000.0)), "-1e-06");
  for (int micrometres = -100000; micrometres <= 100000; micrometres += 7) {
    EXPECT_TRUE(length_to_json(static_cast<double>(micrometres) / 1000.0 / 1000.0).is_number());
  }
}

TEST(Length, ReadsOnlyNumbersAndPlainDecimals) {
  EXPECT_EQ(length_from_json(Json("12.5")), 0.0125);
  EXPECT_EQ(length_from_json(Json("-7")), -0.007);
  for (const char* text :
       {"", "-", ".", "1.", ".5", "1e3", "nan", "inf", "0x1", " 1", "1 ", "+1", "1,5", "--1"}) {
    EXPECT_FALSE(length_from_json(Json(text)).has_value()) << text;
  }
  EXPECT_FALSE(length_from_json(Json(std::string(100, '9'))).has_value());
  EXPECT_FALSE(length_from_json(Json("0." + std::string(1000, '9'))).has_value());
  EXPECT_FALSE(length_from_json(Json(true)).has_value());
  EXPECT_FALSE(length_from_json(Json(nullptr)).has_value());
}

}  // namespace
}  // namespace spoonbill
