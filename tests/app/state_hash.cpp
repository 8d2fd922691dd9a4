// state_hash RECORDING...: replays each recording without drawing and prints its state hash on one line. Also
// built in Debug, where the rest of the program is not.
#include <cstdio>
#include <optional>
#include <utility>

#include "app/report/quantity_text.h"
#include "app/session/lockstep.h"
#include "haptic/recording_lines.h"
#include "haptic/virtual_device.h"

namespace spoonbill {
namespace {

Result<std::string> hash_of(const char* file) {
  const auto recording = read_recording(file);
  if (!recording) return recording.error();
  auto session =
      Session::make(recording->header.document, file, recording->header.device, best_instruction_set());
  if (!session) return session.error();
  PlaybackDevice device(recording->header.device, recording->readings);
  Lockstep lockstep(session.value(),
                    {&device, recording->readings.size(), recording->commands, {}, {}, 0, file}, nullptr);
  if (Status ran = lockstep.run_to(lockstep.tick_count()); !ran) return ran.error();
  if (Status finished = lockstep.finish(); !finished) return finished.error();
  return hash_text(state_hash(session.value()));
}

}  // namespace
}  // namespace spoonbill

int main(int count, char** arguments) {
  for (int k = 1; k < count; ++k) {
    const auto hash = spoonbill::hash_of(arguments[k]);
    if (!hash) {
      std::fprintf(stderr, "state_hash: %s\n", hash.error().message.c_str());
      return 1;
    }
    std::puts(hash.value().c_str());
  }
  return 0;
}
