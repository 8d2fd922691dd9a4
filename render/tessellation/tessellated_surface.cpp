#include "render/tessellation/tessellated_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/geometry.h"
#include "engine/collision/meshes/mesh_edges.h"

namespace spoonbill {
namespace {

Eigen::Vector3d vertex(const GridSamples<float>& samples, std::size_t i) {
  return {samples.x[i], samples.y[i], samples.z[i]};
}

// Cosine of 40 degrees. Faces that meet at a larger angle have a sharp edge between them.
constexpr float smooth_cosine = 0.766F;

Eigen::Vector3f position(const MeshSnapshot& mesh, std::uint32_t vertex) {
  return {mesh.x[vertex], mesh.y[vertex], mesh.z[vertex]};
}

// Returns the normal of a triangle, with twice its area as length.
Eigen::Vector3f face_normal(const MeshSnapshot& mesh, const std::array<std::uint32_t, 3>& corners) {
  const Eigen::Vector3f a = position(mesh, corners[0]);
  return (position(mesh, corners[1]) - a).cross(position(mesh, corners[2]) - a);
}

// Disjoint sets of triangle corners; each set is drawn as one vertex.
class CornerGroups {
 public:
  explicit CornerGroups(std::size_t corners) : parent_(corners) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

constexpr std::array<int, 10> piece_steps = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32};

// A polynomial span keeps its previous number of pieces while the ratio of the needed number to the previous
// number is above tolerated_waste and at most tolerated_excess.
constexpr double tolerated_excess = 1.15;
constexpr double tolerated_waste = 0.4;

// The control points along one line of the net, in the order of the basis functions, with periodic lines
// unrolled.
class NetLine {
 public:
  NetLine(const SurfaceSnapshot& surface, bool along_u, int across)
      : surface_(surface),
        count_((along_u ? surface.u : surface.v).control_point_count()),
        start_(along_u ? across : across * surface.v.control_point_count()),
        stride_(along_u ? surface.v.control_point_count() : 1) {}

  Vector3 operator[](int i) const {
    const auto at = static_cast<std::size_t>(start_ + (i % count_) * stride_);
    return {surface_.x[at], surface_.y[at], surface_.z[at]};
  }

