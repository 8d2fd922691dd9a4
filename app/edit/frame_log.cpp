#include "app/edit/frame_log.h"

#include "engine/exchange/json.h"

namespace spoonbill {

Result<FrameLog> FrameLog::open(const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::trunc);
  if (!out) return Error{file.string() + " cannot be written: check the folder and its permissions"};
  return FrameLog(std::move(out));
}

void FrameLog::add(const ShownFrame& shown) {
  const Json line = {{"frame", ++frames_},
                     {"tick", shown.tick},
                     {"session", shown.session},
                     {"deed", shown.deed},
                     {"recording", shown.recording},
                     {"in_stroke", shown.in_stroke},
                     {"can_undo", shown.can_undo},
                     {"can_redo", shown.can_redo},
                     {"pressing", shown.pressing},
                     {"prompt", shown.prompt},
                     {"typed", shown.typed},
                     {"pointer_x_px", shown.pointer_x_px},
                     {"pointer_y_px", shown.pointer_y_px},
                     {"hand_lag_m", shown.hand_lag_m}};
  out_ << line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n" << std::flush;
}

}  // namespace spoonbill
