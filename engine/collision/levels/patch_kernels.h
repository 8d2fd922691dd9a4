// The loops of contact between surfaces, compiled once for each instruction set: the samples of an element,
// its cells as slabs, and which slabs of two surfaces could meet. As in evaluate_kernels.h, this header and
// its source use no standard library and no Eigen.
#pragma once

namespace spoonbill {

inline constexpr int slab_lanes = 4;

// Values of the basis functions that an element has in one direction, at its finest samples: `bandwidth` rows
// of `padded` values, those past `samples` zero; and the indices of their control points.
struct TileBand {
  const int* controls;
  const double* values;
  int bandwidth, samples, padded;
};

// A list of points, by coordinate; none where the pointers are null.
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

// The four cells within a cell, or one alone, by lane. With p(s, t) = centre + s along_u + t along_v + s t w
// the bilinear patch of a cell's corners, s and t from -1 to 1, the surface lies within the bulge of it:
// along its unit normal it leaves the centre by `thickness` at most, along any unit vector d by
// |d . along_u| + |d . along_v| + slack.
//
// In single precision; thickness and slack hold what that leaves out.
struct SlabGroup {
  float centre[3][slab_lanes];
  float along_u[3][slab_lanes];
  float along_v[3][slab_lanes];
  float normal[3][slab_lanes];  // zero where the corners lie on a line
  float thickness[slab_lanes];
  float slack[slab_lanes];
};

struct PatchKernels {
  // The samples of an element: first along v for each of its control rows, into `lines` (3 * u.bandwidth *
  // v.padded numbers of working memory), then along u. Rows of samples are `columns` apart. Every sum begins
  // at zero and goes by rising control index, as that of a single sample does.
  void (*sample_tile)(const TileBand& u, const TileBand& v, const PlanarPoints& net, long net_columns,
                      double* lines, const PlanarOutput& samples, long columns);

  // The four cells between 3 x 3 samples (9 numbers a coordinate, row by row), each off its bilinear patch by
  // `bulge` at most.
  void (*take_slabs)(const PlanarPoints& samples, double bulge, SlabGroup& group);

  // Bit 4 i + j is set unless a plane lies between slab i of the first, of which there are `lanes`, 1 or 4,
  // and slab j of the second and more than `reach` apart from one of them: across either normal or across the
  // line between their centres.
  unsigned (*meeting)(const SlabGroup& first, int lanes, const SlabGroup& second, float reach);
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
