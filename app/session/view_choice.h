// The view of a document or a recording, its JSON form, and the contact debug views:
//  "view": {"camera": {...}, "overlays": {"lattice": true, ...}, "see_through_body": false,
//           "ground_mm": -40}
//  {"command": "set_camera", ...}   {"command": "set_overlays", "lattice": true, ...}
//  {"command": "set_overlays", "contact_stage": "spheres", "sphere_level": 1}
// A contact stage is "none", "hulls", "spheres", "triangles" or "contacts". The sphere level ranges from 0,
// the coarsest, to 3. Camera fields, all optional: "yaw_deg", "pitch_deg", "field_of_view_deg", and
// "target_mm": [x, y, z] with "distance_mm". Without target and distance the whole body is shown. Overlays
// that are not named keep their state. "ground_mm" is ignored where the scene has a level ground; the default
// is the lowest point of the model. Unknown fields and values out of range are errors that name the field.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "engine/simulation/snapshot_stages.h"
#include "render/view_settings.h"

namespace spoonbill {

// Camera, overlays and ground of a view.
struct ViewChoice {
  Camera camera;
  bool shows_whole_body = true;  // true if target and distance are computed from the body
  Overlays overlays;
  bool see_through_body = false;
  std::optional<double> ground_y_m;  // height of the ground; default: see choose_ground_y_m()
  // Goal of a training session; null for other sessions. It is not part of the JSON.
  std::shared_ptr<const GoalMarks> goal = {};
};

// Reads a view. `source` names the file in messages. An empty object gives the defaults.
Result<ViewChoice> view_from_json(const Json& view, const std::string& source);

// Returns the JSON of a view, as stored in a document.
Json view_to_json(const ViewChoice& choice);

// camera_command() returns the command that sets the camera to that of the choice; overlays_command() returns
// the one that sets all overlays.
Json camera_command(const ViewChoice& choice);
Json overlays_command(const Overlays& overlays, bool see_through_body);

// Returns true if "command" names one of the view's commands.
bool is_view_command(const Json& command);

// Applies a view command to the choice. An error leaves the choice unchanged.
Status apply_view_command(const Json& command, const std::string& source, ViewChoice& choice);

// Camera and ground that all frames of a session have in common, so that neither moves as the model deforms.
struct Framing {
  Box box;  // shown by the camera unless the view has a target: the bodies at the start
  std::optional<double> scene_ground_y_m;  // see level_height_m()
  double lowest_y_m = 0.0;                 // lowest point of the bodies in all frames
};

// Returns the height at which the ground is drawn: that of the scene's ground if there is one, otherwise that
// of the view, otherwise the lowest point of the model.
double choose_ground_y_m(std::optional<double> scene_ground_y_m, std::optional<double> view_ground_y_m,
                         double lowest_y_m);

// Returns the settings for a frame of this size in which the model is beside a panel.
ViewSettings make_view_settings(const ViewChoice& choice, const Framing& framing, int width_px, int height_px,
                                const Rectangle& panel_px, double interface_scale);

// A contact debug view that the user can choose; each sphere level is one choice.
struct StageChoice {
  const char* name;
  ContactStage stage;
  int sphere_level;

  bool is_chosen(const Overlays& overlays) const {
    return overlays.contact_stage == stage &&
           (stage != ContactStage::spheres || overlays.sphere_level == sphere_level);
  }
  void choose(Overlays& overlays) const {
    overlays.contact_stage = stage;
    overlays.sphere_level = sphere_level;
  }
};

static_assert(finest_stage_level == 3);
inline constexpr std::array<StageChoice, 8> stage_choices = {{
    {"None", ContactStage::none, 0},
    {"Hulls", ContactStage::hulls, 0},
    {"Spheres, level 0", ContactStage::spheres, 0},
    {"Spheres, level 1", ContactStage::spheres, 1},
    {"Spheres, level 2", ContactStage::spheres, 2},
    {"Spheres, level 3", ContactStage::spheres, 3},
    {"Triangles", ContactStage::triangles, 0},
    {"Contact points", ContactStage::contacts, 0},
}};

// Computes the data of the contact debug views for the next frame, if such a view is shown. Used only by the
// thread that draws.
class StageFinder {
 public:
  // Stores the computed data in settings.stages, or sets it to null if no contact debug view is shown.
  void fill(const Snapshot& snapshot, ViewSettings& settings) {
    settings.stages = nullptr;
    if (settings.overlays.contact_stage == ContactStage::none) return;
    settings.stages = std::make_shared<const ContactStages>(finder_.find(snapshot));
  }

 private:
  SnapshotStages finder_;
};

}  // namespace spoonbill
