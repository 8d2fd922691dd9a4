#include "app/files/error_cloud.h"

#include <bit>
#include <cstring>
#include <string>

#include "app/report/colour_scale.h"
#include "engine/base/text.h"
#include "engine/base/file.h"

namespace spoonbill {
namespace {

void append_float(std::string& bytes, double number) {
  const auto value = static_cast<float>(number);
  const char* const data = reinterpret_cast<const char*>(&value);
  bytes.append(data, sizeof value);
}

std::string header(std::size_t points, double full_m) {
  return std::string("ply\nformat ") +
         (std::endian::native == std::endian::little ? "binary_little_endian" : "binary_big_endian") +
         " 1.0\ncomment lengths in metres; colours from 0 (dark blue) to " + number_text(full_m * 1e3) +
         " mm (yellow)\nelement vertex " + std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float distance_mm\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
}

}  // namespace

Status write_error_cloud(const ScanFit& fit, double full_m, const std::filesystem::path& file) {
  std::size_t count = 0;
  for (const FittedBody& body : fit.bodies) count += body.errors.positions_m.size();
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  if (Status written = out->write(header(count, full_m)); !written) return written;
  std::string bytes;
  for (const FittedBody& body : fit.bodies) {
    bytes.clear();
    for (std::size_t p = 0; p < body.errors.positions_m.size(); ++p) {
      for (int axis = 0; axis < 3; ++axis) append_float(bytes, body.errors.positions_m[p][axis]);
      append_float(bytes, 1e3 * body.errors.distance_m[p]);
      for (const std::uint8_t value : colour_at(body.errors.distance_m[p] / full_m)) {
        bytes.push_back(static_cast<char>(value));
      }
    }
    if (Status written = out->write(bytes); !written) return written;
  }
  return out->commit();
}

}  // namespace spoonbill
