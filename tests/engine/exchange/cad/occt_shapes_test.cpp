// Compares more than fifty shapes with what our reader returns for them. OpenCASCADE builds the shapes and
// writes the files.
#include "tests/engine/exchange/cad/occt_shapes.h"

#include <gtest/gtest.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <IGESControl_Writer.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Writer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>

#include "engine/bspline/evaluate.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/exchange/cad/cad.h"
#include "tests/engine/exchange/cad/cad_surfaces.h"
#include "tests/engine/exchange/cad/kept_part.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

constexpr double tolerance_m = 1e-5;
// Coordinates of 100 mm in OpenCASCADE's files have an error of about 1e-12 mm. Some curved faces in IGES
// files are only accurate to OpenCASCADE's tolerance of 1e-4 mm.
constexpr double shape_file_tolerance_m = 2e-7;

Vector3 metres(const gp_Pnt& point) {
  return 1e-3 * Vector3(point.X(), point.Y(), point.Z());
}

// Returns points of a grid on each face, without those that OpenCASCADE does not classify as inside the face.
std::vector<Vector3> points_on(const TopoDS_Shape& shape) {
  constexpr int across = 6;
  std::vector<Vector3> points;
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    const TopoDS_Face& face = TopoDS::Face(faces.Current());
    double u_start, u_end, v_start, v_end;
    BRepTools::UVBounds(face, u_start, u_end, v_start, v_end);
    const BRepAdaptor_Surface surface(face);
    for (int i = 0; i < across; ++i) {
      for (int j = 0; j < across; ++j) {
        const double u = u_start + (u_end - u_start) * (i + 0.5) / across;
        const double v = v_start + (v_end - v_start) * (j + 0.5) / across;
        BRepClass_FaceClassifier at(face, gp_Pnt2d(u, v), 1e-6);
        if (at.State() == TopAbs_IN) points.push_back(metres(surface.Value(u, v)));
      }
    }
  }
  return points;
}

// Returns the area of a fine mesh of the shape, because OpenCASCADE's quadratures are off by 1 % on some of
// these faces.
double area_m2(const TopoDS_Shape& shape) {
  const BRepMesh_IncrementalMesh mesher(shape, 0.02, false, 0.1);
  double area = 0.0;
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    TopLoc_Location place;
    const auto mesh = BRep_Tool::Triangulation(TopoDS::Face(faces.Current()), place);
    for (int k = 1; k <= mesh->NbTriangles(); ++k) {
      int a, b, c;
      mesh->Triangle(k).Get(a, b, c);
      const gp_Vec first(mesh->Node(a), mesh->Node(b)), second(mesh->Node(a), mesh->Node(c));
      area += 0.5e-6 * first.Crossed(second).Magnitude();
    }
  }
  BRepTools::Clean(shape);
  return area;
}

struct ReadBack {
  std::vector<CadSurface> surfaces;
  bool trimmed = false;
  double deviation_m = 0.0;
};

void expect_same_shape(const TopoDS_Shape& shape, const ReadBack& back) {
  ASSERT_FALSE(back.surfaces.empty());
  EXPECT_LE(back.deviation_m, tolerance_m);
  std::vector<NearestKeptPoint> surfaces;
  for (const CadSurface& part : back.surfaces) surfaces.emplace_back(part);
  double farthest = 0.0;
  const auto points = points_on(shape);
  EXPECT_GT(points.size(), 10u);
  for (const Vector3& point : points) {
    double least = 1e30;
    for (const NearestKeptPoint& surface : surfaces) least = std::min(least, surface.distance_m(point));
    farthest = std::max(farthest, least);
  }
  EXPECT_LE(farthest, back.deviation_m + shape_file_tolerance_m);

  // The kept parts of the surfaces are on the shape and have the same total area as the shape.
  double area = 0.0;
  for (const CadSurface& part : back.surfaces) {
    EXPECT_EQ(part.trim_problem, "");
    area += kept_area_m2(part);
    const auto kept = TrimmedArea::make(part.surface.u, part.surface.v, part.trims).value();
    for (const double u : uniform_parameters(part.surface.u, 5)) {
      for (const double v : uniform_parameters(part.surface.v, 5)) {
        if (!kept.contains(u, v)) continue;
        const Vector3 at = 1e3 * position(part.surface, u, v);
        const BRepExtrema_DistShapeShape distance(
            BRepBuilderAPI_MakeVertex(gp_Pnt(at.x(), at.y(), at.z())).Shape(), shape);
        EXPECT_LE(1e-3 * distance.Value(), part.deviation_m + shape_file_tolerance_m);
      }
    }
  }
  // On trimmed faces, the midpoint rule with 200 lines in each direction is less precise, so the tolerance is
  // larger.
  EXPECT_NEAR(area, area_m2(shape), (back.trimmed ? 5e-3 : 2e-3) * area);
}

class OcctShapes : public testing::TestWithParam<FileFormat> {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  std::filesystem::path write(const TopoDS_Shape& shape) const {
    set_file_unit("mm");
    if (GetParam() == FileFormat::step) {
      const auto file = folder_.path() / "shape.step";
      STEPControl_Writer writer;
      EXPECT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
      EXPECT_EQ(writer.Write(file.c_str()), IFSelect_RetDone);
      return file;
    }
    const auto file = folder_.path() / "shape.iges";
    IGESControl_Writer writer;
    EXPECT_TRUE(writer.AddShape(shape));
    writer.ComputeModel();
    EXPECT_TRUE(writer.Write(file.c_str()));
    return file;
  }

  ReadBack read(const std::filesystem::path& file) const {
    CadReading reading;
    reading.format = GetParam();
    reading.tolerance_m = tolerance_m;
    ReadBack back;
    const auto model = read_cad(file, reading, [&](CadSurface part) {
      back.trimmed = back.trimmed || !part.trims.empty();
      back.deviation_m = std::max(back.deviation_m, part.deviation_m);
      back.surfaces.push_back(std::move(part));
    });
    EXPECT_TRUE(model) << model.error().message;
    if (!model) return back;
    for (const std::string& note : model->notes) {
      EXPECT_EQ(note.find("missing"), std::string::npos) << note;
    }
    return back;
  }

  void expect_read_without_loss(const std::vector<NamedShape>& shapes) const {
    for (const NamedShape& named : shapes) {
      SCOPED_TRACE(named.name);
      expect_same_shape(named.shape, read(write(named.shape)));
    }
  }

  TemporaryFolder folder_;
};

TEST_P(OcctShapes, FiftyAndMoreAreTried) {
  EXPECT_GE(solid_shapes().size() + single_faces().size(), 50u);
}

TEST_P(OcctShapes, SolidsAreReadWithoutLoss) {
  expect_read_without_loss(every_second(solid_shapes(), GetParam() == FileFormat::step));
}

TEST_P(OcctShapes, FacesAreReadWithoutLoss) {
  expect_read_without_loss(single_faces());
}

INSTANTIATE_TEST_SUITE_P(Both, OcctShapes, testing::Values(FileFormat::step, FileFormat::iges),
                         [](const auto& format) {
                           return std::string(format.param == FileFormat::step ? "Step" : "Iges");
                         });

}  // namespace
}  // namespace spoonbill
