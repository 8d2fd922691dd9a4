#include <filesystem>
#include <memory>
#include <new>
#include <string>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/files/foreign_child.h"
#include "engine/base/file.h"
#include "engine/exchange/file_format.h"
#include "engine/exchange/frame_stream.h"
#include "engine/exchange/points/point_cloud.h"

namespace spoonbill {
namespace {

constexpr std::size_t header_bytes = 65536;

// The header of a PLY file tells, which may be long after it.
Status hand_over(const std::filesystem::path& file, Console& console) {
  const FileFormat format = format_from_name(file);
  if (format == FileFormat::ply && ply_face_count(read_first_bytes(file, header_bytes)) > 0) {
    write_frame(console.out, FrameKind::faces, {});
    return {};
  }
  const auto bytes = read_file(file, point_file_bytes_limit);
  if (!bytes) return bytes.error();
  if (format == FileFormat::obj && obj_has_faces(bytes.value())) {
    write_frame(console.out, FrameKind::faces, {});
    return {};
  }
  const auto cloud = points_of(bytes.value(), file);
  if (!cloud) return cloud.error();
  write_cloud(console.out, cloud.value());
  return {};
}

// Whoever asked knows the file's name, which may be longer than what is handed over.
std::string without_name(const std::string& message, const std::filesystem::path& file) {
  const std::string name = file.string() + ": ";
  return message.starts_with(name) ? message.substr(name.size()) : message;
}

Status read_points(const std::filesystem::path& file, Console& console) {
  try {
    Status done = hand_over(file, console);
    if (!done) write_failure(console.out, without_name(done.error().message, file));
    return done;
  } catch (const std::bad_alloc&) {
    write_failure(console.out, bad_allocation);
    return Error{file.string() + ": " + bad_allocation};
  }
}

}  // namespace

CommandEntry add_read_points(OptionSet root) {
  auto file = std::make_shared<std::filesystem::path>();
  const OptionSet parser = root.add_command("read-points", "Hand a cloud's points to the program itself");
  parser.hide();
  parser.add_option("FILE", *file, "A cloud (.ply, .pcd, .xyz, .txt, .csv, .asc, .pts or .obj)").require();
  return {parser, [file](Console& console) {
            end_with_parent();
            return read_points(*file, console);
          }};
}

}  // namespace spoonbill
