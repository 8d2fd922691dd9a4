#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "engine/base/geometry.h"
#include "render/colour.h"
#include "render/overlay/overlays.h"
#include "render/passes/shadow_pass.h"
#include "render/tessellation/tessellated_surface.h"
#include "tests/render/sample_scene.h"

namespace spoonbill {
namespace {

ViewSettings framed(const Snapshot& snapshot) {
  ViewSettings settings;
  settings.panel_px = {0, 0, 300, 720};
  const Box box = drawn_bounds(snapshot);
  settings.ground_y_m = ground_below(box);
  settings.camera =
      frame(look_from({}, StandardView::perspective), box, make_viewport(1280, 720, settings.panel_px));
  return settings;
}

bool has_line(const std::vector<Label>& labels, const std::string& start) {
  return std::any_of(labels.begin(), labels.end(), [&](const Label& l) { return l.text.starts_with(start); });
}

TEST(Labels, NameTheForceAndTheScale) {
  const Snapshot snapshot = sample_scene();
  const ViewSettings settings = framed(snapshot);
  const OverlayLabels labels = overlay_labels(snapshot, settings, 1280, 720);
  EXPECT_TRUE(has_line(labels.in_scene, "1.84 N"));
  const auto bar =
      ground_scale_bar(settings.camera, make_viewport(1280, 720, settings.panel_px), settings.ground_y_m);
  ASSERT_TRUE(bar);
  EXPECT_TRUE(has_line(labels.in_scene, bar->text()));
  for (const Label& label : labels.in_scene) EXPECT_GT(label.position_px.x(), 300.0);
}

TEST(Labels, TheLegendSaysWhatIsOnAndThere) {
  Snapshot snapshot = sample_scene();
  ViewSettings settings = framed(snapshot);
  OverlayLabels labels = overlay_labels(snapshot, settings, 1280, 720);
  EXPECT_TRUE(has_line(labels.legend, "fixed part"));
  EXPECT_TRUE(has_line(labels.legend, "touched nodes"));
  EXPECT_TRUE(has_line(labels.legend, "sphere tool, push"));
  EXPECT_FALSE(has_line(labels.legend, "control net"));
  EXPECT_FALSE(has_line(labels.legend, "local reach"));

  snapshot.tool.is_local = true;
  EXPECT_TRUE(has_line(overlay_labels(snapshot, settings, 1280, 720).legend, "local reach"));
  snapshot.tool.local_radius_m = 0.012;
  EXPECT_TRUE(has_line(overlay_labels(snapshot, settings, 1280, 720).legend, "local reach, 12.0 mm"));

  settings.overlays.lattice = true;
  EXPECT_TRUE(has_line(overlay_labels(snapshot, settings, 1280, 720).legend, "fixed nodes 640"));

  settings.overlays.control_net = true;
  settings.overlays.fixed_nodes = false;
  std::fill(snapshot.bodies[0].lattice.touched.begin(), snapshot.bodies[0].lattice.touched.end(),
            std::uint8_t{0});
  labels = overlay_labels(snapshot, settings, 1280, 720);
  EXPECT_TRUE(has_line(labels.legend, "control net"));
  EXPECT_FALSE(has_line(labels.legend, "fixed nodes"));
  EXPECT_FALSE(has_line(labels.legend, "touched nodes"));

  settings.overlays.legend = false;
  EXPECT_TRUE(overlay_labels(snapshot, settings, 1280, 720).legend.empty());
}

TEST(Labels, TellTheStageOfAContact) {
  const Snapshot snapshot = sample_scene();
  ViewSettings settings = framed(snapshot);
  const auto labels = [&](ContactStage stage, int level) {
    settings.overlays.contact_stage = stage;
    settings.overlays.sphere_level = level;
    return overlay_labels(snapshot, settings, 1280, 720);
  };
  EXPECT_FALSE(has_line(labels(ContactStage::spheres, 1).in_scene, "Spheres")) << "without stages";
  settings.stages = sample_stages(snapshot);
  EXPECT_TRUE(has_line(labels(ContactStage::hulls, 0).in_scene, "Hulls of the control points"));
  EXPECT_TRUE(has_line(labels(ContactStage::hulls, 0).legend, "elements in range"));
  EXPECT_TRUE(has_line(labels(ContactStage::spheres, 1).in_scene, "Spheres of level 1: "));
  EXPECT_TRUE(
      has_line(labels(ContactStage::spheres, finest_stage_level).in_scene, "Spheres of level 3, the last"));
  const auto kept =
      std::count_if(settings.stages->spheres.begin(), settings.stages->spheres.end(),
                    [](const StageSphere& sphere) { return sphere.kept && sphere.cell.level == 1; });
  EXPECT_GT(kept, 0);
  EXPECT_TRUE(has_line(labels(ContactStage::spheres, 1).legend, "spheres kept " + std::to_string(kept)));
  EXPECT_FALSE(has_line(labels(ContactStage::spheres, 1).legend, "of the other surface"));
  EXPECT_TRUE(has_line(labels(ContactStage::triangles, 0).legend, "triangles that meet"));
  const OverlayLabels contacts = labels(ContactStage::contacts, 0);
  EXPECT_TRUE(has_line(contacts.legend, "contact points"));
  for (const char* name : {"n", "u", "v"}) EXPECT_TRUE(has_line(contacts.in_scene, name));
  EXPECT_FALSE(has_line(contacts.legend, "not all"));
  ContactStages cut = *settings.stages;
  cut.overflow = true;
  settings.stages = std::make_shared<const ContactStages>(cut);
  EXPECT_TRUE(has_line(labels(ContactStage::contacts, 0).legend, "not all are shown"));
}

TEST(ForceArrow, IsAsLongAsTheForceWithinBounds) {
  Snapshot snapshot = sample_scene();
  const ViewSettings settings;
  const auto length = [&](double newtons) {
    snapshot.force_n = {0.0, newtons, 0.0};
    const auto arrow = force_arrow(snapshot, settings);
    return arrow ? (arrow->tip_m - arrow->start_m).norm() : 0.0;
  };
  EXPECT_NEAR(length(2.0), 2.0 * settings.arrow_m_per_n, 1e-12);
  EXPECT_EQ(length(0.001), 0.0);
  EXPECT_NEAR(length(1000.0), 0.060, 1e-12);
}

TEST(ScaleBar, IsOfARoundLengthAndStaysInTheFreeRectangle) {
  EXPECT_DOUBLE_EQ(round_length_below(0.0199), 0.01);
  EXPECT_DOUBLE_EQ(round_length_below(0.02), 0.02);
  EXPECT_DOUBLE_EQ(round_length_below(0.09), 0.05);
  EXPECT_EQ((ScaleBar{Vector3::Zero(), Vector3::Zero(), 0.02}).text(), "20 mm");
  EXPECT_EQ((ScaleBar{Vector3::Zero(), Vector3::Zero(), 0.0005}).text(), "0.5 mm");
  const ViewSettings settings = framed(sample_scene());
  const Viewport viewport = make_viewport(1280, 720, settings.panel_px);
  const auto bar = ground_scale_bar(settings.camera, viewport, settings.ground_y_m);
  ASSERT_TRUE(bar);
  EXPECT_NEAR((bar->end_m - bar->start_m).norm(), bar->length_m, 1e-12);
  const auto start = project(settings.camera, viewport, bar->start_m);
  const auto end = project(settings.camera, viewport, bar->end_m);
  ASSERT_TRUE(start && end);
  EXPECT_GT(start->x(), 300.0);
  EXPECT_LT(end->x(), 1280.0);
  EXPECT_NEAR(start->y(), end->y(), 1e-6) << "level in the picture";

  const Camera level = look_from(settings.camera, StandardView::front);
  Camera from_below = look_from(settings.camera, StandardView::bottom);
  from_below.pitch_rad = -0.3;
  EXPECT_TRUE(ground_scale_bar(level, viewport, settings.ground_y_m));
  EXPECT_TRUE(ground_scale_bar(from_below, viewport, settings.ground_y_m)) << "seen through the ground";
}

TEST(NodeMarks, FixedAreSquaresTouchedAreDiscs) {
  const Snapshot snapshot = sample_scene();
  std::vector<OverlayMark> marks;
  append_fixed_marks(snapshot.bodies[0].lattice, false, marks);
  ASSERT_FALSE(marks.empty());
  for (const OverlayMark& mark : marks) EXPECT_EQ(mark.shape, static_cast<float>(MarkShape::square));
  const std::size_t on_shell = marks.size();
  marks.clear();
  append_fixed_marks(snapshot.bodies[0].lattice, true, marks);
  EXPECT_GT(marks.size(), on_shell);
  marks.clear();
  append_touched_marks(snapshot.bodies[0].lattice, marks);
  ASSERT_FALSE(marks.empty());
  for (const OverlayMark& mark : marks) EXPECT_EQ(mark.shape, static_cast<float>(MarkShape::disc));
}

TEST(FixingPlane, LiesInItsPlaneAroundTheFixedNodes) {
  const Snapshot snapshot = sample_scene();
  const PlaneCorners corners =
      fixing_plane_corners(snapshot.planes[0], snapshot.bodies, drawn_bounds(snapshot));
  Box box;
  for (const Vector3& corner : corners) {
    EXPECT_NEAR((corner - snapshot.planes[0].point_m).dot(snapshot.planes[0].normal), 0.0, 1e-12);
    box.include(corner);
  }
  EXPECT_GT(box.high.z() - box.low.z(), 0.012);
  EXPECT_LT(box.high.z() - box.low.z(), 0.040);
}

// A plane below a block that fills the picture stays in the picture.
TEST(FixingPlane, StaysInThePicture) {
  const Box block{Vector3(-0.02, 0.0, -0.02), Vector3(0.02, 0.02, 0.02)};
  const Viewport viewport = make_viewport(1280, 720, {});
  const Camera camera = frame(look_from({}, StandardView::perspective), block, viewport);
  for (const Vector3& normal : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)}) {
    const PlaneSnapshot plane{block.low, normal};
    for (const Vector3& corner : fixing_plane_corners(plane, {}, block)) {
      const auto pixel = project(camera, viewport, corner);
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(pixel->x() > 0.0 && pixel->x() < 1280.0 && pixel->y() > 0.0 && pixel->y() < 720.0);
    }
  }
}

