// One stage of a contact as lines, shells, triangles, marks and arrows. No GL.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/camera.h"
#include "render/overlay/line.h"
#include "render/overlay/mark.h"
#include "render/view_settings.h"

namespace spoonbill {

// A translucent sphere with its outline; where its colour is faint, the outline alone.
struct OverlayShell {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0.0f;
  Colour colour;
};

// A corner of a filled triangle, three after each other.
struct OverlayCorner {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Colour colour;
};

struct OverlayArrow {
  Vector3 start_m, tip_m;
  Colour colour;
  const char* name;
};

struct StageShapes {
  std::vector<OverlayLine> lines;
  std::vector<OverlayShell> shells;
  std::vector<OverlayCorner> corners;
  std::vector<OverlayMark> marks;
  std::vector<OverlayArrow> arrows;
};

// Empty without stages. Normals are as long as those of append_contact_normals().
StageShapes stage_shapes(const Snapshot& snapshot, const ViewSettings& settings);

// Normal and tangents where the tool or another body is deepest in each region.
std::vector<OverlayArrow> contact_arrows(const Snapshot& snapshot, const ViewSettings& settings);

// What the stage is, as a sentence for the picture; none where no stage is shown.
std::optional<std::string> stage_caption(const ViewSettings& settings);

// Around all that stage_shapes() gives.
Box bounding_box(const StageShapes& shapes);

}  // namespace spoonbill
