#include "app/frames/frame_painter.h"

#include <condition_variable>
#include <deque>
#include <optional>
#include <thread>
#include <utility>

#include "app/panel/interface_context.h"
#include "app/panel/panel.h"
#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "render/overlay/overlays.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

std::unique_lock<std::mutex> lock_interface(std::mutex* interface_turn) {
  return interface_turn != nullptr ? std::unique_lock(*interface_turn) : std::unique_lock<std::mutex>();
}

}  // namespace

Box framed_box(const Snapshot& start) {
  Box box;
  for (const BodySnapshot& body : start.bodies) {
    const SurfaceSnapshot& surface = body.surface;
    for (std::size_t i = 0; i < surface.x.size(); ++i) {
      box.include({surface.x[i], surface.y[i], surface.z[i]});
    }
    for (std::size_t i = 0; i < body.mesh.x.size(); ++i) {
      box.include({body.mesh.x[i], body.mesh.y[i], body.mesh.z[i]});
    }
  }
  return box;
}

Framing find_framing(const Scene& scene, const Snapshot& start) {
  return {framed_box(start), level_height_m(scene.ground), ground_below(drawn_bounds(start))};
}

ViewSettings frame_view(const ViewChoice& choice, const Framing& framing, const PictureSize& size) {
  const int width_px = size.width_px, height_px = size.height_px;
  const Rectangle panel_px = size.has_panel ? picture_panel_rectangle(width_px, height_px) : Rectangle{};
  ViewSettings view =
      make_view_settings(choice, framing, width_px, height_px, panel_px, interface_scale_for(height_px));
  view.keep_level = false;
  return view;
}

PaintingJob make_painting_job(std::uint64_t frame, const Session& session, const Framing& framing,
                              const PictureSize& size) {
  PaintingJob job;
  job.frame = frame;
  write_snapshot(session, job.snapshot);
  job.view = frame_view(session.view, framing, size);
  SessionFacts facts;
  write_facts(session, facts);
  job.panel = make_panel_model(facts, job.snapshot, job.view);
  return job;
}

Result<FramePainter> FramePainter::make(int width_px, int height_px, std::mutex* interface_turn) {
  const auto turn = lock_interface(interface_turn);
  auto context = OsmesaContext::make(width_px, height_px);
  if (!context) return context.error();
  auto interface = InterfaceContext::make(font_file, panel_scale(height_px));
  if (!interface) return interface.error();
  auto renderer = Renderer::make(*context.value());
  if (!renderer) return renderer.error();
  renderer->upload_fonts(interface->fonts());
  return FramePainter(std::move(context).value(), std::move(interface).value(), std::move(renderer).value(),
                      interface_turn);
}

FramePainter::~FramePainter() {
  if (!context_) return;  // nothing to destroy after a move
  const auto turn = lock_interface(interface_turn_);
  interface_.reset();
}

Status FramePainter::paint(const Snapshot& snapshot, const ViewSettings& view, const PanelModel& panel,
                           Image& image) {
  ViewSettings shown = view;
  stages_.fill(snapshot, shown);
  if (Status drawn = renderer_.draw(snapshot, shown, &lay_out(snapshot, shown, panel)); !drawn) return drawn;
  renderer_.read_pixels(image);
  return {};
}

const ImDrawData& FramePainter::lay_out(const Snapshot& snapshot, const ViewSettings& view,
                                        const PanelModel& panel) {
  const int width = context_->width_px();
  const int height = context_->height_px();
  const auto turn = lock_interface(interface_turn_);
  interface_->begin_frame(width, height);
  draw_labels(overlay_labels(snapshot, view, width, height), view, width, height,
              *interface_->theme().fonts.body, *ImGui::GetBackgroundDrawList());
  // Pictures have no input, so the answer of the panel is ignored.
  if (view.panel_px.width > 0.0) draw_panel(panel, interface_->theme(), view.panel_px);
  return interface_->end_frame();
}

namespace {

// Number of painters. It is the same on every machine, because it affects the pictures: each painter finds
// the sharp edges of a deforming mesh in the first shape that it draws.
constexpr std::size_t painter_count = 3;

// Jobs per painter: one in progress and one waiting.
constexpr std::size_t jobs_per_painter = 2;

}  // namespace

class PaintingCrew::Painter {
 public:
  Painter(int width_px, int height_px, std::mutex& interface_turn)
      : width_px_(width_px),
        height_px_(height_px),
        interface_turn_(interface_turn),
        thread_([this] { paint_jobs(); }) {}

  ~Painter() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      jobs_.clear();
      changed_.notify_all();
    }
    thread_.join();
  }

  void add(PaintingJob job) {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
    changed_.notify_all();
  }

  Result<PaintedFrame> receive() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !done_.empty() || failure_; });
    if (done_.empty()) return *failure_;
    PaintedFrame frame = std::move(done_.front());
    done_.pop_front();
    return frame;
  }

 private:
  // Waits for the next job. Returns nothing when the painter stops.
  std::optional<PaintingJob> next_job() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !jobs_.empty() || stopping_; });
    if (stopping_) return {};
    PaintingJob job = std::move(jobs_.front());
    jobs_.pop_front();
    return job;
  }

  void fail(Error error) {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(error);
    changed_.notify_all();
  }

  void paint_jobs() {
    auto painter = FramePainter::make(width_px_, height_px_, &interface_turn_);
    if (!painter) return fail(painter.error());
    while (auto job = next_job()) {
      PaintedFrame frame{job->frame, {}, std::move(job->extra_names), job->is_frame};
      const Status painted = painter->paint(job->snapshot, job->view, job->panel, frame.picture);
      if (!painted) return fail(painted.error());
      const std::lock_guard lock(mutex_);
      done_.push_back(std::move(frame));
      changed_.notify_all();
    }
  }

  const int width_px_;
  const int height_px_;
  std::mutex& interface_turn_;
  std::mutex mutex_;  // guards the members that follow
  std::condition_variable changed_;
  std::deque<PaintingJob> jobs_;
  std::deque<PaintedFrame> done_;
  std::optional<Error> failure_;
  bool stopping_ = false;
  std::thread thread_;  // declared last, because the thread uses all other members
};

PaintingCrew::PaintingCrew(int width_px, int height_px) {
  for (std::size_t i = 0; i < painter_count; ++i) {
    painters_.push_back(std::make_unique<Painter>(width_px, height_px, interface_turn_));
  }
}

PaintingCrew::~PaintingCrew() = default;

bool PaintingCrew::is_full() const {
  return started_ - received_ >= painter_count * jobs_per_painter;
}

void PaintingCrew::start(PaintingJob job) {
  SPOONBILL_ASSERT(!is_full());
  painters_[started_++ % painter_count]->add(std::move(job));
}

Result<PaintedFrame> PaintingCrew::receive() {
  SPOONBILL_ASSERT(received_ < started_);
  return painters_[received_++ % painter_count]->receive();
}

}  // namespace spoonbill
