// Offscreen painting of snapshots with the panel beside them: by one painter, or by a crew of painters on
// threads.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/panel/interface_context.h"
#include "app/panel/panel.h"
#include "app/session/session.h"
#include "app/session/view_choice.h"
#include "engine/base/geometry.h"
#include "render/gl/context.h"
#include "render/image.h"
#include "render/renderer.h"

namespace spoonbill {

// Returns the box around all control nets and meshes of a snapshot.
Box framed_box(const Snapshot& start);

// Returns the framing of a scene whose bodies do not move below where they are in `start`.
Framing find_framing(const Scene& scene, const Snapshot& start);

struct PictureSize {
  int width_px = 0;
  int height_px = 0;
  bool has_panel = false;  // whether a part of the picture is for the panel
};

// Returns the settings for drawing the chosen view in a frame. With these settings, the tessellation of a
// frame does not depend on earlier frames.
ViewSettings frame_view(const ViewChoice& choice, const Framing& framing, const PictureSize& size);

// Paints snapshots into images. A painter must be used on the thread that made it.
class FramePainter {
 public:
  // Makes a painter with its own GL context. Dear ImGui has one current context per process, so painters on
  // several threads share the mutex `interface_turn`, which each painter locks while it lays out its
  // interface. A single painter needs no mutex.
  static Result<FramePainter> make(int width_px, int height_px, std::mutex* interface_turn = nullptr);

  FramePainter(FramePainter&&) noexcept = default;
  FramePainter& operator=(FramePainter&&) = delete;
  ~FramePainter();

  // Paints one frame, with the panel if the view has room for it.
  Status paint(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel, Image& image);

 private:
  FramePainter(std::unique_ptr<OsmesaContext> context, InterfaceContext interface, Renderer renderer,
               std::mutex* interface_turn)
      : context_(std::move(context)),
        interface_(std::move(interface)),
        renderer_(std::move(renderer)),
        interface_turn_(interface_turn) {}
  const ImDrawData& lay_out(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel);

  std::unique_ptr<OsmesaContext> context_;
  std::optional<InterfaceContext> interface_;  // empty only while the painter is destroyed
  Renderer renderer_;                          // declared after the context, which must outlive it
  std::mutex* interface_turn_;
  StageFinder stages_;
};

// Everything that a frame shows, copied so that the session can continue.
struct PaintingJob {
  std::uint64_t frame = 0;
  Snapshot snapshot;
  ViewSettings view;
  PanelModel panel;
  std::vector<std::string> extra_names;  // names of further files that get a copy of this picture
  bool is_frame = true;  // false if the picture is painted only for the files of `extra_names`
};

// Returns the job that paints the session's current state in a frame of this size.
PaintingJob make_painting_job(std::uint64_t frame, const Session& session, const Framing& framing,
                              const PictureSize& size);

// A painted frame.
struct PaintedFrame {
  std::uint64_t frame = 0;
  Image picture;
  std::vector<std::string> extra_names;
  bool is_frame = true;
};

// Paints frames on several threads while the owner prepares the next ones. Frames are assigned to the
// painters in a fixed order, so that the result is the same on any machine. Used by one thread, as follows:
//
//  while (more) {
//    if (crew.is_full()) use(crew.receive());
//    crew.start(job);
//  }
//  while (crew.in_flight() > 0) use(crew.receive());
class PaintingCrew {
 public:
  PaintingCrew(int width_px, int height_px);
  ~PaintingCrew();  // discards frames that were not received
  PaintingCrew(const PaintingCrew&) = delete;
  PaintingCrew& operator=(const PaintingCrew&) = delete;

  bool is_full() const;
  int in_flight() const { return static_cast<int>(started_ - received_); }

  // Queues a job. The crew must not be full.
  void start(PaintingJob job);

  // Waits for the oldest frame in progress; there must be one. After an error of a painter the crew is
  // unusable.
  Result<PaintedFrame> receive();

 private:
  class Painter;

  std::mutex interface_turn_;  // shared by the painters, see FramePainter::make()
  std::vector<std::unique_ptr<Painter>> painters_;
  std::uint64_t started_ = 0;
  std::uint64_t received_ = 0;
};

}  // namespace spoonbill
