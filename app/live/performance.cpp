#include "app/live/performance.h"

#include <chrono>
#include <thread>
#include <utility>

#include "app/frames/frame_painter.h"
#include "app/panel/panel.h"
#include "engine/base/geometry.h"
#include "haptic/virtual_device.h"
#include "render/gl/context.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr int width_px = 1280;
constexpr int height_px = 720;
constexpr std::chrono::microseconds picture_interval{16667};
constexpr std::chrono::seconds wait_limit{10};

// Draws frames offscreen into memory, as the window would.
class Painting {
 public:
  static Result<Painting> make(const LiveFrame& first) {
    retain_freed_memory();
    auto painter = FramePainter::make(width_px, height_px);
    if (!painter) return painter.error();
    return Painting(std::move(painter).value(),
                    Framing{framed_box(first.snapshot), level_height_m(first.facts.ground),
                            ground_below(drawn_bounds(first.snapshot))});
  }

  Status paint(const LiveFrame& frame, const ViewChoice& choice) {
    const ViewSettings view = frame_view(choice, framing_, {width_px, height_px, true});
    return painter_.paint(frame.snapshot, view, make_panel_model(frame.facts, frame.snapshot, view),
                          picture_);
  }

 private:
  Painting(FramePainter painter, const Framing& framing) : painter_(std::move(painter)), framing_(framing) {}
  FramePainter painter_;
  Framing framing_;
  Image picture_;
};

// Waits until a frame satisfies `done`. Returns an error if a notice reports a problem, or after 10 s.
template <class Done>
Status wait_until(LiveSession& live, Done done, const char* what) {
  const auto give_up = SteadyClock::now() + wait_limit;
  while (!done(live.frame())) {
    for (Notice& notice : live.consume_notices()) {
      if (notice.kind == Notice::Kind::problem) return Error{ErrorCode::unwritable, std::move(notice.text)};
    }
    if (SteadyClock::now() > give_up) {
      return Error{ErrorCode::unavailable, std::string(what) + " took longer than 10 s"};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {};
}

Status send_due_requests(const Script& script, std::uint64_t tick, std::size_t& next, LiveSession& live) {
  for (; next < script.commands.size() && script.commands[next].tick <= tick; ++next) {
    auto request = request_from_json(script.commands[next]);
    if (!request) return request.error();
    if (!live.ask(std::move(request).value())) {
      return Error{ErrorCode::too_many, "the command queue of the haptic thread is full"};
    }
  }
  return {};
}

Status play(const Script& script, LiveSession& live, TargetMailbox& mailbox, Painting* painting,
            const ViewChoice& view, const std::function<bool()>& interrupted, std::uint64_t& frames) {
  const auto begin = SteadyClock::now();
  std::size_t next = 0;
  for (auto at = begin; !interrupted(); at = std::max(at + picture_interval, SteadyClock::now())) {
    std::this_thread::sleep_until(at);
    const auto passed =
        std::chrono::duration_cast<std::chrono::milliseconds>(SteadyClock::now() - begin).count();
    const auto tick = static_cast<std::uint64_t>(passed);
    if (Status sent = send_due_requests(script, tick, next, live); !sent) return sent;
    if (tick >= script.tick_count()) break;
    mailbox.aim(script.target_at(tick));
    const LiveFrame& frame = live.frame();
    if (painting == nullptr) continue;
    if (Status painted = painting->paint(frame, view); !painted) return painted;
    ++frames;
  }
  return {};
}

}  // namespace

Result<PerformanceReport> perform(const Script& script, const Document& document, const std::string& source,
                                  const PerformanceSettings& settings,
                                  const std::function<bool()>& interrupted) {
  const auto view = view_from_json(document.view, source);
  if (!view) return view.error();
  auto device = SteeredDevice::make(script.hand, script.start);
  if (!device) return device.error();
  const std::shared_ptr<TargetMailbox> mailbox = device.value()->mailbox();
  auto live = LiveSession::start(document, source, settings.live, std::move(device).value());
  if (!live) return live.error();
  LiveSession& session = *live.value();
  std::vector<Notice> notices = session.consume_notices();
  session.start_recording(settings.recording, view.value(), settings.output);
  const auto recording = [](const LiveFrame& frame) { return frame.recording; };
  Status started = wait_until(session, recording, "starting the recording");
  if (!started) return started.error();
  std::optional<Painting> painting;
  if (settings.draw) {
    auto made = Painting::make(session.frame());
    if (!made) return made.error();
    painting.emplace(std::move(made).value());
  }
  PerformanceReport report;
  Status played = play(script, session, *mailbox, painting ? &*painting : nullptr, view.value(), interrupted,
                       report.frames);
  if (!played) return played.error();
  if (interrupted()) session.leave_recording_unpublished();
  session.stop_recording();
  const auto stopped = [](const LiveFrame& frame) { return !frame.recording; };
  if (Status ended = wait_until(session, stopped, "ending the recording"); !ended) return ended.error();
  session.stop();
  report.loop = session.figures();
  report.recorded = session.last_recording();
  std::string last_problem = "the recording is incomplete";
  for (Notice& notice : session.consume_notices()) {
    if (notice.kind == Notice::Kind::problem) last_problem = notice.text;
    notices.push_back(std::move(notice));
  }
  if (!session.is_last_recording_complete()) return Error{ErrorCode::unwritable, std::move(last_problem)};
  report.notices = std::move(notices);
  return report;
}

}  // namespace spoonbill
