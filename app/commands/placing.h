// The changes of a body's place and size that the change command offers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/scene/scene.h"

namespace spoonbill {

enum class PlacingKind { move, rotate, scale, mirror, align_side, align_length };
enum class BoxSide { low, centre, high };

// A parsed placing. Members that its kind does not use are ignored.
struct PlacingRequest {
  PlacingKind kind = PlacingKind::move;
  Vector3 vector = Vector3::Zero();  // of a move in metres; factors of a scaling; unit axis of the others
  double angle_deg = 0.0;            // counter-clockwise seen against the axis
  BoxSide side = BoxSide::low;       // side of the body's box that an alignment brings to `place_m`
  double place_m = 0.0;              // coordinate along `vector`
};

// Returns true if the first word names a placing.
bool is_placing(const std::vector<std::string>& words);

// Parses words such as {"rotate", "y", "30deg"}. Returns an error for words that are wrong whatever the body
// is.
Result<PlacingRequest> parse_placing(const std::vector<std::string>& words);

// Returns whether the result depends on the point about which a body is placed.
bool takes_point(PlacingKind kind);

// Places a body, with the other faces of its solid, about a point; without one, about the centre: that of the
// volume or, of what encloses none, that of the area. Fixing planes, the plane of symmetry and the trial's
// axis go along if no body stays; otherwise they stay, and a note says so. Returns an error if the body has
// no length to align.
Status place_body(const PlacingRequest& request, const std::optional<Vector3>& about_m, std::size_t body,
                  Scene& scene, std::vector<std::string>& notes);

// Returns the first words of all placings, with commas between them.
std::string placing_names();

// Returns one line per placing for --help.
std::string list_placings();

}  // namespace spoonbill
