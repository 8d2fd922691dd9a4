#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/panel/panel.h"
#include "app/program.h"
#include "app/report/document_facts.h"
#include "app/session/session.h"
#include "engine/base/text.h"
#include "engine/bspline/surface.h"
#include "engine/exchange/document.h"
#include "engine/simulation/simulation.h"
#include "tests/app/workplace.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

TEST(Info, TellsOfAModel) {
  const Workplace place;
  const Outcome outcome = run({"info", place.text("model.json"), "--json"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const Json facts = json_of(outcome.out);
  EXPECT_EQ(facts["kind"], "document");
  EXPECT_EQ(facts["unit"], "mm");
  EXPECT_NEAR(facts["size_mm"][0], 60.0, 0.01);
  EXPECT_EQ(facts["surfaces"][0]["v"]["degree"], 3);
  EXPECT_EQ(facts["surfaces"][0]["u"]["periodic"], true);
  EXPECT_GT(facts["lattice"]["node_count"], 100);
  EXPECT_GT(facts["mass_kg"], 0.0);
  EXPECT_GE(facts["inertia_scale"], 1.0);
  EXPECT_DOUBLE_EQ(facts["responds_times_slower"], std::sqrt(facts["inertia_scale"].get<double>()));
  EXPECT_GE(facts["real_time_substeps"], 1);
  EXPECT_NE(run({"info", place.text("model.json")}).out.find("Size"), std::string::npos);
}

// All reports give the same mass, computed from the exact volume. The mass of the lattice is reported under
// another name.
TEST(Info, AMassIsOneNumber) {
  const Workplace place;
  const Document document = read_document(place.path("model.json")).value();
  const Json facts = json_of(run({"info", place.text("model.json"), "--json"}).out);
  const Json checked = json_of(run({"check", place.text("model.json"), "--json"}).out)["bodies"][0];
  const double mass_kg = checked["mass_kg"];
  EXPECT_NEAR(facts["mass_kg"], mass_kg, 1e-9 * mass_kg);
  EXPECT_NEAR(mass_kg,
              document.scene.bodies[0].material.density_kg_per_m3 * checked["volume_m3"].get<double>(),
              1e-9 * mass_kg);
  EXPECT_NE(facts["lattice_mass_kg"], facts["mass_kg"]);
  auto session = Session::make(document, "model.json", DeviceSpecification(), InstructionSet::baseline);
  ASSERT_TRUE(session.ok()) << session.error().message;
  SessionFacts shown;
  write_facts(session.value(), shown);
  Snapshot snapshot;
  write_snapshot(session.value(), snapshot);
  EXPECT_NEAR(make_panel_model(shown, snapshot, {}).mass_kg, mass_kg, 1e-9 * mass_kg);
  Material heavy = document.scene.bodies[0].material;
  heavy.density_kg_per_m3 *= 2.0;
  ASSERT_TRUE(apply_request(session.value(), Request(Command(SetMaterial{heavy}))).ok());
  write_facts(session.value(), shown);
  EXPECT_NEAR(shown.mass_kg, 2.0 * mass_kg, 1e-9 * mass_kg);
}

// A name must neither control the terminal nor change the order of the letters in its line; the JSON has the
// name unchanged. Documents with ASCII control characters in names are refused.
TEST(Info, EscapesControlsInNames) {
  const Workplace place;
  Document document = read_document(place.path("model.json")).value();
  const std::string name = "red\xc2\x9b\xe2\x80\xae\xe2\x81\xa6\xe2\x80\x8f \xc3\xa9";
  const std::string shown = "red\\u009b\\u202e\\u2066\\u200f \xc3\xa9";
  document.name = document.scene.bodies[0].name = document.scene.bodies[0].material.name = name;
  document.scene.bodies[0].supports = {{{{0.0, 0.2}}, {}}};
  place.write("named.json", json_to_page(document_to_json(document)));
  for (const char* command : {"info", "check", "rest"}) {
    const Outcome lines = run({command, place.text("named.json")});
    EXPECT_NE(lines.out.find(shown), std::string::npos) << command << lines.out << lines.err;
    const Outcome json = run({command, place.text("named.json"), "--json"});
    EXPECT_NE(json.out.find(shown), std::string::npos) << command;
    for (const std::string& text : {lines.out, lines.err, json.out}) {
      for (const char* raw : {"\xc2\x9b", "\xe2\x80\xae", "\xe2\x81\xa6", "\xe2\x80\x8f"}) {
        EXPECT_EQ(text.find(raw), std::string::npos) << command;
      }
    }
    EXPECT_EQ(json_of(json.out)["bodies"][0]["name"], name) << command;
  }
}

TEST(Info, EscapesWhatIsNotText) {
  EXPECT_EQ(escaped("a\x9b"
                    "b\xc3"),
            "a\\u009bb\\u00c3");
  EXPECT_EQ(escaped("\xe2("), "\\u00e2(") << "a character that is not complete";
  EXPECT_EQ(escaped("gr\xc3\xb6\xc3\x9f\x65\xf0\x9f\x99\x82"), "gr\xc3\xb6\xc3\x9f\x65\xf0\x9f\x99\x82");
  EXPECT_EQ(without_controls("\n\xe2\x80\xa8"), "??");
}

// Every body is listed with its number and the domain of its parameters, which `--bodies` and `change` need.
TEST(Info, TellsOfEveryBody) {
  const Workplace place;
  Document two = read_document(place.path("model.json")).value();
  two.scene.bodies.push_back(two.scene.bodies[0]);
  two.scene.bodies[1].name = "other";
  two.scene.bodies[1].surface =
      placed(two.scene.bodies[1].surface, {Vector3(0.0, 0.5, 0.0), Quaternion::Identity()});
  place.write("two.json", json_to_page(document_to_json(two)));
  const Json facts = json_of(run({"info", place.text("two.json"), "--json"}).out);
  ASSERT_EQ(facts["bodies"].size(), 2U);
  EXPECT_EQ(facts["bodies"][0]["name"], two.scene.bodies[0].name);
  EXPECT_EQ(facts["bodies"][1]["name"], "other");
  EXPECT_NEAR(facts["bodies"][1]["size_mm"][0], 60.0, 0.01);
  EXPECT_EQ(facts["bodies"][1]["closedness"], "solid");
  EXPECT_NEAR(facts["size_mm"][1].get<double>() - facts["bodies"][1]["size_mm"][1].get<double>(), 500.0,
              1e-6);
  ASSERT_EQ(facts["simulated"].size(), 2U);
  EXPECT_EQ(facts["simulated"][1]["body"], "other");
  EXPECT_NEAR(facts["mass_kg"], 2.0 * facts["simulated"][1]["mass_kg"].get<double>(), 1e-12);
  EXPECT_EQ(facts["cells"].size(), 2U);
  ASSERT_EQ(facts["surfaces"].size(), 2U);
  EXPECT_EQ(facts["surfaces"][1]["v"]["control_points"], two.scene.bodies[1].surface.net.columns);
  const std::string lines = run({"info", place.text("two.json")}).out;
  EXPECT_NE(lines.find("Body 2"), std::string::npos) << lines;
  EXPECT_NE(lines.find("periodic, from 0 to "), std::string::npos) << lines;
}

// The trim loop keeps a part of the handle, and the reported size is that of this part.
TEST(Info, TheSizeOfATrimmedBodyIsOfWhatIsKept) {
  const Workplace place;
  Document model = read_document(place.path("model.json")).value();
  Body& body = model.scene.bodies[0];
  const Vector3 whole = extent_of(body.surface).high - extent_of(body.surface).low;
  const auto polygon = [&](double share) {
    const KnotVector &u = body.surface.u, &v = body.surface.v;
    const double u0 = u.domain_start(), v0 = v.domain_start();
    const double u1 = u0 + share * (u.domain_end() - u0), v1 = v0 + share * (v.domain_end() - v0);
    return make_polygon_loop(u, v, {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}}).value();
  };
  body.trims = {polygon(0.25)};
  const Box kept = extent_of(body.surface, body.trims);
  EXPECT_LT((kept.high - kept.low).maxCoeff(), 0.5 * whole.maxCoeff());
  place.write("corner.json", json_to_page(document_to_json(model)));
  const Json facts = json_of(run({"info", place.text("corner.json"), "--json"}).out);
  EXPECT_NEAR(facts["size_mm"][0], 1e3 * (kept.high - kept.low).x(), 1e-6);
}

// The facts repeat the lattice's report and the document's regions.
TEST(Info, TellsOfRegionsAndOfWhatABodyAchieves) {
  const Workplace place;
  auto document = read_document(place.path("model.json"));
  ASSERT_TRUE(document);
  Body& body = document->scene.bodies[0];
  MaterialRegion region;
  region.region.along = {0.5, 1.0};
  region.material = body.material;
  region.material->name = "grip";
  region.friction = 0.75;
  body.regions = {region};
  place.write("grip.json", json_to_page(document_to_json(document.value())));
  const Json facts = json_of(run({"info", place.text("grip.json"), "--json"}).out);
  ASSERT_EQ(facts["regions"].size(), 1U);
  EXPECT_EQ(facts["regions"][0]["material"]["name"], "grip");
  EXPECT_EQ(facts["regions"][0]["friction"], 0.75);
  const auto simulation = Simulation::make(document->scene, best_instruction_set());
  ASSERT_TRUE(simulation) << simulation.error().message;
  const LatticeReport& report = simulation->report();
  ASSERT_EQ(facts["achieved"].size(), 1U);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(facts["achieved"][0]["youngs_modulus_ratio"][axis], report.youngs_modulus_ratio[axis]);
    EXPECT_EQ(facts["achieved"][0]["poissons_ratio"][axis], report.poissons_ratio[axis]);
  }
  EXPECT_NEAR(facts["achieved"][0]["wanted_poissons_ratio"], body.material.poissons_ratio, 1e-12);
  const std::string text = run({"info", place.text("grip.json")}).out;
  EXPECT_NE(text.find("50 to 100 % along: grip, friction 0.75"), std::string::npos) << text;
  EXPECT_NE(text.find("Achieved E"), std::string::npos) << text;
}

