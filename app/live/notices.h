// One-line messages for the person, from the threads that may wait: never the haptic one. Thread-safe.
#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace spoonbill {

struct Notice {
  enum class Kind { information, problem };
  Kind kind = Kind::information;
  std::string text;
};

class Notices {
 public:
  void add(Notice::Kind kind, std::string text) {
    const std::lock_guard lock(mutex_);
    all_.push_back({kind, std::move(text)});
  }

  // Those since the last call.
  std::vector<Notice> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(all_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<Notice> all_;
};

}  // namespace spoonbill