 private:
  const SurfaceSnapshot& surface_;
  int count_;
  int start_;
  int stride_;
};

// Bounds on the derivatives of a surface along one direction. On each line of the net, a derivative is a
// spline with its own control points. Entry i of each list is the largest value at control point i of this
// spline, over all lines. `speed` bounds the length of the first derivative S' in metres per parameter.
// `bend` estimates the component of S'' perpendicular to S', which curves a line.
struct DerivativeBounds {
  std::vector<double> speed;  // control point i acts on spans i + 1 to i + degree
  std::vector<double> bend;   // control point i acts on spans i + 2 to i + degree
};

void include_line(const NetLine& line, const KnotVector& knots, DerivativeBounds& bounds) {
  const auto& t = knots.extended_knots();
  const int p = knots.degree();
  Vector3 before = Vector3::Zero();
  for (int i = 0; i < static_cast<int>(bounds.speed.size()); ++i) {
    const double width = t[i + p + 1] - t[i + 1];
    const Vector3 slope = width > 0.0 ? Vector3((line[i + 1] - line[i]) * (p / width)) : before;
    bounds.speed[i] = std::max(bounds.speed[i], slope.norm());
    const double inner_width = t[i + p] - t[i + 1];
    if (i > 0 && p > 1 && inner_width > 0.0) {
      const Vector3 second = (slope - before) * ((p - 1) / inner_width);
      const Vector3 direction = (slope + before).normalized();
      bounds.bend[i - 1] = std::max(bounds.bend[i - 1], (second - direction * direction.dot(second)).norm());
    }
    before = slope;
  }
}

DerivativeBounds derivative_bounds(const SurfaceSnapshot& surface, bool along_u) {
  const KnotVector& knots = along_u ? surface.u : surface.v;
  const int lines = (along_u ? surface.v : surface.u).control_point_count();
  const std::size_t slopes = knots.extended_knots().size() - static_cast<std::size_t>(knots.degree()) - 2;
  DerivativeBounds bounds{std::vector<double>(slopes), std::vector<double>(slopes)};
  for (int across = 0; across < lines; ++across) {
    include_line(NetLine(surface, along_u, across), knots, bounds);
  }
  return bounds;
}

// Returns the largest of the values from index `first` to `last`. Indices that do not exist are skipped.
double maximum_over(const std::vector<double>& values, int first, int last) {
  double maximum = 0.0;
  for (int i = std::max(first, 0); i <= last && i < static_cast<int>(values.size()); ++i) {
    maximum = std::max(maximum, values[static_cast<std::size_t>(i)]);
  }
  return maximum;
}

int choose_pieces(double needed, int previous) {
  if (previous > 0 && needed <= previous * tolerated_excess && needed > previous * tolerated_waste) {
    return previous;
  }
  const auto step = std::lower_bound(piece_steps.begin(), piece_steps.end(), needed);
  return step == piece_steps.end() ? piece_steps.back() : *step;
}

std::vector<int> pieces_along(const SurfaceSnapshot& surface, bool along_u, double pixels_per_metre,
                              const std::vector<int>& previous, const SamplingTarget& target) {
  const KnotVector& knots = along_u ? surface.u : surface.v;
  const DerivativeBounds bounds = derivative_bounds(surface, along_u);
  const std::vector<double> breakpoints = knots.breakpoints();
  const std::size_t spans = breakpoints.size() - 1;
  std::vector<int> pieces(spans);
  for (std::size_t s = 0; s < spans; ++s) {
    const double width = breakpoints[s + 1] - breakpoints[s];
    const int k = knots.find_span(0.5 * (breakpoints[s] + breakpoints[s + 1]));
    const double speed = maximum_over(bounds.speed, k - knots.degree(), k - 1);
    const double bend = maximum_over(bounds.bend, k - knots.degree(), k - 2);
    const double edge_px = speed * width * pixels_per_metre;
    // The chord over a parameter width h deviates from its arc by at most h^2 |S''| / 8.
    const double sagitta_px = bend * width * width / 8.0 * pixels_per_metre;
    const double needed =
        std::max(edge_px / target.longest_edge_px, std::sqrt(sagitta_px / target.largest_sagitta_px));
    pieces[s] = choose_pieces(needed, previous.size() == spans ? previous[s] : 0);
  }
  return pieces;
}

std::int64_t pieces_below(const std::vector<int>& pieces, int maximum) {
  std::int64_t sum = 0;
  for (const int count : pieces) sum += std::min(count, maximum);
  return sum;
}

// Reduces the pieces of the finest spans until the number of cells is within the limit.
void thin(SamplingLevel& level) {
  auto maximum = piece_steps.rbegin();
  while (std::next(maximum) != piece_steps.rend() &&
         pieces_below(level.u_pieces, *maximum) * pieces_below(level.v_pieces, *maximum) >
             sampling_cell_limit) {
    ++maximum;
  }
  for (std::vector<int>* pieces : {&level.u_pieces, &level.v_pieces}) {
    for (int& count : *pieces) count = std::min(count, *maximum);
  }
}

}  // namespace

Status check_net(const SurfaceSnapshot& surface) {
  const auto expected = static_cast<std::size_t>(surface.u.control_point_count()) *
                        static_cast<std::size_t>(surface.v.control_point_count());
  if (surface.x.size() == expected && surface.y.size() == expected && surface.z.size() == expected) return {};
  return Error{ErrorCode::inconsistent, "surface to draw: its knots need " + std::to_string(expected) +
                                            " control points, its net has " +
                                            std::to_string(surface.x.size())};
}

Status TessellatedSurface::update(const SurfaceSnapshot& surface, const SamplingLevel& level) {
  if (Status net = check_net(surface); !net) return net;
  const bool unchanged = !is_mesh_ && evaluator_ && structure_ == surface.structure && level_ == level &&
                         grid_->u.knots == surface.u && grid_->v.knots == surface.v && trim_ == surface.trim;
  if (!unchanged) {
    if (Status built = rebuild(surface, level); !built) return built;
  }
  evaluator_->points_and_normals(surface.x.data(), surface.y.data(), surface.z.data(), samples_);
  if (!unchanged) orient();
  fill_cut_vertices();
  if (inward_) {
    for (auto* component : {&samples_.nx, &samples_.ny, &samples_.nz}) {
      for (float& value : *component) value = -value;
    }
  }
  return {};
}

void TessellatedSurface::update(const MeshSnapshot& mesh) {
  if (!is_mesh_ || !shading_.matches(mesh)) {
    shading_.rebuild(mesh);
    indices_ = shading_.indices();
    ++topology_version_;
    is_mesh_ = true;
    level_ = {};
    trim_ = nullptr;
    cut_vertices_.clear();
  }
  closed_ = mesh.is_closed;
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

// Returns true if row `at` of the samples (column `at` if not `along_u`) has shrunk to a point.
bool TessellatedSurface::is_edge_collapsed(bool along_u, int at) const {
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
  const bool u_closed = grid_->u.knots.is_periodic() ||
                        (is_edge_collapsed(true, 0) && is_edge_collapsed(true, grid_->rows() - 1));
  const bool v_closed = grid_->v.knots.is_periodic() ||
                        (is_edge_collapsed(false, 0) && is_edge_collapsed(false, grid_->columns() - 1));
  closed_ = u_closed && v_closed;
  inward_ = closed_ && signed_volume_m3() < 0.0;
  if (trim_) trim_indices();
  if (!inward_) return;
  for (std::size_t i = 0; i + 2 < indices_.size(); i += 3) std::swap(indices_[i + 1], indices_[i + 2]);
}

// Replaces the triangles of the whole surface by those within the trim loops. orient() calls this after it
// has determined whether the whole surface is closed and which side is outside.
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

void MeshShading::rebuild(const MeshSnapshot& mesh) {
  SPOONBILL_ASSERT(mesh.triangles != nullptr);
  triangles_ = mesh.triangles;
  const auto& triangles = *triangles_;
  const MeshEdges edges(triangles, mesh.x.size());
  CornerGroups groups(3 * triangles.size());
  for (MeshSide side = 0; side < 3 * triangles.size(); ++side) {
    const MeshSide other = edges.across(side);
    if (other == MeshEdges::open || other == MeshEdges::branching) continue;
    const Eigen::Vector3f one = face_normal(mesh, triangles[side / 3]).normalized();
    if (one.dot(face_normal(mesh, triangles[other / 3]).normalized()) < smooth_cosine) continue;
    // Adjacent triangles traverse their common side in opposite directions, so the other side starts where
    // this one ends.
    groups.join(side, next_side(other));
  }
  indices_.assign(3 * triangles.size(), 0);
  vertex_.clear();
  constexpr std::uint32_t none = 0xffffffffU;
  std::vector<std::uint32_t> drawn(3 * triangles.size(), none);
  for (std::uint32_t corner = 0; corner < indices_.size(); ++corner) {
    std::uint32_t& index = drawn[groups.find(corner)];
    if (index == none) {
      index = static_cast<std::uint32_t>(vertex_.size());
      vertex_.push_back(triangles[corner / 3][corner % 3]);
    }
    indices_[corner] = index;
  }
}

void MeshShading::shade(const MeshSnapshot& mesh, GridSamples<float>& samples) const {
  SPOONBILL_ASSERT(matches(mesh));
  samples.resize(vertex_.size());
  for (std::size_t v = 0; v < vertex_.size(); ++v) {
    samples.x[v] = mesh.x[vertex_[v]];
    samples.y[v] = mesh.y[vertex_[v]];
    samples.z[v] = mesh.z[vertex_[v]];
    samples.nx[v] = samples.ny[v] = samples.nz[v] = 0.0F;
  }
  for (std::size_t t = 0; t < triangles_->size(); ++t) {
    const Eigen::Vector3f normal = face_normal(mesh, (*triangles_)[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = indices_[3 * t + k];
      samples.nx[v] += normal.x();
      samples.ny[v] += normal.y();
      samples.nz[v] += normal.z();
    }
  }
  for (std::size_t v = 0; v < vertex_.size(); ++v) {
    const float length = std::hypot(samples.nx[v], samples.ny[v], samples.nz[v]);
    if (!(length > 0.0F)) continue;
    samples.nx[v] /= length;
    samples.ny[v] /= length;
    samples.nz[v] /= length;
  }
}

SamplingLevel uniform_sampling_level(const SurfaceSnapshot& surface, int pieces) {
  SPOONBILL_ASSERT(pieces >= 1);
  return {std::vector<int>(surface.u.breakpoints().size() - 1, pieces),
          std::vector<int>(surface.v.breakpoints().size() - 1, pieces)};
}

SamplingLevel choose_sampling_level(const SurfaceSnapshot& surface, double pixels_per_metre,
                                    const SamplingLevel& previous, const SamplingTarget& target) {
  SPOONBILL_ASSERT(surface.x.size() == static_cast<std::size_t>(surface.u.control_point_count()) *
                                           surface.v.control_point_count());
  SamplingLevel level{pieces_along(surface, true, pixels_per_metre, previous.u_pieces, target),
                      pieces_along(surface, false, pixels_per_metre, previous.v_pieces, target)};
  thin(level);
  return level;
}

std::vector<double> drawing_parameters(const KnotVector& knots, const std::vector<int>& pieces) {
  SPOONBILL_ASSERT(pieces.size() + 1 == knots.breakpoints().size());
  const std::vector<double> breakpoints = knots.breakpoints();
  std::vector<double> parameters;
  for (std::size_t s = 0; s + 1 < breakpoints.size(); ++s) {
    const double width = breakpoints[s + 1] - breakpoints[s];
    for (int i = 0; i < pieces[s]; ++i) parameters.push_back(breakpoints[s] + width * i / pieces[s]);
  }
  if (!knots.is_periodic()) parameters.push_back(breakpoints.back());
  return parameters;
}

}  // namespace spoonbill
