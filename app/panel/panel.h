// The panel: tool, material, fixtures, view and device, in the order of work; in frames of a trial, what it
// has found so far.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/panel/interface_context.h"
#include "app/session/session.h"
#include "engine/scene/scene.h"
#include "engine/simulation/snapshot.h"
#include "render/camera.h"
#include "render/view_settings.h"

namespace spoonbill {

// State of a trial, which the panel of its frames shows instead of the tool and the device. All texts are for
// people.
struct TrialRows {
  std::string phase;
  std::string tilt;  // empty if nothing turns
  bool is_settled = false;
  double largest_speed_m_per_s = 0.0;
  double largest_overlap_m = 0.0;
  int inverted_cells = 0;
  struct BodyRow {
    std::string name, text;
  };
  std::vector<BodyRow> bodies;
};

// State of a task that is trained, which the panel shows instead of the tool and the material. All texts are
// for people.
struct TaskRows {
  struct Row {
    std::string name, text;
    std::optional<double> fraction = {};  // 0 to 1, of a bar; without it, the row has only text
  };
  std::string note;  // what to do
  std::vector<Row> goal, spoon, hand;
  std::string hand_name;
};

// Settings of the mouse as a hand.
struct PressSettings {
  double strength_m = 0.004;  // depth of a press
};

inline constexpr Range<double> press_strength_range_m{0.0002, 0.02};

template <>
inline constexpr auto fields_of<PressSettings> = std::to_array<Field<PressSettings>>({
    number_field("strength_mm", &PressSettings::strength_m, press_strength_range_m, FieldUnit::metre)
        .with_slider({"Strength", {0.0005, 0.02}, true}),
});

// Contents of the panel, as plain data. Made once a frame from a snapshot and the settings; the panel has no
// access to the simulation.
struct PanelModel {
  std::string title;
  double time_s = 0.0;
  bool can_undo = false;
  bool can_redo = false;

  Tool tool;
  Sculpting sculpting;
  Material material;
  int region_count = 0;           // number of regions with a material or friction of their own
  std::vector<Material> presets;  // materials in the list of presets

  std::optional<PressSettings> press;  // empty where there is no mouse

  double inertia_scale = 1.0;
  double mass_kg = 0.0;        // mass of all bodies
  double volume_change = 0.0;  // by which strokes have changed the first body's volume, as a fraction
  int plane_count = 0;
  int fixed_node_count = 0;
  int node_count = 0;
  int unheld_count = 0;  // number of bodies without fixed nodes
  bool has_ground = false;

  double residual_m = 0.0;  // largest distance of a surface from the deformed lattice that it follows
  bool residual_is_at_limit = false;  // see ResidualSnapshot::is_at_limit
  int residual_body = 0;              // index in the scene of the body whose surface has this distance

  Overlays overlays;
  bool see_through_body = false;

  std::string device;
  double force_n = 0.0;
  double force_limit_n = 0.0;
  double rate_hz = 0.0;
  bool rate_is_nominal = true;  // true in lock-step, where no clock measures the rate
  int substeps = 0;
  std::uint32_t flags = tick_flag_none;
  std::optional<bool> force_on;    // whether the device's force is on; empty in a replay, which has no device
  std::string safety_text;         // reasons for a limited device force, one per line
  std::string drawing_text;        // details omitted from the picture
  std::optional<TrialRows> trial;  // only in frames of a trial
  std::optional<TaskRows> task;    // only while a task is trained
};

// Makes the panel's contents. `snapshot` must be of the same session and tick as `facts`. `view` has the
// settings with which the snapshot is drawn.
PanelModel make_panel_model(const SessionFacts& facts, const Snapshot& snapshot, const ViewSettings& view);

// Returns the area of the panel in a frame of this size and scale: at the left edge, below `top_px`. The area
// is empty if the frame is too small for a legible panel.
Rectangle panel_rectangle(int width_px, int height_px, double scale, double top_px = 0.0);

// Returns the area of the panel in a picture of this size. The area is empty if the whole panel does not fit,
// because a picture cannot be scrolled.
Rectangle picture_panel_rectangle(int width_px, int height_px);

// Returns the interface's scale for a frame of this height: 1 at 720 pixels or less, in steps of 0.5.
double panel_scale(int height_px);

// The user's requests of one frame. `refusal` is the reason why a value was rejected; it is empty if none
// was.
struct PanelAnswer {
  std::vector<Request> requests;
  std::string refusal;
  std::optional<PressSettings> press = {};  // new settings of the mouse
};

// Lays out the panel, between InterfaceContext::begin_frame() and end_frame().
PanelAnswer draw_panel(const PanelModel& model, const Theme& theme, const Rectangle& area_px);

}  // namespace spoonbill
