#include "app/study/study_pictures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "app/files/shown_model.h"
#include "app/frames/frame_painter.h"
#include "app/frames/model_picture.h"
#include "app/study/case_trial.h"
#include "render/image.h"

namespace spoonbill {
namespace {

constexpr int width_px = 720, height_px = 450;
constexpr double azimuth_deg = -18.0, elevation_deg = 14.0;

std::string describe_end(const CaseResult& result) {
  std::string text = verdict_names[static_cast<std::size_t>(result.verdict)];
  if (result.side && result.verdict != Verdict::holds) {
    text += std::string(" over the ") + rim_side_names[static_cast<std::size_t>(*result.side)];
  }
  return text;
}

// Returns the bytes of the picture of a scene.
Result<std::string> paint(const Scene& scene, const std::string& source) {
  const auto shown = show_scene(scene, source);
  if (!shown) return shown.error();
  PictureSettings settings;
  settings.direction = {azimuth_deg * std::numbers::pi / 180.0, elevation_deg * std::numbers::pi / 180.0};
  settings.width_px = width_px;
  settings.height_px = height_px;
  auto painter = FramePainter::make(width_px, height_px);
  if (!painter) return painter.error();
  Image image;
  const ViewSettings view = make_picture_view(shown.value(), settings);
  if (Status painted = painter->paint(shown->snapshot, view, {}, image); !painted) return painted.error();
  PngEncoder encoder;
  const auto bytes = encoder.encode(image);
  if (!bytes) return bytes.error();
  return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

}  // namespace

std::vector<StudyCase> list_pictured_cases(const StudyPlan& plan) {
  std::vector<StudyCase> cases;
  for (const StudySpoon& spoon : plan.spoons) {
    for (const double tilt : plan.frame_tilts_deg) {
      StudyCase& one = cases.emplace_back();
      one.spoon = spoon.name;
      one.food = plan.foods.front().name;
      one.friction = plan.usual_friction;
      one.tilt_deg = tilt;
    }
  }
  return cases;
}

Result<StudyPicture> make_study_picture(const StudyPlan& plan, const StudyCase& study_case,
                                        const std::function<bool()>& is_stopped) {
  Scene end;
  const auto result = run_case(
      plan, study_case, [&](const Trial&, const Simulation&) { return !is_stopped(); }, &end);
  if (!result) return result.error();
  StudyPicture picture{study_case, {}, {}};
  if (!result->failure.empty()) {
    picture.verdict = "not judged: " + result->failure;
    return picture;
  }
  picture.verdict = describe_end(result.value());
  auto png = paint(end, study_case.spoon);
  if (png) {
    picture.png = std::move(png).value();
  } else {
    picture.verdict += ", without a picture: " + png.error().message;
  }
  return picture;
}

}  // namespace spoonbill
