#include <gtest/gtest.h>

#include <functional>

#include "engine/exchange/document.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/refusal.h"

namespace spoonbill {
namespace {

MeshSolid mesh_tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 1.0 / 300.0}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return {clean_mesh(std::move(mesh), "tetrahedron").value()};
}

std::vector<ToolSolid> every_solid() {
  Surface surface = sample_document().scene.bodies[0].surface;
  return {ImplicitShape(SphereShape{0.006}),
          ImplicitShape(EllipsoidShape{{0.0081, 0.004, 0.006}}),
          ImplicitShape(CylinderShape{0.005, 0.008}),
          ImplicitShape(CapsuleShape{0.004, 0.0}),
          ImplicitShape(BoxShape{{0.004, 1.0 / 300.0, 0.01}}),
          ImplicitShape(ConeShape{0.006, 0.01}),
          ImplicitShape(TorusShape{0.006, 0.002}),
          ImplicitShape(HalfSpaceShape{}),
          ImplicitShape(SuperquadricShape{{0.006, 0.004, 0.006}, 0.5, 1.5}),
          mesh_tetrahedron(),
          SurfaceSolid{std::move(surface)}};
}

Document with_tool(ToolSolid solid, std::optional<SoftTool> soft = std::nullopt) {
  Document document = sample_document();
  document.scene.tool.kind = ToolKind::solid;
  document.scene.tool.body = std::make_shared<ToolBody>(ToolBody{std::move(solid), std::move(soft)});
  return document;
}

std::string page(const Document& document) {
  return json_to_page(document_to_json(document));
}

std::string read_and_written(const std::string& text) {
  const auto json = parse_json(text, "sample.json");
  EXPECT_TRUE(json.ok());
  const auto read = document_from_json(json.value(), "sample.json");
  EXPECT_TRUE(read.ok()) << read.error().message;
  return read.ok() ? page(read.value()) : "";
}

Refusal tool_refusal(const std::function<void(Json&)>& change) {
  Json json = document_to_json(with_tool(ImplicitShape(BoxShape{})));
  change(json);
  const auto read = document_from_json(json, "sample.json");
  return Refusal(read);
}

// Numbers read back to the same bits (document_test.cpp), so two tools are equal if their texts are equal.
TEST(ToolJson, KeepsEverySolid) {
  for (const ToolSolid& solid : every_solid()) {
    const std::string text = page(with_tool(solid));
    EXPECT_NE(text.find("\"kind\": \"solid\""), std::string::npos);
    EXPECT_EQ(read_and_written(text), text);
  }
}

TEST(ToolJson, KeepsASoftOne) {
  const Material clay = sample_document().scene.bodies[0].material;
  const SoftTool soft{clay, {300, {}}, {Vector3(0, 0.001, 0), -Vector3::UnitY()}};
  for (const ToolSolid& solid : {every_solid().back(), ToolSolid(mesh_tetrahedron())}) {
    const std::string text = page(with_tool(solid, soft));
    EXPECT_NE(text.find("\"grip\""), std::string::npos);
    EXPECT_EQ(read_and_written(text), text);
    const Json command = command_to_json(SetTool{with_tool(solid, soft).scene.tool});
    const auto read = command_from_json(command, "script");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(command_to_json(read.value()), command);
  }
}

TEST(ToolJson, KeepsASolidThatIsNotInTheHand) {
  Document document = with_tool(ImplicitShape(BoxShape{}));
  document.scene.tool.kind = ToolKind::sphere;
  EXPECT_EQ(read_and_written(page(document)), page(document));
}

