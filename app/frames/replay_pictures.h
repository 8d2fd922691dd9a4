// Files that a replay writes: requested documents and screenshots, numbered frames with a contact sheet, and
// a video.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/frames/frame_events.h"
#include "app/frames/frame_painter.h"
#include "app/session/session.h"
#include "engine/base/result.h"
#include "engine/base/unfinished_files.h"
#include "render/contact_sheet.h"
#include "render/image.h"

namespace spoonbill {

// Removes the marks (requests for files) from the session. Writes the requested documents into the folder and
// returns the names of the requested screenshots. The caller must write the next picture that it draws under
// these names. If there is no folder, writes nothing and returns no names.
Result<std::vector<std::string>> consume_marks(Session& session,
                                               const std::optional<std::filesystem::path>& folder);

// Writes picture-NAME.png into the folder.
Status write_marked_picture(const Image& picture, const std::string& name,
                            const std::filesystem::path& folder);

// Returns "frame-0042.png" for 42.
std::string frame_file_name(int number);

// Makes the folder if it is missing; otherwise removes the frames and the contact sheet of an earlier run
// from it. Other files are not changed. Returns an error with the folder's name if the folder cannot be made
// or written. Removes read-only files only if `replaces_read_only` is set; otherwise they are an error.
Status prepare_frame_folder(const std::filesystem::path& folder, bool replaces_read_only = false);

// Writes numbered frames as PNG files on its own thread, so that encoding does not delay drawing. One thread
// adds frames; the queue is bounded, and add() waits while it is full.
class FrameWriter {
 public:
  explicit FrameWriter(std::filesystem::path folder);
  ~FrameWriter();  // waits until all added frames are written
  FrameWriter(const FrameWriter&) = delete;
  FrameWriter& operator=(const FrameWriter&) = delete;

  // add() and finish() return the first failure of any frame so far. After a failure nothing more is written.
  Status add(int number, Image frame);
  Status finish();  // waits until all frames are on the disk; no frame may be added afterwards

 private:
  void write_frames();

  const std::filesystem::path folder_;
  std::mutex mutex_;  // guards the members that follow
  std::condition_variable changed_;
  std::deque<std::pair<int, Image>> queue_;
  bool finishing_ = false;
  Status failure_;
  std::thread thread_;  // declared last, because the thread uses all other members
};

// A video file that an ffmpeg process encodes from raw pictures. The complete file appears under its name in
// finish(), or not at all. Used by one thread. The program must ignore SIGPIPE (see main).
class VideoEncoder {
 public:
  // Returns true if ffmpeg is on the PATH.
  static bool available();

  // Starts ffmpeg. The file extension selects the format. The frame rate is rate_numerator / rate_denominator
  // frames per second.
  static Result<VideoEncoder> start(const std::filesystem::path& file, int width_px, int height_px,
                                    int rate_numerator, int rate_denominator);

  VideoEncoder(VideoEncoder&& other) noexcept;
  VideoEncoder& operator=(VideoEncoder&&) = delete;
  ~VideoEncoder();  // removes an unfinished video

  // Adds a picture of the size given to start().
  Status add(const Image& frame);
  Status finish();

 private:
  VideoEncoder(std::filesystem::path file, std::filesystem::path unfinished, pid_t process, int pipe);
  int close_and_wait();
  void remove_unfinished();

  std::filesystem::path file_;
  std::filesystem::path unfinished_;
  pid_t process_;  // process of ffmpeg; -1 when it does not run
  int pipe_;       // pipe to ffmpeg; -1 when it is closed
  UnfinishedFile ending_;
};

// Frames and files that a replay is to write.
struct PictureRequest {
  PictureSize size;
  std::uint64_t frame_count = 0;  // frames of the whole replay, 60 per second
  std::uint64_t every = 1;        // interval between drawn frames, in frames
  // Folder for the frames and the contact sheet. If empty, neither frames nor contact sheet are written.
  std::optional<std::filesystem::path> folder;
  std::optional<std::filesystem::path> video;
  bool replaces_read_only = false;  // if true, read-only files of earlier runs are replaced too
};

// Number of frames on a contact sheet.
inline constexpr std::size_t sheet_frame_count = 12;

// Writes the pictures of a replay. Used by one thread.
class ReplayPictures {
 public:
  // Prepares the folder and starts the video.
  static Result<ReplayPictures> start(const PictureRequest& request);

  // Chooses the frames of the contact sheet. Call before add().
  void choose_sheet(std::vector<SheetFrame> frames) { sheet_frames_ = std::move(frames); }

  // Adds frame number `frame`, a multiple of `every`.
  Status add(std::uint64_t frame, Image picture);

  // Waits until everything is written.
  Status finish();

  std::uint64_t count() const { return count_; }
  std::filesystem::path contact_sheet_file() const { return *request_.folder / "contact-sheet.png"; }

 private:
  ReplayPictures(PictureRequest request, std::optional<VideoEncoder> video);

  PictureRequest request_;
  std::unique_ptr<FrameWriter> frames_;  // null if there is no folder
  std::optional<VideoEncoder> video_;
  ContactSheet sheet_;
  std::vector<SheetFrame> sheet_frames_;
  std::uint64_t count_ = 0;
};

}  // namespace spoonbill
