// The overlays of the scene as lines, marks and other simple shapes, and the labels of the picture, without
// GL. Each overlay has one meaning and can be switched off in Overlays (render/view_settings.h). Lengths are
// in metres, in the world.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/simulation/snapshot.h"
#include "render/camera.h"
#include "render/colour.h"
#include "render/tessellation/reach_ring.h"
#include "render/view_settings.h"

struct ImDrawList;
struct ImFont;

namespace spoonbill {

// A straight line between two points of the world, of constant width in pixels.
struct OverlayLine {
  Eigen::Vector3f start_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f end_m = Eigen::Vector3f::Zero();
  Colour start_colour;
  Colour end_colour;
  float width_px = 1.0f;  // width before the interface scale
};

enum class MarkShape { square, disc, diamond };

// A small flat mark at a point of the world, facing the eye.
struct OverlayMark {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Colour colour;
  float radius_m = 0.0f;    // half the width of the mark, in the world
  float minimum_px = 2.0f;  // smallest radius on the screen, at an interface scale of 1
  float shape = 0.0f;       // a MarkShape
};

// A translucent sphere with an outline. If its colour is faint, only the outline is drawn.
struct OverlayShell {
  Eigen::Vector3f centre_m = Eigen::Vector3f::Zero();
  float radius_m = 0.0f;
  Colour colour;
};

// A corner of a filled triangle; three consecutive corners are one triangle.
struct OverlayCorner {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Colour colour;
};

struct OverlayArrow {
  Vector3 start_m, tip_m;
  Colour colour;
  const char* name;
};

// Overlays of the lattice and of the control net, defined in body_overlays.cpp.

// Returns the mean edge lengths along the directions of the lattice, in metres; zero without edges.
std::array<double, 3> mean_edges_m(const LatticeSnapshot& lattice);

// Returns the smallest of them that is above zero: the space available for marks. Zero for a lattice without
// edges.
float mean_edge_m(const LatticeSnapshot& lattice);

// Appends a green square for each fixed node that is not touched and is on the surface of the body or next to
// it. If `inner`, nodes inside the body get a square too (Fig. 7 of Pungotra et al. 2013).
void append_fixed_marks(const LatticeSnapshot& lattice, bool inner, std::vector<OverlayMark>& marks);

// Appends a red disc for each touched node.
void append_touched_marks(const LatticeSnapshot& lattice, std::vector<OverlayMark>& marks);

// Appends the edges between neighbouring nodes that are on the surface of the body or next to it, or all
// edges of the body if `inner`.
void append_lattice_lines(const LatticeSnapshot& lattice, bool inner, std::vector<OverlayLine>& lines);

// The boundaries of the lattice's hexahedra on the surface of the body (Fig. 11 of Pungotra et al. 2013).
struct CellLines {
  std::vector<OverlayLine> near;  // edges of faces toward the eye, thick
  // Edges of faces away from the eye, thin and pale; drawn before a translucent body.
  std::vector<OverlayLine> far;
};

// Appends each edge of the outer faces of the lattice once, except edges with an end outside the body. If the
// lattice is a box of cells around the body, these edges go to lines.near, wherever the eye is.
void append_cell_lines(const LatticeSnapshot& lattice, const Eigen::Vector3f& eye_m, CellLines& lines);

// Appends the rows and columns of the control net as thin lines, closed in periodic directions, with a
// diamond at each control point.
void append_control_net(const SurfaceSnapshot& surface, std::vector<OverlayLine>& lines,
                        std::vector<OverlayMark>& marks);

// Appends the ring of a local stroke, without the parts beyond the edge of an open surface.
void append_reach_ring(const ReachRing& ring, std::vector<OverlayLine>& lines);

// Overlays of the fixing planes and of the plane of symmetry, defined in plane_overlays.cpp.

using PlaneCorners = std::array<Vector3, 4>;  // in order around a rectangle

// Returns an upright rectangle in a fixing plane. It encloses the fixed nodes near the plane, because these
// do not move while the body bends. If there are none, it encloses the box of the body.
PlaneCorners fixing_plane_corners(const PlaneSnapshot& plane, const std::vector<BodySnapshot>& bodies,
                                  const Box& body);

// Returns the tip of the arrow along the normal of a fixing plane.
Vector3 plane_arrow_tip(const PlaneCorners& corners, const PlaneSnapshot& plane);

// Appends the border of a fixing plane and a short arrow along its normal, toward the side that can move.
void append_plane_border(const PlaneCorners& corners, const PlaneSnapshot& plane,
                         std::vector<OverlayLine>& lines);

// Returns an upright rectangle in the plane of symmetry, around the box of the body.
PlaneCorners symmetry_plane_corners(const PlaneSnapshot& plane, const Box& body);

// Appends the dash-dotted border of a plane of symmetry, as in engineering drawings.
void append_symmetry_plane(const PlaneCorners& corners, std::vector<OverlayLine>& lines);

// Overlays of the force and of the contacts, defined in contact_overlays.cpp.

// The force on the hand as an arrow from the tool.
struct ForceArrow {
  Vector3 start_m, tip_m;
  double newtons = 0.0;
};

// Returns an arrow whose length is proportional to the force: at least 6 mm, and at most 60 mm or five tool
// radii, whichever is more. Empty if the overlay is off, or if the force is below 5 mN, where its direction
// is noise.
std::optional<ForceArrow> force_arrow(const Snapshot& snapshot, const ViewSettings& settings);

// Returns the length at which contact normals are drawn: the larger of 4 mm and 0.6 tool radii.
double contact_normal_length_m(const ToolSnapshot& tool);

// Appends the outward normals of the contact points as short lines.
void append_contact_normals(const std::vector<ContactSnapshot>& contacts, double length_m,
                            std::vector<OverlayLine>& lines);

// The shapes of one stage of the contact search.
struct StageShapes {
  std::vector<OverlayLine> lines;
  std::vector<OverlayShell> shells;
  std::vector<OverlayCorner> corners;
  std::vector<OverlayMark> marks;
  std::vector<OverlayArrow> arrows;
};

// Returns the shapes of the selected stage of the contact search. There are none if `settings` has no stages.
StageShapes stage_shapes(const Snapshot& snapshot, const ViewSettings& settings);

// Returns arrows for the normal and the two tangents at the deepest contact of each contact region, for at
// most eight regions. Empty unless the contact points are the selected stage.
std::vector<OverlayArrow> contact_arrows(const Snapshot& snapshot, const ViewSettings& settings);

// Returns a caption for the selected stage of the contact search; empty if no stage is shown.
std::optional<std::string> stage_caption(const ViewSettings& settings);

// Returns the box around all shapes.
Box bounding_box(const StageShapes& shapes);

// Appends the goal of a task, defined in goal_overlays.cpp: rings around places to reach, dashed paths with
// an arrow head, thin reference lines, and diamonds at marked points.
void append_goal(const GoalMarks& goal, std::vector<OverlayLine>& lines, std::vector<OverlayMark>& marks);

// Overlays of the ground, defined in ground_overlays.cpp: the grid and the scale bar.

// Appends the lines of the ground grid, at multiples of a power of ten that suits the distance of the camera.
// Every fifth line is stronger, and all lines fade out with the distance from the target of the camera. The
// alpha of the colour is ignored.
void append_ground_grid(const Camera& camera, const Viewport& viewport, double ground_y_m, Colour colour,
                        std::vector<OverlayLine>& lines);

// A bar of a round length (1, 2 or 5 times a power of ten), parallel to the lower edge of the picture.
struct ScaleBar {
  Vector3 start_m, end_m;
  double length_m = 0.0;