TEST(ToolJson, NamesWhatIsWrong) {
  EXPECT_EQ(tool_refusal([](Json& j) { j["tool"].erase("solid"); }),
            Refusal(ErrorCode::missing, "tool.solid"));
  EXPECT_EQ(tool_refusal([](Json& j) { j["tool"]["solid"]["shape"] = "blob"; }).message,
            "sample.json: tool.solid.shape is \"blob\", must be sphere or ellipsoid or cylinder or "
            "capsule or box or cone or torus or half_space or superquadric or mesh or surface");
  EXPECT_EQ(tool_refusal([](Json& j) { j["tool"]["solid"]["half_extents_mm"][1] = -4; }),
            Refusal(ErrorCode::out_of_range, "tool.solid.half_extents_mm[1]"));
  EXPECT_EQ(tool_refusal([](Json& j) {
              j["tool"]["solid"] = {{"shape", "torus"}, {"ring_radius_mm", 2}, {"tube_radius_mm", 3}};
            }).message.substr(0, 18),
            "sample.json: tool ");
  EXPECT_EQ(tool_refusal([](Json& j) {
              j["tool"]["solid"] = {{"shape", "mesh"},
                                    {"vertices_mm", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                                    {"triangles", {{0, 1, 3}}}};
            }),
            Refusal(ErrorCode::out_of_range, "tool.solid.triangles[0]"));
  EXPECT_EQ(tool_refusal([](Json& j) {
              j["tool"]["solid"] = {{"shape", "mesh"},
                                    {"vertices_mm", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}},
                                    {"triangles", {{0, 1, 2}}}};
            }).field.substr(0, 10),
            "tool.solid");
  EXPECT_EQ(tool_refusal([](Json& j) {
              j["tool"]["soft"] = {{"material", 3}};
            }),
            Refusal(ErrorCode::wrong_type, "tool.soft.material"));
}

TEST(ToolJson, NamesWhatIsWrongWithASoftMesh) {
  const Material clay = sample_document().scene.bodies[0].material;
  const SoftTool soft{clay, {300, {}}, {Vector3(0, 0.001, 0), -Vector3::UnitY()}};
  const auto refused = [&](const std::function<void(Json&)>& change) {
    Json json = document_to_json(with_tool(mesh_tetrahedron(), soft));
    change(json["tool"]);
    const auto read = document_from_json(json, "sample.json");
    return Refusal(read);
  };
  EXPECT_EQ(refused([](Json&) {}), Refusal());
  EXPECT_EQ(refused([](Json& tool) { tool["soft"].erase("lattice"); }),
            Refusal(ErrorCode::missing, "tool.soft.lattice"));
  EXPECT_EQ(refused([](Json& tool) { tool["soft"]["lattice"]["node_budget"] = 3; }),
            Refusal(ErrorCode::out_of_range, "tool.soft.lattice.node_budget"));
  EXPECT_EQ(refused([](Json& tool) { tool["soft"]["material"]["density_kg_per_m3"] = -1; }),
            Refusal(ErrorCode::out_of_range, "tool.soft.material.density_kg_per_m3"));
  EXPECT_EQ(refused([](Json& tool) {
              tool["soft"]["grip"]["normal"] = {0, 0, 0};
            }),
            Refusal(ErrorCode::degenerate, "tool.soft.grip.normal"));
  EXPECT_EQ(refused([](Json& tool) { tool["solid"]["triangles"].erase(3); }),
            Refusal(ErrorCode::inconsistent, "tool"));
  EXPECT_EQ(refused([](Json& tool) {
              tool["solid"] = {{"shape", "half_space"}};
            }),
            Refusal(ErrorCode::unsupported, "tool"));
}

TEST(ToolJson, KeepsSeveralBodies) {
  Document document = sample_document();
  document.scene.bodies.resize(3, document.scene.bodies[0]);
  document.scene.bodies[2].name = "third";
  const std::string text = page(document);
  EXPECT_EQ(read_and_written(text), text);
  Json json = document_to_json(document);
  json["other_bodies"][1].erase("name");
  const auto read = document_from_json(json, "sample.json");
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(Refusal(read), Refusal(ErrorCode::missing, "other_bodies[1].name"));
}

TEST(ToolJson, ReadsTheCommandsOfAnyTool) {
  const Tool tool = with_tool(every_solid().back()).scene.tool;
  const Json json = command_to_json(SetTool{tool});
  const auto read = command_from_json(json, "script");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(command_to_json(read.value()), json);
  const Json material = command_to_json(SetMaterial{sample_document().scene.bodies[0].material, 2});
  EXPECT_EQ(material["body"], 2);
  EXPECT_EQ(command_to_json(command_from_json(material, "script").value()), material);
}

}  // namespace
}  // namespace spoonbill
