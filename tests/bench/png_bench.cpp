// Times the encoding of a frame of 1280 x 720 pixels as PNG, by our encoder and by that of stb_image_write.
// The frame is the reference screenshot of the bent handle at rest.
#include <benchmark/benchmark.h>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#include "render/image.h"
#include "tests/render/read_png.h"

namespace spoonbill {
namespace {

Image frame() {
  return read_png(std::filesystem::path(SPOONBILL_SCREENSHOTS) / "bend-settled.png").value();
}

void png_ours(benchmark::State& state) {
  const Image image = frame();
  PngEncoder encoder;
  std::size_t bytes = 0;
  for (auto _ : state) bytes = encoder.encode(image)->size();
  state.counters["bytes"] = static_cast<double>(bytes);
}

void count_bytes(void* total, void*, int size) {
  *static_cast<std::size_t*>(total) += static_cast<std::size_t>(size);
}

void png_stb(benchmark::State& state) {
  const Image image = frame();
  std::size_t bytes = 0;
  for (auto _ : state) {
    bytes = 0;
    stbi_write_png_to_func(count_bytes, &bytes, image.width, image.height, 4, image.rgba.data(),
                           static_cast<int>(image.row_bytes()));
  }
  state.counters["bytes"] = static_cast<double>(bytes);
}

BENCHMARK(png_ours)->Unit(benchmark::kMillisecond);
BENCHMARK(png_stb)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace spoonbill
