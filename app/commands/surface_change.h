// The changes of a surface that the change command offers, and the adaptation of a body whose surface is
// replaced.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/bspline/surface.h"
#include "engine/bspline/trim_loop.h"
#include "engine/merging/patch_edge.h"
#include "engine/scene/scene.h"

namespace spoonbill {

struct ChangedSurfaces {
  std::vector<Surface> surfaces;  // two after a split of an open direction, otherwise one
  std::vector<TrimLoop> trims = {};
  double deviation_m = 0.0;      // bound of the deviation; 0 if the change is exact
  bool keeps_parameters = true;  // false if regions, loads, supports and rim would move
};

enum class ChangeKind {
  split,
  insert,
  remove,
  degree,
  simplify,
  rebuild,
  reverse,
  exchange,
  seam,
  close,
  cap,
  open
};

// A parsed change. Members that its kind does not use are ignored.
struct ChangeRequest {
  ChangeKind kind = ChangeKind::simplify;
  Direction direction = Direction::u;
  double parameter = 0.0;  // in the knot domain of the direction
  int number = 1;          // a degree, or the number of copies of a knot
  Side side = Side::v_end;
  double height_m = 0.0;                // height of a cap
  int continuity = 2;                   // continuity of the seam that the change `close` makes
  std::array<int, 2> control = {0, 0};  // control points along u and v that the change `rebuild` leaves
};

// Parses words such as {"insert", "v=0.3", "2"}. Returns an error for words that are wrong whatever the
// surface is.
Result<ChangeRequest> parse_change(const std::vector<std::string>& words);

// Applies the change to a surface and its trims. A change that is not exact deviates by at most
// `tolerance_m`, and `progress` can stop it. Returns an error if the change would lose the trims.
Result<ChangedSurfaces> change_surface(const Surface& surface, const std::vector<TrimLoop>& trims,
                                       const ChangeRequest& request, double tolerance_m,
                                       const Progress& progress = {});

// Returns one line per change for --help.
std::string list_changes();

// Removes regions, loads, supports and the rim, because their positions refer to the surface that is
// replaced. Adds a note if the body had any.
void drop_surface_features(Body& body, std::vector<std::string>& notes);

// Adapts the shell thickness of a body whose surface was `before`. A body that has become a closed solid
// loses its thickness. Adds a note about this, and also a note for a body that is no longer a closed solid
// and has no thickness.
void adapt_thickness(Body& body, const Surface& before, std::vector<std::string>& notes);

}  // namespace spoonbill
