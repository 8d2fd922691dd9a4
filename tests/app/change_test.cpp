// Tests the change command.
#include <gtest/gtest.h>

#include <string>

#include "app/program.h"
#include "engine/bspline/change_knots.h"
#include "engine/exchange/document.h"
#include "tests/app/spoon_parts.h"
#include "tests/app/workplace.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

TEST(ChangeCommand, EachChangeDoesWhatItSays) {
  const Workplace place;
  const auto change = [&](std::vector<std::string> words) {
    std::vector<std::string> arguments{"change", handle};
    arguments.insert(arguments.end(), words.begin(), words.end());
    for (const char* more : {"--out", "", "--json"}) arguments.emplace_back(more);
    arguments[arguments.size() - 2] = place.text("out.json");
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return outcome.code == exit_done ? json_of(outcome.out) : Json();
  };
  const Surface before = surface_of(handle);
  const auto after = [&] { return surface_of(place.path("out.json")); };
  const auto expect_same_surface = [&](double tolerance) {
    const Surface changed = after();
    for (double v = 0.0; v <= 100.0; v += 2.3) {
      for (double u = 0.0; u < 1.0; u += 0.11) {
        EXPECT_LT((position(before, u, v) - position(changed, u, v)).norm(), tolerance);
      }
    }
  };
  change({"insert", "v=33", "2"});
  expect_same_surface(1e-15);
  EXPECT_EQ(after().v.control_point_count(), before.v.control_point_count() + 2);
  const std::string finer = place.text("finer.json");
  ASSERT_EQ(run({"change", handle, "insert", "v=33", "2", "--out", finer}).code, exit_done);
  const Outcome removed =
      run({"change", finer, "remove", "v=33", "2", "--out", place.text("out.json"), "--json"});
  ASSERT_EQ(removed.code, exit_done) << removed.err;
  EXPECT_LT(json_of(removed.out)["deviation_m"].get<double>(), 1e-12);
  expect_same_surface(1e-12);
  EXPECT_EQ(after().v, before.v);
  EXPECT_EQ(change({"degree", "u", "5"})["deviation_m"], 0.0);
  expect_same_surface(1e-15);
  EXPECT_EQ(after().u.degree(), 5);
  EXPECT_LE(change({"degree", "v", "2"})["deviation_m"].get<double>(), 1e-5);
  expect_same_surface(1e-5);
  change({"simplify"});
  expect_same_surface(1e-5);
  EXPECT_LT(after().v.control_point_count(), before.v.control_point_count());
  const double rebuilt_m = change({"rebuild", "--control", "14x24"})["deviation_m"].get<double>();
  EXPECT_GT(rebuilt_m, 1e-5);
  EXPECT_LT(rebuilt_m, 1e-3);
  expect_same_surface(rebuilt_m);
  EXPECT_EQ(after().u.control_point_count(), 14);
  EXPECT_EQ(after().v.control_point_count(), 24);
  change({"reverse", "v"});
  EXPECT_LT((position(after(), 0.2, 10.0) - position(before, 0.2, 90.0)).norm(), 1e-15);
  change({"exchange"});
  EXPECT_LT((position(after(), 10.0, 0.2) - position(before, 0.2, 10.0)).norm(), 1e-15);
  change({"seam", "u=0.25"});
  EXPECT_LT((position(after(), 0.0, 10.0) - position(before, 0.25, 10.0)).norm(), 1e-15);
  change({"open", "v_end"});
  EXPECT_LT(after().v.domain_end(), 100.0);
  EXPECT_FALSE(read_document(place.path("out.json")).value().scene.bodies.empty());
  change({"split", "u=0.5"});
  EXPECT_FALSE(after().u.is_periodic());
  EXPECT_LT((position(after(), 0.5, 10.0) - position(after(), 1.5, 10.0)).norm(), 1e-15);
}

