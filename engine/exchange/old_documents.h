// Conversion of former fields. Documents of versions 1 and 2 counted time in the steps of their own tick: its
// `iterations` were steps of one millisecond of material time each, so that damping and flow ran that many
// times faster than their constants said. The conversion replaces these fields of JSON by the current ones,
// in real time, so that only the current fields are read. With n iterations:
//
//   tool       iterations n            substeps n
//   sculpting  damping_per_s d         drag_per_s n d
//   material   flow_rate_per_s f       flow_rate_per_s n f
//              damping_ratio z         damping_time_s 2 z / (1500 n); loss_factor is twice the damping ratio
//
// 1500 rad/s is the fastest vibration that the former steps allowed, in material time: 0.75 of the limit of
// two per millisecond. n is that of the file's own tool, or 6 where there is no tool. A value outside its
// former range is an error that names the former field and range. Every value within it fits the current
// range.
#pragma once

#include <string>

#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

inline constexpr int newest_old_document_version = 2;
inline constexpr int default_old_iterations = 6;

// Returns true if the document's version is one that has the former fields.
bool is_old_document(const Json& document);

// Returns a document of an old version with the current fields; "spoonbill_document" is unchanged.
Result<Json> convert_old_document(const Json& document, const std::string& source);

// Converts a material of a file, which has no version: it is old if it has a damping ratio or a loss factor.
// Leaves any other JSON unchanged.
Status convert_old_material(Json& material, const std::string& source);

// Converts the commands of an old script or recording, in their order. A command is old if it has a former
// name; others are left unchanged.
class OldCommands {
 public:
  // `iterations` are those of the tool before the first command.
  explicit OldCommands(int iterations = default_old_iterations) : iterations_(iterations) {}

  Status convert(Json& command, const std::string& source);

 private:
  int iterations_;
};

}  // namespace spoonbill
