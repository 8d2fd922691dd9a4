// Tests that trimmed surfaces are the same after export to STEP or IGES and import.
#include <gtest/gtest.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <cmath>

#include "engine/bspline/evaluate.h"
#include "engine/bspline/reparameterise.h"
#include "engine/exchange/cad/body_shape.h"
#include "engine/exchange/cad/cad.h"
#include "engine/exchange/cad_stream.h"
#include "tests/engine/bspline/random_surface.h"
#include "tests/engine/bspline/tube.h"
#include "tests/engine/exchange/cad/kept_part.h"
#include "tests/engine/exchange/sample_document.h"
#include "tests/engine/trims/loops.h"

namespace spoonbill {
namespace {

constexpr double trimmed_tolerance_m = 1e-7;

CadSurface named(const std::string& name, Surface surface) {
  CadSurface part;
  part.name = name;
  part.surface = std::move(surface);
  return part;
}

CadSurface sheet(const std::string& name) {
  Random random(4);
  const KnotVector u = KnotVector::clamped_uniform(3, 8).value(),
                   v = KnotVector::clamped_uniform(2, 6).value();
  return named(name, random_surface(random, u, v));
}

void add_polygon(CadSurface& part, const std::vector<Eigen::Vector2d>& points) {
  part.trims.push_back(polygon_loop(part.surface.u, part.surface.v, points));
}

void add_circle(CadSurface& part, double u, double v, double radius, bool hole) {
  part.trims.push_back(round_loop(part.surface.u, part.surface.v, {u, v}, radius, 12, hole));
}

std::vector<CadSurface> trimmed_surfaces() {
  CadSurface holed = sheet("sheet with a hole");
  add_circle(holed, 0.4, 0.6, 0.2, true);
  CadSurface framed = sheet("polygon with two holes");
  add_polygon(framed, {{0.1, 0.1}, {0.9, 0.2}, {0.8, 0.9}, {0.3, 0.8}});
  add_circle(framed, 0.4, 0.4, 0.1, true);
  add_circle(framed, 0.65, 0.6, 0.1, true);
  CadSurface islands = sheet("two islands");
  add_circle(islands, 0.25, 0.3, 0.2, false);
  add_polygon(islands, rectangle(0.6, 0.5, 0.9, 0.95));
  CadSurface tube = named("tube with a hole", ellipsoid_tube(10, 10));
  add_circle(tube, 0.5, 0.5, 0.15, true);
  CadSurface across = named("tube with a hole across its seam", ellipsoid_tube(10, 10));
  add_circle(across, 0.98, 0.5, 0.15, true);
  CadSurface cup = named("strip of a tube", ellipsoid_tube(10, 10));
  add_polygon(cup, rectangle(0.0, 0.25, 1.0, 0.8));
  return {holed, framed, islands, tube, across, cup};
}

class TrimmedRoundTrip : public testing::TestWithParam<FileFormat> {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  std::vector<CadSurface> there_and_back(const CadSurface& part) const {
    CadModel model;
    model.surfaces.push_back(part);
    const auto content = write_cad(model, {GetParam(), StepSchema::ap214, "mm"});
    EXPECT_TRUE(content) << content.error().message;
    if (!content) return {};
    const auto file = folder_.write(GetParam() == FileFormat::step ? "a.step" : "a.igs", content->text);
    CadReading reading;
    reading.format = GetParam();
    std::vector<CadSurface> back;
    const auto read =
        read_cad(file, reading, [&](CadSurface surface) { back.push_back(std::move(surface)); });
    EXPECT_TRUE(read) << read.error().message;
    return back;
  }

