// Contact debug views: the stages of collision detection (ContactStages) for every contact in a snapshot.
// They cover the tool and its mirror image against every body, and every pair of bodies.
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

// Largest gap at which a contact is drawn, in metres. It is about the gap that remains between pressed bodies
// and tools.
inline constexpr double stage_margin_m = 1e-4;

// Finds collision stages for drawing. The result depends only on the snapshot, whose control points are
// floats. Data that depends only on knots and tool is cached between snapshots. Has one owner, on the drawing
// thread, and allocates.
class SnapshotStages {
 public:
  // Finds the stages of a snapshot. Skips meshes, and bodies whose control net does not fit their knots or is
  // not finite.
  ContactStages find(const Snapshot& snapshot);

 private:
  struct Solid {
    std::shared_ptr<const ToolBody> made_from;
    std::shared_ptr<const SignedDistance> distance;  // only for implicit or tessellated tools
    std::shared_ptr<const Surface> surface;          // only for B-spline tools, in the tool's frame
  };
  // Surface of a body or a tool, with the fingerprint of its knots.
  struct StructuredSurface {
    const Surface* surface;
    std::uint64_t structure;
    bool closed = true;  // true if it encloses a solid, with du x dv outward
    std::shared_ptr<const TrimmedArea> trim = {};
  };

  void update_solid(const ToolSnapshot& tool);
  void add_tool(const Snapshot& snapshot, const Pose& pose, const Eigen::Matrix3d& turn,
                const std::vector<StructuredSurface>& bodies, ContactStages& stages);
  void add_pair(const StructuredSurface& first, const StructuredSurface& second, ContactStages& stages);

  Solid solid_;
  // Both caches are keyed by the fingerprints of the surfaces.
  std::map<std::uint64_t, ToolStages> tool_stages_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, PairStages> pair_stages_;
};

}  // namespace spoonbill
