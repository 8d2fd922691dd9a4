// Where a tool that comes along a ray first touches the body: how a mouse, which knows no depth, brings a
// tool to the surface. One owner; the thread that draws.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/simulation/snapshot.h"
#include "render/camera.h"
#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

struct PickedPoint {
  Vector3 centre_m;  // of the tool as it touches
  Vector3 outward;   // unit, from the body to the tool's centre
};

class SurfacePick {
 public:
  // Samples the surfaces as they are; keeps the grids until a surface's knots change. Surfaces that cannot be
  // evaluated are not picked.
  void update(const Snapshot& snapshot);

  // The first place along the ray where a sphere of that radius meets the samples, each taken as a small ball
  // so that the tool does not sink between them; none where it passes by.
  std::optional<PickedPoint> first_touch(const Ray& ray, double radius_m) const;

 private:
  struct Sampled {
    TessellatedSurface surface;
    double ball_m = 0.0;  // radius of the small balls: half a cell's diagonal
    std::vector<std::uint32_t> vertices;
    std::uint64_t topology = 0;  // of which those are
  };
  static void take_vertices(Sampled& sampled);

  std::vector<Sampled> surfaces_;
};

}  // namespace spoonbill
