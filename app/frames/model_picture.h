// Pictures of models that are not simulated: views, and the settings with which they are drawn.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "app/files/shown_model.h"
#include "engine/base/result.h"
#include "engine/scene/material.h"
#include "render/view_settings.h"

namespace spoonbill {

// Direction from which a picture shows a model, in radians (see Camera).
struct ViewDirection {
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
};

// Default direction: three quarters from the right, from above.
ViewDirection default_view_direction();

// Parses the name of a standard view, such as "front", or azimuth and elevation in degrees: "30,20". The
// azimuth turns the eye to the right around the model, the elevation raises it.
Result<ViewDirection> parse_view_direction(std::string_view text);

// A studio, turned about the vertical.
struct StudioChoice {
  Studio studio = studios().front();
  double turn_rad = 0.0;
};

// Parses the name of a studio, and degrees by which it is turned: "dark,30".
Result<StudioChoice> parse_studio(std::string_view text);
// Returns the names of all studios, separated by commas.
std::string list_studios();

// Parses the names of overlays, such as "grid,net". Without a name nothing but the model is shown.
Result<Overlays> parse_picture_overlays(std::string_view text);

// Returns overlays that are all switched off.
Overlays no_overlays();

// Puts the bodies of several models into one, as they are. The ground is that of the first model with one,
// the tool that of the first model.
ShownModel join_models(std::span<const ShownModel> models);

// Lets all bodies look like the material of this name.
void show_material(const std::string& name, ShownModel& model);

// Puts the tool onto the highest point of the model.
void rest_tool_on_top(ShownModel& model);

struct PictureSettings {
  ViewDirection direction = default_view_direction();
  Overlays overlays = no_overlays();
  StudioChoice studio;
  bool is_transparent = false;
  int width_px = 1280, height_px = 720;
};

// Returns the settings that show the whole model. It stands on the level ground of its document, or on a
// ground at its lowest point.
ViewSettings make_picture_view(const ShownModel& model, const PictureSettings& picture);
// Returns the settings of `count` pictures in which the model turns once, at the same distance.
std::vector<ViewSettings> make_turntable(const ShownModel& model, const PictureSettings& picture, int count);

}  // namespace spoonbill
