#include "engine/base/unfinished_files.h"

#include <unistd.h>

#include <map>
#include <mutex>
#include <utility>

namespace spoonbill {
namespace {

struct UnfinishedList {
  std::mutex mutex;
  std::uint64_t last_number = 0;
  std::map<std::uint64_t, UnfinishedFile::Ending> endings;
};

// Returns the process's list of unfinished files. The list is never destroyed, because other threads may
// still finish files while the process exits.
UnfinishedList& unfinished_list() {
  static auto* const list = new UnfinishedList;
  return *list;
}

UnfinishedFile::Ending removal_of(std::filesystem::path file) {
  return [file = std::move(file)] {
    ::unlink(file.c_str());
    return std::string();
  };
}

}  // namespace

UnfinishedFile::UnfinishedFile(std::filesystem::path file) : UnfinishedFile(removal_of(std::move(file))) {}

UnfinishedFile::UnfinishedFile(Ending ending) {
  UnfinishedList& list = unfinished_list();
  const std::lock_guard lock(list.mutex);
  number_ = ++list.last_number;
  list.endings.emplace(number_, std::move(ending));
}

UnfinishedFile::UnfinishedFile(UnfinishedFile&& other) noexcept : number_(std::exchange(other.number_, 0)) {}

UnfinishedFile& UnfinishedFile::operator=(UnfinishedFile&& other) noexcept {
  std::swap(number_, other.number_);
  return *this;
}

UnfinishedFile::~UnfinishedFile() {
  if (number_ == 0) return;
  UnfinishedList& list = unfinished_list();
  const std::lock_guard lock(list.mutex);
  list.endings.erase(number_);
}

std::vector<std::string> end_unfinished_files() {
  UnfinishedList& list = unfinished_list();
  list.mutex.lock();  // never unlocked, because the process is about to end
  std::vector<std::string> lines;
  for (const auto& [number, ending] : list.endings) {
    if (std::string line = ending(); !line.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace spoonbill
