#include "render/interface_fonts.h"

#include <cstdint>
#include <cstring>
#include <string>

#include "engine/base/file.h"

namespace spoonbill {
namespace {

constexpr std::size_t font_bytes_limit = std::size_t{256} << 20;

// Latin-1, Greek, general punctuation, superscripts, arrows and mathematical signs. ImGui keeps the pointer.
constexpr ImWchar signs[] = {0x0020, 0x00ff, 0x0370, 0x03ff, 0x2010, 0x2030, 0x2070, 0x209f,
                             0x2190, 0x2194, 0x2212, 0x2212, 0x2248, 0x2265, 0};

ImFont* add_size(ImFontAtlas& atlas, const std::string& file, float size_px) {
  ImFontConfig config;
  config.OversampleH = 2;
  config.OversampleV = 1;
  // The atlas reads the file when it is built, after this function has returned: give it a copy to own.
  void* copy = IM_ALLOC(file.size());
  std::memcpy(copy, file.data(), file.size());
  return atlas.AddFontFromMemoryTTF(copy, static_cast<int>(file.size()), size_px, &config, signs);
}

}  // namespace

Result<InterfaceFonts> add_interface_fonts(ImFontAtlas& atlas, const std::string& path, float body_px,
                                           float heading_px) {
  const auto file = read_file(path, font_bytes_limit);
  constexpr std::uint8_t truetype[4] = {0, 1, 0, 0};
  if (!file || file->size() < sizeof(truetype) ||
      std::memcmp(file->data(), truetype, sizeof(truetype)) != 0) {
    return Error{path + ": no readable TrueType font; install fonts-roboto-unhinted or name another file"};
  }
  return InterfaceFonts{add_size(atlas, file.value(), body_px), add_size(atlas, file.value(), heading_px)};
}

}  // namespace spoonbill
