// How a document or a recording wants its scene looked at, and the JSON for it:
//   "view": {"camera": {...}, "overlays": {"lattice": true, ...}, "see_through_body": false, "ground_mm":
//   -40}
//   {"command": "set_camera", ...}   {"command": "set_overlays", "lattice": true, ...}
//   {"command": "set_overlays", "contact_stage": "spheres", "sphere_level": 1}
// A contact stage is "none", "hulls", "spheres", "triangles" or "contacts"; the level, from 0, the coarsest,
// to 3, is that of the spheres. Camera fields, all optional: "yaw_deg", "pitch_deg", "field_of_view_deg", and
// "target_mm": [x, y, z] with "distance_mm"; without these two the whole body is shown. Overlays that are not
// named stay as they are. The ground lies just below the body unless its height is given, for bodies that
// will be bent further down. Unknown fields and values out of range are refused by name.
#pragma once

#include <optional>
#include <string>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"
#include "render/view_settings.h"

namespace spoonbill {

struct ViewChoice {
  Camera camera;
  bool shows_whole_body = true;  // the camera's target and distance follow from the body
  Overlays overlays;
  bool see_through_body = false;
  std::optional<double> ground_y_m;  // none: just below the body
};

// `source` names the file in messages. An empty object gives the defaults.
Result<ViewChoice> view_from_json(const Json& view, const std::string& source);

// The inverse, as a document keeps it.
Json view_to_json(const ViewChoice& choice);

// The commands that set a camera, or all overlays, as they are in the choice.
Json camera_command(const ViewChoice& choice);
Json overlays_command(const Overlays& overlays, bool see_through_body);

// Whether "command" names one of the view's commands.
bool is_view_command(const Json& command);

// On an error the choice is as it was.
Status apply_view_command(const Json& command, const std::string& source, ViewChoice& choice);

// The settings to draw a frame of that size with, beside a panel. `body` is the model as it was at the start,
// so that neither the camera nor the ground moves with its deformation.
ViewSettings settings_for(const ViewChoice& choice, const Box& body, int width_px, int height_px,
                          const Rectangle& panel_px, double interface_scale);

}  // namespace spoonbill
