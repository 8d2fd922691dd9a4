// The conversation with a child process that reads or writes a file of another program, so that a hostile
// file cannot take the session with it. The child answers with frames (engine/exchange/frame_stream.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "app/process/child_output.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/exchange/frame_stream.h"

namespace spoonbill {

// What a child does with which file, and how messages speak of it.
struct ForeignTask {
  enum class Work { reading, writing };

  std::filesystem::path file;
  std::string thing;   // that it hands back: "mesh"
  std::string remedy;  // for a file that is too much for it: "reduce the mesh"
  Work work = Work::reading;
  // What is said after "FILE: " of a child that has not enough memory, is followed by a number of GiB; of one
  // that answers in another form; and of the reason that it gives itself, which may be any bytes.
  std::string too_much = "reading it takes more than ";
  std::string not_in_form = "the reader did not answer in its own form; build the program anew";
  std::function<std::string(const std::string& reason)> refusal = printable;

  // With a blank for every letter that is none of ASCII.
  static std::string printable(const std::string& reason);
};

// One owner, one thread. Every Error names the file.
class ForeignChild {
 public:
  // Starts the program `arguments[0]`, whose memory is limited to ChildOutput::memory_limit, and whose time
  // to the patience. `input` becomes its standard input, nothing if negative.
  static Result<ForeignChild> start(ForeignTask task, const std::vector<std::string>& arguments,
                                    std::chrono::milliseconds patience, int input = -1);

  // Reports the child's progress from now on, several times a second, and ends the child where that asks it
  // to stop.
  void watch(Progress progress);

  // The head of the next frame that is neither progress nor a failure; its content is to be read. Refused:
  // the child's failure, its end, its time being over, a request to stop, what is no frame.
  Result<FrameHead> next();

  // The whole content of the frame whose head came last. Refused: as next() does, more than
  // frame_bytes_limit.
  Result<std::string> content(const FrameHead& head);

  // A part of that content.
  Status read(void* to, std::size_t bytes);
  template <class T>
  Status read(std::vector<T>& items) {
    return read(items.data(), items.size() * sizeof(T));
  }

  // That the child did not answer in the form that it should.
  Error not_in_form() const { return about(task_.not_in_form); }

 private:
  ForeignChild(ForeignTask task, ChildOutput output, std::chrono::milliseconds patience);
  Error about(const std::string& message) const;
  Error end_without_answer();
  Error failure(const FrameHead& head);

  ForeignTask task_;
  ChildOutput output_;
  std::chrono::milliseconds patience_;
  Progress progress_;
  double fraction_ = 0.0;  // that the child last reported
};

// In the child itself: ends it when the program that asked ends, because a file may keep it busy for long.
void end_with_parent();

}  // namespace spoonbill
