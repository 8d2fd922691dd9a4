#include "app/frames/painting_crew.h"

#include <condition_variable>
#include <deque>
#include <optional>
#include <thread>
#include <utility>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Fixed, whatever the machine: what a painter has drawn before must not depend on it.
constexpr std::size_t painter_count = 3;

// One being painted and one waiting, so that nobody waits for the owner.
constexpr std::size_t jobs_a_painter = 2;

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

  Result<PaintedFrame> take() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !done_.empty() || failure_; });
    if (done_.empty()) return *failure_;
    PaintedFrame frame = std::move(done_.front());
    done_.pop_front();
    return frame;
  }

 private:
  // Empty when it is time to stop.
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
      PaintedFrame frame{job->frame, job->snapshot.time_s(), {}, std::move(job->also_as)};
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
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::deque<PaintingJob> jobs_;
  std::deque<PaintedFrame> done_;
  std::optional<Error> failure_;
  bool stopping_ = false;
  std::thread thread_;  // last: it uses all of the above
};

PaintingCrew::PaintingCrew(int width_px, int height_px) {
  for (std::size_t i = 0; i < painter_count; ++i) {
    painters_.push_back(std::make_unique<Painter>(width_px, height_px, interface_turn_));
  }
}

PaintingCrew::~PaintingCrew() = default;

bool PaintingCrew::is_full() const {
  return started_ - taken_ >= painter_count * jobs_a_painter;
}

void PaintingCrew::start(PaintingJob job) {
  SPOONBILL_ASSERT(!is_full());
  painters_[started_++ % painter_count]->add(std::move(job));
}

Result<PaintedFrame> PaintingCrew::take() {
  SPOONBILL_ASSERT(taken_ < started_);
  return painters_[taken_++ % painter_count]->take();
}

}  // namespace spoonbill
