// Tests STL and OBJ files as other programs write them, and generated files of every form.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "engine/base/text.h"
#include "engine/exchange/scans/obj_file.h"
#include "engine/exchange/scans/stl_file.h"
#include "tests/engine/effort.h"
#include "tests/engine/random.h"

namespace spoonbill {
namespace {

using Corners = std::array<std::uint32_t, 3>;

const std::string obj_corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::vector<Corners> obj_triangles(const std::string& text) {
  const auto mesh = parse_obj_mesh(text);
  EXPECT_TRUE(mesh) << mesh.error().message << "\n" << text;
  return mesh ? mesh->triangles : std::vector<Corners>();
}

void expect_obj_refusal(const std::string& text, ErrorCode code, const std::string& words = {}) {
  const auto mesh = parse_obj_mesh(text);
  ASSERT_FALSE(mesh) << text;
  EXPECT_EQ(mesh.error().code, code) << mesh.error().message;
  EXPECT_NE(mesh.error().message.find(words), std::string::npos) << mesh.error().message;
}

TEST(ObjFile, ReadsEveryFormOfACorner) {
  for (const char* face :
       {"f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//1", "f 1/1/1 2/2/1 3/3/1", "f 1/ 2/ 3/", "f -4 -3 -2",
        "\tf  1\t2 3 ", "f 1 2 3 # corners", "f 1 2 \\\n3", "f 1 2 3\r"}) {
    EXPECT_EQ(obj_triangles(obj_corners + face + "\n"), std::vector<Corners>({{0, 1, 2}})) << face;
  }
}

TEST(ObjFile, ReadsVerticesWithColoursWeightsAndMarks) {
  EXPECT_EQ(obj_triangles("\xEF\xBB\xBFv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv +1e0 1. .0\nf 1 2 3\n").size(),
            1U);
}

TEST(ObjFile, ReadsFacesBeforeTheirVertices) {
  EXPECT_EQ(obj_triangles("f 1 2 3\n" + obj_corners), std::vector<Corners>({{0, 1, 2}}));
}

TEST(ObjFile, CutsPolygonsAndLeavesOutTheRest) {
  const std::string rest =
      "mtllib a.mtl\nusemtl gold\nvt 0 0\nvn 0 0 1\nvp 1\np 1\nl 1 2\ns off\ng a b\no c\n";
  EXPECT_EQ(obj_triangles(obj_corners + rest + "f 1 2 3 4\n").size(), 2U);
}

TEST(ObjFile, RefusesWhatIsWrongAndNamesTheLine) {
  expect_obj_refusal("", ErrorCode::too_few);
  expect_obj_refusal(obj_corners, ErrorCode::too_few);
  expect_obj_refusal("v 0 0\nf 1 1 1\n", ErrorCode::malformed, "line 1");
  expect_obj_refusal("v 0 0 x\n", ErrorCode::malformed, "line 1");
  for (const char* face :
       {"f 1 2", "f 1 2 5", "f 0 1 2", "f -5 1 2", "f 1 2 x", "f 1 2 3.5", "f 1 2 99999999999"}) {
    expect_obj_refusal(obj_corners + face + "\n", ErrorCode::malformed, "line 5");
  }
  std::string many = obj_corners + "f";
  for (std::size_t k = 0; k <= face_corner_limit; ++k) many += " 1";
  expect_obj_refusal(many + "\n", ErrorCode::malformed, "corners");
}

std::string stl_facet(const std::string& vertices) {
  return "facet normal 0 0 1\nouter loop\n" + vertices + "endloop\nendfacet\n";
}

const std::string usual_facet = stl_facet("vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n");

TEST(StlFile, ReadsTextsOfManyPrograms) {
  const std::vector<std::string> texts = {
      "solid\n" + usual_facet + "endsolid\n", "  solid a name\r\n" + usual_facet + "endsolid a name",
      "SOLID A\nFACET NORMAL 0 0 1\n  OUTER LOOP\n VERTEX 0 0 0 VERTEX 1 0 0\n VERTEX 1 1 0\n "
      "ENDLOOP\nENDFACET\n"
      "ENDSOLID A\n \n",
      std::string("solid a\nendsolid a\nsolid b\n") + usual_facet + "endsolid b\n"};
  for (const std::string& text : texts) {
    const auto mesh = parse_stl(text);
    ASSERT_TRUE(mesh) << mesh.error().message << "\n" << text;
    EXPECT_EQ(mesh->triangles, std::vector<Corners>({{0, 1, 2}}));
    EXPECT_EQ(mesh->vertices[2], Vector3(1, 1, 0));
  }
}

TEST(StlFile, RefusesWhatIsWrongAndNamesTheLine) {
  for (const std::string& facet :
       {stl_facet("vertex 0 0 0\nvertex 1 0 0\n"), stl_facet("vertex 0 0 0\nvertex 1 0 x\nvertex 1 1 0\n"),
        stl_facet("vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\n"), std::string("face 1 2 3\n")}) {
    const auto mesh = parse_stl("solid\n" + facet + "endsolid\n");
    ASSERT_FALSE(mesh) << facet;
    EXPECT_EQ(mesh.error().code, ErrorCode::malformed);
    EXPECT_NE(mesh.error().message.find("line "), std::string::npos) << mesh.error().message;
  }
  EXPECT_FALSE(parse_stl(""));
  EXPECT_FALSE(parse_stl("solid\n" + usual_facet));
}

std::string binary_stl(const FileMesh& mesh, const std::string& start) {
  std::string bytes = start;
  bytes.resize(80, ' ');
  const auto append = [&](const void* value, std::size_t size) {
    bytes.append(static_cast<const char*>(value), size);
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  append(&count, sizeof count);
  for (const Corners& corners : mesh.triangles) {
    bytes.append(12, '\0');
    for (const std::uint32_t corner : corners) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto number = static_cast<float>(mesh.vertices[corner][axis]);
        append(&number, sizeof number);
      }
    }
    bytes.append(2, '\1');
  }
  return bytes;
}

// Writer of texts whose blanks, capitals, numbers and line ends are random.
class RandomWriter {
 public:
  explicit RandomWriter(Random& random) : random_(random) {}

