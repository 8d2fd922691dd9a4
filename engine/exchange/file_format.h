// Formats of the files that the program reads and writes, by name and by content.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string>
#include <string_view>

#include "engine/base/result.h"

namespace spoonbill {

enum class FileFormat {
  unknown,
  document,  // .json, like the next three; find_native_format() distinguishes them by content
  recording,
  script,
  material,
  step,  // .step, .stp
  iges,  // .iges, .igs
  stl,
  obj,
  ply,
  three_mf,  // .3mf
  pcd,
  point_text  // .xyz, .txt, .csv, .asc, .pts
};

struct FileEnding {
  std::string_view ending;  // in lower case, without the dot
  FileFormat format;
};

// All endings of known formats. The first ending of a format is its usual one.
inline constexpr std::array<FileEnding, 15> file_endings{{{"json", FileFormat::document},
                                                          {"step", FileFormat::step},
                                                          {"stp", FileFormat::step},
                                                          {"iges", FileFormat::iges},
                                                          {"igs", FileFormat::iges},
                                                          {"stl", FileFormat::stl},
                                                          {"obj", FileFormat::obj},
                                                          {"ply", FileFormat::ply},
                                                          {"3mf", FileFormat::three_mf},
                                                          {"pcd", FileFormat::pcd},
                                                          {"xyz", FileFormat::point_text},
                                                          {"txt", FileFormat::point_text},
                                                          {"csv", FileFormat::point_text},
                                                          {"asc", FileFormat::point_text},
                                                          {"pts", FileFormat::point_text}}};

// Returns the format that belongs to the ending of the name, in upper or lower case. Every .json file counts
// as a document.
inline FileFormat format_from_name(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  if (ending.empty()) return FileFormat::unknown;
  ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  for (const FileEnding& known : file_endings) {
    if (known.ending == ending) return known.format;
  }
  return FileFormat::unknown;
}

// Returns the usual ending of a format's files, without the dot. Empty for FileFormat::unknown, recording,
// script and material.
inline std::string_view usual_ending(FileFormat format) {
  for (const FileEnding& known : file_endings) {
    if (known.format == format) return known.ending;
  }
  return {};
}

inline bool is_cad(FileFormat format) {
  return format == FileFormat::step || format == FileFormat::iges;
}

// Returns true for formats from which triangles are read.
inline bool is_mesh(FileFormat format) {
  return format == FileFormat::obj || format == FileFormat::stl || format == FileFormat::ply;
}

// Returns true for formats to which triangles are written.
inline bool is_written_mesh(FileFormat format) {
  return is_mesh(format) || format == FileFormat::three_mf;
}

// Returns true for formats from which points are read.
inline bool is_cloud(FileFormat format) {
  return format == FileFormat::ply || format == FileFormat::pcd || format == FileFormat::obj ||
         format == FileFormat::point_text;
}

// Returns which of the program's own formats a file has: document, recording, script or material. The file's
// name is ignored. Refused: a file that cannot be read, or has none of these formats.
Result<FileFormat> find_native_format(const std::filesystem::path& file);

}  // namespace spoonbill
