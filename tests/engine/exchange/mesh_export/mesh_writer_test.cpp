// Tests that other libraries read the written meshes: meshio reads STL, OBJ and PLY, and libzip opens 3MF.
#include "engine/exchange/mesh_export/mesh_writer.h"

#include <gtest/gtest.h>
#include <zip.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <regex>
#include <sstream>
#include <tuple>

#include "engine/exchange/mesh_export/tessellation.h"
#include "engine/exchange/mesh_import.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

NamedMesh tube(const std::string& name, const Vector3& centre) {
  return {name, tessellate(ellipsoid_tube(8, 10, centre), {}, 2e-4).value().mesh, true};
}

std::string bytes_of(const std::vector<NamedMesh>& meshes, FileFormat format, double unit_m) {
  std::string bytes;
  const Status written = write_meshes(meshes, format, unit_m, [&](std::string_view more) -> Status {
    bytes += more;
    return {};
  });
  EXPECT_TRUE(written.ok());
  return bytes;
}

class MeshWriter : public testing::Test {
 protected:
  struct Measured {
    std::size_t triangles = 0;
    double volume = 0.0;
  };
  // Measures all meshes with meshio, which shares no code with the writer.
  Measured measure(const std::string& name, const std::string& bytes) const {
    const auto file = folder_.write(name, bytes), out = folder_.path() / "measured";
    const std::string line = std::string(SPOONBILL_PYTHON) + " " + SPOONBILL_MEASURE_SCRIPT + " " +
                             file.string() + " >" + out.string();
    Measured measured;
    EXPECT_EQ(std::system(line.c_str()), 0);
    std::istringstream(content_of(out)) >> measured.triangles >> measured.volume;
    return measured;
  }

  std::string unzipped(const std::string& bytes, const char* name) const {
    const auto file = folder_.write("model.3mf", bytes);
    int error = 0;
    zip_t* archive = zip_open(file.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, &error);
    if (archive == nullptr) return {};
    std::string content;
    zip_stat_t facts;
    zip_file_t* entry = zip_fopen(archive, name, 0);
    if (entry != nullptr && zip_stat(archive, name, 0, &facts) == 0) {
      content.resize(facts.size);
      zip_fread(entry, content.data(), content.size());
      zip_fclose(entry);
    }
    zip_close(archive);
    return content;
  }

  TemporaryFolder folder_;
};

TEST_F(MeshWriter, AnotherLibraryReadsTheSameTriangles) {
  const std::vector<NamedMesh> meshes = {tube("one", {0, 0, 0}), tube("two", {0.1, 0, 0})};
  const std::size_t triangles = meshes[0].mesh.triangles.size() + meshes[1].mesh.triangles.size();
  const double volume = enclosed_volume_m3(meshes[0].mesh) + enclosed_volume_m3(meshes[1].mesh);
  // Coordinates of STL have single precision.
  for (const auto& [name, format, unit_m, precision] :
       {std::tuple("a.stl", FileFormat::stl, 1e-3, 1e-5), std::tuple("a.obj", FileFormat::obj, 0.0254, 1e-12),
        std::tuple("a.ply", FileFormat::ply, 1.0, 1e-12)}) {
    SCOPED_TRACE(name);
    const std::string bytes = bytes_of(meshes, format, unit_m);
    const Measured back = measure(name, bytes);
    EXPECT_EQ(back.triangles, triangles);
    EXPECT_NEAR(back.volume * std::pow(unit_m, 3), volume, precision * volume);
    const auto ours = import_mesh(folder_.write(name, bytes));
    ASSERT_TRUE(ours) << ours.error().message;
    EXPECT_EQ(ours->triangles.size(), triangles);
    EXPECT_NEAR(enclosed_volume_m3(ours.value()), back.volume, precision * back.volume);
  }
}

