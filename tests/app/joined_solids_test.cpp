// Tests documents whose bodies are the faces of one solid, as in parts from CAD: they are converted and
// checked as this solid.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <sstream>
#include <utility>

#include "app/program.h"
#include "engine/exchange/document.h"
#include "tests/app/process.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

constexpr double metres_per_mm = 1e-3;

// Returns a parallelogram with the given corner and sides. For a face of a solid, the cross product of its
// sides must point outwards.
Surface plate(const Vector3& corner_mm, const Vector3& u_mm, const Vector3& v_mm) {
  ControlNet net(2, 2);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) net.set_point(i, j, metres_per_mm * (corner_mm + i * u_mm + j * v_mm));
  }
  const KnotVector knots = KnotVector::clamped_uniform(1, 2).value();
  return make_surface(knots, knots, std::move(net)).value();
}

// Returns a box of 30 x 20 x 10 mm as six bodies. Its top is too high by the given length.
Document box_of_faces(double too_high_mm = 0.0) {
  const Vector3 x(30, 0, 0), y(0, 20, 0), z(0, 0, 10), none = Vector3::Zero();
  const std::array<Surface, 6> faces = {plate(z + Vector3(0, 0, too_high_mm), x, y),
                                        plate(none, y, x),
                                        plate(none, x, z),
                                        plate(y, z, x),
                                        plate(none, z, y),
                                        plate(x, y, z)};
  Document document = sample_document();
  const Body like = document.scene.bodies[0];
  document.scene.bodies.clear();
  for (const Surface& face : faces) {
    Body body = like;
    body.name = "face " + std::to_string(document.scene.bodies.size() + 1);
    body.surface = face;
    body.solid = "bracket";
    document.scene.bodies.push_back(std::move(body));
  }
  return document;
}

class JoinedSolids : public testing::Test {
 protected:
  void save(const std::string& name, const Document& document) const {
    place_.write(name, json_to_page(document_to_json(document)));
  }

  static Json facts_of(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    const Outcome outcome = run_process(SPOONBILL_PROGRAM, arguments);
    EXPECT_EQ(outcome.code, exit_done) << outcome.err;
    return json_of(outcome.out);
  }

  Json convert(const std::string& in, const std::string& out) const {
    return facts_of({"convert", place_.text(in), place_.text(out)});
  }

  Workplace place_;
};

// Returns the enclosed volume in the file's unit. Returns -1 unless every edge is used by two triangles in
// opposite directions.
double volume_of_watertight_obj(const std::string& text) {
  std::istringstream lines(text);
  std::vector<Vector3> points;
  std::map<std::pair<int, int>, int> ways;
  double volume = 0.0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Vector3 point;
      words >> point.x() >> point.y() >> point.z();
      points.push_back(point);
    } else if (kind == "f") {
      std::array<int, 3> corners{};
      for (int& corner : corners) words >> corner;
      for (std::size_t k = 0; k < 3; ++k) ++ways[{corners[k], corners[(k + 1) % 3]}];
      const auto at = [&](int corner) { return points[static_cast<std::size_t>(corner) - 1]; };
      volume += at(corners[0]).dot(at(corners[1]).cross(at(corners[2]))) / 6.0;
    }
  }
  for (const auto& [way, count] : ways) {
    if (count != 1 || !ways.contains({way.second, way.first})) return -1.0;
  }
  return volume;
}

TEST_F(JoinedSolids, LeaveAsOneWatertightMesh) {
  save("box.json", box_of_faces());
  convert("box.json", "box.step");
  for (const char* in : {"box.json", "box.step"}) {
    for (const char* out : {"box.stl", "box.obj", "box.ply", "box.3mf"}) {
      SCOPED_TRACE(std::string(in) + " to " + out);
      const Json facts = convert(in, out);
      EXPECT_EQ(facts["meshes"], 1);
      EXPECT_EQ(facts["closed_meshes"], 1);
      EXPECT_EQ(facts["triangles"], 12);
      // Only the STEP file gives a note, which is about its import.
      EXPECT_EQ(facts["notes"].size(), std::string(in) == "box.step" ? 1u : 0u) << facts["notes"];
    }
    EXPECT_NEAR(volume_of_watertight_obj(content_of(place_.path("box.obj"))), 6000.0, 1e-6);
    EXPECT_NE(content_of(place_.path("box.obj")).find("o bracket"), std::string::npos);
  }
}

TEST_F(JoinedSolids, StandBesideOtherBodiesInTheirOrder) {
  Document document = box_of_faces();
  document.scene.bodies.insert(document.scene.bodies.begin() + 3, sample_document().scene.bodies[0]);
  save("both.json", document);
  const Json facts = convert("both.json", "both.obj");
  EXPECT_EQ(facts["meshes"], 2);
  EXPECT_EQ(facts["closed_meshes"], 2);
  const std::string text = content_of(place_.path("both.obj"));
  EXPECT_LT(text.find("o bracket"), text.find("o " + document.scene.bodies[3].name));
}

TEST_F(JoinedSolids, FacesThatDoNotCloseAreMeshesEachWithANote) {
  Document document = box_of_faces();
  document.scene.bodies.pop_back();
  save("open.json", document);
  const Json facts = convert("open.json", "open.stl");
  EXPECT_EQ(facts["meshes"], 5);
  EXPECT_EQ(facts["closed_meshes"], 0);
  EXPECT_EQ(facts["notes"], Json::array({"5 of the 5 faces of 'bracket' together enclose no volume",
                                         "faces that are not part of a solid: 5, each a separate mesh"}));
}

