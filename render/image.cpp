#include "render/image.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "engine/base/assert.h"

namespace spoonbill {

namespace {

constexpr std::array<std::uint8_t, 8> signature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr int maximum_png_side_px = 16384;
constexpr std::uint8_t filter_none = 0;
constexpr std::uint8_t filter_up = 2;

void append_u32(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

bool is_opaque(const Image& image) {
  std::uint8_t all = 0xff;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) all &= image.rgba[i];
  return all == 0xff;
}

}  // namespace

PngEncoder::PngEncoder() : deflate_memory_(ISAL_DEF_LVL1_DEFAULT) {}

// Applies the Up filter to all rows but the first. This filter vectorises and suits a picture whose
// background is a vertical gradient.
void PngEncoder::filter(const Image& image, int channels) {
  const std::size_t stride = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(channels);
  filtered_.resize((stride + 1) * static_cast<std::size_t>(image.height));
  std::vector<std::uint8_t> rows[2] = {std::vector<std::uint8_t>(stride), std::vector<std::uint8_t>(stride)};
  std::uint8_t* out = filtered_.data();
  for (int y = 0; y < image.height; ++y) {
    std::uint8_t* row = rows[y & 1].data();
    const std::uint8_t* above = rows[(y + 1) & 1].data();
    const std::uint8_t* in = image.pixel(0, y);
    if (channels == 4) {
      std::memcpy(row, in, stride);
    } else {
      for (int x = 0; x < image.width; ++x) {
        row[3 * x] = in[4 * x];
        row[3 * x + 1] = in[4 * x + 1];
        row[3 * x + 2] = in[4 * x + 2];
      }
    }
    *out++ = y == 0 ? filter_none : filter_up;
    for (std::size_t i = 0; i < stride; ++i) out[i] = static_cast<std::uint8_t>(row[i] - above[i]);
    out += stride;
  }
}

// Compresses at level 1; higher levels take longer and save one per cent.
Result<std::size_t> PngEncoder::compress() {
  // The buffer must also hold incompressible rows. They are stored in blocks of up to 65535 bytes, each with
  // a header of five bytes.
  constexpr std::size_t zlib_wrapping = 64;
  compressed_.resize(filtered_.size() + filtered_.size() / 4096 + zlib_wrapping);
  isal_zstream stream;
  isal_deflate_stateless_init(&stream);
  stream.gzip_flag = IGZIP_ZLIB;
  stream.level = 1;
  stream.level_buf = deflate_memory_.data();
  stream.level_buf_size = static_cast<std::uint32_t>(deflate_memory_.size());
  stream.end_of_stream = 1;
  stream.next_in = filtered_.data();
  stream.avail_in = static_cast<std::uint32_t>(filtered_.size());
  stream.next_out = compressed_.data();
  stream.avail_out = static_cast<std::uint32_t>(compressed_.size());
  if (isal_deflate_stateless(&stream) != COMP_OK)
    return Error{ErrorCode::internal, "the picture cannot be compressed"};
  return std::size_t{stream.total_out};
}

void PngEncoder::append_chunk(const char* type, std::span<const std::uint8_t> data) {
  append_u32(file_, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = file_.size();
  file_.insert(file_.end(), type, type + 4);
  file_.insert(file_.end(), data.begin(), data.end());
  append_u32(file_, crc32_gzip_refl(0, file_.data() + start, file_.size() - start));
}

Result<std::span<const std::uint8_t>> PngEncoder::encode(const Image& image) {
  if (image.width < 1 || image.height < 1) {
    return Error{ErrorCode::too_few, "an empty picture cannot be written as a PNG file"};
  }
  if (image.width > maximum_png_side_px || image.height > maximum_png_side_px) {
    return Error{ErrorCode::too_many, "a picture of " + std::to_string(image.width) + "x" +
                                          std::to_string(image.height) +
                                          " pixels is too large for a PNG file: choose sides of at most " +
                                          std::to_string(maximum_png_side_px) + " pixels"};
  }
  SPOONBILL_ASSERT(image.rgba.size() == image.row_bytes() * static_cast<std::size_t>(image.height));
  const int channels = is_opaque(image) ? 3 : 4;
  filter(image, channels);
  const auto size = compress();
  if (!size) return size.error();
  file_.assign(signature.begin(), signature.end());
  std::vector<std::uint8_t> header;
  append_u32(header, static_cast<std::uint32_t>(image.width));
  append_u32(header, static_cast<std::uint32_t>(image.height));
  const std::uint8_t colour_type = channels == 3 ? 2 : 6;
  header.insert(header.end(), {8, colour_type, 0, 0, 0});
  append_chunk("IHDR", header);
  constexpr std::array<std::uint8_t, 1> perceptual = {0};
  append_chunk("sRGB", perceptual);
  append_chunk("IDAT", {compressed_.data(), size.value()});
  append_chunk("IEND", {});
  return std::span<const std::uint8_t>(file_);
}

Status write_png(const std::filesystem::path& path, const Image& image, PngEncoder& encoder,
                 Durability durability, const OutputOptions& options) {
  const auto bytes = encoder.encode(image);
  if (!bytes) return bytes.error().in(path.string());
  return write_file(path, {reinterpret_cast<const char*>(bytes->data()), bytes->size()}, durability, options);
}

Status write_png(const std::filesystem::path& path, const Image& image, const OutputOptions& options) {
  PngEncoder encoder;
  return write_png(path, image, encoder, Durability::now, options);
}

void make_alpha_straight(Image& image) {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const int alpha = image.rgba[i + 3];
    if (alpha == 0 || alpha == 255) continue;
    for (std::size_t c = i; c < i + 3; ++c) {
      const int straight = (255 * image.rgba[c] + alpha / 2) / alpha;
      image.rgba[c] = static_cast<std::uint8_t>(std::min(255, straight));
    }
  }
}

void flip_rows(Image& image) {
  SPOONBILL_ASSERT(image.rgba.size() == image.row_bytes() * static_cast<std::size_t>(image.height));
  for (int top = 0, bottom = image.height - 1; top < bottom; ++top, --bottom) {
    std::swap_ranges(image.pixel(0, top), image.pixel(0, top) + image.row_bytes(), image.pixel(0, bottom));
  }
}

}  // namespace spoonbill
