#include "app/live/session_worker.h"

#include <exception>
#include <string>
#include <utility>

namespace spoonbill {
namespace {

// What the standard library throws, for want of memory above all, ends here: the thread must live on.
Status do_work(LiveCommand& command, LentSession& lent) {
  try {
    if (auto* asked = std::get_if<AskedRequest>(&command)) {
      return apply_request(*lent.session, asked->request);
    }
    if (auto* asked = std::get_if<AskedWork>(&command)) return asked->work(lent);
  } catch (const std::exception& exception) {
    return Error{std::string("not done: ") + exception.what()};
  }
  return {};
}

}  // namespace

SessionWorker::SessionWorker(Notices& notices) : notices_(&notices), thread_([this] { run(); }) {}

SessionWorker::~SessionWorker() {
  stopping_.store(true, std::memory_order_release);
  asked_.release();
  thread_.join();
}

void SessionWorker::lend(LentSession lent, LiveCommand work) {
  lent_ = std::move(lent);
  work_ = std::move(work);
  finished_.store(false, std::memory_order_relaxed);
  asked_.release();
}

bool SessionWorker::take_back(LentSession& lent, LiveCommand& work, bool& done) {
  if (!finished_.exchange(false, std::memory_order_acquire)) return false;
  lent = std::move(lent_);
  work = std::move(work_);
  done = done_;
  return true;
}

void SessionWorker::run() {
  while (true) {
    asked_.acquire();
    if (stopping_.load(std::memory_order_acquire)) return;
    const Status status = do_work(work_, lent_);
    if (!status) notices_->add(Notice::Kind::problem, status.error().message);
    done_ = status.ok();
    finished_.store(true, std::memory_order_release);
  }
}

}  // namespace spoonbill