TEST_F(MeshWriter, StlHoldsItsCountAndUnitNormals) {
  const NamedMesh mesh = tube("one", {0, 0, 0});
  const std::string bytes = bytes_of({mesh}, FileFormat::stl, 1e-3);
  ASSERT_EQ(bytes.size(), 84 + 50 * mesh.mesh.triangles.size());
  EXPECT_FALSE(bytes.starts_with("solid"));  // text STL files begin with this word
  for (std::size_t k = 0; k < mesh.mesh.triangles.size(); ++k) {
    float values[12];
    std::memcpy(values, bytes.data() + 84 + 50 * k, sizeof values);
    const Vector3 normal(values[0], values[1], values[2]);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
    // The normal points outward: the body is convex and contains the origin.
    EXPECT_GT(normal.dot(Vector3(values[3], values[4], values[5])), 0.0);
  }
}

TEST_F(MeshWriter, ThreeMfHoldsAModelInMillimetres) {
  const NamedMesh mesh = tube("a <b> & \"c\"", {0, 0, 0});
  NamedMesh sheet = tube("two", {0.1, 0, 0});
  sheet.closed = false;
  const std::string bytes = bytes_of({mesh, sheet}, FileFormat::three_mf, 1.0);
  EXPECT_NE(unzipped(bytes, "[Content_Types].xml").find("3dmanufacturing-3dmodel+xml"), std::string::npos);
  EXPECT_NE(unzipped(bytes, "_rels/.rels").find("/3D/3dmodel.model"), std::string::npos);
  const std::string model = unzipped(bytes, "3D/3dmodel.model");
  EXPECT_NE(model.find("unit=\"millimeter\""), std::string::npos);
  EXPECT_NE(model.find("name=\"a &lt;b> &amp; &quot;c&quot;\""), std::string::npos);
  EXPECT_NE(model.find("<object id=\"1\" type=\"model\""), std::string::npos);
  EXPECT_NE(model.find("<object id=\"2\" type=\"surface\""), std::string::npos);
  EXPECT_NE(model.find("<item objectid=\"2\"/>"), std::string::npos);

  const std::regex vertex("<vertex x=\"([^\"]+)\" y=\"([^\"]+)\" z=\"([^\"]+)\"/>");
  std::size_t k = 0;
  for (std::sregex_iterator at(model.begin(), model.end(), vertex), end;
       at != end && k < mesh.mesh.vertices_m.size(); ++at, ++k) {
    EXPECT_DOUBLE_EQ(std::stod((*at)[1]), 1e3 * mesh.mesh.vertices_m[k].x());
    EXPECT_DOUBLE_EQ(std::stod((*at)[3]), 1e3 * mesh.mesh.vertices_m[k].z());
  }
  EXPECT_EQ(k, mesh.mesh.vertices_m.size());
}

TEST_F(MeshWriter, ARefusalOfTheTakerEndsIt) {
  for (const FileFormat format : {FileFormat::stl, FileFormat::obj, FileFormat::ply, FileFormat::three_mf}) {
    const Status written =
        write_meshes({tube("one", {0, 0, 0})}, format, 1.0, [](std::string_view) -> Status {
          return Error{ErrorCode::unwritable, "disk full"};
        });
    ASSERT_FALSE(written.ok());
    EXPECT_EQ(written.error().code, ErrorCode::unwritable);
    EXPECT_EQ(written.error().message, "disk full");
  }
}

// A zip archive is complete before its first byte is written, so the progress function is called while the
// archive is built and packed.
TEST_F(MeshWriter, ThreeMfAsksWhetherToGoOn) {
  const std::vector<NamedMesh> meshes = {
      {"fine", tessellate(ellipsoid_tube(8, 10, {0, 0, 0}), {}, 2e-5).value().mesh, true}};
  int asked = 0;
  bool has_begun = false;
  ASSERT_TRUE(write_meshes(meshes, FileFormat::three_mf, 1.0, [&](std::string_view bytes) -> Status {
    has_begun = has_begun || !bytes.empty();
    asked += has_begun ? 0 : 1;
    return {};
  }));
  ASSERT_GT(asked, 10);
  for (const int last : {1, asked / 2, asked}) {
    int left = last;
    const Status stopped =
        write_meshes(meshes, FileFormat::three_mf, 1.0, [&](std::string_view bytes) -> Status {
          EXPECT_TRUE(bytes.empty());
          EXPECT_GT(left, 0);
          if (--left > 0) return {};
          return Error{ErrorCode::cancelled, "stopped"};
        });
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace spoonbill
