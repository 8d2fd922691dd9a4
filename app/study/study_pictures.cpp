#include "app/study/study_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "app/files/shown_model.h"
#include "app/frames/frame_painter.h"
#include "app/frames/model_picture.h"
#include "app/frames/replay_pictures.h"
#include "app/study/case_trial.h"
#include "engine/base/file.h"
#include "render/image.h"

namespace spoonbill {
namespace {

constexpr std::uint64_t ticks_a_frame = 50;
constexpr int video_frames_per_s = 20;  // at a millisecond a tick
constexpr std::size_t video_limit_bytes = std::size_t{1} << 26;
constexpr int width_px = 720, height_px = 450;
constexpr double azimuth_deg = -18.0, elevation_deg = 14.0;

std::string describe_end(const CaseResult& result) {
  std::string text = verdict_names[static_cast<std::size_t>(result.verdict)];
  if (result.side && result.verdict != Verdict::holds) {
    text += std::string(" over the ") + rim_side_names[static_cast<std::size_t>(*result.side)];
  }
  return text;
}

ViewSettings view_of(const ShownModel& model) {
  PictureSettings settings;
  settings.direction = {azimuth_deg * std::numbers::pi / 180.0, elevation_deg * std::numbers::pi / 180.0};
  settings.width_px = width_px;
  settings.height_px = height_px;
  return make_picture_view(model, settings);
}

// Returns the bytes of the picture of a scene.
Result<std::string> paint(const Scene& scene, const std::string& source) {
  const auto shown = show_scene(scene, source);
  if (!shown) return shown.error();
  auto painter = FramePainter::make(width_px, height_px);
  if (!painter) return painter.error();
  Image image;
  if (Status painted = painter->paint(shown->snapshot, view_of(shown.value()), {}, image); !painted) {
    return painted.error();
  }
  PngEncoder encoder;
  const auto bytes = encoder.encode(image);
  if (!bytes) return bytes.error();
  return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

// Encodes the scenes of a case from one point of view that shows the first and the last. Returns the bytes of
// the file.
Result<std::string> encode_video(const std::vector<ShownModel>& models, const std::filesystem::path& file) {
  if (models.empty()) return Error{ErrorCode::missing, "the case has no scenes"};
  const ShownModel ends[] = {models.front(), models.back()};
  const ViewSettings view = view_of(join_models(ends));
  auto painter = FramePainter::make(width_px, height_px);
  if (!painter) return painter.error();
  auto encoder = VideoEncoder::start(file, width_px, height_px, video_frames_per_s, 1);
  if (!encoder) return encoder.error();
  Image image;
  for (const ShownModel& model : models) {
    if (Status painted = painter->paint(model.snapshot, view, {}, image); !painted) return painted.error();
    if (Status added = encoder->add(image); !added) return added.error();
  }
  if (Status finished = encoder->finish(); !finished) return finished.error();
  return read_file(file, video_limit_bytes);
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
                                        const std::filesystem::path& video,
                                        const std::function<bool()>& is_stopped) {
  const bool is_filmed = !video.empty() && VideoEncoder::available();
  Scene end;
  std::vector<ShownModel> film;
  const auto watch = [&](const Trial&, const Simulation& simulation) {
    if (is_filmed && simulation.tick() % ticks_a_frame == 0) {
      Scene scene = simulation.scene();
      simulation.write_scene(scene);
      if (auto shown = show_scene(scene, study_case.spoon)) film.push_back(std::move(shown).value());
    }
    return !is_stopped();
  };
  const auto result = run_case(plan, study_case, watch, &end);
  if (!result) return result.error();
  StudyPicture picture{study_case, {}, {}, {}};
  if (!is_judged(result.value())) {
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
  if (is_filmed) {
    if (auto bytes = encode_video(film, video)) picture.video = std::move(bytes).value();
  }
  return picture;
}

}  // namespace spoonbill
