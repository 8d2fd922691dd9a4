// The stages of every contact in a snapshot, for drawing: of the tool and, where it is mirrored, its image
// with each body, and of the bodies with each other.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "engine/collision/stages/pair_stages.h"
#include "engine/collision/stages/tool_stages.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// Within which contacts are shown, in metres: what pressed bodies and tools leave between each other.
inline constexpr double stage_margin_m = 1e-4;

// One owner, whoever draws, on its own thread; allocates, and keeps what depends on knots and tool alone from
// snapshot to snapshot. The stages depend on the snapshot alone; they are those of its float control points.
class SnapshotStages {
 public:
  // Bodies whose control net does not fit their knots or is not finite are left out.
  ContactStages find(const Snapshot& snapshot);

 private:
  struct Solid {
    std::shared_ptr<const ToolBody> made_from;
    std::shared_ptr<const SignedDistance> distance;  // of an implicit or tessellated one
    std::shared_ptr<const Surface> surface;          // of a B-spline one, in its frame
  };
  struct Numbered {
    const Surface* surface;
    std::uint64_t structure;
    bool closed = true;  // with du x dv outward
    std::shared_ptr<const TrimmedArea> trim = {};
  };

  void follow(const ToolSnapshot& tool);
  void add_tool(const Snapshot& snapshot, const Pose& pose, const Eigen::Matrix3d& turn,
                const std::vector<Numbered>& bodies, ContactStages& stages);
  void add_pair(const Numbered& first, const Numbered& second, ContactStages& stages);

  Solid solid_;
  // By the structures of their surfaces.
  std::map<std::uint64_t, ToolStages> tool_stages_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, PairStages> pair_stages_;
};

}  // namespace spoonbill
