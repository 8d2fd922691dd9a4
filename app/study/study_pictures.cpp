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
#include "engine/base/text.h"
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

// Keeps letters, digits, - and _ of a name; each other character becomes -.
std::string file_name_part(std::string name) {
  for (char& letter : name) {
    const bool is_plain = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                          (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
    if (!is_plain) letter = '-';
  }
  return name;
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
  if (!result->failure.empty()) return Error{ErrorCode::not_converged, result->failure};
  const auto shown = show_scene(end, study_case.spoon);
  if (!shown) return shown.error();
  PictureSettings settings;
  settings.direction = {azimuth_deg * std::numbers::pi / 180.0, elevation_deg * std::numbers::pi / 180.0};
  settings.width_px = width_px;
  settings.height_px = height_px;
  auto painter = FramePainter::make(width_px, height_px);
  if (!painter) return painter.error();
  Image image;
  if (Status painted = painter->paint(shown->snapshot, make_picture_view(shown.value(), settings), {}, image);
      !painted) {
    return painted.error();
  }
  PngEncoder encoder;
  const auto bytes = encoder.encode(image);
  if (!bytes) return bytes.error();
  StudyPicture picture{study_case,
                       describe_end(result.value()),
                       std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size()),
                       {}};
  picture.file = file_name_part(study_case.spoon) + "-tilt" + number_text(study_case.tilt_deg) + ".png";
  return picture;
}

}  // namespace spoonbill
