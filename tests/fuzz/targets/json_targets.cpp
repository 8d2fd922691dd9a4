// Fuzz targets for readers of our own JSON formats.
#include <sstream>

#include "engine/exchange/cad_stream.h"
#include "engine/exchange/document.h"
#include "engine/exchange/frame_stream.h"
#include "haptic/recording.h"
#include "haptic/script.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/targets/targets.h"

namespace spoonbill {

void must_be_one_line(const Error& error) {
  must_hold(!error.message.empty(), "an error says something");
  must_hold(error.message.find('\n') == std::string::npos, "an error is one line");
}

void take_document(std::string_view bytes) {
  const auto json = parse_json(bytes, "fuzzed");
  if (!json) return must_be_one_line(json.error());
  const auto document = document_from_json(json.value(), "fuzzed");
  if (!document) return must_be_one_line(document.error());
  // An accepted document must be written and read back as the same document.
  const std::string written = json_to_page(document_to_json(document.value()));
  const auto again = parse_json(written, "written");
  must_hold(again.ok(), "what is written can be parsed");
  const auto back = document_from_json(again.value(), "written");
  must_hold(back.ok(), "what is written can be read");
  must_hold(json_to_page(document_to_json(back.value())) == written, "what is read is the same");
}

void take_recording(std::string_view bytes) {
  std::istringstream in{std::string(bytes)};
  const auto recording = read_recording(in, "fuzzed");
  if (!recording) must_be_one_line(recording.error());
}

void take_script(std::string_view bytes) {
  const auto json = parse_json(bytes, "fuzzed");
  if (!json) return must_be_one_line(json.error());
  const auto script = script_from_json(json.value(), "fuzzed", ".");
  if (!script) return must_be_one_line(script.error());
  must_hold(script->tick_count() <= script_tick_limit, "a script has an end");
  const HandTarget last = script->target_at(script->tick_count());
  must_hold(last.pose.position_m.allFinite(), "hands go to finite places");
}

namespace {

void take_cad_solid(std::string_view bytes) {
  constexpr std::size_t surfaces = 8;
  const auto solid = cad_solid_from_bytes(bytes, surfaces, "fuzzed");
  if (!solid) return must_be_one_line(solid.error());
  for (const Vector3& vertex : solid->mesh.vertices_m) must_hold(vertex.allFinite(), "vertices are finite");
  for (const std::size_t place : solid->surface_indices)
    must_hold(place < surfaces, "a face is one of the model's");
  const std::string written = cad_solid_to_bytes(solid.value());
  const auto back = cad_solid_from_bytes(written, surfaces, "written");
  must_hold(back.ok(), "what is written can be read");
  must_hold(cad_solid_to_bytes(back.value()) == written, "what is read is the same");
}

}  // namespace

void take_cad_stream(std::string_view bytes) {
  std::size_t at = 0;
  const ReadBytes read = [&](void* to, std::size_t count) {
    if (bytes.size() - at < count) return false;
    bytes.copy(static_cast<char*>(to), count, at);
    at += count;
    return true;
  };
  while (const auto frame = read_frame(read)) {
    if (frame->kind == FrameKind::solid) {
      take_cad_solid(frame->content);
      continue;
    }
    const auto surface = cad_surface_from_json(frame->content, "fuzzed");
    if (!surface) must_be_one_line(surface.error());
  }
}

}  // namespace spoonbill