  // Returns the length as text, such as "20 mm".
  std::string text() const;
};

// Returns a scale bar on the ground in the lower centre of the area that no panel covers. Empty if the ground
// is not visible there, or if its visible part is far behind the model.
std::optional<ScaleBar> ground_scale_bar(const Camera& camera, const Viewport& viewport, double ground_y_m);

// Appends the bar with a tick at each end.
void append_scale_bar(const ScaleBar& bar, const Camera& camera, Colour colour,
                      std::vector<OverlayLine>& lines);

// Returns the largest of 1, 2, 5 times a power of ten that does not exceed `length`, which must be positive.
double round_length_below(double length);

// Labels and legend, defined in labels.cpp.

enum class LabelSymbol { none, square, disc, ring, diamond, line, arrow, sphere, plane };

struct Label {
  std::string text;
  Eigen::Vector2d position_px = Eigen::Vector2d::Zero();  // position of the anchor
  // Point of the text's box that is at `position_px`: (0, 0) is the top left corner, (1, 1) the bottom right.
  Eigen::Vector2d anchor = Eigen::Vector2d::Zero();
  LabelSymbol symbol = LabelSymbol::none;  // drawn to the left of the text
  Colour colour;                           // colour of the symbol
};

struct OverlayLabels {
  std::vector<Label> in_scene;  // force, scale bar and contact stage
  std::vector<Label> legend;    // one line each, from the top; draw_labels() chooses the positions
};

// Lays out the labels of the enabled overlays, without GL or ImGui. The legend omits forces, marks, planes
// and contact normals that the snapshot does not contain.
OverlayLabels overlay_labels(const Snapshot& snapshot, const ViewSettings& settings, int width_px,
                             int height_px);

// Draws the labels on an ImGui draw list, the legend in the lower right corner of the area that no panel
// covers. Use the background draw list, which is behind the panel.
void draw_labels(const OverlayLabels& labels, const ViewSettings& settings, int width_px, int height_px,
                 ImFont& font, ImDrawList& list);

}  // namespace spoonbill
