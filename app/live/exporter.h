// Writes bodies for other programs, as CAD files and meshes, on a thread of its own, so that neither
// autosaving nor drawing waits for it.
#pragma once

#include <atomic>
#include <filesystem>
#include <thread>
#include <vector>

#include "app/live/notices.h"
#include "engine/scene/scene.h"

namespace spoonbill {

// One owner; begin() by one thread.
class Exporter {
 public:
  // The notices must outlive it.
  explicit Exporter(Notices& notices) : notices_(&notices) {}
  ~Exporter();  // what is under way is left off, and an older file of that name stays
  Exporter(const Exporter&) = delete;
  Exporter& operator=(const Exporter&) = delete;

  // Whether the ending of the file's name is one of those that are exported to.
  static bool writes(const std::filesystem::path& file);
  static const char* endings_text();

  // Says when it is done or why not; refused, by a notice too, while another is under way.
  void begin(std::vector<Body> bodies, std::filesystem::path file);

 private:
  void run(std::vector<Body> bodies, const std::filesystem::path& file);

  Notices* notices_;
  std::atomic<bool> busy_{false}, stopping_{false};
  std::thread thread_;
};

}  // namespace spoonbill
