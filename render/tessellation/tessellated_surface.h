// A surface as triangles: samples on a knot-aligned grid and the indices that join them, or those that a mesh
// has. No GL. One owner, one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/simulation/snapshot.h"
#include "render/camera.h"
#include "render/tessellation/mesh_shading.h"
#include "render/tessellation/sampling_level.h"

namespace spoonbill {

// Refused: a control net whose size does not fit its knots.
Status check_net(const SurfaceSnapshot& surface);

class TessellatedSurface {
 public:
  // Evaluates the surface at the level. The grid, its blending matrices and the indices are built again only
  // when the surface's structure or the level changed; otherwise this allocates nothing. The error names what
  // the grid refused, or a control net whose size does not fit its knots.
  Status update(const SurfaceSnapshot& surface, const SamplingLevel& level);

  // The same of a mesh, which has its triangles whatever the level.
  void update(const MeshSnapshot& mesh);
  // Whether it holds one now.
  bool is_mesh() const { return is_mesh_; }

  const SamplingLevel& level() const { return level_; }

  // Positions in metres and unit normals, vertex by vertex. Normals point outward from a closed surface,
  // along du x dv of an open one.
  const GridSamples<float>& samples() const { return samples_; }
  std::size_t vertex_count() const { return samples_.x.size(); }

  // Triangles, counter-clockwise seen from where the normals point. Seams are joined by shared vertices. A
  // pole is a row of vertices in one place, its triangles partly of no area.
  const std::vector<std::uint32_t>& indices() const { return indices_; }

  // Counts the rebuilds of grid and indices, so that buffers know when to follow.
  std::uint64_t topology_version() const { return topology_version_; }

  // Whether the surface encloses a volume: nobody sees its inside.
  bool is_closed() const { return closed_; }

  // Whether triangles are cut along trim loops; samples that no triangle has are then not of the surface.
  bool is_trimmed() const { return trim_ != nullptr; }

  Box bounds() const;

 private:
  Status rebuild(const SurfaceSnapshot& surface, const SamplingLevel& level);
  void build_indices(bool u_wraps, bool v_wraps);
  void trim_indices();
  void fill_cut_vertices();
  void orient();
  bool edge_collapsed(bool along_u, int at) const;
  double signed_volume_m3() const;

  std::uint64_t structure_ = 0;
  SamplingLevel level_;
  MeshShading shading_;
  bool is_mesh_ = false;
  std::uint64_t topology_version_ = 0;
  bool closed_ = false;
  bool inward_ = false;  // du x dv points into the closed surface
  std::unique_ptr<const Grid> grid_;
  std::optional<GridEvaluator<float>> evaluator_;
  GridSamples<float> samples_;
  std::vector<std::uint32_t> indices_;
  std::shared_ptr<const TrimmedArea> trim_;
  std::vector<CutVertex> cut_vertices_;  // the samples after the grid's
};

// The box around all surfaces of a snapshot, evaluated rather than taken from the control nets, which reach
// farther. Meant for framing and for the ground, not for every frame. Surfaces that cannot be evaluated are
// left out.
Box drawn_bounds(const Snapshot& snapshot);

}  // namespace spoonbill
