// Tests damaged documents: each must be read, or be refused with a message of one line, and never crash the
// program.
#include <gtest/gtest.h>

#include <random>

#include "engine/exchange/document.h"
#include "tests/engine/effort.h"
#include "tests/engine/exchange/damage.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

void expect_document_or_line(const std::string& text) {
  const auto json = parse_json(text, "damaged.json");
  const auto read =
      json.ok() ? document_from_json(json.value(), "damaged.json") : Result<Document>(json.error());
  if (read.ok()) return;
  const std::string& message = read.error().message;
  EXPECT_TRUE(message.starts_with("damaged.json: ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(message.size(), 600u) << message;
}

TEST(DamagedDocument, CutAtEveryByte) {
  const std::string text = json_to_line(document_to_json(sample_document()));
  for (std::size_t length = 0; length < text.size(); ++length) {
    const auto json = parse_json(std::string_view(text).substr(0, length), "cut.json");
    ASSERT_FALSE(json.ok()) << length;
    EXPECT_EQ(json.error().message.find('\n'), std::string::npos);
  }
}

TEST(DamagedDocument, AnyBytesChanged) {
  const std::string text = json_to_line(document_to_json(deformed_document(5)));
  std::mt19937_64 random(2);
  for (int i = random_cases(4'000, 100'000); i > 0; --i) expect_document_or_line(damaged(text, 0, random));
}

// Replaces each value of a document in turn by values of every kind.
TEST(DamagedDocument, AnyValueReplaced) {
  const Json whole = document_to_json(sample_document());
  const Json flat = whole.flatten();
  const Json strange[] = {nullptr,
                          true,
                          "text",
                          -1,
                          0,
                          1e300,
                          -1e-300,
                          18446744073709551615u,
                          Json::array(),
                          Json::object(),
                          Json::array({Json::array({1})}),
                          Json{{"u", 1}}};
  for (const auto& item : flat.items()) {
    Json::json_pointer pointer(item.key());
    for (; !pointer.empty(); pointer.pop_back()) {
      if (item.key().find("/control_points_mm/") != std::string::npos && !item.key().ends_with("/0/0/0"))
        break;
      for (const Json& value : strange) {
        Json changed = whole;
        changed[pointer] = value;
        expect_document_or_line(json_to_line(changed));
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
