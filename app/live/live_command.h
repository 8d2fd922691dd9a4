// What travels from the program's main thread to the haptic thread, and with a session to the worker and
// back.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "app/session/request.h"
#include "app/session/session.h"
#include "haptic/recording.h"

namespace spoonbill {

// A session with what was begun for it while it was on loan.
struct LentSession {
  std::unique_ptr<Session> session;
  bool begun_anew = false;                     // another session than the one that was lent
  bool other_document = false;                 // and of another document
  std::unique_ptr<RecordingWriter> recording;  // that begins with the session's next tick
};

// Work on a session that may take its time: it is done on the worker's thread while the haptic thread keeps
// ticking its device with no force. An error leaves the session as it was.
using SessionWork = std::function<Status(LentSession&)>;

// Asked for together with its JSON, so that the haptic thread has none to make.
struct AskedRequest {
  Request request;
  Json json;
};
struct AskedWork {
  SessionWork work;
  bool ends_recording = false;
};
struct AskedScene {
  std::uint64_t request = 0;
};
struct EndRecording {};

using LiveCommand = std::variant<std::monostate, AskedRequest, AskedWork, AskedScene, EndRecording>;

}  // namespace spoonbill
