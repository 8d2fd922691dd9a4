#include "engine/exchange/json.h"

#include <gtest/gtest.h>

namespace spoonbill {
namespace {

std::string text_refusal(std::string_view text) {
  const auto json = parse_json(text, "x.json");
  return json.ok() ? "accepted" : json.error().message;
}

ErrorCode refusal_code(std::string_view text) {
  const auto json = parse_json(text, "x.json");
  EXPECT_FALSE(json.ok()) << text.substr(0, 40);
  return json.ok() ? ErrorCode::internal : json.error().code;
}

TEST(Json, SaysWhereTheTextIsWrong) {
  EXPECT_EQ(text_refusal("{\"a\": 1,\n \"b\": nan}"),
            "x.json: line 2, column 8: parsing value - invalid literal; last read: '\"b\": na'");
  EXPECT_EQ(text_refusal("{\"a\": 1"),
            "x.json: column 8: parsing object - unexpected end of input; expected '}'");
  EXPECT_EQ(text_refusal("hello"), "x.json: column 1: parsing value - invalid literal; last read: 'h'");
}

TEST(Json, RefusesWhatIsNotStrict) {
  for (const char* text :
       {"", " ", "NaN", "[Infinity]", "[-Infinity]", "[1e999]", "{\"a\":1}x", "{'a':1}", "[1,]", "// c",
        "[01]", "[.5]", "[1.]", "\"\x01\"", "\"\xff\"", "[+1]", "{\"a\" 1}"}) {
    const std::string message = text_refusal(text);
    EXPECT_TRUE(message.starts_with("x.json: column ")) << text << " -> " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(Json, RefusesWhatFollowsAZeroByte) {
  using std::string_view_literals::operator""sv;
  EXPECT_EQ(text_refusal("{\"a\": 1}\0"sv), "x.json: column 9: a zero byte, which is not JSON");
  EXPECT_EQ(text_refusal("{\"a\":\n1}\n\0garbage {[["sv),
            "x.json: line 3, column 1: a zero byte, which is not JSON");
  EXPECT_NE(text_refusal("{\0\"a\": 1}"sv), "accepted");
}

TEST(Json, RefusesAFieldGivenTwice) {
  EXPECT_EQ(text_refusal("{\"a\": 1, \"b\": {\"c\": 1, \"c\": 2}}"),
            "x.json: column 26: field \"c\" is given twice");
  EXPECT_EQ(refusal_code("{\"a\": 1, \"a\": 2}"), ErrorCode::duplicate);
}

TEST(Json, LimitsNestingAndSize) {
  EXPECT_EQ(text_refusal(std::string(64, '[') + std::string(64, ']')), "accepted");
  EXPECT_EQ(text_refusal(std::string(65, '[') + std::string(65, ']')),
            "x.json: column 65: nested deeper than 64 levels");
  EXPECT_EQ(refusal_code(std::string(5'000'000, '[')), ErrorCode::too_many);
  std::string many = "[0";
  for (int i = 0; i < 6'000'000; ++i) many += ",0";
  EXPECT_EQ(refusal_code(many + "]"), ErrorCode::too_many);
  std::string wide = "{\"f\":0";
  for (int i = 0; i < 1'000; ++i) wide += ",\"f" + std::to_string(i) + "\":0";
  EXPECT_EQ(refusal_code(wide + "}"), ErrorCode::too_many);
}

TEST(Json, WritesPagesThatReadBack) {
  const Json json = {{"short", {1, 2, {{"a", "b"}}}},
                     {"long", Json::array()},
                     {"empty", Json::object()},
                     {"quote\"d", "line\nbreak"},
                     {"numbers", std::vector<double>(60, 0.125)}};
  const std::string page = json_to_page(json);
  EXPECT_EQ(parse_json(page, "page").value(), json);
  EXPECT_NE(page.find("  \"short\": [1, 2, {\"a\": \"b\"}],\n"), std::string::npos) << page;
  EXPECT_NE(page.find("    0.125,\n"), std::string::npos) << page;
}

TEST(Json, ReplacesBytesThatAreNotText) {
  EXPECT_EQ(json_to_line(Json("\xff")), "\"\xef\xbf\xbd\"");
}

TEST(Json, WritesWholeNumbersWithoutFraction) {
  EXPECT_EQ(json_to_line(number_to_json(8.0)), "8");
  EXPECT_EQ(json_to_line(number_to_json(-0.0)), "-0.0");
  EXPECT_EQ(json_to_line(number_to_json(0.1)), "0.1");
  EXPECT_EQ(json_to_line(number_to_json(1e300)), "1e+300");
}

}  // namespace
}  // namespace spoonbill
