#include "render/tessellation/tessellated_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <utility>

#include "engine/base/geometry.h"

namespace spoonbill {
namespace {

Eigen::Vector3d vertex(const GridSamples<float>& samples, std::size_t i) {
  return {samples.x[i], samples.y[i], samples.z[i]};
}

}  // namespace

Status check_net(const SurfaceSnapshot& surface) {
  const auto expected = static_cast<std::size_t>(surface.u.control_point_count()) *
                        static_cast<std::size_t>(surface.v.control_point_count());
  if (surface.x.size() == expected && surface.y.size() == expected && surface.z.size() == expected) return {};
  return Error{"surface to draw: its knots ask for " + std::to_string(expected) +
               " control points, its net has " + std::to_string(surface.x.size())};
}

Status TessellatedSurface::update(const SurfaceSnapshot& surface, const SamplingLevel& level) {
  if (Status net = check_net(surface); !net) return net;
  const bool keep = !is_mesh_ && evaluator_ && structure_ == surface.structure && level_ == level &&
                    grid_->u.knots == surface.u && grid_->v.knots == surface.v && trim_ == surface.trim;
  if (!keep) {
    if (Status built = rebuild(surface, level); !built) return built;
  }
  evaluator_->points_and_normals(surface.x.data(), surface.y.data(), surface.z.data(), samples_);
  if (!keep) orient();
  fill_cut_vertices();
  if (inward_) {
    for (auto* component : {&samples_.nx, &samples_.ny, &samples_.nz}) {
      for (float& value : *component) value = -value;
    }
  }
  return {};
}

void TessellatedSurface::update(const MeshSnapshot& mesh) {
  if (!is_mesh_ || !shading_.is_of(mesh)) {
    shading_.make(mesh);
    indices_ = shading_.indices();
    ++topology_version_;
    closed_ = is_mesh_ = true;
    level_ = {};
    trim_ = nullptr;
    cut_vertices_.clear();
  }
  shading_.shade(mesh, samples_);
}

Status TessellatedSurface::rebuild(const SurfaceSnapshot& surface, const SamplingLevel& level) {
  auto grid = make_grid(surface.u, surface.v, drawing_parameters(surface.u, level.u_pieces),
                        drawing_parameters(surface.v, level.v_pieces));
  if (!grid) return grid.error();
  evaluator_.reset();
  grid_ = std::make_unique<const Grid>(std::move(grid).value());
  evaluator_.emplace(*grid_, best_instruction_set());
  samples_.resize(static_cast<std::size_t>(grid_->rows()) * static_cast<std::size_t>(grid_->columns()));
  structure_ = surface.structure;
  level_ = level;
  is_mesh_ = false;
  trim_ = surface.trim;
  cut_vertices_.clear();
  build_indices(surface.u.is_periodic(), surface.v.is_periodic());
  ++topology_version_;
  return {};
}

void TessellatedSurface::build_indices(bool u_wraps, bool v_wraps) {
  const int rows = grid_->rows(), columns = grid_->columns();
  const int row_cells = u_wraps ? rows : rows - 1;
  const int column_cells = v_wraps ? columns : columns - 1;
  indices_.clear();
  indices_.reserve(6 * static_cast<std::size_t>(row_cells) * static_cast<std::size_t>(column_cells));
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % rows) * columns + j % columns);
  };
  for (int i = 0; i < row_cells; ++i) {
    for (int j = 0; j < column_cells; ++j) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      for (const std::uint32_t corner : {a, b, c, a, c, d}) indices_.push_back(corner);
    }
  }
}

// Whether the first or last line across a direction has shrunk to a point.
bool TessellatedSurface::edge_collapsed(bool along_u, int at) const {
  const int rows = grid_->rows(), columns = grid_->columns();
  const int count = along_u ? columns : rows;
  constexpr double pole_m = 1e-7;
  const auto index = [&](int k) {
    return static_cast<std::size_t>(along_u ? at * columns + k : k * columns + at);
  };
  const Eigen::Vector3d first = vertex(samples_, index(0));
  for (int k = 1; k < count; ++k) {
    if ((vertex(samples_, index(k)) - first).norm() > pole_m) return false;
  }
  return true;
}