TEST(ShadowArea, HoldsWhatTheLightCarriesToTheGround) {
  Box body;
  body.include({0.0, 0.01, -0.006});
  body.include({0.1, 0.03, 0.006});
  const Eigen::Vector3f toward_key = Eigen::Vector3f(-0.4f, 0.8f, 0.4f).normalized();
  const ShadowArea area = shadow_area(body, {}, 0.0f, toward_key, 1024);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector4f clip = area.key_to_clip * body.corner(i).cast<float>().homogeneous();
    EXPECT_LT(clip.head<3>().cwiseAbs().maxCoeff(), 1.0f);
    // A point and its shadow on the ground have the same position in the map.
    const Eigen::Vector3f top = body.corner(i).cast<float>();
    const Eigen::Vector3f shadow = top - toward_key * (top.y() / toward_key.y());
    const Eigen::Vector4f shadow_clip = area.key_to_clip * shadow.homogeneous();
    EXPECT_NEAR(clip.x(), shadow_clip.x(), 1e-4f);
    EXPECT_NEAR(clip.y(), shadow_clip.y(), 1e-4f);
    EXPECT_LT(clip.z(), shadow_clip.z()) << "the higher point is nearer to the light";
  }
}

TEST(SurfaceLook, MaterialsLookLikeThemselves) {
  EXPECT_GT(find_material_look("modelling-clay").roughness, 0.6f);
  EXPECT_EQ(find_material_look("Steel 304").metalness, 1.0f);
  EXPECT_TRUE(find_material_look("jelly").is_clear());
  EXPECT_TRUE(find_material_look("silicone-00-30").is_clear());
  EXPECT_FALSE(find_material_look("wax").is_clear());
  EXPECT_EQ(find_material_look("beech").pattern, SurfacePattern::grain);
  EXPECT_EQ(find_material_look("unobtainium").translucency, 0.0f);
}