// The gap is wider than the errors of two approximated faces can explain.
TEST_F(JoinedSolids, AGapThatIsBridgedIsSaid) {
  save("gap.json", box_of_faces(0.05));
  for (const char* out : {"gap.step", "gap.igs", "gap.stl"}) {
    SCOPED_TRACE(out);
    EXPECT_EQ(
        convert("gap.json", out)["notes"],
        Json::array({"the faces of 'bracket' have gaps of up to 0.05 mm; they are joined as if there were "
                     "none"}));
  }
  EXPECT_EQ(convert("gap.json", "gap.step")["solids"], 1);
  save("near.json", box_of_faces(0.015));
  EXPECT_TRUE(convert("near.json", "near.step")["notes"].empty());
}

TEST_F(JoinedSolids, AreCheckedAsOne) {
  save("box.json", box_of_faces());
  const Json facts = facts_of({"check", place_.text("box.json")});
  EXPECT_EQ(facts["sound"], true);
  ASSERT_EQ(facts["solids"].size(), 1u);
  const Json& solid = facts["solids"][0];
  EXPECT_EQ(solid["name"], "bracket");
  EXPECT_EQ(solid["closed"], true);
  EXPECT_EQ(solid["bodies"].size(), 6u);
  // Integrals over planes are exact up to rounding.
  EXPECT_NEAR(solid["volume_m3"], 6000e-9, 1e-15);
  EXPECT_NEAR(solid["area_m2"], 2200e-6, 1e-12);
  const double density = box_of_faces().scene.bodies[0].material.density_kg_per_m3;
  EXPECT_NEAR(solid["mass_kg"], density * 6000e-9, 1e-12 * density);
  EXPECT_NEAR(solid["centre_of_mass_m"][0], 0.015, 1e-9);
  EXPECT_EQ(solid["sound"], true);
  EXPECT_EQ(solid["self_intersections"], Json::array());
  EXPECT_NEAR(solid["smallest_thickness_m"], 0.010, 1e-9);
  EXPECT_LT(solid["thickness_error_m"], 1e-9);
  EXPECT_EQ(facts["bodies"][0]["solid"], "bracket");
  EXPECT_EQ(facts["bodies"][0]["problems"], Json::array());
  const Outcome lines = run_process(SPOONBILL_PROGRAM, {"check", place_.text("box.json")});
  EXPECT_NE(lines.out.find("bracket: closed, solid of 6 faces"), std::string::npos) << lines.out;
}

// Returns the box with a top that sags at its centre by the given length. The edges of the top stay straight.
Document sagging_box(double by_mm) {
  Document document = box_of_faces();
  ControlNet net(5, 5);
  // Weight of the central control point at the centre: (6 / 16)^2.
  constexpr double share = 0.140625;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      const double height = i == 2 && j == 2 ? 10.0 - by_mm / share : 10.0;
      net.set_point(i, j, metres_per_mm * Vector3(7.5 * i, 5.0 * j, height));
    }
  }
  const KnotVector knots = KnotVector::clamped_uniform(4, 5).value();
  document.scene.bodies[0].surface = make_surface(knots, knots, std::move(net)).value();
  return document;
}

TEST_F(JoinedSolids, AreAsThickAsBetweenTwoFaces) {
  save("thin.json", sagging_box(9.0));
  const Json facts = facts_of({"check", place_.text("thin.json")});
  EXPECT_EQ(facts["sound"], true) << facts["solids"];
  const Json& solid = facts["solids"][0];
  // The thickness is measured on the surfaces; the mesh is coarser.
  EXPECT_NEAR(solid["smallest_thickness_m"], 0.001, 1e-8);
  EXPECT_GT(solid["thickness_error_m"], 1e-6);
  EXPECT_NEAR(solid["thinnest"]["point_m"][0], 0.015, 5e-4);
  EXPECT_NEAR(solid["thinnest"]["point_m"][1], 0.010, 5e-4);
}

TEST_F(JoinedSolids, WhoseFacesPassThroughEachOtherAreNotSound) {
  save("through.json", sagging_box(12.0));
  const Json facts = facts_of({"check", place_.text("through.json")});
  EXPECT_EQ(facts["sound"], false);
  const Json& solid = facts["solids"][0];
  EXPECT_EQ(solid["closed"], true);
  EXPECT_EQ(solid["sound"], false);
  ASSERT_FALSE(solid["self_intersections"].empty());
  EXPECT_NEAR(solid["self_intersections"][0]["point_m"][2], 0.0, 1e-6);
  ASSERT_EQ(solid["problems"].size(), 1u);
  EXPECT_NE(solid["problems"][0].get<std::string>().find("passes through itself"), std::string::npos);
}

TEST_F(JoinedSolids, ThatDoNotCloseAreNotSound) {
  Document document = box_of_faces();
  document.scene.bodies.pop_back();
  save("open.json", document);
  const Json facts = facts_of({"check", place_.text("open.json")});
  EXPECT_EQ(facts["sound"], false);
  ASSERT_EQ(facts["solids"].size(), 1u);
  EXPECT_EQ(facts["solids"][0]["closed"], false);
  EXPECT_EQ(facts["notes"], Json::array({"5 of the 5 faces of 'bracket' together enclose no volume"}));
  EXPECT_FALSE(facts["solids"][0].contains("volume_m3"));
  EXPECT_EQ(facts["bodies"][0]["sound"], false);
}

TEST_F(JoinedSolids, OfSeveralMaterialsHaveNoMass) {
  Document document = box_of_faces();
  document.scene.bodies[4].material.density_kg_per_m3 *= 2.0;
  save("mixed.json", document);
  const Json facts = facts_of({"check", place_.text("mixed.json")});
  EXPECT_FALSE(facts["solids"][0].contains("mass_kg"));
  EXPECT_TRUE(facts["solids"][0].contains("volume_m3"));
}

}  // namespace
}  // namespace spoonbill
