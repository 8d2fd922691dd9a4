#include "engine/exchange/cad_stream.h"

#include <algorithm>
#include <utility>

#include "engine/exchange/scene_json.h"

namespace spoonbill {
namespace {

constexpr std::size_t longest_failure = 400, longest_name = 200;

struct Head {
  std::uint64_t letters = 0;
  std::uint64_t size = 0;
};

bool is_known(std::uint64_t letters) {
  for (const CadFrameKind kind : {CadFrameKind::progress, CadFrameKind::surface, CadFrameKind::file,
                                  CadFrameKind::ending, CadFrameKind::failure}) {
    if (letters == static_cast<std::uint64_t>(kind)) return true;
  }
  return false;
}

// How many bytes of UTF-8 begin at `start`; 0 where none do.
std::size_t letter_bytes(const std::string& text, std::size_t start) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned first = byte(start);
  const std::size_t count = first < 0x80                     ? 1
                            : first >= 0xc2 && first <= 0xdf ? 2
                            : first >= 0xe0 && first <= 0xef ? 3
                            : first >= 0xf0 && first <= 0xf4 ? 4
                                                             : 0;
  if (count == 0 || start + count > text.size()) return 0;
  for (std::size_t k = start + 1; k < start + count; ++k) {
    if ((byte(k) & 0xc0) != 0x80) return 0;
  }
  // Overlong forms, surrogates, beyond Unicode.
  const unsigned second = count > 2 ? byte(start + 1) : 0x80;
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
    return 0;
  }
  return count;
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
  reader.finish();
  if (!surface || !reader.status().ok()) return reader.status().error();
  result.surface = *std::move(surface);
  return result;
}

std::string clean_cad_name(const std::string& name, const std::string& instead) {
  std::string clean;
  for (std::size_t k = 0; k < name.size();) {
    const std::size_t count = letter_bytes(name, k);
    const bool shown = count > 1 || (count == 1 && name[k] >= ' ' && name[k] != '\x7f');
    if (clean.size() + std::max<std::size_t>(count, 1) > longest_name) break;
    clean += shown ? name.substr(k, count) : std::string(1, ' ');
    k += std::max<std::size_t>(count, 1);
  }
  const std::size_t first = clean.find_first_not_of(' ');
  if (first == std::string::npos) return instead;
  return clean.substr(first, clean.find_last_not_of(' ') - first + 1);
}

}  // namespace spoonbill
