#include "render/frame_budget.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace spoonbill {
namespace {

// A late frame counts two, one in time takes one back: more than a third of the frames late, for a while,
// lowers the quality.
constexpr int late_weight = 2;
constexpr int late_limit = 12;

// What the next better quality costs beside this one, at most: samples and shadow add half to double, fine
// tessellation less. There is room for it when this one takes no more than the share of the frame.
constexpr std::array<double, 4> roomy_share = {0.0, 0.45, 0.65, 0.65};

constexpr int least_patience_frames = 120;  // two seconds, as at the start
constexpr int most_patience_frames = 7200;  // two minutes
constexpr int trial_frames = 120;           // a quality that holds this long has proved itself

constexpr double coarse_detail = 0.5;

FrameQuality neighbour(FrameQuality quality, int step) {
  return static_cast<FrameQuality>(static_cast<int>(quality) + step);
}

}  // namespace

void FrameBudget::add_frame(double took_s) {
  ++frames_here_;
  if (frames_here_ == trial_frames && on_trial_) {
    on_trial_ = false;
    patience_frames_ = least_patience_frames;
  }
  const bool late = !(took_s <= frame_s_);
  late_frames_ = late ? late_frames_ + late_weight : std::max(0, late_frames_ - 1);
  if (late_frames_ >= late_limit && quality_ != FrameQuality::coarse) {
    if (on_trial_) patience_frames_ = std::min(2 * patience_frames_, most_patience_frames);
    on_trial_ = false;
    change(neighbour(quality_, +1));
    return;
  }
  late_frames_ = std::min(late_frames_, late_limit);
  look_for_room(took_s);
}

void FrameBudget::look_for_room(double took_s) {
  if (quality_ == FrameQuality::full) return;
  const bool roomy = took_s <= roomy_share[static_cast<std::size_t>(quality_)] * frame_s_;
  // One slow frame among many says little; it takes back more than one of the others gives.
  constexpr int lost_by_one = 10;
  roomy_frames_ = roomy ? roomy_frames_ + 1 : std::max(0, roomy_frames_ - lost_by_one);
  if (roomy_frames_ < patience_frames_) return;
  change(neighbour(quality_, -1));
  on_trial_ = true;
}

void FrameBudget::change(FrameQuality quality) {
  quality_ = quality;
  late_frames_ = roomy_frames_ = frames_here_ = 0;
}

void FrameBudget::apply(ViewSettings& settings) const {
  if (quality_ >= FrameQuality::no_samples) settings.samples = 0;
  if (quality_ >= FrameQuality::no_shadow) settings.shadow = false;
  if (quality_ >= FrameQuality::coarse) settings.detail = std::min(settings.detail, coarse_detail);
}

std::string FrameBudget::text() const {
  std::string missing;
  switch (quality_) {
    case FrameQuality::full:
      return {};
    case FrameQuality::no_samples:
      missing = "without antialiasing";
      break;
    case FrameQuality::no_shadow:
      missing = "without antialiasing and shadow";
      break;
    case FrameQuality::coarse:
      missing = "coarser, without antialiasing and shadow";
      break;
  }
  return "drawing " + missing + " to hold " + std::to_string(std::lround(1.0 / frame_s_)) + " Hz";
}

}  // namespace spoonbill
