// Checks that the schema of documents agrees with the tables of fields.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/scene/scene.h"
#include "tests/engine/exchange/described_schema.h"

namespace spoonbill {
namespace {

const std::string schema_file = std::string(SPOONBILL_ASSETS) + "/schemas/document.schema.json";

std::string text_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Returns the help of all tool actions as one text.
std::string actions_text() {
  std::string text;
  for (const ToolActionRow& row : tool_actions) {
    text += (text.empty() ? "" : ". ") + std::string(row.name) + ": " + row.help;
  }
  return text;
}

// Returns the schema of the tool, which is built from the table of fields. Properties that no table describes
// are copied from `old`.
Json tool_schema(const Json& old) {
  Json tool = object_schema(Tool{});
  Json& properties = tool["properties"];
  properties["action"] = with_help(actions_text(), properties["action"]);
  for (const char* undescribed : {"solid", "soft"}) properties[undescribed] = old["properties"][undescribed];
  for (const char* undescribed : {"if", "then", "dependentRequired"}) tool[undescribed] = old[undescribed];
  return tool;
}

Json solid_schema(const Json& old) {
  Json solid = variant_schema<ImplicitShape>("shape");
  for (const Json& form : old["oneOf"]) {
    const Json& shape = form["properties"]["shape"];
    const bool described =
        shape != Json{{"const", kind_name<MeshSolid>}} && shape != Json{{"const", kind_name<SurfaceSolid>}};
    if (!described) solid["oneOf"].push_back(form);
  }
  return solid;
}

template <class Object>
Json with_description_of(const Json& old) {
  Json json = Json::object();
  if (old.contains("description")) json["description"] = old["description"];
  json.update(object_schema(Object{}));
  return json;
}

// Returns the schema after rewriting every part that a table of fields describes.
Json rewritten_schema(Json schema) {
  Json& all = schema["$defs"];
  all["material"] = with_description_of<Material>(all["material"]);
  all["plane"] = with_description_of<FixingPlane>(all["plane"]);
  all["ground"] = with_description_of<Ground>(all["ground"]);
  all["symmetry"] = with_description_of<Symmetry>(all["symmetry"]);
  all["hand"] = with_description_of<HandSpring>(all["hand"]);
  all["pose"] = with_description_of<BodyPlacement>(all["pose"]);
  all["motion"]["properties"]["waypoints"]["items"] = object_schema(Waypoint{});
  all["trial"] = with_description_of<TrialPlan>(all["trial"]);
  all["sculpting"] = with_description_of<Sculpting>(all["sculpting"]);
  all["load"] = variant_schema<Load>("kind");
  all["support"]["properties"]["motion"] = choice_schema<SupportMotion>();
  all["lattice"]["properties"]["feature_map"] = object_schema(FeatureMapSettings{});
  all["tool"] = tool_schema(all["tool"]);
  all["solid"] = solid_schema(all["solid"]);
  return schema;
}

// With SPOONBILL_APPROVE=1 the test rewrites the schema file.
TEST(DocumentSchema, SaysWhatTheTablesOfFieldsSay) {
  const auto schema = parse_json(text_of(schema_file), schema_file);
  ASSERT_TRUE(schema.ok()) << schema.error().message;
  const std::string rewritten = json_to_page(rewritten_schema(schema.value()));
  if (std::getenv("SPOONBILL_APPROVE") != nullptr) std::ofstream(schema_file, std::ios::binary) << rewritten;
  EXPECT_EQ(text_of(schema_file), rewritten) << "to rewrite it: SPOONBILL_APPROVE=1";
}

}  // namespace
}  // namespace spoonbill