LatticeSnapshot block_of_nodes(int ni, int nj, int nk) {
  LatticeSnapshot block;
  block.count[0] = ni;
  block.count[1] = nj;
  block.count[2] = nk;
  for (int i = 0; i < ni; ++i) {
    for (int j = 0; j < nj; ++j) {
      for (int k = 0; k < nk; ++k) {
        block.x.push_back(static_cast<float>(i));
        block.y.push_back(static_cast<float>(j));
        block.z.push_back(static_cast<float>(k));
      }
    }
  }
  block.in_body.assign(block.x.size(), 1);
  return block;
}

// A cube seen from beyond a corner has nine edges on the three faces towards the eye, and three edges that
// are only on the other faces.
TEST(CellLines, AreNearWhereAFaceLooksAtTheEye) {
  CellLines of_corner, of_face;
  append_cell_lines(block_of_nodes(2, 2, 2), {5.0f, 4.0f, 3.0f}, of_corner);
  EXPECT_EQ(of_corner.near.size(), 9u);
  EXPECT_EQ(of_corner.far.size(), 3u);
  append_cell_lines(block_of_nodes(2, 2, 2), {0.5f, 0.5f, 9.0f}, of_face);
  EXPECT_EQ(of_face.near.size(), 4u);
  EXPECT_EQ(of_face.far.size(), 8u);
  for (const OverlayLine& line : of_face.near) EXPECT_EQ(line.start_m.z(), 1.0f);
}

// Each edge on the outside of the block is listed once. An outer face of a cell has four edges, and each edge
// is on two outer faces, so there are twice as many edges as faces.
TEST(CellLines, AreTheOuterEdgesEachOnce) {
  CellLines lines;
  append_cell_lines(block_of_nodes(12, 12, 12), {50.0f, 40.0f, 30.0f}, lines);
  EXPECT_EQ(lines.near.size() + lines.far.size(), 2u * 6u * 11u * 11u);
  CellLines none;
  append_cell_lines(LatticeSnapshot{}, {1.0f, 1.0f, 1.0f}, none);
  EXPECT_TRUE(none.near.empty() && none.far.empty());
}

}  // namespace
}  // namespace spoonbill
