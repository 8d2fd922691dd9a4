// Where a recording goes that may take the place of an older file: beside it, until it is whole.
#pragma once

#include <filesystem>

#include "engine/base/result.h"

namespace spoonbill {

class RecordingPlace {
 public:
  explicit RecordingPlace(std::filesystem::path file);

  // What to write: the file itself where there is none yet, and `file`.part beside an older one, which stays
  // as it is until commit(). A recording that was cut replays up to there under either name.
  const std::filesystem::path& written() const { return written_; }

  // The whole recording takes the older file's place.
  Status commit() const;

 private:
  std::filesystem::path file_, written_;
};

}  // namespace spoonbill