  TemporaryFolder folder_;
};

// Expects each kept point of `part` to be on one of the kept parts in `by`.
void expect_covered(const CadSurface& part, const std::vector<CadSurface>& by) {
  std::vector<NearestKeptPoint> nearest(by.begin(), by.end());
  const auto kept = TrimmedArea::make(part.surface.u, part.surface.v, part.trims).value();
  int points = 0;
  for (const double u : uniform_parameters(part.surface.u, 24)) {
    for (const double v : uniform_parameters(part.surface.v, 24)) {
      if (!kept.contains(u, v)) continue;
      ++points;
      double least = 1e30;
      for (const NearestKeptPoint& other : nearest) {
        least = std::min(least, other.distance_m(position(part.surface, u, v)));
      }
      EXPECT_LT(least, trimmed_tolerance_m) << u << " " << v;
    }
  }
  EXPECT_GT(points, 20);
}

TEST_P(TrimmedRoundTrip, WhatIsKeptComesBack) {
  for (const CadSurface& part : trimmed_surfaces()) {
    SCOPED_TRACE(part.name);
    const std::vector<CadSurface> back = there_and_back(part);
    ASSERT_FALSE(back.empty());
    double area = 0.0;
    for (const CadSurface& face : back) {
      EXPECT_EQ(face.trim_problem, "");
      EXPECT_EQ(face.deviation_m, 0.0);
      EXPECT_TRUE(face.name.starts_with(part.name)) << face.name;
      area += kept_area_m2(face);
      expect_covered(face, {part});
    }
    expect_covered(part, back);
    // Both areas are computed by the midpoint rule with 200 lines in each direction.
    EXPECT_NEAR(area, kept_area_m2(part), 5e-3 * area);
  }
}

TEST_P(TrimmedRoundTrip, ASurfaceWithOneFaceKeepsItsParameters) {
  const CadSurface part = trimmed_surfaces()[1];
  const std::vector<CadSurface> back = there_and_back(part);
  ASSERT_EQ(back.size(), 1u);
  ASSERT_EQ(back[0].trims.size(), 3u);
  const auto before = TrimmedArea::make(part.surface.u, part.surface.v, part.trims).value();
  const auto after = TrimmedArea::make(back[0].surface.u, back[0].surface.v, back[0].trims);
  ASSERT_TRUE(after);
  EXPECT_NEAR(after->remaining_fraction(), before.remaining_fraction(), 1e-6);
}

// Only surfaces that would be closed without their trims get a note. A trimmed sheet gets none.
TEST_P(TrimmedRoundTrip, WhatWouldCloseButForItsTrimsIsSaid) {
  CadModel model;
  for (const CadSurface& part : trimmed_surfaces()) model.surfaces.push_back(part);
  const auto content = write_cad(model, {GetParam(), StepSchema::ap214, "mm"});
  ASSERT_TRUE(content) << content.error().message;
  EXPECT_EQ(content->solids, 0);
  EXPECT_EQ(content->open_shells, 6);
  ASSERT_EQ(content->notes.size(), 3u);
  EXPECT_EQ(content->notes[0],
            "'tube with a hole' would close but is trimmed; the remaining part is written as an open shell, "
            "cut in 2 faces, which are imported as a body each");
}

INSTANTIATE_TEST_SUITE_P(Both, TrimmedRoundTrip, testing::Values(FileFormat::step, FileFormat::iges),
                         [](const auto& format) {
                           return std::string(format.param == FileFormat::step ? "Step" : "Iges");
                         });

// The hole is small, so that the sign of the enclosed volume still shows whether the normals point inwards.
TEST(BodyShape, FacesOfWhatWouldCloseAreTurnedOutwards) {
  for (const Surface& tube : {ellipsoid_tube(10, 10), reversed(ellipsoid_tube(10, 10), Direction::u)}) {
    CadSurface part = named("tube", tube);
    add_circle(part, 0.5, 0.5, 0.1, true);
    const auto body = build_body_shape(part);
    ASSERT_TRUE(body) << body.error().message;
    GProp_GProps properties;
    BRepGProp::VolumeProperties(body->shape, properties, 1e-3);
    EXPECT_GT(properties.Mass(), 0.0);
  }
}

// A closed surface is cut into two faces when it is exported. The two faces share their edges.
TEST(BodyShape, FacesOfOneSurfaceAreOneShell) {
  for (const CadSurface& part : trimmed_surfaces()) {
    SCOPED_TRACE(part.name);
    const auto body = build_body_shape(part);
    ASSERT_TRUE(body) << body.error().message;
    int shells = 0;
    for (TopExp_Explorer each(body->shape, TopAbs_SHELL); each.More(); each.Next()) ++shells;
    EXPECT_EQ(shells, part.name == "two islands" ? 2 : 1);
    EXPECT_TRUE(BRepCheck_Analyzer(body->shape).IsValid());
  }
}

TEST(CadStream, TrimsComeBackToTheBit) {
  for (const CadSurface& part : trimmed_surfaces()) {
    const auto back = cad_surface_from_json(json_to_line(cad_surface_to_json(part)), "file");
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->trims, part.trims);
  }
}

}  // namespace
}  // namespace spoonbill
