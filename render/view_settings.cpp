#include "render/view_settings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/geometry.h"

namespace spoonbill {

namespace {

// A late frame adds 2 to the count of late frames, a punctual frame subtracts 1. The quality is lowered if
// more than a third of the frames are late for a while.
constexpr int late_weight = 2;
constexpr int late_limit = 12;

// A frame has spare capacity if its time is at most this fraction of the available time. Entry i is for the
// quality with number i. Multisampling and shadows multiply the time of a frame by 1.5 to 2 each, and the
// full resolution by up to 3; the others multiply it by less.
constexpr std::array<double, 6> spare_fraction = {0.0, 0.65, 0.65, 0.45, 0.65, 0.35};

constexpr int minimum_patience_frames = 120;   // two seconds; the initial value
constexpr int maximum_patience_frames = 7200;  // two minutes
constexpr int trial_frames = 120;              // a quality sustained for this long is accepted

constexpr double coarse_detail = 0.5, coarse_resolution = 0.5;

FrameQuality neighbour(FrameQuality quality, int step) {
  return static_cast<FrameQuality>(static_cast<int>(quality) + step);
}

}  // namespace

double interface_scale_for(int height_px) {
  constexpr double reference_height_px = 720.0;
  return std::max(1.0, height_px / reference_height_px);
}

double ground_below(const Box& model) {
  return model.is_empty() ? 0.0 : model.low.y();
}

void FrameBudget::add_frame(double took_s) {
  if (is_fixed_) return;
  ++frames_since_change_;
  if (frames_since_change_ == trial_frames && on_trial_) {
    on_trial_ = false;
    patience_frames_ = minimum_patience_frames;
  }
  const bool late = !(took_s <= frame_s_);
  late_frames_ = late ? late_frames_ + late_weight : std::max(0, late_frames_ - 1);
  if (late_frames_ >= late_limit && quality_ != FrameQuality::coarse) {
    if (on_trial_) patience_frames_ = std::min(2 * patience_frames_, maximum_patience_frames);
    on_trial_ = false;
    change(neighbour(quality_, +1));
    return;
  }
  late_frames_ = std::min(late_frames_, late_limit);
  consider_raising(took_s);
}

void FrameBudget::consider_raising(double took_s) {
  if (quality_ == FrameQuality::full) return;
  const bool spare = took_s <= spare_fraction[static_cast<std::size_t>(quality_)] * frame_s_;
  // Number of fast frames that one slow frame cancels. A slow frame does not cancel all of them: one among
  // many fast frames does not show that the machine is too slow.
  constexpr int slow_frame_penalty = 10;
  spare_frames_ = spare ? spare_frames_ + 1 : std::max(0, spare_frames_ - slow_frame_penalty);
  if (spare_frames_ < patience_frames_) return;
  change(neighbour(quality_, -1));
  on_trial_ = true;
}

void FrameBudget::change(FrameQuality quality) {
  quality_ = quality;
  late_frames_ = spare_frames_ = frames_since_change_ = 0;
}

void FrameBudget::apply(ViewSettings& settings) const {
  if (quality_ >= FrameQuality::no_occlusion) settings.occlusion = false;
  if (quality_ >= FrameQuality::no_reflections) settings.reflections = false;
  if (quality_ >= FrameQuality::no_samples) settings.samples = 0;
  if (quality_ >= FrameQuality::no_shadow) settings.shadow = false;
  if (quality_ < FrameQuality::coarse) return;
  settings.detail = std::min(settings.detail, coarse_detail);
  settings.resolution = std::min(settings.resolution, coarse_resolution);
}

std::string FrameBudget::text() const {
  static constexpr std::array<const char*, 5> omitted = {"occlusion", "reflections", "antialiasing", "shadow",
                                                         "detail"};
  const auto count = static_cast<std::size_t>(quality_);
  if (count == 0) return {};
  std::string list;
  for (std::size_t i = 0; i < count; ++i) {
    list += (i == 0 ? "" : i + 1 == count ? " and " : ", ") + std::string(omitted[i]);
  }
  return "drawing without " + list +
         (!is_fixed_ && (quality_ != FrameQuality::coarse || late_frames_ == 0)
              ? " to hold " + std::to_string(std::lround(1.0 / frame_s_)) + " Hz"
              : "");
}

}  // namespace spoonbill
