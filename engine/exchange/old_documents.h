// Conversion of former fields. In documents of versions 1 and 2, a tick consisted of `iterations` steps, and
// each step advanced the material by one millisecond. Damping and flow therefore ran `iterations` times
// faster than their constants stated. The conversion replaces these fields of JSON by the current ones, whose
// constants refer to real time. Only the current fields are read afterwards. With n iterations:
//
//   tool       iterations n            substeps n
//   sculpting  damping_per_s d         drag_per_s n d
//   material   flow_rate_per_s f       flow_rate_per_s n f
//              damping_ratio z         damping_time_s 2 z / (1500 n); loss_factor is twice the damping ratio
//
// 1500 rad/s is the fastest vibration that a former step, a millisecond of the material's time, allowed: 0.75
// of the limit of two per millisecond. n is the number of iterations of the file's own tool, or 6 if there is
// no tool. A value outside its former range is an error that names the former field and range. Every value
// within the former range fits the current range.
#pragma once

#include <string>

#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

inline constexpr int newest_old_document_version = 2;
inline constexpr int default_old_iterations = 6;

// Returns true if the document has version 1 or 2, and thus the former fields.
bool is_old_document(const Json& document);

// Converts the fields of a document of an old version to the current ones. The field "spoonbill_document",
// which is the version, stays unchanged.
Result<Json> convert_old_document(const Json& document, const std::string& source);

// Converts the material of a material file, which has no version. The material is old if it has a damping
// ratio or a loss factor. Leaves any other JSON unchanged.
Status convert_old_material(Json& material, const std::string& source);

// Converts the commands of an old script or recording, in their order. A command is old if it has a former
// field name. Other commands are left unchanged.
class OldCommands {
 public:
  // `iterations` is the tool's former setting "iterations", which applies until a command changes it.
  explicit OldCommands(int iterations = default_old_iterations) : iterations_(iterations) {}

  Status convert(Json& command, const std::string& source);

 private:
  int iterations_;
};

}  // namespace spoonbill
