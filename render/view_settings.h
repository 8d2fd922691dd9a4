// Settings of how a snapshot is drawn: plain data, set by the panel, a recording or a test. They do not
// change the simulation.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/collision/stages/contact_stages.h"
#include "render/camera.h"
#include "render/studio.h"

namespace spoonbill {

// Stages of the contact search, in their order (section 4.1 of Pungotra et al. 2013).
enum class ContactStage { none, hulls, spheres, triangles, contacts };

// Switches of the overlays. Each overlay has one meaning.
struct Overlays {
  bool fixed_nodes = true;       // a green tint; squares with the lattice
  bool touched_nodes = true;     // red discs
  bool lattice = false;          // the thinnest lines
  bool cells = false;            // thick lines where the hexahedra of the lattice meet the surface
  bool control_net = false;      // thin lines with diamonds
  bool force = true;             // the force on the hand, as an arrow with its value in newtons
  bool contact_normals = false;  // short lines from the contact points
  bool fixing_planes = true;
  bool symmetry_plane = true;  // dash-dotted
  bool tool = true;
  bool ground_grid = true;
  bool scale_bar = true;
  bool legend = true;  // lists the visible overlays
  ContactStage contact_stage = ContactStage::none;
  int sphere_level = 0;  // level of the spheres: 0, the coarsest, to finest_stage_level
};

// The goal of a task, in the scene. Plain data; lengths in metres, in the world.
struct GoalMarks {
  // A circle around a place to reach.
  struct Ring {
    Vector3 centre_m = Vector3::Zero();
    Vector3 normal = Vector3::UnitX();  // unit vector
    double radius_m = 0.0;
  };
  std::vector<Ring> rings;
  std::vector<std::vector<Vector3>> paths_m;  // corners of each path, from its start
  std::vector<std::array<Vector3, 2>> lines;  // ends of reference lines, such as the level
  std::vector<Vector3> points_m;              // marked points
  bool is_reached = false;                    // true once the task has succeeded
};

struct ViewSettings {
  Camera camera;
  Rectangle panel_px;            // area covered by the panel at the left or right edge; empty without a panel
  double interface_scale = 1.0;  // factor on line widths and mark sizes: 1 at a height of 720 pixels

  Overlays overlays;
  std::shared_ptr<const ContactStages> stages;  // contact stages of the snapshot; null draws none
  std::shared_ptr<const GoalMarks> goal;        // goal of a task; null draws none
  bool see_through_body = false;                // draws the body as a ghost, so that inner nodes are visible
  // Returns whether fixed nodes have marks, instead of a tint of the skin.
  bool marks_fixed_nodes() const { return overlays.fixed_nodes && (overlays.lattice || see_through_body); }

  Vector3 toward_key_light = Vector3(-0.42, 0.80, 0.43);  // any length; raised above the horizon when drawn
  Studio studio = studios().front();
  double studio_turn_rad = 0.0;  // angle by which all lights are turned about the vertical
  bool shadow = true;
  bool occlusion = true;    // dims light where bodies hide their surroundings
  bool reflections = true;  // lets shiny bodies mirror the studio
  int samples = 4;          // samples per pixel, 0 or 4
  double detail = 1.0;      // fineness of the tessellation; 0.5 doubles edge lengths and chord errors
  // Pixels of bodies and overlays for each pixel of the frame, in each direction; 0.5 to 1. Only without
  // samples.
  double resolution = 1.0;
  bool keep_level = true;   // see MeshChoice::keeps_level
  double ground_y_m = 0.0;  // height of the ground, see ground_below()
  // Leaves out the background. The pixels then have premultiplied alpha; see make_alpha_straight().
  bool is_transparent = false;
  double arrow_m_per_n = 0.012;
};

// Returns the interface scale for a window height: 1 up to 720 pixels, 2 at 1440.
double interface_scale_for(int height_px);

// Returns the height of the ground on which a model stands: that of its lowest point.
double ground_below(const Box& model);

// Drawing qualities, from best to worst: each leaves out one thing more. `coarse` has half the detail and
// half the resolution.
enum class FrameQuality { full, no_occlusion, no_reflections, no_samples, no_shadow, coarse };

// Reduces the drawing quality to hold the frame rate. Its decisions depend only on the times that it
// receives; it reads no clock. One owner: the drawing thread.
//
//   FrameBudget budget;
//   budget.apply(settings);                  // before each frame
//   renderer.draw(snapshot, settings, ...);
//   budget.add_frame(seconds_it_took);       // after each frame: drawing and presenting, without waiting
class FrameBudget {
 public:
  // `frame_s` is the time available for a frame, above 0. With a fixed quality, late frames do not lower it.
  explicit FrameBudget(double frame_s = 1.0 / 60.0, std::optional<FrameQuality> fixed = {})
      : frame_s_(frame_s), is_fixed_(fixed.has_value()), quality_(fixed.value_or(FrameQuality::full)) {}

  // Records the time of a frame drawn at quality(). Consecutive late frames, or more than one late frame in
  // three, lower the quality. A long time with spare capacity raises it. A single late frame changes nothing,
  // because another program may have caused it. If a raised quality soon fails, it is retried after a longer
  // time.
  void add_frame(double took_s);

  FrameQuality quality() const { return quality_; }

  // Lowers settings to quality(); never raises them.
  void apply(ViewSettings& settings) const;

  // Returns one line for the panel that reports how the quality is reduced; empty at full quality.
  std::string text() const;

 private:
  void change(FrameQuality quality);
  void consider_raising(double took_s);

  double frame_s_;
  bool is_fixed_;
  FrameQuality quality_;
  int late_frames_ = 0;          // weighted count of recent late frames
  int spare_frames_ = 0;         // count of frames with spare capacity
  int frames_since_change_ = 0;  // frames since the quality changed
  int patience_frames_ = 120;    // frames with spare capacity before the quality is raised
  bool on_trial_ = false;        // true until a raised quality has lasted for trial_frames
};

}  // namespace spoonbill
