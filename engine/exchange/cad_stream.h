// CAD models as bytes between the program and its child that reads and writes CAD files, on one machine:
// frames of eight letters, a length of 64 bits, and so many bytes, of which surfaces are JSON in the form
// that documents have.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "engine/base/result.h"
#include "engine/exchange/cad_model.h"
#include "engine/exchange/json.h"

namespace spoonbill {

enum class CadFrameKind : std::uint64_t {
  progress = 0x676f72706c6e7073,  // "spnlprog" in little-endian order: a share in thousandths
  surface = 0x667275736c6e7073,   // "spnlsurf"
  file = 0x656c69666c6e7073,      // "spnlfile": the text of a CAD file
  solid = 0x646c6f736c6e7073,     // "spnlsold": what cad_solid_stream.h says
  ending = 0x20646e656c6e7073,    // "spnlend ": what is said of all surfaces together
  failure = 0x6c6961666c6e7073    // "spnlfail": the line that says why there is nothing
};

struct CadFrame {
  CadFrameKind kind;
  std::string content;
};

inline constexpr std::uint64_t cad_frame_bytes_limit = std::uint64_t{1} << 30;

void write_frame(std::ostream& out, CadFrameKind kind, std::string_view content);
void write_progress(std::ostream& out, double share);
// As one line of printable letters of at most 400.
void write_cad_failure(std::ostream& out, const std::string& message);

// False when there are fewer bytes.
using ReadBytes = std::function<bool(void* to, std::size_t bytes)>;
// Nothing where the bytes end, or are no frame, or one of more than the limit.
std::optional<CadFrame> read_frame(const ReadBytes& read);

Json cad_surface_to_json(const CadSurface& surface);
// `source` names the CAD file in messages. Refused: what no document could hold.
Result<CadSurface> cad_surface_from_json(std::string_view text, const std::string& source);

}  // namespace spoonbill