TEST(Info, TellsOfRecordingScriptAndMaterial) {
  const Workplace place;
  const Json recording = json_of(run({"info", place.record("bend.jsonl").string(), "--json"}).out);
  EXPECT_EQ(recording["kind"], "recording");
  EXPECT_EQ(recording["ticks"], 600);
  EXPECT_EQ(recording["duration_s"], 0.6);
  EXPECT_EQ(recording["commands"], 3);
  EXPECT_EQ(recording["complete"], true);
  EXPECT_EQ(recording["state_hash"].get<std::string>().size(), 16U);

  const Json script = json_of(run({"info", place.text("script.json"), "--json"}).out);
  EXPECT_EQ(script["kind"], "script");
  EXPECT_EQ(script["ticks"], 600);

  const auto document = read_document(place.path("model.json"));
  ASSERT_TRUE(document);
  place.write("material.json", json_to_page(material_to_json(document->scene.bodies[0].material)));
  const Json material = json_of(run({"info", place.text("material.json"), "--json"}).out);
  EXPECT_EQ(material["kind"], "material");
  EXPECT_EQ(material["material"]["youngs_modulus_pa"], document->scene.bodies[0].material.youngs_modulus_pa);
}

// One model is a straight handle, the other a handle bent around until its ends overlap.
TEST(Collide, TellsOfOneModelWhetherItPassesThroughItself) {
  const Workplace place;
  const Json straight = json_of(run({"collide", place.text("model.json"), "--json"}).out);
  EXPECT_EQ(straight["touching"], false);
  EXPECT_FALSE(straight.contains("b"));
  EXPECT_FALSE(straight.contains("nearest"));

  auto document = read_document(place.path("model.json"));
  ASSERT_TRUE(document);
  ControlNet& net = document->scene.bodies[0].surface.net;
  const double low = *std::min_element(net.x.begin(), net.x.end());
  const double radius = (*std::max_element(net.x.begin(), net.x.end()) - low) / 6.6;
  for (std::size_t k = 0; k < net.size(); ++k) {
    const double angle = (net.x[k] - low) / radius, from_middle = radius - net.y[k];
    net.x[k] = low + from_middle * std::sin(angle);
    net.y[k] = radius - from_middle * std::cos(angle);
  }
  place.write("ring.json", json_to_page(document_to_json(document.value())));
  const Json folded = json_of(run({"collide", place.text("ring.json"), "--json"}).out);
  EXPECT_EQ(folded["touching"], true);
  EXPECT_FALSE(folded["contacts"].empty());

  const auto refused = run({"collide", place.text("model.json"), "--pose", "0,1mm,0,1,0,0,0"});
  EXPECT_EQ(refused.code, exit_failed);
  EXPECT_NE(refused.err.find("add B"), std::string::npos) << refused.err;
}

