// Tests the log of a person who trains: nothing that was logged is ever lost.
#include "app/training/person_log.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "app/program.h"
#include "app/report/progress_page.h"
#include "engine/base/file.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

Attempt make_attempt(int number) {
  Attempt attempt;
  attempt.date = "2026-12-01T11:00:00Z";
  attempt.task = "carry";
  attempt.spoon = "spoon-bent";
  attempt.hand = "limited wrist";
  attempt.severity = 1.0;
  attempt.seed = static_cast<std::uint32_t>(number);
  attempt.guidance = 0.25;
  attempt.end = TaskEnd::success;
  attempt.time_s = 2.5;
  attempt.score = 80.0;
  attempt.smoothness = -1.6;
  attempt.tremor_m = 1e-5;
  attempt.state_hash = "0123456789abcdef";
  return attempt;
}

std::string text_of(const PersonLog& log) {
  return read_file(log.file(), std::size_t{1} << 24).value();
}

std::vector<std::uint32_t> seeds_of(const PersonLog& log) {
  std::vector<std::uint32_t> seeds;
  const auto logged = log.read();
  EXPECT_TRUE(logged) << logged.error().message;
  if (!logged) return seeds;
  for (const Attempt& attempt : logged->attempts) seeds.push_back(attempt.seed);
  return seeds;
}

TEST(PersonLog, KeepsEveryAttempt) {
  const Workplace place;
  const PersonLog log = PersonLog::find(place.path("training"), "P-07").value();
  EXPECT_TRUE(log.read()->attempts.empty());
  Attempt attempt = make_attempt(1);
  attempt.error_m = 0.004;
  ASSERT_TRUE(log.append(attempt));
  ASSERT_TRUE(log.append(make_attempt(2)));
  const LoggedAttempts logged = log.read().value();
  ASSERT_EQ(logged.attempts.size(), 2u);
  EXPECT_EQ(attempt_to_json(logged.attempts[0]), attempt_to_json(attempt));
  EXPECT_EQ(attempt_to_json(logged.attempts[1]), attempt_to_json(make_attempt(2)));
  EXPECT_EQ(logged.unreadable_lines, 0);
}

// Wherever a crash or a full disk has cut the log, the attempts before the cut stay, and so does the next
// one.
TEST(PersonLog, CutLogLosesNoOlderAttempt) {
  const Workplace place;
  const PersonLog log = PersonLog::find(place.path("training"), "ada").value();
  ASSERT_TRUE(log.append(make_attempt(1)));
  const std::size_t one = text_of(log).size();
  ASSERT_TRUE(log.append(make_attempt(2)));
  const std::string whole = text_of(log);
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    ASSERT_TRUE(write_file(log.file(), whole.substr(0, length), Durability::later));
    ASSERT_TRUE(log.append(make_attempt(3))) << length;
    std::vector<std::uint32_t> kept = {3};
    if (length + 1 >= whole.size()) kept.insert(kept.begin(), 2);
    if (length + 1 >= one) kept.insert(kept.begin(), 1);
    ASSERT_EQ(seeds_of(log), kept) << length;
  }
}

TEST(PersonLog, ProgramsThatAppendAtOnceLoseNothing) {
  const Workplace place;
  const PersonLog log = PersonLog::find(place.path("training"), "ada").value();
  constexpr int count = 100;
  const auto append_from = [&](int first) {
    const PersonLog own = PersonLog::find(place.path("training"), "ada").value();
    for (int k = 0; k < count; ++k) EXPECT_TRUE(own.append(make_attempt(first + k)));
  };
  std::thread one(append_from, 1000), other(append_from, 2000);
  one.join();
  other.join();
  std::vector<std::uint32_t> seeds = seeds_of(log);
  std::sort(seeds.begin(), seeds.end());
  ASSERT_EQ(seeds.size(), 2u * count);
  EXPECT_EQ(std::adjacent_find(seeds.begin(), seeds.end()), seeds.end());
}

TEST(PersonLog, OtherFilesAreRefusedAndStay) {
  const Workplace place;
  const PersonLog log = PersonLog::find(place.path("training"), "ada").value();
  std::filesystem::create_directories(place.path("training"));
  for (const std::string text :
       {"a shopping list\n", "{\"spoonbill_training_log\": 2, \"person\": \"ada\"}\n",
        "{\"spoonbill_training_log\": 1, \"person\": \"eve\"}\n", "{\"spoonbill_training_log\": 1}\n", "[]\n",
        "\n"}) {
    ASSERT_TRUE(write_file(log.file(), text, Durability::later));
    EXPECT_FALSE(log.append(make_attempt(1))) << text;
    EXPECT_FALSE(log.read()) << text;
    EXPECT_FALSE(log.forget()) << text;
    EXPECT_EQ(text_of(log), text);
  }
  std::filesystem::remove(log.file());
  std::filesystem::create_directory(log.file());
  EXPECT_FALSE(log.append(make_attempt(1)));
  EXPECT_FALSE(log.read());
  EXPECT_FALSE(log.forget());
  std::filesystem::remove(log.file());
  std::filesystem::create_symlink(place.path("elsewhere"), log.file());
  EXPECT_FALSE(log.append(make_attempt(1)));
  EXPECT_FALSE(std::filesystem::exists(place.path("elsewhere")));
}

TEST(PersonLog, ReadOnlyLogStaysAsItIs) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write every file";
  const Workplace place;
  const PersonLog log = PersonLog::find(place.path("training"), "ada").value();
  ASSERT_TRUE(log.append(make_attempt(1)));
  const std::string before = text_of(log);
  std::filesystem::permissions(log.file(), std::filesystem::perms::owner_read);
  EXPECT_FALSE(log.append(make_attempt(2)));
  EXPECT_EQ(text_of(log), before);
}

