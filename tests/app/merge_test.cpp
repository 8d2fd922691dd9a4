// Tests the merge command.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <sstream>
#include <string>

#include "app/program.h"
#include "engine/bspline/change_knots.h"
#include "engine/bspline/reparameterise.h"
#include "engine/exchange/document.h"
#include "tests/app/spoon_parts.h"
#include "tests/app/workplace.h"

namespace spoonbill {
namespace {

TEST(MergeCommand, BowlAndHandleBecomeASpoon) {
  const Workplace place;
  const Outcome outcome =
      run({"merge", handle, bowl, "--continuity", "C2", "--out", place.text("spoon.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_LE(facts["deviation_m"].get<double>(), 5e-5);
  ASSERT_EQ(facts["joints"].size(), 1u);
  const Json joint = facts["joints"][0];
  EXPECT_EQ(joint["a"], "1.v_end");
  EXPECT_EQ(joint["b"], "2.v_start");
  EXPECT_TRUE(joint["bridged"]);

  const Surface spoon = surface_of(place.path("spoon.json"));
  // At degree 3, continuity C2 requires inner knots of multiplicity one.
  for (const auto& [knot, multiplicity] : knot_multiplicities(spoon.v)) {
    EXPECT_TRUE(knot == spoon.v.domain_start() || multiplicity == 1) << knot;
  }
  // Before the blend, the spoon has the shape and the parameters of the handle.
  const Surface part = surface_of(handle);
  const double end = joint["blend_start"];
  EXPECT_GT(end, 90.0);
  for (double v = 0.0; v <= end; v += 0.7) {
    for (double u = 0.0; u < 1.0; u += 0.05) {
      EXPECT_LT((position(spoon, u, v) - position(part, u, v)).norm(), 5e-5);
    }
  }
  const Outcome info = run({"info", place.text("spoon.json"), "--json"});
  ASSERT_EQ(info.code, exit_done) << info.err;
  EXPECT_FALSE(json_of(info.out)["lattice"].is_null()) << info.out;
}

TEST(MergeCommand, ASplitHandleIsWholeAgain) {
  const Workplace place;
  ASSERT_EQ(run({"change", handle, "split", "v=50", "--out", place.text("halves.json")}).code, exit_done);
  EXPECT_EQ(read_document(place.path("halves.json")).value().scene.bodies.size(), 2u);
  const Outcome outcome =
      run({"merge", place.text("halves.json"), "--out", place.text("whole.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_LT(json_of(outcome.out)["deviation_m"].get<double>(), 1e-12);
  const Surface before = surface_of(handle), after = surface_of(place.path("whole.json"));
  for (double v = 0.0; v <= 100.0; v += 1.3) {
    EXPECT_LT((position(before, 0.3, v) - position(after, 0.3, v)).norm(), 1e-12);
  }
}

TEST(MergeCommand, AHandleCutInFourAlongIsClosedAroundAgain) {
  const Workplace place;
  Document document = read_document(handle).value();
  const Body whole = document.scene.bodies[0];
  document.scene.bodies.assign(4, whole);
  for (std::size_t k = 0; k < 4; ++k) {
    const double start = 0.25 * static_cast<double>(k);
    document.scene.bodies[k].name = "quarter " + std::to_string(k);
    document.scene.bodies[k].surface = part_of(whole.surface, Direction::u, start, start + 0.25).value();
  }
  place.write("quarters.json", json_to_page(document_to_json(document)));
  const Outcome outcome =
      run({"merge", place.text("quarters.json"), "--out", place.text("whole.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json joints = json_of(outcome.out)["joints"];
  ASSERT_EQ(joints.size(), 4U);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(joints[k]["closes"], k == 3);
  EXPECT_FALSE(json_of(run({"info", place.text("whole.json"), "--json"}).out)["lattice"].is_null());
  const Outcome told = run({"merge", place.text("quarters.json"), "--out", place.text("whole.json")});
  EXPECT_NE(told.out.find("4.u_end and 1.u_start, edge to edge, which closes the surface in this direction"),
            std::string::npos)
      << told.out;
}

TEST(MergeCommand, ABlendIsToldOf) {
  const Workplace place;
  ASSERT_EQ(run({"change", handle, "split", "v=50", "--out", place.text("halves.json")}).code, exit_done);
  const Outcome smooth = run(
      {"merge", place.text("halves.json"), "--blend", "5mm", "--out", place.text("whole.json"), "--json"});
  ASSERT_EQ(smooth.code, exit_done) << smooth.err;
  EXPECT_NE(smooth.out.find("the blend was not applied to 1.v_end and 2.v_start"), std::string::npos)
      << smooth.out;
  const Outcome blended =
      run({"merge", handle, bowl, "--blend", "12mm", "--out", place.text("spoon.json"), "--json"});
  ASSERT_EQ(blended.code, exit_done) << blended.err;
  const Json joint = json_of(blended.out)["joints"][0];
  EXPECT_NEAR(joint["blend_length_m"].get<double>(), 0.012, 5e-4);
  EXPECT_GT(joint["cut_back_m"].get<double>(), 1e-3);
  const Outcome longer = run({"merge", handle, bowl, "--blend", "1m", "--out", place.text("long.json")});
  EXPECT_EQ(longer.code, exit_failed);
  EXPECT_NE(longer.err.find("more than half of a patch"), std::string::npos) << longer.err;
}

TEST(MergeCommand, NormalsThatPointInwardsAreToldOf) {
  const Workplace place;
  const std::string inward = place.text("inward.json"), parts = place.text("parts.json");
  ASSERT_EQ(run({"change", handle, "reverse", "u", "--out", inward}).code, exit_done);
  for (const auto& [model, told] : {std::pair(inward, true), std::pair(std::string(handle), false)}) {
    ASSERT_EQ(run({"change", model, "split", "v=50", "--out", parts}).code, exit_done);
    const Outcome outcome = run({"merge", parts, "--out", place.text("whole.json"), "--json"});
    ASSERT_EQ(outcome.code, exit_done) << outcome.err;
    EXPECT_EQ(outcome.out.find("normals point inwards") != std::string::npos, told) << outcome.out;
  }
}

// A closed body cannot be a face of a solid.
TEST(MergeCommand, FacesOfOneSolidStayAFaceOfItWhileOpen) {
  const Workplace place;
  const auto solid_of_merged = [&](const std::string& whole, const std::string& other) {
    EXPECT_EQ(run({"change", whole, "split", "v=50", "--out", place.text("halves.json")}).code, exit_done);
    Document halves = read_document(place.path("halves.json")).value();
    halves.scene.bodies[0].solid = "bracket";
    halves.scene.bodies[1].solid = other;
    place.write("faces.json", json_to_page(document_to_json(halves)));
    EXPECT_EQ(run({"merge", place.text("faces.json"), "--out", place.text("whole.json")}).code, exit_done);
    return read_document(place.path("whole.json"))->scene.bodies[0].solid;
  };
  const std::string opened = place.text("opened.json");
  ASSERT_EQ(run({"change", handle, "open", "v_end", "--out", opened}).code, exit_done);
  EXPECT_EQ(solid_of_merged(opened, "bracket"), "bracket");
  EXPECT_EQ(solid_of_merged(opened, "lid"), "");
  EXPECT_EQ(solid_of_merged(handle, "bracket"), "");
}

Vector3 middle_of(const std::string& ball) {
  const Surface sphere = surface_of(ball);
  return 0.5 *
         (position(sphere, 0.0, sphere.v.domain_start()) + position(sphere, 0.0, sphere.v.domain_end()));
}

// Moves the rod in rod.json so that its lower end is at the height of the ball's centre.
void stand_in_middle(const Workplace& place, const std::string& ball) {
  Document moved = read_document(place.path("rod.json")).value();
  Vector3 low = moved.scene.bodies[0].surface.net.point(0, 0);
  for (int i = 0; i < moved.scene.bodies[0].surface.net.rows; ++i) {
    for (int j = 0; j < moved.scene.bodies[0].surface.net.columns; ++j) {
      low = low.cwiseMin(moved.scene.bodies[0].surface.net.point(i, j));
    }
  }
  Surface& surface = moved.scene.bodies[0].surface;
  surface = placed(surface, {Vector3(0, middle_of(ball).y() - low.y(), 0), Quaternion::Identity()});
  place.write("rod.json", json_to_page(document_to_json(moved)));
}

TEST(MergeCommand, CrossingBodiesBecomeOneWithAFillet) {
  const Workplace place;
  const std::string rod = place.text("rod.json"), ball = place.text("ball.json"),
                    knob = place.text("knob.json");
  ASSERT_EQ(run({"new", "cylinder", "--radius", "6mm", "--height", "60mm", "--out", rod}).code, exit_done);
  ASSERT_EQ(run({"new", "sphere", "--radius", "20mm", "--out", ball}).code, exit_done);
  stand_in_middle(place, ball);
  const Outcome outcome =
      run({"merge", rod, ball, "--intersect", "--fillet", "3mm", "--out", knob, "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json told = json_of(outcome.out);
  EXPECT_LE(told["deviation_m"].get<double>(), 5e-5);
  EXPECT_EQ(told["continuity"], 1);
  EXPECT_TRUE(told["remarks"].empty()) << outcome.out;
  ASSERT_EQ(told["joints"].size(), 1U);
  EXPECT_GT(told["joints"][0]["blend_end"], told["joints"][0]["blend_start"]);
  EXPECT_GT(told["joints"][0]["blend_length_m"].get<double>(), 0.002);
  const Outcome tighter = run({"merge", rod, ball, "--intersect", "--fillet", "3mm", "--continuity", "C2",
                               "--out", place.text("tighter.json"), "--json"});
  ASSERT_EQ(tighter.code, exit_done) << tighter.err;
  EXPECT_EQ(json_of(tighter.out)["continuity"], 2);
  EXPECT_EQ(json_of(tighter.out)["remarks"].size(), 1U) << tighter.out;
  const std::string inward = place.text("inward.json");
  ASSERT_EQ(run({"change", ball, "reverse", "u", "--out", inward}).code, exit_done);
  const Outcome turned =
      run({"merge", rod, inward, "--intersect", "--out", place.text("turned.json"), "--json"});
  ASSERT_EQ(turned.code, exit_done) << turned.err;
  EXPECT_NE(turned.out.find("the normals of patch 2 pointed inwards; the patch was reversed"),
            std::string::npos)
      << turned.out;
  // Both fillets get a note, not only the last.
  Document third = read_document(rod).value();
  third.scene.bodies[0].surface =
      placed(third.scene.bodies[0].surface,
             {2.0 * middle_of(ball), Quaternion(Eigen::AngleAxisd(M_PI, Vector3::UnitX()))});
  place.write("third.json", json_to_page(document_to_json(third)));
  const Outcome both =
      run({"merge", rod, ball, place.text("third.json"), "--intersect", "--fillet", "3mm", "--continuity",
           "C2", "--tolerance", "0.4mm", "--out", place.text("both.json"), "--json"});
  ASSERT_EQ(both.code, exit_done) << both.err;
  EXPECT_NE(both.out.find("the fillet with patch 2 has a radius"), std::string::npos) << both.out;
  EXPECT_NE(both.out.find("the fillet with patch 3 has a radius"), std::string::npos) << both.out;
  // The smallest concave radius is that of the fillet.
  const Json curved = json_of(run({"check", knob, "--json"}).out)["bodies"][0];
  EXPECT_NEAR(curved["smallest_concave_radius_m"].get<double>(), 0.003, 2e-4);
  const Json body = json_of(run({"check", knob, "--json"}).out)["bodies"][0];
  // The volume is that of the ball and of the part of the rod above the plane in which they intersect, minus
  // the ball's cap above this plane. The rounding of the rod's end and the fillet are negligible.
  const double ball_m3 = 4.0 / 3.0 * M_PI * 8e-6, plane_m = std::sqrt(4e-4 - 36e-6), cap_m = 0.02 - plane_m;
  const double rod_m3 = M_PI * 36e-6 * (0.06 - plane_m), cap_m3 = M_PI * cap_m * cap_m * (0.02 - cap_m / 3.0);
  EXPECT_NEAR(body["volume_m3"].get<double>(), ball_m3 + rod_m3 - cap_m3, 0.01 * rod_m3);
}

TEST(MergeCommand, RefusesInOneLine) {
  const Workplace place;
  const std::string out = place.text("out.json");
  place.write("out.json", "mine");
  struct Case {
    std::vector<std::string> arguments;
    int code;
    const char* told;
  };
  const std::vector<Case> cases{
      {{"merge", handle, bowl, "--continuity", "G2", "--out", out},
       exit_wrong_use,
       "not a continuity from C0 to C8"},
      {{"merge", handle, bowl, "--tolerance", "5", "--out", out}, exit_wrong_use, "not a length with a unit"},
      {{"merge", handle, bowl, "--tolerance", "nanmm", "--out", out},
       exit_wrong_use,
       "not a length with a unit"},
      {{"merge", handle, bowl, "--edges", "1.v_end", "--out", out}, exit_wrong_use, "not a pair of edges"},
      {{"merge", handle, bowl, "--edges", "1.top:2.v_end", "--out", out},
       exit_wrong_use,
       "edge 'top' is unknown"},
      {{"merge", handle, bowl, "--edges", "1.v_end:9.v_end", "--out", out},
       exit_failed,
       "patch 9 of a chosen edge"},
      {{"merge", handle, bowl, "--edges", "1.u_end:2.v_end", "--out", out},
       exit_failed,
       "it is closed in this direction"},
      {{"merge", handle, bowl, "--twist", "nan", "--out", out},
       exit_wrong_use,
       "'nan' is not a fraction of a turn from -1 to 1"},
      {{"merge", handle, bowl, "--continuity", "C\n2", "--out", out},
       exit_wrong_use,
       "'C?2' is not a continuity"},
      {{"merge", handle, bowl, "--edges", "1.v\nend:2.v_start", "--out", out},
       exit_wrong_use,
       "edge 'v?end' is unknown"},
      {{"merge", handle, bowl, "--intersect", "--continuity", "C2", "--out", out},
       exit_wrong_use,
       "add --fillet"},
      {{"merge", handle, "--intersect", "--out", out}, exit_failed, "needs at least two bodies"},
      {{"merge", place.text("none.json"), "--out", out}, exit_failed, "none.json"},
      {{"merge", "--out", out}, exit_wrong_use, "MODEL"}};
  for (const Case& one : cases) {
    const Outcome outcome = run(one.arguments);
    EXPECT_EQ(outcome.code, one.code) << one.told;
    EXPECT_NE(outcome.err.find(one.told), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(std::filesystem::file_size(out), 4u);  // the existing file is unchanged
  }
}

// A terminal whose user presses Ctrl+C as soon as the progress bar moves.
class ImpatientTerminal : public std::stringbuf {
 public:
  int shown_percent() const { return shown_percent_; }

 protected:
  int sync() override {
    const std::string text = str();
    const std::size_t end = text.rfind(" %"), start = text.rfind("] ");
    if (end == std::string::npos || start == std::string::npos || start > end) return 0;
    shown_percent_ = std::stoi(text.substr(start + 2, end - start - 2));
    if (shown_percent_ > 0 && !pressed_) raise(SIGINT);
    pressed_ = pressed_ || shown_percent_ > 0;
    return 0;
  }

 private:
  int shown_percent_ = 0;
  bool pressed_ = false;
};

TEST(MergeCommand, StopsInTheMiddleOfTheWork) {
  const Workplace place;
  place.write("out.json", "mine");
  const std::string rod = place.text("rod.json"), ball = place.text("ball.json"),
                    out = place.text("out.json"), finer = place.text("finer.json");
  ASSERT_EQ(run({"new", "cylinder", "--radius", "6mm", "--height", "60mm", "--out", rod}).code, exit_done);
  ASSERT_EQ(run({"new", "sphere", "--radius", "20mm", "--out", ball}).code, exit_done);
  stand_in_middle(place, ball);
  ASSERT_EQ(run({"change", ball, "degree", "v", "4", "--out", finer}).code, exit_done);
  const std::vector<std::vector<std::string>> commands{{"merge", handle, bowl, "--out", out},
                                                       {"merge", rod, ball, "--intersect", "--out", out},
                                                       {"change", finer, "simplify", "--out", out},
                                                       {"change", handle, "degree", "v", "2", "--out", out}};
  for (const auto& arguments : commands) {
    ImpatientTerminal terminal;
    std::ostream err(&terminal);
    std::ostringstream said;
    Console console{said, err, true};
    EXPECT_EQ(run_program(arguments, console), exit_failed) << arguments[2];
    EXPECT_GT(terminal.shown_percent(), 0);
    EXPECT_LT(terminal.shown_percent(), 100) << arguments[2];
    EXPECT_NE(terminal.str().find("spoonbill: stopped; " + out + " was not written"), std::string::npos)
        << terminal.str();
    EXPECT_TRUE(said.str().empty());
    EXPECT_EQ(std::filesystem::file_size(out), 4U);
  }
}

TEST(MergeCommand, StopsWhenAskedTo) {
  const Workplace place;
  place.write("out.json", "mine");
  sigset_t interrupt, before;
  sigemptyset(&interrupt);
  sigaddset(&interrupt, SIGINT);
  pthread_sigmask(SIG_BLOCK, &interrupt, &before);
  raise(SIGINT);
  const Outcome outcome = run({"merge", handle, bowl, "--out", place.text("out.json")});
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  EXPECT_EQ(outcome.code, exit_failed);
  EXPECT_TRUE(is_clean_failure(outcome)) << outcome.err;
  EXPECT_NE(outcome.err.find("stopped"), std::string::npos) << outcome.err;
  EXPECT_EQ(std::filesystem::file_size(place.path("out.json")), 4U);
}

}  // namespace
}  // namespace spoonbill