TEST(Collide, TellsTheDistanceAndThenTheDepth) {
  const Workplace place;
  const std::string model = place.text("model.json");
  const Json apart = json_of(run({"collide", model, model, "--pose", "0,1m,0,1,0,0,0", "--json"}).out);
  EXPECT_EQ(apart["touching"], false);
  EXPECT_TRUE(apart["contacts"].empty());
  const double distance = apart["distance_m"];
  EXPECT_GT(distance, 0.9);
  EXPECT_LT(distance, 1.0);
  const Json& nearest = apart["nearest"];
  EXPECT_NEAR(nearest["b"]["point_m"][1].get<double>() - nearest["a"]["point_m"][1].get<double>(), distance,
              1e-9);

  // The second model is moved closer by the distance plus a tenth of a millimetre.
  const std::string pose = std::to_string(1000.0 - distance * 1e3 - 0.1) + "mm,";
  const Json deep =
      json_of(run({"collide", model, model, "--pose", "0," + pose + "0,1,0,0,0", "--json"}).out);
  EXPECT_EQ(deep["touching"], true);
  EXPECT_EQ(deep["contained"], false);
  EXPECT_FALSE(deep.contains("distance_m"));
  // The pose above is rounded to six decimals of a millimetre.
  EXPECT_NEAR(deep["depth_m"].get<double>(), 1e-4, 1e-9);
  const Json& contact = deep["contacts"][0];
  EXPECT_NEAR(contact["normal"][1].get<double>(), -1.0, 1e-6);
  for (const char* tangent : {"tangent_u", "tangent_v"}) {
    double square = 0.0, along_normal = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = contact[tangent][axis].get<double>();
      square += share * share;
      along_normal += share * contact["normal"][axis].get<double>();
    }
    EXPECT_NEAR(square, 1.0, 1e-12);
    EXPECT_NEAR(along_normal, 0.0, 1e-12);
  }
  for (const char* side : {"a", "b"}) {
    const Json& at = contact[side];
    EXPECT_LE(at["u_range"][0], at["u"]);
    EXPECT_LE(at["u"], at["u_range"][1]);
  }
  const std::string text = run({"collide", model, model, "--pose", "0," + pose + "0,1,0,0,0"}).out;
  EXPECT_NE(text.find("Depth     0.1 mm"), std::string::npos) << text;
  EXPECT_NE(text.find("separating direction"), std::string::npos) << text;
}