TEST(PersonLog, LinesThatWereChangedAreCountedAndLeftOut) {
  const Workplace place;
  const PersonLog log = PersonLog::find(place.path("training"), "ada").value();
  ASSERT_TRUE(log.append(make_attempt(1)));
  std::string text = text_of(log);
  Json strange = attempt_to_json(make_attempt(5));
  for (const auto& [field, value] : {std::pair<const char*, Json>{"score", 1e9},
                                     {"score", "high"},
                                     {"end", "won"},
                                     {"time_s", -1.0},
                                     {"task", 3},
                                     {"seed", -1}}) {
    Json wrong = strange;
    wrong[field] = value;
    text += wrong.dump() + "\n";
  }
  ASSERT_TRUE(write_file(log.file(), text + "{\"date\"\n", Durability::later));
  EXPECT_EQ(seeds_of(log), std::vector<std::uint32_t>{1});
  EXPECT_EQ(log.read()->unreadable_lines, 7);
}

TEST(PersonLog, NamesCannotLeaveTheFolder) {
  const std::vector<std::string> wrong = {
      "", "../ada", "a/b", "a.b", ".", "ada lovelace", std::string(65, 'a')};
  for (const std::string& name : wrong) EXPECT_FALSE(PersonLog::find("/tmp", name)) << name;
  EXPECT_TRUE(PersonLog::find("/tmp", std::string(64, 'a')));
}

TEST(PersonLog, GuidanceFadesAsThePersonImproves) {
  std::vector<Attempt> attempts;
  EXPECT_EQ(find_next_guidance(attempts, "carry"), 1.0);
  const auto add = [&](double score, const std::string& task = "carry") {
    attempts.push_back(make_attempt(1));
    attempts.back().score = score;
    attempts.back().task = task;
  };
  add(0.0);
  EXPECT_EQ(find_next_guidance(attempts, "carry"), 1.0);
  add(40.0);
  EXPECT_DOUBLE_EQ(find_next_guidance(attempts, "carry"), 0.75);
  add(60.0);
  add(100.0, "level");
  add(60.0);
  EXPECT_NEAR(find_next_guidance(attempts, "carry"), 1.0 - 160.0 / 3.0 / 80.0, 1e-12);
  for (int k = 0; k < 3; ++k) add(95.0);
  EXPECT_EQ(find_next_guidance(attempts, "carry"), 0.0);
}

TEST(ProgressPage, HasEveryAttemptAndNoForeignMarkup) {
  LoggedAttempts logged;
  for (int k = 0; k < 5; ++k) logged.attempts.push_back(make_attempt(k));
  logged.attempts[1].end = TaskEnd::lost;
  logged.attempts[1].score = 0.0;
  logged.attempts[2].task = "<script>alert(1)</script>";
  logged.attempts[3].spoon = "\"><img src=x>";
  const std::string page = make_progress_page("ada", logged).value();
  const auto count = [&](const std::string& part) {
    int found = 0;
    for (std::size_t at = 0; (at = page.find(part, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  EXPECT_EQ(count("<circle"), 4);
  EXPECT_EQ(count("stroke=\"#b8432f\""), 1);
  EXPECT_EQ(count("<td>2026-12-01T11:00:00Z</td>"), 5);
  EXPECT_EQ(count("<script>alert"), 0);
  EXPECT_EQ(count("<img"), 0);
  EXPECT_EQ(count("<link") + count(" src=\"") + count("url("), 0);  // nothing from other files
}

// The log of a person as the command line uses it.
TEST(TrainLog, AttemptsAreLoggedListedAndForgotten) {
  const Workplace place;
  setenv("XDG_STATE_HOME", place.text("state").c_str(), 1);
  const std::string assets = SPOONBILL_ASSETS;
  const auto script =
      place.write("short.script.json", Json({{"spoonbill_script", 1},
                                             {"model", assets + "/models/tissue.json"},
                                             {"steps", {{{"start_mm", {0, 36, 0}}}, {{"hold_s", 0.1}}}}})
                                           .dump());
  const std::vector<std::string> attempt = {
      "train", assets + "/tasks/palpate.json", "--script", script.string(), "--person", "ada"};
  ASSERT_EQ(run(attempt).code, exit_done);
  const std::string page = place.text("page.html");
  const Outcome listed = run({"train", "--progress", "ada", "--page", page, "--json"});
  ASSERT_EQ(listed.code, exit_done) << listed.err;
  const Json json = json_of(listed.out);
  ASSERT_EQ(json["attempts"].size(), 1u);
  EXPECT_EQ(json["attempts"][0]["task"], "palpate");
  EXPECT_EQ(json["attempts"][0]["end"], "under_way");
  EXPECT_EQ(json["unreadable_lines"], 0);
  EXPECT_TRUE(std::filesystem::exists(page));
  EXPECT_EQ(run({"train", "--forget", "ada"}).code, exit_done);
  EXPECT_FALSE(std::filesystem::exists(place.path("state") / "spoonbill/training/ada.jsonl"));
  EXPECT_TRUE(is_clean_failure(run({"train", "--forget", "ada"})));
  EXPECT_TRUE(is_clean_failure(run({"train", "--forget", "../ada"})));
  EXPECT_EQ(json_of(run({"train", "--progress", "ada", "--json"}).out)["attempts"].size(), 0u);
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"train"},
                                             {"train", "--page", page},
                                             {"train", "--forget", "ada", "--progress", "ada"},
                                             {"train", assets + "/tasks/carry.json", "--forget", "ada"},
                                             {"train", "--forget", "ada", "--page", page}}) {
    EXPECT_EQ(run(wrong).code, exit_wrong_use);
  }
}

}  // namespace
}  // namespace spoonbill
