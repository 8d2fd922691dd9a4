// How two patches cross, line by line: for any u of the first where its line meets the second, and on which
// line of the second. Outside the tick.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "engine/merging/line_crossing.h"
#include "engine/merging/rolling_ball.h"

namespace spoonbill {

// Both patches run along v: the first towards the crossing, the second away from it.
struct CrossingPatches {
  Surface first, second;
  // Whether the crossing lies beside the second's pole at the start of v, so that only lines of another kind
  // lead away from it (LinesFromLoop).
  bool beside_pole = false;
};

// Turned so that they do. Refused as merge_crossing() says.
Result<CrossingPatches> facing_each_other(const Surface& first, const Surface& second);

// The end of the first patch's line at u, the start of the second's, and between them an arc about the
// centre.
struct CornerLine {
  double first_v = 0.0;
  double second_u = 0.0, second_v = 0.0;
  std::optional<Vector3> centre_m;  // of the rolling ball
};

// Remembers what was asked, because fits ask for the same lines again. One owner.
class CornerLines {
 public:
  // The patches must outlive it; radius 0 for an edge.
  CornerLines(const CrossingPatches& patches, double fillet_m);

  // None where the line does not cross, or no ball fits.
  const std::optional<CornerLine>& at(double u);

  // The second's u, v where its lines start, of so many lines of the first as tell the loop that they make.
  std::vector<Eigen::Vector2d> loop_on_second();

 private:
  std::optional<CornerLine> found(double u) const;
  void choose_sides();

  const CrossingPatches* patches_;
  CrossingFinder second_;
  double fillet_m_;
  BallSides sides_;
  std::map<double, std::optional<CornerLine>> lines_;
};

}  // namespace spoonbill