TEST(ChangeCommand, OpenedAndCappedAndClosed) {
  const Workplace place;
  const std::string opened = place.text("opened.json"), capped = place.text("capped.json");
  ASSERT_EQ(run({"change", handle, "open", "v_end", "--out", opened}).code, exit_done);
  const Outcome outcome =
      run({"change", opened, "cap", "v_end", "2mm", "--out", capped, "--tolerance", "0.05mm"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  // The capped body is closed and can be simulated.
  EXPECT_FALSE(json_of(run({"info", capped, "--json"}).out)["lattice"].is_null());
  const std::string slit = place.text("slit.json"), closed = place.text("closed.json");
  ASSERT_EQ(run({"change", handle, "split", "u=0.5", "--out", slit}).code, exit_done);
  ASSERT_EQ(run({"change", slit, "close", "u", "--out", closed}).code, exit_done);
  EXPECT_TRUE(surface_of(place.path("closed.json")).u.is_periodic());
  const auto knots_at_seam = [&] {
    return knot_multiplicities(surface_of(place.path("closed.json")).u).front().multiplicity;
  };
  EXPECT_EQ(knots_at_seam(), 1);
  ASSERT_EQ(run({"change", slit, "close", "u", "--continuity", "C0", "--out", closed}).code, exit_done);
  EXPECT_EQ(knots_at_seam(), 3);
}

// Capping makes the body closed, so its shell thickness must be removed: a closed body with a shell thickness
// cannot be sculpted.
TEST(ChangeCommand, AShellThatIsCappedIsASolid) {
  const Workplace place;
  const std::string opened = place.text("opened.json"), capped = place.text("capped.json");
  ASSERT_EQ(run({"change", handle, "open", "v_end", "--out", opened}).code, exit_done);
  Document shell = read_document(opened).value();
  shell.scene.bodies[0].shell_thickness_m = 0.0005;
  place.write("opened.json", json_to_page(document_to_json(shell)));
  const Outcome outcome =
      run({"change", opened, "cap", "v_end", "2mm", "--out", capped, "--tolerance", "0.05mm", "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(json_of(outcome.out)["remarks"].size(), 1U) << outcome.out;
  EXPECT_FALSE(read_document(capped).value().scene.bodies[0].shell_thickness_m.has_value());
  EXPECT_FALSE(json_of(run({"info", capped, "--json"}).out)["lattice"].is_null());
}

TEST(ChangeCommand, RefusesInOneLine) {
  const Workplace place;
  const std::string out = place.text("out.json");
  struct Case {
    std::vector<std::string> words;
    int code;
    const char* told;
  };
  const std::vector<Case> cases{
      {{"split", "v=500"}, exit_failed, "empty or not within the domain"},
      {{"split", "w=0.5"}, exit_wrong_use, "not a parameter like v=0.3"},
      {{"split", "v=nan"}, exit_wrong_use, "not a parameter like v=0.3"},
      {{"split", "v="}, exit_wrong_use, "not a parameter like v=0.3"},
      {{"split"}, exit_wrong_use, "must have the form: split v=0.5"},
      {{"split", "v=1", "2"}, exit_wrong_use, "must have the form: split v=0.5"},
      {{"simplify", "u"}, exit_wrong_use, "must have the form: simplify"},
      {{"rebuild"}, exit_wrong_use, "rebuild: needs --control"},
      {{"simplify", "--control", "20x20"}, exit_wrong_use, "applies only to 'rebuild'"},
      {{"rebuild", "--control", "20x20"}, exit_failed, "must be from 2 to the 16"},
      {{"rebuild", "--control", "16x3"}, exit_failed, "must be from 4 to the 31"},
      {{"rebuild", "--control", "20"}, exit_wrong_use, "--control"},
      {{"degree", "v", "12"}, exit_wrong_use, "'12' is not a whole number from 1 to 9"},
      {{"degree", "v", "2.5"}, exit_wrong_use, "not a whole number"},
      {{"insert", "v=50", "9"}, exit_failed, "multiplicity 9"},
      {{"insert", "v=1e-300"}, exit_failed, "too near the one at 0"},
      {{"remove", "v=50.01"}, exit_failed, "there is no knot at 50.01; the nearest is at"},
      {{"remove", "v=0"}, exit_failed, "is an end of the domain"},
      {{"remove", "u=0"}, exit_failed, "the seam needs a knot"},
      {{"remove", "u=0.5"}, exit_failed, "leaves a deviation of"},
      {{"remove"}, exit_wrong_use, "must have the form: remove v=0.5"},
      {{"insert", "v=50", "0"}, exit_wrong_use, "not a whole number from 1"},
      {{"close", "u"}, exit_failed, "closed already"},
      {{"close", "v"}, exit_failed, "apart"},
      {{"cap", "v_end"}, exit_failed, "not the open end of a tube"},
      {{"cap", "top\nend"}, exit_wrong_use, "edge 'top?end' is unknown"},
      {{"cap", "v_end", "3"}, exit_wrong_use, "not a length with a unit"},
      {{"me\nlt"}, exit_wrong_use, "'me?lt' is not a change; choose from move"}};
  for (const auto& [words, code, told] : cases) {
    std::vector<std::string> arguments{"change", handle};
    arguments.insert(arguments.end(), words.begin(), words.end());
    arguments.insert(arguments.end(), {"--out", out});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code) << told;
    EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
    EXPECT_NE(outcome.err.find(told), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
  const Outcome seamless = run({"change", handle, "--continuity", "C1", "simplify", "--out", out});
  EXPECT_EQ(seamless.code, exit_wrong_use);
  EXPECT_TRUE(is_clean_failure(seamless)) << seamless.err;
  EXPECT_NE(seamless.err.find("applies only to the seam that 'close' makes"), std::string::npos)
      << seamless.err;
  const Outcome second = run({"change", handle, "exchange", "--body", "2", "--out", out});
  EXPECT_EQ(second.code, exit_failed);
  EXPECT_NE(second.err.find("has 1 body, and --body names 2"), std::string::npos) << second.err;
}

TEST(ChangeCommand, SaysWhatADegreeTakes) {
  const Workplace place;
  Document document = sample_document();
  document.scene.bodies[0].surface = wavy_sheet(4, 600);
  place.write("sheet.json", json_to_page(document_to_json(document)));
  // The 600 control points in v make 597 spans of degree 3. At degree 9, the knot vector has 596 inner knots
  // of multiplicity seven and ten knots at each end, which makes 596 x 7 + 10 control points.
  const Outcome outcome =
      run({"change", place.text("sheet.json"), "degree", "v", "9", "--out", place.text("out.json")});
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_NE(outcome.err.find("needs 4182 control points, and a document holds 4000"), std::string::npos)
      << outcome.err;
}

TEST(ChangeCommand, SaysWhatItLeavesOut) {
  const Workplace place;
  const std::string grip = SPOONBILL_ASSETS "/models/soft-grip.json", out = place.text("out.json");
  const auto remarks = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return json_of(outcome.out)["remarks"].size();
  };
  // Each half of a split surface gets a note that it is open. Another note reports the grip's lost regions.
  EXPECT_EQ(remarks({"change", grip, "split", "v=40", "--out", out, "--json"}), 3U);
  EXPECT_EQ(remarks({"change", grip, "insert", "v=40", "--out", out, "--json"}), 0U);
  EXPECT_EQ(remarks({"change", handle, "split", "v=40", "--out", out, "--json"}), 2U);
  EXPECT_EQ(remarks({"merge", grip, bowl, "--out", out, "--json"}), 2U);  // also the rim of the bowl
}

}  // namespace
}  // namespace spoonbill
