#include <gtest/gtest.h>

#include <sstream>

#include "engine/exchange/cad_stream.h"
#include "engine/exchange/frame_stream.h"

namespace spoonbill {
namespace {

CadSolid tetrahedron() {
  CadSolid solid;
  solid.name = "wedge";
  solid.surface_indices = {0, 2, 3};
  solid.mesh.vertices_m = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 1.0 / 3.0}};
  solid.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  solid.chord_error_m = 1e-5;
  solid.gap_m = 2e-6;
  solid.volume_m3 = 1e-3 / 18.0;
  solid.area_m2 = 0.04;
  solid.centre_m = {0.025, 0.025, 1.0 / 12.0};
  return solid;
}

constexpr std::size_t surfaces = 4;

TEST(CadSolidStream, KeepsEveryBit) {
  const CadSolid solid = tetrahedron();
  const auto back = cad_solid_from_bytes(cad_solid_to_bytes(solid), surfaces, "part.json");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, solid.name);
  EXPECT_EQ(back->surface_indices, solid.surface_indices);
  EXPECT_EQ(back->mesh.vertices_m, solid.mesh.vertices_m);
  EXPECT_EQ(back->mesh.triangles, solid.mesh.triangles);
  EXPECT_EQ(back->chord_error_m, solid.chord_error_m);
  EXPECT_EQ(back->gap_m, solid.gap_m);
  EXPECT_EQ(back->volume_m3, solid.volume_m3);
  EXPECT_EQ(back->area_m2, solid.area_m2);
  EXPECT_EQ(back->centre_m, solid.centre_m);
}

TEST(CadSolidStream, RefusesWhatIsNoSolid) {
  const std::string whole = cad_solid_to_bytes(tetrahedron());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(cad_solid_from_bytes(whole.substr(0, length), surfaces, "part.json")) << length;
  }
  EXPECT_FALSE(cad_solid_from_bytes(whole + "x", surfaces, "part.json"));
  EXPECT_FALSE(cad_solid_from_bytes(whole, 3, "part.json"));
  CadSolid beyond = tetrahedron();
  beyond.mesh.triangles[3][2] = 4;
  EXPECT_FALSE(cad_solid_from_bytes(cad_solid_to_bytes(beyond), surfaces, "part.json"));
  CadSolid far = tetrahedron();
  far.mesh.vertices_m[1].x() = 1e7;
  EXPECT_FALSE(cad_solid_from_bytes(cad_solid_to_bytes(far), surfaces, "part.json"));
  CadSolid nowhere = tetrahedron();
  nowhere.surface_indices.clear();
  EXPECT_FALSE(cad_solid_from_bytes(cad_solid_to_bytes(nowhere), surfaces, "part.json"));
}

TEST(FrameStream, AFailureCarriesItsCode) {
  const auto pass_on = [](const auto& failure) {
    std::stringstream stream;
    write_failure(stream, failure);
    const auto frame = read_frame([&](void* to, std::size_t bytes) {
      return static_cast<bool>(stream.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)));
    });
    EXPECT_TRUE(frame && frame->kind == FrameKind::failure);
    return parse_failure(frame ? frame->content : std::string());
  };
  const Error coded = pass_on(Error{ErrorCode::malformed, "is not a STEP file"});
  EXPECT_EQ(coded.code, ErrorCode::malformed);
  EXPECT_EQ(coded.message, "is not a STEP file");
  const Error plain = pass_on(std::string("#1000000 is no code"));
  EXPECT_EQ(plain.code, ErrorCode::process_failed);
  EXPECT_EQ(plain.message, "#1000000 is no code");
}

}  // namespace
}  // namespace spoonbill
