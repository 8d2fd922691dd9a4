// A child process that reads or writes a file in a foreign format, so that a hostile file cannot crash the
// session. The child answers with frames (engine/exchange/frame_stream.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/child_process.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/frame_stream.h"

namespace spoonbill {

// The job of a child process, and the words that its error messages use.
struct ForeignTask {
  enum class Work { reading, writing };

  std::filesystem::path file;
  std::string thing;   // what the child returns, such as "mesh"
  std::string remedy;  // advice for a file that exceeds the limits, such as "reduce the mesh"
  Work work = Work::reading;
  // Message after "FILE: " when memory runs out; a number of GiB follows.
  std::string too_much = "reading it needs more than ";
  // Message after "FILE: " for an answer that is not a valid frame.
  std::string invalid_answer = "the reader gave an invalid answer; rebuild the program";
  // Turns the child's own reason, which may be any bytes, into the text that follows "FILE: " in the error
  // message.
  std::function<std::string(const std::string& reason)> refusal = printable;

  // Returns the text with every byte that is not printable ASCII replaced by a blank.
  static std::string printable(const std::string& reason);
};

// The parent's side of the exchange with a child process. It has one owner and is used by one thread. Every
// error names the file.
class ForeignChild {
 public:
  // Starts the program `arguments[0]`. `patience` limits its time, ChildOutput::memory_limit its memory.
  // `input` becomes its standard input; a negative descriptor stands for /dev/null.
  static Result<ForeignChild> start(ForeignTask task, const std::vector<std::string>& arguments,
                                    std::chrono::milliseconds patience, int input = -1);

  // Forwards the child's progress several times a second, and ends the child when `progress` asks to stop.
  void watch(Progress progress);

  // Returns the head of the next frame that is neither progress nor a failure. The caller must then read the
  // frame's content. Errors: the child fails, ends, exceeds its time or sends an invalid frame; the user
  // stops the work.
  Result<FrameHead> next();

  // Returns the whole content of the frame whose head next() returned last. Errors: those of next(), and
  // content of more than frame_bytes_limit bytes.
  Result<std::string> content(const FrameHead& head);

  // Reads the next bytes of the content of the frame whose head next() returned last.
  Status read(void* to, std::size_t bytes);
  template <class T>
  Status read(std::vector<T>& items) {
    return read(items.data(), items.size() * sizeof(T));
  }

  // The error of a child whose answer violates the protocol.
  Error invalid_answer() const { return error(ErrorCode::process_failed, task_.invalid_answer); }

 private:
  ForeignChild(ForeignTask task, ChildOutput output, std::chrono::milliseconds patience);
  Error error(ErrorCode code, const std::string& message) const;
  Error missing_answer();
  Error failure(const FrameHead& head);

  ForeignTask task_;
  ChildOutput output_;
  std::chrono::milliseconds patience_;
  Progress progress_;
  double fraction_ = 0.0;  // fraction last reported by the child
};

}  // namespace spoonbill