  std::string stl(const FileMesh& mesh) {
    std::string text = blanks() + "solid" + (random_.once_in(2) ? " a name" : "") + line_end();
    for (const Corners& corners : mesh.triangles) {
      text += blanks() + "facet normal 0 0 1" + line_end() + "outer loop" + line_end();
      for (const std::uint32_t corner : corners)
        text += blanks() + "vertex" + position(mesh, corner) + line_end();
      text += "endloop" + line_end() + blanks() + "endfacet" + line_end();
    }
    return text + "endsolid" + line_end();
  }

  std::string obj(const FileMesh& mesh) {
    std::string text;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      if (random_.once_in(5)) text += "# a comment" + line_end();
      if (random_.once_in(5)) text += "vn 0 0 1" + line_end();
      text += blanks() + "v" + position(mesh, v) + line_end();
    }
    for (const Corners& corners : mesh.triangles) {
      const char* const forms[] = {"", "/1", "//1", "/1/1"};
      const std::string form = forms[random_.integer(0, 3)];
      text += blanks() + "f";
      for (const std::uint32_t corner : corners) {
        const auto count = static_cast<int>(mesh.vertices.size());
        const int number = static_cast<int>(corner) + 1;
        text += (random_.once_in(9) ? " \\" + line_end() : std::string(" ")) +
                std::to_string(random_.once_in(2) ? number : number - 1 - count) + form;
      }
      text += line_end();
    }
    return text;
  }

 private:
  std::string blanks() {
    return std::string(static_cast<std::size_t>(random_.integer(0, 2)), random_.once_in(2) ? ' ' : '\t');
  }
  std::string line_end() { return random_.once_in(2) ? "\n" : "\r\n"; }
  std::string position(const FileMesh& mesh, std::uint32_t vertex) {
    std::string text;
    for (int axis = 0; axis < 3; ++axis) text += " " + blanks() + number_text(mesh.vertices[vertex][axis]);
    return text;
  }

  Random& random_;
};

TEST(MeshText, GeneratedFilesGiveTheirMesh) {
  Random random(5);
  RandomWriter writer(random);
  for (int trial = 0, trials = random_cases(50, 2000); trial < trials; ++trial) {
    FileMesh mesh;
    for (int v = random.integer(3, 20); v > 0; --v) {
      // Binary files have single precision.
      mesh.vertices.push_back(random.in_box(Vector3(100, 1, 1e-3)).cast<float>().cast<double>());
    }
    const int last = static_cast<int>(mesh.vertices.size()) - 1;
    const auto corner = [&] { return static_cast<std::uint32_t>(random.integer(0, last)); };
    for (int t = random.integer(1, 12); t > 0; --t) mesh.triangles.push_back({corner(), corner(), corner()});
    const auto obj = parse_obj_mesh(writer.obj(mesh));
    ASSERT_TRUE(obj) << obj.error().message;
    EXPECT_EQ(obj->vertices, mesh.vertices);
    EXPECT_EQ(obj->triangles, mesh.triangles);
    for (const std::string& bytes :
         {writer.stl(mesh), binary_stl(mesh, "solid "), binary_stl(mesh, "a name")}) {
      const auto stl = parse_stl(bytes);
      ASSERT_TRUE(stl) << stl.error().message << "\n" << bytes;
      ASSERT_EQ(stl->triangles.size(), mesh.triangles.size());
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_EQ(stl->vertices[stl->triangles[t][k]], mesh.vertices[mesh.triangles[t][k]]);
        }
      }
    }
  }
}

}  // namespace
}  // namespace spoonbill
