// Runs every fuzz target on the inputs of tests/fuzz/corpus, both complete and truncated, and on a set of
// inputs that covers all code that the fuzzer has reached.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <vector>

#include "tests/engine/exchange/sample_document.h"
#include "tests/fuzz/fuzz_target.h"

namespace spoonbill {

// Google Test calls a function of this name to print a parameter.
void PrintTo(const FuzzTarget& target, std::ostream* out) {
  *out << target.name;
}

namespace {

std::vector<std::filesystem::path> cases_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> cases;
  for (const auto& file : std::filesystem::directory_iterator(folder)) cases.push_back(file.path());
  std::sort(cases.begin(), cases.end());
  return cases;
}

class Corpus : public testing::TestWithParam<FuzzTarget> {};

TEST_P(Corpus, EveryCaseIsTaken) {
  const auto cases = cases_in(std::filesystem::path(SPOONBILL_CORPUS) / GetParam().name);
  EXPECT_FALSE(cases.empty());
  for (const auto& file : cases) {
    SCOPED_TRACE(file.filename().string());
    const std::string bytes = content_of(file);
    GetParam().take(bytes);
    for (const std::size_t part : {2, 3, 7})
      GetParam().take(std::string_view(bytes).substr(0, bytes.size() / part));
  }
}

TEST_P(Corpus, EveryGrownCaseIsTaken) {
  const auto cases = cases_in(std::filesystem::path(SPOONBILL_GROWN_CORPUS) / GetParam().name);
  EXPECT_GT(cases.size(), 100U);
  for (const auto& file : cases) {
    SCOPED_TRACE(file.filename().string());
    GetParam().take(content_of(file));
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus, testing::ValuesIn(fuzz_targets().begin(), fuzz_targets().end()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace spoonbill
