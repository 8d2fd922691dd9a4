// Numeric kernels of surface contact, compiled once for each instruction set. They sample an element, bound
// its cells by slabs and test which slabs of two surfaces may meet. As in evaluate_kernels.h, this header and
// its source use no standard library and no Eigen.
#pragma once

namespace spoonbill {

inline constexpr int slab_lanes = 4;

// Values of an element's basis functions in one direction, at the element's samples of the finest level.
// `values` has `bandwidth` rows of `padded` numbers, which are zero beyond `samples`. `controls` contains the
// index of each row's control point.
struct TileBand {
  const int* controls;
  const double* values;
  int bandwidth, samples, padded;
};

// Points as separate coordinate arrays. Null pointers mean that no points are given.
struct PlanarPoints {
  const double* x = nullptr;
  const double* y = nullptr;
  const double* z = nullptr;
};
struct PlanarOutput {
  double* x;
  double* y;
  double* z;
};

// Slabs around four cells, or around one cell that is repeated in all lanes.
//
// The bilinear patch of a cell's corners is p(s, t) = centre + s along_u + t along_v + s t w, with s and t
// from -1 to 1. The surface deviates from this patch by at most the bulge. Along the unit normal, the surface
// is at most `thickness` from the centre; along any unit vector d, at most |d . along_u| + |d . along_v| +
// slack. The values are in single precision; thickness and slack include the rounding.
struct SlabGroup {
  float centre[3][slab_lanes];
  float along_u[3][slab_lanes];
  float along_v[3][slab_lanes];
  float normal[3][slab_lanes];  // unit normal; zero if the corners are collinear
  float thickness[slab_lanes];
  float slack[slab_lanes];
};

// The kernels of one instruction set. They are pure functions and may be called from any thread.
struct PatchKernels {
  // Samples one element: first along v, for each row of control points, into `lines` (working memory of 3 *
  // u.bandwidth * v.padded numbers), then along u. Rows of `samples` are `columns` apart. Each sum starts at
  // zero and adds its terms in the same order as SurfaceLevels::sample(), so both give bitwise equal results.
  void (*sample_tile)(const TileBand& u, const TileBand& v, const PlanarPoints& net, long net_columns,
                      double* lines, const PlanarOutput& samples, long columns);

  // Computes the slabs of the four cells between 3 x 3 samples (9 numbers per coordinate, row by row). The
  // surface deviates from the bilinear patch of each cell by at most `bulge`.
  void (*compute_slabs)(const PlanarPoints& samples, double bulge, SlabGroup& group);

  // Sets bit 4 i + j of the result if slab i of the first group may be within `reach` of slab j of the
  // second. The tested separating planes are perpendicular to the two normals and to the line between the
  // centres. `lanes` is the number of slabs of the first group, 1 or 4.
  unsigned (*find_meeting)(const SlabGroup& first, int lanes, const SlabGroup& second, float reach);
};

namespace kernels_baseline {
extern const PatchKernels patch_kernels;
}  // namespace kernels_baseline
namespace kernels_avx2 {
extern const PatchKernels patch_kernels;
}  // namespace kernels_avx2
namespace kernels_avx512 {
extern const PatchKernels patch_kernels;
}  // namespace kernels_avx512

}  // namespace spoonbill
