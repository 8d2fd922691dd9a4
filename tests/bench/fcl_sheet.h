// Sheets in FCL's form: triangle meshes whose vertices are replaced and whose tree is refitted.
#pragma once

#include <fcl/geometry/bvh/BVH_model.h>
#include <malloc.h>

#include <memory>
#include <vector>

#include "engine/bspline/evaluate.h"
#include "engine/bspline/grid.h"

namespace spoonbill {

using FclPoints = std::vector<fcl::Vector3<float>>;

inline FclPoints fcl_points(const GridSamples<double>& samples) {
  FclPoints points;
  for (std::size_t k = 0; k < samples.x.size(); ++k) {
    points.push_back(fcl::Vector3<double>(samples.x[k], samples.y[k], samples.z[k]).cast<float>());
  }
  return points;
}

// Triangles 2 q and 2 q + 1 belong to quad q; quads are in row-major order.
template <class Volume>
std::shared_ptr<fcl::BVHModel<Volume>> fcl_mesh(const FclPoints& vertices, std::size_t quads) {
  std::vector<fcl::Triangle> triangles;
  for (std::size_t i = 0; i < quads; ++i) {
    for (std::size_t j = 0; j < quads; ++j) {
      const std::size_t corner = i * (quads + 1) + j;
      triangles.emplace_back(corner, corner + 1, corner + quads + 1);
      triangles.emplace_back(corner + 1, corner + quads + 2, corner + quads + 1);
    }
  }
  auto mesh = std::make_shared<fcl::BVHModel<Volume>>();
  mesh->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
  mesh->addSubModel(vertices, triangles);
  mesh->endModel();
  return mesh;
}

template <class Volume>
void refit(fcl::BVHModel<Volume>& mesh, const FclPoints& vertices) {
  mesh.beginReplaceModel();
  mesh.replaceSubModel(vertices);
  mesh.endReplaceModel(true, true);
}

// Makes the allocator keep freed pages. FCL copies a mesh of boxes at each query, and returning the pages to
// the system each time would double the cost of a query.
inline void keep_freed_pages() {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
}

// Returns the points of the surface at the grid's parameters.
inline GridSamples<double> samples_of(const Surface& surface, const Grid& grid) {
  GridSamples<double> samples;
  samples.resize(static_cast<std::size_t>(grid.rows()) * static_cast<std::size_t>(grid.columns()));
  GridEvaluator<double> evaluator(grid, best_instruction_set());
  evaluator.points(surface.net.x.data(), surface.net.y.data(), surface.net.z.data(), samples);
  return samples;
}

}  // namespace spoonbill
