#include "engine/merging/intersection_merge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "engine/merging/crossing_lines.h"
#include "engine/merging/joint_edges.h"
#include "engine/merging/tube_ends.h"
#include "engine/number_text.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

namespace {

// Of the tolerance, for new poles and for each of the parts, whose edges then meet within twice of it;
// joining them takes the rest.
constexpr double part_share = 0.2;

using LineShape = std::function<Vector3(double u, const CornerLine& line, double s)>;

// A part as a function of the first patch's u and the share of the way along its lines.
Result<FittedShape> fitted_part(const Surface& first, CornerLines& lines, const LineShape& shape,
                                bool pole_at_start, bool pole_at_end, double tolerance_m) {
  bool missed = false;
  ExactShape exact;
  exact.u = {first.u.is_periodic(), {first.u.domain_start(), first.u.domain_end()}};
  exact.pole_at_start = pole_at_start;
  exact.pole_at_end = pole_at_end;
  exact.at = [&](double u, double s) -> Vector3 {
    const auto& line = lines.at(u);
    if (!line) {
      missed = true;
      return position(first, u, first.v.domain_start());
    }
    return shape(u, *line, s);
  };
  ShapeFit fit;
  fit.tolerance_m = tolerance_m;
  fit.least_spans = 4;
  fit.keeps_parameters = true;
  auto fitted = fit_shape(exact, fit);
  if (missed) {
    return Error{
        "a line of constant u does not reach the other patch, or the fillet's ball does not fit there; "
        "choose a smaller fillet"};
  }
  return fitted;
}

double between(double from, double to, double share) {
  return from + (to - from) * share;
}

// From one touching point to the other, about the ball's centre.
Vector3 on_arc(const Vector3& from, const Vector3& to, const Vector3& centre, double share) {
  const Vector3 a = from - centre, b = to - centre;
  const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
  if (!(std::sin(angle) > 1e-12)) return (1.0 - share) * from + share * to;
  return centre + (std::sin((1.0 - share) * angle) * a + std::sin(share * angle) * b) / std::sin(angle);
}

struct Parts {
  std::vector<Surface> surfaces;
  double deviation_m = 0.0;
};

Result<Parts> fitted_parts(const CrossingPatches& patches, const IntersectionRequest& request) {
  const Surface &first = patches.first, &second = patches.second;
  CornerLines lines(patches, request.fillet_m);
  const double tolerance_m = part_share * request.join.tolerance_m;
  const double first_start = first.v.domain_start(), second_end = second.v.domain_end();
  const LineShape of_first = [&](double u, const CornerLine& line, double s) {
    return position(first, u, between(first_start, line.first_v, s));
  };
  const LineShape of_fillet = [&](double u, const CornerLine& line, double s) {
    return on_arc(position(first, u, line.first_v), position(second, line.second_u, line.second_v),
                  *line.centre_m, s);
  };
  const LineShape of_second = [&](double, const CornerLine& line, double s) {
    return position(second, line.second_u, between(line.second_v, second_end, s));
  };
  const bool first_pole = is_tube(first) && is_pole(first, Side::v_start);
  const bool second_pole = is_tube(second) && is_pole(second, Side::v_end);
  Parts parts;
  const auto add = [&](const LineShape& shape, bool pole_at_start, bool pole_at_end) -> Status {
    auto part = fitted_part(first, lines, shape, pole_at_start, pole_at_end, tolerance_m);
    if (!part) return part.error();
    parts.deviation_m = std::max(parts.deviation_m, part->deviation_m);
    parts.surfaces.push_back(std::move(part->surface));
    return {};
  };
  if (Status status = add(of_first, first_pole, false); !status) return status.error();
  if (request.fillet_m > 0.0) {
    if (Status status = add(of_fillet, false, false); !status) return status.error();
  }
  if (Status status = add(of_second, false, second_pole); !status) return status.error();
  return parts;
}

// From the first part's end to the start of the last.
Joint corner_of(const Joined& joined) {
  Joint corner;
  for (const Joint& joint : joined.joints) corner.gap_m = std::max(corner.gap_m, joint.gap_m);
  corner.apart_m = corner.gap_m;
  corner.blend_start = joined.joints.front().blend_start;
  corner.blend_end = joined.joints.back().blend_end;
  corner.bridged = corner.blend_end > corner.blend_start;
  if (corner.bridged) {
    corner.blend_length_m = mean_length_m(joined.surface, corner.blend_start, corner.blend_end);
  }
  return corner;
}

}  // namespace

Result<IntersectionMerge> merge_crossing(const Surface& first, const Surface& second,
                                         const IntersectionRequest& request) {
  const auto patches = facing_each_other(first, second, part_share * request.join.tolerance_m);
  if (!patches) return patches.error();
  auto parts = fitted_parts(patches.value(), request);
  if (!parts) return parts.error();
  const double before_m = patches->deviation_m + parts->deviation_m;
  JoinRequest join = request.join;
  join.tolerance_m -= before_m;
  join.blend_m = 0.0;
  join.shared_parameters = true;
  if (request.fillet_m == 0.0) join.continuity = 0;
  auto joined = join_row(std::move(parts->surfaces), join);
  if (!joined) return joined.error();
  const Joint corner = corner_of(joined.value());
  return IntersectionMerge{std::move(joined->surface), before_m + joined->deviation_m, corner};
}

}  // namespace spoonbill
