#include "app/commands/merge_report.h"

#include <algorithm>
#include <limits>

#include "engine/base/text.h"
#include "engine/inspection/curvature.h"

namespace spoonbill {

namespace {

std::string edge_text(const PatchEdge& edge) {
  return std::to_string(edge.patch + 1) + "." + side_name(edge.side);
}

std::string edges_text(const PatchEdge& a, const PatchEdge& b) {
  return edge_text(a) + " and " + edge_text(b);
}

std::string joint_text(const MergedJoint& merged) {
  const Joint& joint = merged.joint;
  const std::string edges = edges_text(merged.a, merged.b);
  if (merged.closes) return edges + ", edge to edge, which closes the surface around";
  if (!joint.bridged) return edges + ", edge to edge";
  if (joint.cut_back_m == 0.0) {
    return edges + ", bridged over a gap of " + short_length_text(joint.gap_m) + " by a blend of " +
           short_length_text(joint.blend_length_m);
  }
  return edges + ", up to " + short_length_text(joint.apart_m) + " apart, cut back by " +
         short_length_text(joint.cut_back_m) + " each for a blend of " +
         short_length_text(joint.blend_length_m);
}

Json joint_json(const std::string& a, const std::string& b, Direction along, const Joint& joint) {
  return {{"a", a},
          {"b", b},
          {"along", along == Direction::u ? "u" : "v"},
          {"bridged", joint.bridged},
          {"gap_m", joint.gap_m},
          {"apart_m", joint.apart_m},
          {"cut_back_m", joint.cut_back_m},
          {"blend_start", joint.blend_start},
          {"blend_end", joint.blend_end},
          {"blend_length_m", joint.blend_length_m}};
}

std::string corner_text(const Joint& corner, bool is_last) {
  const std::string start = number_text(corner.blend_start), end = number_text(corner.blend_end);
  if (!corner.bridged) return "an edge" + (is_last ? " at v = " + start : "");
  return "a fillet of " + short_length_text(corner.blend_length_m) + " along" +
         (is_last ? " from v = " + start + " to " + end : "");
}

// The middles of the quarters of those pieces that reach into a range.
std::vector<double> within_pieces(const KnotVector& knots, double start, double end) {
  constexpr int parts = 4;
  const std::vector<double> ends = knots.breakpoints();
  std::vector<double> middles;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    if (ends[k + 1] < start || ends[k] > end) continue;
    for (int part = 0; part < parts; ++part) {
      middles.push_back(ends[k] + (ends[k + 1] - ends[k]) * (part + 0.5) / parts);
    }
  }
  return middles;
}

// Along a fillet and where it begins and ends; of the side that is hollow, a fillet's own.
double tightest_radius_m(const Surface& merged, const Joint& corner) {
  double least = std::numeric_limits<double>::infinity();
  const KnotVector &u = merged.u, &v = merged.v;
  for (const double at_v : within_pieces(v, corner.blend_start, corner.blend_end)) {
    for (const double at_u : within_pieces(u, u.domain_start(), u.domain_end())) {
      const auto curvatures = compute_principal_curvatures(evaluate(merged, at_u, at_v));
      if (curvatures && curvatures->smallest < 0.0) least = std::min(least, -1.0 / curvatures->smallest);
    }
  }
  return least;
}

}  // namespace

void add_joints(FactSheet& facts, const std::vector<MergedJoint>& joints) {
  Json list = Json::array();
  for (const MergedJoint& merged : joints) {
    facts.add("Joint", joint_text(merged), "", nullptr);
    list.push_back(joint_json(edge_text(merged.a), edge_text(merged.b), merged.along, merged.joint));
    list.back()["closes"] = merged.closes;
  }
  facts.add("", "", "joints", list);
}

void add_corners(FactSheet& facts, const std::vector<Joint>& corners) {
  Json list = Json::array();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const bool is_last = k + 1 == corners.size();
    const std::string second = std::to_string(k + 2);
    facts.add("Joint",
              (k == 0 ? "1 and " : "before and ") + second + " at " + corner_text(corners[k], is_last), "",
              nullptr);
    list.push_back(joint_json("1", second, Direction::v, corners[k]));
    if (!is_last) list.back()["blend_start"] = list.back()["blend_end"] = nullptr;
  }
  facts.add("", "", "joints", list);
}

void add_unused_blends(const std::vector<MergedJoint>& joints, std::vector<std::string>& remarks) {
  for (const MergedJoint& merged : joints) {
    if (merged.joint.cut_back_m > 0.0) continue;
    remarks.push_back("the blend was not applied to " + edges_text(merged.a, merged.b) +
                      (merged.closes          ? ": the seam that they make is closed within the tolerance"
                       : merged.joint.bridged ? ": the gap between them is longer"
                                              : ": they meet as smoothly as asked"));
  }
}

void add_tight_fillet(const Surface& merged, const Joint& corner, const std::string& which, double fillet_m,
                      int continuity, std::vector<std::string>& remarks) {
  constexpr double tight_share = 0.8;
  const double least_m = tightest_radius_m(merged, corner);
  if (!(least_m < tight_share * fillet_m)) return;
  remarks.push_back("the fillet" + which + " is as tight as about " + short_length_text(least_m) +
                    " somewhere, where " + short_length_text(fillet_m) + " was asked for" +
                    (continuity > 1 ? ": an arc is not C2 with what it touches; C1 keeps its radius"
                                    : "; a smaller tolerance brings it nearer"));
}

void add_left_open(const std::vector<OpenEdges>& edges, std::vector<std::string>& remarks) {
  for (const auto& [a, b, why] : edges) {
    remarks.push_back(edges_text(a, b) + " touch too and stay open: " + why);
  }
}

}  // namespace spoonbill
