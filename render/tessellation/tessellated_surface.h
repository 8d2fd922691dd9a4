// The surface of a body as triangles: a B-spline surface sampled on a knot-aligned grid, or a deforming mesh.
// Does not use GL.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/base/geometry.h"
#include "engine/base/result.h"
#include "engine/bspline/evaluate.h"
#include "engine/bspline/grid.h"
#include "engine/bspline/trimmed_area.h"
#include "engine/simulation/snapshot.h"

namespace spoonbill {

// The fineness of a tessellation: the number of pieces into which each polynomial span is divided.
// choose_sampling_level() uses only the numbers 1, 2, 3, 4, 6, 8, 12, 16, 24 and 32, so that the grid seldom
// changes. The ends of every span are vertices.
struct SamplingLevel {
  // Number of pieces of each span between the breakpoints of a direction; empty before the first choice.
  std::vector<int> u_pieces;
  std::vector<int> v_pieces;

  friend bool operator==(const SamplingLevel&, const SamplingLevel&) = default;
};

// Returns a level with the same number of pieces in every span.
SamplingLevel uniform_sampling_level(const SurfaceSnapshot& surface, int pieces);

struct SamplingTarget {
  double longest_edge_px = 48.0;
  // Largest distance of a chord from its arc. With 4 samples per pixel, larger distances are visible.
  double largest_sagitta_px = 0.3;
};

// Maximum number of cells of one surface. Without a limit, all of a large surface seen from close up would be
// sampled finely, including the part behind the camera.
inline constexpr std::int64_t sampling_cell_limit = 1'000'000;

// Returns the level at which no edge and no sagitta exceeds the target, estimated from the control points of
// the derivatives. A span keeps the number of pieces that it has in `previous` while this number is between
// 0.87 and 2.5 times the needed number. A slowly changing shape then does not flicker between levels. The
// level is coarser if the number of cells would exceed sampling_cell_limit. The size of the net must fit the
// knots.
SamplingLevel choose_sampling_level(const SurfaceSnapshot& surface, double pixels_per_metre,
                                    const SamplingLevel& previous, const SamplingTarget& target = {});

// Returns the parameters at which one parameter direction is sampled, aligned with the knots. The seam of a
// periodic direction appears once. `pieces` has one entry per span.
std::vector<double> drawing_parameters(const KnotVector& knots, const std::vector<int>& pieces);

// Computes the vertices and normals of a deforming mesh. The mesh appears smooth where adjacent faces meet at
// an angle of up to 40 degrees, and has a sharp edge elsewhere. One owner, one thread.
class MeshShading {
 public:
  // Returns whether the shading was built for these triangles.
  bool matches(const MeshSnapshot& mesh) const { return mesh.triangles == triangles_; }

  // Finds the sharp edges in the current shape of the mesh. They remain sharp edges while the mesh deforms.
  void rebuild(const MeshSnapshot& mesh);

  // Vertex indices, three per triangle, counter-clockwise seen from outside.
  const std::vector<std::uint32_t>& indices() const { return indices_; }

  // Computes positions and normals of the vertices. Requires matches(mesh). Allocates nothing once `samples`
  // has its size.
  void shade(const MeshSnapshot& mesh, GridSamples<float>& samples) const;

 private:
  // Shared ownership, so that no other mesh can get this address, which matches() compares.
  std::shared_ptr<const std::vector<std::array<std::uint32_t, 3>>> triangles_;
  std::vector<std::uint32_t> indices_;  // for each triangle corner, the index of its drawn vertex
  std::vector<std::uint32_t> vertex_;   // for each drawn vertex, the index of its mesh vertex
};

// Returns an error if the size of the control net does not fit the knots.
Status check_net(const SurfaceSnapshot& surface);

// A surface or a deforming mesh, tessellated for drawing. One owner, one thread.
class TessellatedSurface {
 public:
  // Evaluates the surface at a sampling level. Grid, blending matrices and indices are rebuilt only if the
  // level or the surface's structure, knots or trim have changed; otherwise nothing is allocated. Errors: a
  // grid that cannot be built, a control net whose size does not fit its knots.
  Status update(const SurfaceSnapshot& surface, const SamplingLevel& level);

  // Updates from a mesh. Its triangles do not depend on a sampling level.
  void update(const MeshSnapshot& mesh);
  // Returns whether the last update() received a mesh.
  bool is_mesh() const { return is_mesh_; }

  const SamplingLevel& level() const { return level_; }

  // The rows and columns of the grid whose samples come first in samples(); not for a mesh.
  std::size_t rows() const { return static_cast<std::size_t>(grid_->rows()); }
  std::size_t columns() const { return static_cast<std::size_t>(grid_->columns()); }

  // Positions in metres and unit normals of the vertices. Normals point outward on a closed surface and along
  // du x dv on an open surface.
  const GridSamples<float>& samples() const { return samples_; }
  std::size_t vertex_count() const { return samples_.x.size(); }

  // Triangles, counter-clockwise seen from the side of the normals. Seams share vertices. A pole is a row of
  // coincident vertices; some of the triangles at a pole have no area.
  const std::vector<std::uint32_t>& indices() const { return indices_; }

  // Number of rebuilds of the indices. GL buffers upload the indices when it has changed.
  std::uint64_t topology_version() const { return topology_version_; }

  // Returns whether the surface encloses a volume. The inside of such a surface is never visible.
  bool is_closed() const { return closed_; }

  // Returns true if the triangles are cut along trim loops. Samples that no triangle uses are then outside
  // the trimmed surface.
  bool is_trimmed() const { return trim_ != nullptr; }

  Box bounds() const;

 private:
  Status rebuild(const SurfaceSnapshot& surface, const SamplingLevel& level);
  void build_indices(bool u_wraps, bool v_wraps);
  void trim_indices();
  void fill_cut_vertices();
  void orient();
  bool is_edge_collapsed(bool along_u, int at) const;
  double signed_volume_m3() const;

  std::uint64_t structure_ = 0;
  SamplingLevel level_;
  MeshShading shading_;
  bool is_mesh_ = false;
  std::uint64_t topology_version_ = 0;
  bool closed_ = false;
  bool inward_ = false;  // true if du x dv points into the closed surface
  std::unique_ptr<const Grid> grid_;
  std::optional<GridEvaluator<float>> evaluator_;
  GridSamples<float> samples_;
  std::vector<std::uint32_t> indices_;
  std::shared_ptr<const TrimmedArea> trim_;
  std::vector<CutVertex> cut_vertices_;  // vertices of trimmed cells; their samples come last in samples_
};

// Returns the box around all surfaces of a snapshot. The surfaces are evaluated, because boxes around control
// nets would be larger. Meant for framing and for the ground, not for every frame. Surfaces that cannot be
// evaluated are skipped.
Box drawn_bounds(const Snapshot& snapshot);

}  // namespace spoonbill
