#include "engine/exchange/cad_stream.h"

#include <algorithm>
#include <utility>

#include "engine/exchange/cad_names.h"
#include "engine/exchange/scene_json.h"

namespace spoonbill {
namespace {

constexpr std::size_t longest_failure = 400;

struct Head {
  std::uint64_t letters = 0;
  std::uint64_t size = 0;
};

bool is_known(std::uint64_t letters) {
  for (const CadFrameKind kind : {CadFrameKind::progress, CadFrameKind::surface, CadFrameKind::file,
                                  CadFrameKind::solid, CadFrameKind::ending, CadFrameKind::failure}) {
    if (letters == static_cast<std::uint64_t>(kind)) return true;
  }
  return false;
}

}  // namespace

void write_frame(std::ostream& out, CadFrameKind kind, std::string_view content) {
  const Head head{static_cast<std::uint64_t>(kind), content.size()};
  out.write(reinterpret_cast<const char*>(&head), sizeof head);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.flush();
}

void write_progress(std::ostream& out, double share) {
  write_frame(out, CadFrameKind::progress,
              std::to_string(static_cast<int>(1000.0 * std::clamp(share, 0.0, 1.0))));
}

void write_cad_failure(std::ostream& out, const std::string& message) {
  std::string line = message.substr(0, longest_failure);
  std::replace_if(
      line.begin(), line.end(), [](char letter) { return letter < ' ' || letter > '~'; }, ' ');
  write_frame(out, CadFrameKind::failure, line);
}

std::optional<CadFrame> read_frame(const ReadBytes& read) {
  Head head;
  if (!read(&head, sizeof head) || !is_known(head.letters) || head.size > cad_frame_bytes_limit) return {};
  CadFrame frame{static_cast<CadFrameKind>(head.letters), std::string(head.size, '\0')};
  if (!read(frame.content.data(), frame.content.size())) return {};
  return frame;
}

Json cad_surface_to_json(const CadSurface& surface) {
  Json json;
  json["name"] = surface.name;
  json["surface"] = surface_to_json(surface.surface);
  add_trims(surface.trims, json["surface"]);
  json["deviation_m"] = surface.deviation_m;
  json["trim_problem"] = clean_cad_name(surface.trim_problem, "");
  json["solid"] = clean_cad_name(surface.solid, "");
  return json;
}

Result<CadSurface> cad_surface_from_json(std::string_view text, const std::string& source) {
  const auto json = parse_json(text, source);
  if (!json) return json.error();
  FieldReader named(json.value(), source);
  CadSurface result;
  result.name = named.text("name");
  if (!named.status().ok()) return named.status().error();

  FieldReader reader(json.value(), source + ": '" + result.name + "'");
  reader.ignore("name");
  FieldReader surface_reader = reader.inner("surface");
  std::optional<Surface> surface = read_surface(surface_reader);
  if (surface) result.trims = read_trims(surface_reader, *surface);
  surface_reader.finish();
  result.deviation_m = reader.number("deviation_m", {0.0, 1e3});
  result.trim_problem = reader.text("trim_problem");
  result.solid = reader.text("solid");
  reader.finish();
  if (!surface || !reader.status().ok()) return reader.status().error();
  result.surface = *std::move(surface);
  return result;
}

}  // namespace spoonbill
