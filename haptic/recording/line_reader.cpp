#include "haptic/recording/line_reader.h"

#include <istream>
#include <utility>

namespace spoonbill {

namespace {

constexpr std::size_t chunk_bytes = std::size_t{64} << 10;

std::string readable_size(std::size_t bytes) {
  return bytes >= (std::size_t{1} << 20) ? std::to_string(bytes >> 20) + " MiB"
                                         : std::to_string(bytes >> 10) + " KiB";
}

}  // namespace

LineReader::LineReader(std::istream& in, std::string source, std::size_t bytes_limit)
    : in_(in), source_(std::move(source)), bytes_limit_(bytes_limit) {}

bool LineReader::fill() {
  buffer_.erase(0, start_);
  start_ = 0;
  const std::size_t kept = buffer_.size();
  buffer_.resize(kept + chunk_bytes);
  in_.read(buffer_.data() + kept, static_cast<std::streamsize>(chunk_bytes));
  const auto count = static_cast<std::size_t>(in_.gcount());
  buffer_.resize(kept + count);
  bytes_read_ += count;
  return count > 0;
}

Error LineReader::too_long(const std::string& what, std::size_t limit) const {
  return Error{source_ + ": " + what + " is longer than " + readable_size(limit)};
}

Result<std::optional<Line>> LineReader::next(std::size_t line_bytes_limit) {
  std::size_t searched = 0;  // bytes of this line known to hold no newline
  for (;;) {
    const std::size_t newline = buffer_.find('\n', start_ + searched);
    const std::size_t length = (newline == std::string::npos ? buffer_.size() : newline) - start_;
    if (length >= line_bytes_limit) return too_long("line " + std::to_string(number_ + 1), line_bytes_limit);
    const std::string_view text = std::string_view(buffer_).substr(start_, length);
    if (newline != std::string::npos) {
      start_ = newline + 1;
      return std::optional(Line{text, ++number_, true});
    }
    searched = length;
    if (fill()) {
      if (bytes_read_ > bytes_limit_) return too_long("the file", bytes_limit_);
      continue;
    }
    if (in_.bad()) return Error{source_ + ": line " + std::to_string(number_ + 1) + " cannot be read"};
    if (buffer_.empty()) return std::optional<Line>();
    start_ = buffer_.size();
    return std::optional(Line{buffer_, ++number_, false});
  }
}

}  // namespace spoonbill
