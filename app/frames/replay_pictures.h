// What a replay leaves behind to look at: numbered frames and a contact sheet in a folder, and a video. One
// owner, one thread.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "app/frames/frame_writer.h"
#include "app/frames/video_encoder.h"
#include "engine/base/result.h"
#include "render/contact_sheet.h"

namespace spoonbill {

struct PictureRequest {
  int width_px = 0;
  int height_px = 0;
  std::uint64_t frame_count = 0;                // of the whole replay, 60 for each second
  std::uint64_t every = 1;                      // only each so many-th of them is drawn
  std::optional<std::filesystem::path> folder;  // of frames and contact sheet
  std::optional<std::filesystem::path> video;
};

class ReplayPictures {
 public:
  // Prepares the folder and starts the video.
  static Result<ReplayPictures> start(const PictureRequest& request);

  // Frame number `frame`, a multiple of `every`, shown at `time_s`.
  Status add(std::uint64_t frame, double time_s, Image picture);

  // Waits until everything is written.
  Status finish();

  std::uint64_t count() const { return count_; }
  std::filesystem::path contact_sheet_file() const { return *request_.folder / "contact-sheet.png"; }

 private:
  ReplayPictures(PictureRequest request, std::optional<VideoEncoder> video);
  bool belongs_on_sheet(std::uint64_t index) const;

  PictureRequest request_;
  std::unique_ptr<FrameWriter> frames_;  // none without a folder
  std::optional<VideoEncoder> video_;
  ContactSheet sheet_;
  std::uint64_t count_ = 0;
};

}  // namespace spoonbill