double TessellatedSurface::signed_volume_m3() const {
  double six_volumes = 0.0;
  const Eigen::Vector3d origin = vertex(samples_, 0);
  for (std::size_t i = 0; i + 2 < indices_.size(); i += 3) {
    const Eigen::Vector3d a = vertex(samples_, indices_[i]) - origin;
    const Eigen::Vector3d b = vertex(samples_, indices_[i + 1]) - origin;
    const Eigen::Vector3d c = vertex(samples_, indices_[i + 2]) - origin;
    six_volumes += a.dot(b.cross(c));
  }
  return six_volumes / 6.0;
}

void TessellatedSurface::orient() {
  const bool u_shut =
      grid_->u.knots.is_periodic() || (edge_collapsed(true, 0) && edge_collapsed(true, grid_->rows() - 1));
  const bool v_shut = grid_->v.knots.is_periodic() ||
                      (edge_collapsed(false, 0) && edge_collapsed(false, grid_->columns() - 1));
  closed_ = u_shut && v_shut;
  inward_ = closed_ && signed_volume_m3() < 0.0;
  if (trim_) trim_indices();
  if (!inward_) return;
  for (std::size_t i = 0; i + 2 < indices_.size(); i += 3) std::swap(indices_[i + 1], indices_[i + 2]);
}

// Takes the place of the whole surface's triangles, by which it is known whether it is closed and which side
// is out.
void TessellatedSurface::trim_indices() {
  TrimmedGrid cut = trim_grid(grid_->u, grid_->v, *trim_);
  indices_.clear();
  for (const auto& triangle : cut.triangles) {
    indices_.insert(indices_.end(), triangle.begin(), triangle.end());
  }
  cut_vertices_ = std::move(cut.vertices);
  samples_.resize(samples_.x.size() + cut_vertices_.size());
  closed_ = false;
}

void TessellatedSurface::fill_cut_vertices() {
  std::size_t at = samples_.x.size() - cut_vertices_.size();
  for (const CutVertex& cut : cut_vertices_) {
    const auto mean = [&](const std::vector<float>& values) {
      double sum = 0.0;
      for (std::size_t c = 0; c < cut.corners.size(); ++c) sum += cut.weights[c] * values[cut.corners[c]];
      return sum;
    };
    const Eigen::Vector3d normal =
        Eigen::Vector3d(mean(samples_.nx), mean(samples_.ny), mean(samples_.nz)).normalized();
    samples_.x[at] = static_cast<float>(mean(samples_.x));
    samples_.y[at] = static_cast<float>(mean(samples_.y));
    samples_.z[at] = static_cast<float>(mean(samples_.z));
    samples_.nx[at] = static_cast<float>(normal.x());
    samples_.ny[at] = static_cast<float>(normal.y());
    samples_.nz[at] = static_cast<float>(normal.z());
    ++at;
  }
}

Box TessellatedSurface::bounds() const {
  Box box;
  if (samples_.x.empty()) return box;
  if (trim_) {
    for (const std::uint32_t i : indices_) box.include(vertex(samples_, i));
    return box;
  }
  const std::vector<float>* axes[3] = {&samples_.x, &samples_.y, &samples_.z};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax_element(axes[axis]->begin(), axes[axis]->end());
    box.low[axis] = *low;
    box.high[axis] = *high;
  }
  return box;
}

Box drawn_bounds(const Snapshot& snapshot) {
  constexpr int fine_enough = 4;
  Box box;
  for (const BodySnapshot& body : snapshot.bodies) {
    const SurfaceSnapshot& surface = body.surface;
    TessellatedSurface tessellated;
    if (body.is_mesh()) {
      tessellated.update(body.mesh);
    } else if (!check_net(surface) ||
               !tessellated.update(surface, uniform_sampling_level(surface, fine_enough))) {
      continue;
    }
    const Box one = tessellated.bounds();
    if (one.is_empty()) continue;
    box.join(one);
  }
  return box;
}

}  // namespace spoonbill
