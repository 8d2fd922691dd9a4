#include "app/frames/replay_pictures.h"

#include <array>
#include <cstdio>
#include <utility>

#include "app/panel/font_file.h"
#include "app/session/lockstep.h"
#include "render/image.h"

namespace spoonbill {
namespace {

constexpr std::uint64_t sheet_cells = 12;

ContactSheetLayout sheet_layout() {
  ContactSheetLayout layout;
  layout.columns = 3;
  layout.cell_width_px = 480;
  layout.caption_px = 18;
  layout.caption_font_path = font_file;
  return layout;
}

std::string seconds_text(double time_s) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f s", time_s);
  return text.data();
}

}  // namespace

Result<ReplayPictures> ReplayPictures::start(const PictureRequest& request) {
  if (request.folder) {
    if (Status prepared = prepare_frame_folder(*request.folder); !prepared) return prepared.error();
  }
  std::optional<VideoEncoder> video;
  if (request.video) {
    auto started = VideoEncoder::start(*request.video, request.width_px, request.height_px,
                                       static_cast<int>(frames_per_second), static_cast<int>(request.every));
    if (!started) return started.error();
    video.emplace(std::move(started).value());
  }
  return ReplayPictures(request, std::move(video));
}

ReplayPictures::ReplayPictures(PictureRequest request, std::optional<VideoEncoder> video)
    : request_(std::move(request)), video_(std::move(video)), sheet_(sheet_layout()) {
  if (request_.folder) frames_ = std::make_unique<FrameWriter>(*request_.folder);
}

Status ReplayPictures::add(std::uint64_t frame, double time_s, Image picture) {
  if (video_) {
    if (Status added = video_->add(picture); !added) return added;
  }
  if (frames_) {
    if (belongs_on_sheet(count_)) sheet_.add(picture, seconds_text(time_s));
    if (Status added = frames_->add(static_cast<int>(frame), std::move(picture)); !added) return added;
  }
  ++count_;
  return {};
}

bool ReplayPictures::belongs_on_sheet(std::uint64_t index) const {
  const std::uint64_t drawn = (request_.frame_count + request_.every - 1) / request_.every;
  if (drawn <= sheet_cells) return true;
  // The first, the last, and the others evenly between.
  constexpr std::uint64_t steps = sheet_cells - 1;
  for (std::uint64_t cell = 0; cell <= steps; ++cell) {
    if (index == cell * (drawn - 1) / steps) return true;
  }
  return false;
}

Status ReplayPictures::finish() {
  if (video_) {
    if (Status finished = video_->finish(); !finished) return finished;
  }
  if (!frames_) return {};
  if (Status finished = frames_->finish(); !finished) return finished;
  const auto sheet = sheet_.compose();
  if (!sheet) return sheet.error();
  return write_png(contact_sheet_file(), sheet.value());
}

}  // namespace spoonbill
