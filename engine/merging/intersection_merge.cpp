#include "engine/merging/intersection_merge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/text.h"
#include "engine/bspline/reparameterise.h"
#include "engine/inspection/mass_properties.h"
#include "engine/merging/crossing_lines.h"
#include "engine/merging/fold_search.h"
#include "engine/merging/joint_edges.h"
#include "engine/merging/lines_from_loop.h"
#include "engine/merging/tube_ends.h"
#include "engine/shapes/fit_shape.h"

namespace spoonbill {

namespace {

// Of the tolerance, for each of the parts, whose edges then meet within twice of it; joining them takes the
// rest. More for one whose roundings lie askew to its lines, as they do that start beside a pole.
constexpr double part_share = 0.2, askew_share = 0.5;
// Of the work, for each of up to three parts.
constexpr double fitted_share = 0.25;

double between(double from, double to, double share) {
  return from + (to - from) * share;
}

using LineShape = std::function<Vector3(double u, const CornerLine& line, double s)>;

// A part as a function of the first patch's u and the share of the way along its lines.
struct PartShape {
  LineShape at;
  bool pole_at_start = false, pole_at_end = false;
  // Where the lines start beside a pole: the share of the way at which they bend into the patch's own.
  std::optional<double> bend = {};
};

// Spans are added in whole cells, of which each direction has at least so many: few leave a simple part
// simple, but roundings that lie askew to the lines somewhere must not ask for spans all around.
constexpr int few_spans = 4, local_spans = 48;

Error not_fitted(const Error& error, double share, double tolerance_m) {
  return Error{"a part of a patch that is kept gets " + short_length_text(share * tolerance_m) +
               " of the tolerance of " + short_length_text(tolerance_m) + ": " + error.message};
}

Error not_reached(bool with_fillet) {
  return Error{with_fillet
                   ? "a line of constant u does not reach the other patch, or the fillet's ball does not fit "
                     "there; choose a smaller fillet"
                   : "a line of constant u does not cross the other patch, or touches it alone, as where one "
                     "body stands in the side of another that is as wide; make one wider, or move it"};
}

Result<FittedShape> fitted_part(const Surface& first, CornerLines& lines, const PartShape& part,
                                bool with_fillet, double tolerance_m, const Progress& progress) {
  bool missed = false;
  ExactShape exact;
  exact.u = {first.u.is_periodic(), {first.u.domain_start(), first.u.domain_end()}};
  if (part.bend) exact.v.breaks = {0.0, *part.bend, 1.0};
  exact.pole_at_start = part.pole_at_start;
  exact.pole_at_end = part.pole_at_end;
  exact.at = [&](double u, double s) -> Vector3 {
    const auto& line = lines.at(u);
    if (!line) {
      missed = true;
      return position(first, u, first.v.domain_start());
    }
    return part.at(u, *line, s);
  };
  const double share = part.bend ? askew_share : part_share;
  ShapeFit fit;
  fit.tolerance_m = share * tolerance_m;
  fit.keeps_parameters = true;
  fit.min_spans = few_spans;
  constexpr double first_try = 0.5;
  fit.progress = progress.part(0.0, first_try);
  auto fitted = fit_shape(exact, fit);
  if (!progress.report(first_try)) return Progress::stopped();
  if (!fitted && !missed) {
    fit.progress = progress.part(first_try, 1.0);
    fit.min_spans = local_spans;
    fitted = fit_shape(exact, fit);
    if (!progress.report(1.0)) return Progress::stopped();
  }
  if (missed) return not_reached(with_fillet);
  if (!fitted) return not_fitted(fitted.error(), share, tolerance_m);
  return fitted;
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
  const double first_start = first.v.domain_start(), second_end = second.v.domain_end();
  PartShape of_first, of_fillet, of_second;
  of_first.at = [&](double u, const CornerLine& line, double s) {
    return position(first, u, between(first_start, line.first_v, s));
  };
  of_fillet.at = [&](double u, const CornerLine& line, double s) {
    return on_arc(position(first, u, line.first_v), position(second, line.second_u, line.second_v),
                  *line.centre_m, s);
  };
  of_second.at = [&](double, const CornerLine& line, double s) {
    return position(second, line.second_u, between(line.second_v, second_end, s));
  };
  of_first.pole_at_start = is_tube(first) && is_pole(first, Side::v_start);
  of_second.pole_at_end = is_tube(second) && is_pole(second, Side::v_end);
  std::optional<LinesFromLoop> from_loop;
  if (patches.beside_pole) {
    from_loop.emplace(second, lines.loop_on_second());
    of_second.bend = from_loop->share_of_bend();
    of_second.at = [&](double, const CornerLine& line, double s) {
      const Eigen::Vector2d uv = from_loop->at({line.second_u, line.second_v}, s);
      return position(second, uv.x(), uv.y());
    };
  }
  Parts parts;
  for (const PartShape* part : {&of_first, &of_fillet, &of_second}) {
    if (part == &of_fillet && request.fillet_m == 0.0) continue;
    const double done = static_cast<double>(parts.surfaces.size());
    const Progress progress = request.join.progress.part(done * fitted_share, (done + 1.0) * fitted_share);
    auto fitted =
        fitted_part(first, lines, *part, request.fillet_m > 0.0, request.join.tolerance_m, progress);
    if (!fitted) return fitted.error();
    parts.deviation_m = std::max(parts.deviation_m, fitted->deviation_m);
    parts.surfaces.push_back(std::move(fitted->surface));
  }
  return parts;
}

Error edges_apart(double apart_m, double tolerance_m) {
  return Error{"the parts that are kept end up to " + short_length_text(apart_m) +
               " apart where they should meet, too far for the tolerance of " +
               short_length_text(tolerance_m) + "; allow a larger one"};
}

Status check_folds(const Surface& merged, const Surface& first, const Surface& second) {
  const auto place = place_of_fold(merged);
  if (!place || place_of_fold(first) || place_of_fold(second)) return {};
  return Error{"the merged surface folds over at " + position_text(*place) +
               ": lines that lead away from the crossing run into each other there; let the other body enter "
               "nearer to a pole, or give the patches in the other order"};
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

// Which side of it is outside is told by its normals.
bool is_inward(const Surface& patch) {
  if (!is_tube(patch)) return false;
  const auto [start, end] = tube_sides(patch);
  return is_pole(patch, start) && is_pole(patch, end) && compute_enclosed_mass(patch).volume_m3 < 0.0;
}

Result<IntersectionMerge> merge_outward(const Surface& first, const Surface& second,
                                        const IntersectionRequest& request) {
  const auto patches = facing_each_other(first, second);
  if (!patches) return patches.error();
  auto parts = fitted_parts(patches.value(), request);
  if (!parts) return parts.error();
  const double before_m = parts->deviation_m;
  JoinRequest join = request.join;
  join.tolerance_m -= before_m;
  join.blend_m = 0.0;
  join.progress = request.join.progress.part(3.0 * fitted_share, 1.0);
  join.shared_parameters = true;
  if (request.fillet_m == 0.0) join.continuity = 0;
  auto joined = join_row(std::move(parts->surfaces), join);
  if (!joined) return joined.error();
  for (const Joint& joint : joined->joints) {
    if (joint.bridged) return edges_apart(joint.apart_m, request.join.tolerance_m);
  }
  if (Status sound = check_folds(joined->surface, first, second); !sound) return sound.error();
  const Joint corner = corner_of(joined.value());
  return IntersectionMerge{std::move(joined->surface), before_m + joined->deviation_m, corner};
}

}  // namespace

Result<IntersectionMerge> merge_crossing(const Surface& first, const Surface& second,
                                         const IntersectionRequest& request) {
  SPOONBILL_ASSERT(request.fillet_m >= 0.0);
  SPOONBILL_ASSERT_DEBUG(is_valid(first) && is_valid(second));
  const bool first_inward = is_inward(first), second_inward = is_inward(second);
  auto merged = merge_outward(first_inward ? reversed(first, Direction::u) : first,
                              second_inward ? reversed(second, Direction::u) : second, request);
  if (!merged) return merged;
  merged->first_was_inward = first_inward;
  merged->second_was_inward = second_inward;
  return merged;
}

}  // namespace spoonbill
