// Ambient occlusion: how much of its surroundings each vertex of the drawn bodies sees past the bodies.
// Does not use GL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/tessellation/tessellated_surface.h"

namespace spoonbill {

// Visibility of each vertex of a surface, from 0 to 1, on the side of its normal and on the other.
struct BothSides {
  std::vector<float> front, back;

  // Makes everything visible.
  void assign(std::size_t count) {
    front.assign(count, 1.0f);
    back.assign(count, 1.0f);
  }
};

// The triangles of all bodies are gathered into discs; the light that each disc keeps from a vertex is its
// form factor (point to disc, Bunnell 2005), and the sum of these is taken from 1. Overlapping discs are
// counted twice, so that deep corners are darker than they should be. What a smooth body hides of itself is
// exact in the limit of small discs: inside a part of a sphere, the part's area over that of the sphere. One
// owner, one thread.
class AmbientOcclusion {
 public:
  // Computes the visibility of all vertices that moved since the last call, or could see or hide something
  // that did. Where there are so many vertices and bodies that it would take seconds, everything is visible.
  // With `parts` above 1, a call computes only one vertex in so many, so that as many calls compute all of
  // them; the first call for other triangles computes all.
  void update(const std::vector<TessellatedSurface>& surfaces, std::size_t parts = 1);

  // Returns for each vertex of a surface how much of the hemisphere above it no body hides, weighted by the
  // cosine. The back of a closed surface is as visible as its front.
  const BothSides& visibility(std::size_t surface) const { return bodies_[surface].visibility; }

 private:
  // Triangles of a body, in groups that become discs. They stay the same while the body deforms, so that
  // nothing flickers.
  struct Groups {
    std::uint64_t topology_version = 0;
    std::size_t index_count = 0;
    std::size_t wanted = 0;                // number of groups that was asked for
    std::vector<std::uint32_t> triangles;  // ordered by group
    std::vector<std::uint32_t> ends;       // end of each group in `triangles`

    // Returns whether the groups are those of a surface. Groups of a mesh depend on its first shape, so that
    // they stay, however many are wanted.
    bool fit(const TessellatedSurface& surface, std::size_t wanted_now) const {
      return topology_version == surface.topology_version() && index_count == surface.indices().size() &&
             (surface.is_mesh() || wanted == wanted_now);
    }
  };
  struct Body {
    Groups groups;
    std::vector<float> positions_m;  // at the last update, x then y then z
    BothSides visibility;
  };
  // Discs as separate arrays; `x` to `z` are centres, `nx` to `nz` normals.
  struct Discs {
    std::vector<float> x, y, z, nx, ny, nz, area_m2;
    std::vector<float> two_sided;  // 1 for a disc of an open surface, which also hides what is behind it

    void clear();
    void add(const Eigen::Vector3f& centre_m, const Eigen::Vector3f& area_normal_m2, bool is_two_sided);
    std::size_t count() const { return x.size(); }
  };

  bool have_moved(const std::vector<TessellatedSurface>& surfaces, std::size_t wanted);
  // Returns whether visibility() has a value for each vertex of these surfaces.
  bool fits(const std::vector<TessellatedSurface>& surfaces) const;
  // Computes the visibility of vertices `first`, `first + step`...
  void find_visibility(const TessellatedSurface& surface, std::size_t first, std::size_t step,
                       BothSides& visibility) const;
  static void group(const TessellatedSurface& surface, std::size_t wanted, Groups& groups);
  void append_discs(const TessellatedSurface& surface, const Groups& groups);
  float hidden(const Eigen::Vector3f& point_m, const Eigen::Vector3f& normal) const;

  std::vector<Body> bodies_;
  Discs discs_;
  std::size_t parts_left_ = 0;  // number of calls after which all vertices are computed
  std::size_t part_ = 0;        // part that is computed next
};

}  // namespace spoonbill
