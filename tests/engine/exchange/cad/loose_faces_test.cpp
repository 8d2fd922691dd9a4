// Tests loose faces of files, which share no edges, and are joined to solids where they enclose a volume.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_Copy.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <set>
#include <string>

#include "engine/exchange/cad/cad.h"
#include "engine/exchange/mesh_export/tessellation.h"
#include "tests/engine/exchange/cad/occt_shapes.h"
#include "tests/engine/exchange/sample_document.h"

namespace spoonbill {
namespace {

// Returns copies of a shape's faces without common edges. The first face is moved by `apart_mm` along z, and
// every second face is turned over.
TopoDS_Shape loose_faces(const TopoDS_Shape& shape, double apart_mm = 0.0) {
  TopoDS_Compound compound;
  BRep_Builder().MakeCompound(compound);
  bool is_turned = false;
  for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next()) {
    TopoDS_Shape face = BRepBuilderAPI_Copy(each.Current()).Shape();
    gp_Trsf moved;
    moved.SetTranslation(gp_Vec(0.0, 0.0, apart_mm));
    face.Move(moved);
    apart_mm = 0.0;
    BRep_Builder().Add(compound, is_turned ? face.Reversed() : face);
    is_turned = !is_turned;
  }
  return compound;
}

std::set<std::string> solids_of(const CadModel& model) {
  std::set<std::string> names;
  for (const CadSurface& surface : model.surfaces) names.insert(surface.solid);
  return names;
}

bool has_note(const CadModel& model, const std::string& text) {
  return std::any_of(model.notes.begin(), model.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

class LooseFaces : public testing::Test {
 protected:
  static void SetUpTestSuite() { prepare_occt(); }

  TemporaryFolder folder_;
};

TEST_F(LooseFaces, AreJoinedToTheSolidThatTheyEnclose) {
  const CadModel whole = read_through_step(drilled_box(), folder_.path());
  const CadModel model = read_through_step(loose_faces(drilled_box()), folder_.path());
  EXPECT_EQ(model.surfaces.size(), whole.surfaces.size());
  EXPECT_EQ(solids_of(model), std::set<std::string>{"solid"});
  const auto expected = mesh_solids(whole, {}), solids = mesh_solids(model, {});
  ASSERT_TRUE(expected && solids);
  ASSERT_EQ(solids->solids.size(), 1u);
  EXPECT_TRUE(solids->loose.empty());
  // Both volumes are integrated to a millionth.
  EXPECT_NEAR(solids->solids[0].volume_m3, expected->solids[0].volume_m3,
              2e-6 * expected->solids[0].volume_m3);
  EXPECT_GT(enclosed_volume_m3(solids->solids[0].mesh), 0.0);
}

TEST_F(LooseFaces, AreJoinedAcrossAGapOnlyOnRequest) {
  const TopoDS_Shape apart = loose_faces(drilled_box(), 0.05);
  const CadModel model = read_through_step(apart, folder_.path());
  EXPECT_EQ(solids_of(model), std::set<std::string>{""});
  EXPECT_TRUE(has_note(model, "--sew"));
  CadReading reading;
  reading.sew_m = 1e-4;
  EXPECT_EQ(solids_of(read_through_step(apart, folder_.path(), reading)), std::set<std::string>{"solid"});
}

TEST_F(LooseFaces, StayLooseWhereTheyEncloseNothing) {
  TopoDS_Compound open;
  BRep_Builder().MakeCompound(open);
  TopExp_Explorer faces(loose_faces(drilled_box()), TopAbs_FACE);
  for (int k = 0; k < 3; ++k, faces.Next()) BRep_Builder().Add(open, faces.Current());
  const CadModel model = read_through_step(open, folder_.path());
  EXPECT_EQ(solids_of(model), std::set<std::string>{""});
  EXPECT_TRUE(model.notes.empty());
}

}  // namespace
}  // namespace spoonbill