TEST(Collide, OneModelInsideAnother) {
  const Workplace place;
  auto small = read_document(place.path("model.json"));
  ASSERT_TRUE(small);
  for (std::vector<double>* values :
       {&small->scene.bodies[0].surface.net.x, &small->scene.bodies[0].surface.net.y,
        &small->scene.bodies[0].surface.net.z}) {
    const double middle = 0.5 * (*std::min_element(values->begin(), values->end()) +
                                 *std::max_element(values->begin(), values->end()));
    for (double& value : *values) value = middle + 0.5 * (value - middle);
  }
  place.write("small.json", json_to_page(document_to_json(small.value())));
  const Json facts =
      json_of(run({"collide", place.text("small.json"), place.text("model.json"), "--json"}).out);
  EXPECT_EQ(facts["touching"], true);
  EXPECT_EQ(facts["contained"], true);
  EXPECT_EQ(facts["contacts"].size(), 1U);
  EXPECT_GT(facts["depth_m"], 0.0);
}

TEST(Sample, WritesPointsOfTheSurfaceWithBothEnds) {
  const Workplace place;
  const auto document = read_document(place.path("model.json"));
  ASSERT_TRUE(document);
  const Surface& surface = document->scene.bodies[0].surface;
  const Outcome outcome = run({"sample", place.text("model.json"), "--grid", "7x5", "--out", "-"});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  const auto lines = split(outcome.out, '\n');
  ASSERT_EQ(lines.size(), 36U);
  EXPECT_EQ(lines[0], "body,surface,u,v,x_m,y_m,z_m,nx,ny,nz");
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = split(lines[i], ',');
    ASSERT_EQ(fields.size(), 10U);
    EXPECT_EQ(fields[0], document->scene.bodies[0].name);
    const double u = std::stod(fields[2]);
    const double v = std::stod(fields[3]);
    const Vector3 point(std::stod(fields[4]), std::stod(fields[5]), std::stod(fields[6]));
    const Vector3 normal(std::stod(fields[7]), std::stod(fields[8]), std::stod(fields[9]));
    EXPECT_LT((point - evaluate(surface, u, v).position_m).norm(), 1e-15) << lines[i];
    EXPECT_LT((normal - unit_normal(surface, u, v)).norm(), 1e-9) << lines[i];
  }
  const auto first = split(lines[1], ',');
  const auto last = split(lines[35], ',');
  EXPECT_EQ(std::stod(first[2]), surface.u.domain_start());
  EXPECT_EQ(std::stod(last[2]), surface.u.domain_end());
  EXPECT_EQ(std::stod(last[3]), surface.v.domain_end());
}

TEST(Sample, WritesTheSameIntoAFile) {
  const Workplace place;
  const Outcome outcome = run({"sample", place.text("model.json"), "--out", place.text("points.csv")});
  ASSERT_EQ(outcome.code, exit_done) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(content_of(place.path("points.csv")),
            run({"sample", place.text("model.json"), "--out", "-"}).out);
}

}  // namespace
}  // namespace spoonbill
