// Lines of a stream, each and all together of limited length, so that no file can exhaust the memory.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

struct Line {
  std::string_view text;    // without its newline; valid until the next line is asked for
  std::size_t number = 0;   // from 1
  bool terminated = false;  // false for a last line without a newline
};

// Borrows the stream. One owner.
class LineReader {
 public:
  LineReader(std::istream& in, std::string source, std::size_t bytes_limit);

  // Nothing at the end of the stream. Refused: a longer line, a stream longer than the limit, a reading
  // error.
  Result<std::optional<Line>> next(std::size_t line_bytes_limit);

 private:
  bool fill();
  Error too_long(const std::string& what, std::size_t limit) const;

  std::istream& in_;
  std::string source_;
  std::size_t bytes_limit_;
  std::size_t bytes_read_ = 0;
  std::string buffer_;
  std::size_t start_ = 0;  // of the next line in the buffer
  std::size_t number_ = 0;
};

}  // namespace spoonbill
