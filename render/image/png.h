// PNG files. Encoding is the same on every machine: the same picture and effort give the same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "engine/result.h"
#include "render/image/image.h"

struct libdeflate_compressor;

namespace spoonbill {

// Sequences are written at the frames' pace; single pictures are made small.
enum class PngEffort { sequence, single };

// Encodes pictures one after another in its own working memory: one encoder a thread.
class PngEncoder {
 public:
  explicit PngEncoder(PngEffort effort);

  // The bytes of the file, valid until the next call. An opaque picture is stored without alpha. Refused: an
  // empty picture.
  Result<std::span<const std::uint8_t>> encode(const Image& image);

 private:
  struct Free {
    void operator()(libdeflate_compressor* compressor) const;
  };
  void filter(const Image& image, int channels);
  void append_chunk(const char* type, std::span<const std::uint8_t> data);

  PngEffort effort_;
  std::unique_ptr<libdeflate_compressor, Free> compressor_;
  std::vector<std::uint8_t> filtered_;
  std::vector<std::uint8_t> compressed_;
  std::vector<std::uint8_t> file_;
};

// Encodes and writes. The file appears whole or not at all: it is written beside its place under another name
// and renamed. The error names the path.
Status write_png(const std::filesystem::path& path, const Image& image, PngEncoder& encoder);

// As above, for a single picture.
Status write_png(const std::filesystem::path& path, const Image& image);

// Refused, with the path: a missing file, a broken one, a side above 16384 pixels.
Result<Image> read_png(const std::filesystem::path& path);

}  // namespace spoonbill
