// A live session: the tick in real time on its own thread, with a journal and a worker beside it, and the
// main thread's way to all of them.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/live/haptic_side.h"

namespace spoonbill {

struct LiveSettings {
  InstructionSet instruction_set = best_instruction_set();
  bool real_time = true;
};

// One owner, the program's main thread, which makes every call; none of them waits for the haptic thread.
class LiveSession {
 public:
  // `source` names the document's file in messages. The device must not be null; it is closed with the
  // session. Refused: a scene that cannot be simulated, a device that does not answer or whose specification
  // is out of range, no threads.
  static Result<std::unique_ptr<LiveSession>> start(const Document& document, const std::string& source,
                                                    const LiveSettings& settings,
                                                    std::unique_ptr<Device> device);
  ~LiveSession();  // stops the threads; what was handed over is written

  // Done before the next tick, in the order asked. False when the haptic thread is so far behind that nothing
  // more can be asked.
  bool ask(Request request);

  // Another document in place of this one; a recording ends first.
  bool open(Document document, std::string source);

  // Begins anew from the shape as it is now, at rest, and records from there: that is what makes the
  // recording whole by itself.
  // `view` is how the replay looks at its beginning.
  bool start_recording(std::filesystem::path file, const ViewChoice& view);
  bool stop_recording();

  // Saves the document of the last frame as it is when the haptic thread hears of it; take_saved() and the
  // notices tell. Refused there when another one has been opened by then.
  bool save(std::filesystem::path file);
  std::optional<SavedDocument> take_saved() { return journal_.take_saved(); }

  // How documents are looked at when they are saved, and where unsaved work goes.
  void set_view(Json view) { journal_.set_view(std::move(view)); }
  void set_autosave(std::optional<Autosave> autosave);

  // The newest tick there is.
  const LiveFrame& frame();
  // The one that frame() gave last; stays as it is until frame() is called again.
  const LiveFrame& last_frame() const { return exchange_.frames.reading(); }
  // The forces of the ticks since the last call, oldest first.
  void take_forces(std::vector<float>& forces_n);
  std::vector<Notice> take_notices();
  LoopFigures figures() const { return loop_->figures(); }

  // Ends the haptic thread and a recording with it, and waits for what is written. Afterwards only the
  // figures, the notices and the next are of use.
  void stop();
  // Whether the last recording was written to its end.
  bool last_recording_is_whole() const { return journal_.last_recording_is_whole(); }

 private:
  LiveSession(std::unique_ptr<Session> session, std::unique_ptr<Device> device, const LiveSettings& settings,
              const LiveFrame& first, const LiveScene& first_scene);
  bool send(LiveCommand command);

  LiveSettings settings_;
  DeviceSpecification device_;
  Notices notices_;
  Journal journal_;
  SessionWorker worker_;
  LiveExchange exchange_;
  HapticSide haptic_;
  std::optional<HapticLoop> loop_;
  std::uint64_t saves_ = 0;
  std::uint64_t recordings_lost_ = 0;
};

}  // namespace spoonbill
