#include "app/files/recording_place.h"

#include <system_error>
#include <utility>

namespace spoonbill {

RecordingPlace::RecordingPlace(std::filesystem::path file) : file_(std::move(file)), written_(file_) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file_, ignored)) written_ += ".part";
}

Status RecordingPlace::commit() const {
  if (written_ == file_) return {};
  std::error_code error;
  std::filesystem::rename(written_, file_, error);
  if (!error) return {};
  return Error{file_.string() + ": cannot be replaced (" + error.message() + "); the new recording is " +
               written_.string()};
}

}  // namespace spoonbill
