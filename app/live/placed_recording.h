// A recording while it is written, and the place it takes when it is whole.
#pragma once

#include <filesystem>
#include <memory>

#include "app/files/recording_place.h"
#include "engine/base/result.h"
#include "haptic/recording/recording_writer.h"

namespace spoonbill {

// Made on the worker's thread, handed through the haptic thread, and written by the journal's.
struct PlacedRecording {
  RecordingPlace place;
  RecordingWriter writer;

  // Fails where the place cannot be written.
  static Result<std::unique_ptr<PlacedRecording>> begin(const std::filesystem::path& file,
                                                        const RecordingHeader& header) {
    RecordingPlace place(file);
    auto writer = RecordingWriter::create(place.written(), header);
    if (!writer) return writer.error();
    return std::make_unique<PlacedRecording>(PlacedRecording{std::move(place), std::move(writer).value()});
  }
};

}  // namespace spoonbill
